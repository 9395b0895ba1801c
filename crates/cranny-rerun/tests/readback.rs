//! What a recording holds is in the file, as Rerun's own decoder reads it.

#[path = "../../cranny-record/tests/pendulum/mod.rs"]
mod pendulum;
mod rrd;

use std::fs;
use std::net::TcpListener;
use std::path::{Path, PathBuf};

use cranny_exact::{DVec3, Pose};
use cranny_geometry::Mesh;
use cranny_record::{Frame, RecordedBody, Recorder, Recording, RecordingInfo};
use cranny_rerun::{RerunError, write};
use cranny_shapes::Cuboid;
use pendulum::{BODIES, DT, PNG, record};
use re_sdk_types::archetypes::{
    Arrows3D, Clear, EncodedImage, LineStrips3D, Mesh3D, Points3D, Scalars, TextDocument, TextLog,
    Transform3D,
};
use re_sdk_types::components;
use rrd::{Row, Rrd};
use tempfile::TempDir;

const STEPS: u64 = 300;

/// A recording of the pendulum.
fn recorded(folder: &TempDir) -> PathBuf {
    let path = folder.path().join("run.mcap");
    let (recorder, _) = record(&path, STEPS).unwrap();
    recorder.finish().unwrap();
    path
}

/// A recording and what Rerun reads of it.
fn converted(path: &Path) -> (Recording, Rrd) {
    let recording = Recording::open(path).unwrap();
    let out = path.with_extension("rrd");
    let written = write(&recording, &out).unwrap();
    assert_eq!(written.bytes, fs::metadata(&out).unwrap().len());
    assert_eq!(written.frames, recording.transforms().unwrap().len());
    (recording, Rrd::read(&out))
}

fn at(time: u64, step: u64) -> Option<(i64, i64)> {
    Some((i64::try_from(time).unwrap(), i64::try_from(step).unwrap()))
}

#[test]
fn every_body_has_one_mesh_and_a_transform_a_frame() {
    let folder = TempDir::new().unwrap();
    let (recording, rrd) = converted(&recorded(&folder));
    let (bodies, transforms) = (recording.bodies().unwrap(), recording.transforms().unwrap());
    assert_eq!(bodies.len(), BODIES.len());
    for body in bodies {
        let entity = format!("/bodies/{}", body.name);
        let triangles: Vec<Row<components::TriangleIndices>> =
            rrd.rows(&entity, &Mesh3D::descriptor_triangle_indices());
        let [(None, triangles)] = &triangles[..] else { panic!("{entity} has one mesh, always") };
        assert_eq!(triangles.len(), body.mesh.faces().len());
        let corners: Vec<Row<components::Position3D>> =
            rrd.rows(&entity, &Mesh3D::descriptor_vertex_positions());
        let normals: Vec<Row<components::Vector3D>> =
            rrd.rows(&entity, &Mesh3D::descriptor_vertex_normals());
        assert_eq!(normals[0].1.len(), corners[0].1.len());
        for (triangle, face) in triangles.iter().zip(body.mesh.faces()) {
            for (corner, vertex) in triangle.0.0.into_iter().zip(face) {
                let vertex = body.mesh.vertices()[*vertex as usize].as_vec3().to_array();
                assert_eq!(corners[0].1[corner as usize].0.0, vertex);
            }
        }
        let color: Vec<Row<components::AlbedoFactor>> =
            rrd.rows(&entity, &Mesh3D::descriptor_albedo_factor());
        assert_eq!(color[0].1[0].0.0, 0x99_B3_CC_FF, "0.6, 0.7, 0.8 and 1 of 255");

        let translations: Vec<Row<components::Translation3D>> =
            rrd.rows(&entity, &Transform3D::descriptor_translation());
        let rotations: Vec<Row<components::RotationQuat>> =
            rrd.rows(&entity, &Transform3D::descriptor_quaternion());
        let steps = (0..STEPS).zip(&transforms);
        let expected: Vec<_> = steps
            .map(|(step, (time, poses))| {
                let pose = poses[&body.name];
                let translation = pose.translation.as_vec3().to_array();
                (at(*time, step), translation, pose.rotation.as_quat().to_array())
            })
            .collect();
        let read: Vec<_> = translations
            .iter()
            .zip(&rotations)
            .map(|((time, t), (_, q))| (*time, t[0].0.0, q[0].0.0))
            .collect();
        assert_eq!(read, expected);
    }
}

#[test]
fn contacts_are_those_of_each_frame() {
    let folder = TempDir::new().unwrap();
    let (recording, rrd) = converted(&recorded(&folder));
    let changing = |rows: Vec<Row<components::Position3D>>| -> Vec<_> {
        rows.into_iter().filter_map(|(time, values)| Some((time?, values))).collect()
    };
    let points = changing(rrd.rows("/contacts/points", &Points3D::descriptor_positions()));
    let origins = changing(rrd.rows("/contacts/normals", &Arrows3D::descriptor_origins()));
    let vectors: Vec<Row<components::Vector3D>> =
        rrd.rows("/contacts/normals", &Arrows3D::descriptor_vectors());
    let strips: Vec<Row<components::LineStrip3D>> =
        rrd.rows("/contacts/curves", &LineStrips3D::descriptor_strips());
    let labels: Vec<Row<components::Text>> =
        rrd.rows("/contacts/points", &Points3D::descriptor_labels());
    let (stats, drawn) = (recording.stats().unwrap(), recording.contact_points().unwrap());
    let contacts = recording.contacts().unwrap();
    assert_eq!([points.len(), origins.len(), strips.len()], [stats.len(); 3]);
    let (mut most, mut most_curves, mut deep) = (0, 0, 0);
    for (frame, (time, stats)) in stats.iter().enumerate() {
        let (read, found) = (&points[frame], &drawn[frame].1);
        assert_eq!(Some(read.0), at(*time, stats.step));
        assert_eq!((read.1.len(), found.len()), (stats.contacts, stats.contacts));
        for ((point, contact), label) in read.1.iter().zip(found).zip(&labels[frame].1) {
            assert_eq!(point.0.0, contact.point);
            let pair = &contacts[frame].1.pairs[contact.pair];
            assert!(label.starts_with(&format!("{} and {}: ", pair.a, pair.b)), "{label:?}");
            assert_eq!(label.ends_with("deep"), contact.separation <= 0.0);
            deep += usize::from(contact.separation < 0.0);
        }
        // Every contact of this run has a normal.
        assert_eq!(origins[frame].1, read.1);
        let length = |v: &components::Vector3D| v.0.0.iter().map(|x| x * x).sum::<f32>().sqrt();
        let expected = 0.15 * 0.75f32.sqrt();
        assert!(vectors[frame].1.iter().all(|v| (length(v) - expected).abs() < 1e-5));
        let regions = contacts[frame].1.pairs.iter().flat_map(|pair| &pair.regions);
        let curves: u32 = regions.map(|region| region.curve_count).sum();
        assert_eq!(strips[frame].1.len(), curves as usize);
        most = most.max(stats.contacts);
        most_curves = most_curves.max(curves);
    }
    assert!(most > 3 && most_curves > 0 && deep > 10, "{most} {most_curves} {deep}");
}

#[test]
fn numbers_words_and_pictures_are_there() {
    let folder = TempDir::new().unwrap();
    let (recording, rrd) = converted(&recorded(&folder));
    let scalars = |entity: &str| -> Vec<(Option<(i64, i64)>, f64)> {
        let rows: Vec<Row<components::Scalar>> = rrd.rows(entity, &Scalars::descriptor_scalars());
        rows.into_iter().map(|(time, values)| (time, values[0].0.0)).collect()
    };
    let stats = recording.stats().unwrap();
    let series = |value: &dyn Fn(&cranny_record::StatsMessage) -> f64| -> Vec<_> {
        stats.iter().map(|(time, stats)| (at(*time, stats.step), value(stats))).collect()
    };
    assert_eq!(scalars("/plots/contacts/contacts"), series(&|stats| stats.contacts as f64));
    assert_eq!(scalars("/plots/tests/triangles"), series(&|stats| stats.triangle_tests as f64));
    let depth = series(&|stats| stats.deepest.as_ref().map_or(0.0, |deepest| deepest.depth));
    assert_eq!(scalars("/plots/depth/deepest"), depth);
    assert!(depth.iter().any(|(_, depth)| *depth > 0.0));
    assert_eq!(scalars("/plots/measures/swing"), series(&|s| s.measures[0].value.unwrap()));

    let lines = |entity: &str| -> Vec<Row<components::Text>> {
        rrd.rows(entity, &TextLog::descriptor_text())
    };
    let last = stats.last().unwrap();
    let log = lines("/log");
    assert_eq!((log.len(), log[0].0, log[0].1[0].as_str()), (1, at(last.0, STEPS - 1), "swung"));
    let events: Vec<_> = recording.events().unwrap();
    let happened: usize = events.iter().map(|(_, message)| message.events.len()).sum();
    let shown = lines("/events");
    assert!(happened > 1 && shown.len() == happened, "{happened}");
    assert_eq!(shown[0].1[0].as_str(), "ring and bob begin to touch");
    let about: Vec<Row<components::Text>> = rrd.rows("/about", &TextDocument::descriptor_text());
    assert!(about[0].1[0].contains("| scene | pendulum |"), "{about:?}");
    let pictures: Vec<Row<components::Blob>> =
        rrd.rows("/camera/main", &EncodedImage::descriptor_blob());
    assert_eq!((pictures.len(), &pictures[0].1[0].0[..]), (1, PNG));
    assert!(rrd.layout_chunks > 5, "{}", rrd.layout_chunks);
    let named = |group: &str| rrd.entities().iter().filter(|e| e.starts_with(group)).count();
    assert_eq!(["/bodies/", "/contacts/", "/plots/", "/"].map(named), [3, 3, 11, 22]);
}

/// A recording of boxes that stand still; `plan` says what happens before each of four frames.
fn boxes(path: &Path, plan: impl Fn(&mut Recorder, u64, &[Mesh; 2])) {
    let meshes = [1.0, 2.0].map(|size| Cuboid { size: [size; 3] }.build().unwrap());
    let mut recorder = Recorder::create(path, &RecordingInfo::new(DT)).unwrap();
    for step in 10..14 {
        plan(&mut recorder, step, &meshes);
        let poses = vec![("a/b", Pose::at(DVec3::X * (step - 10) as f64))];
        recorder.frame(&Frame { poses, ..Frame::at_step(step) }).unwrap();
    }
    recorder.finish().unwrap();
}

fn body<'a>(name: &'a str, mesh: &'a Mesh) -> RecordedBody<'a> {
    RecordedBody {
        name,
        mesh,
        color: [1.0; 4],
        color_is_stated: false,
        number: None,
        sensor: false,
        model: None,
        primitive: None,
        kind: None,
    }
}

#[test]
fn bodies_that_come_change_and_leave_do_so_in_time() {
    let folder = TempDir::new().unwrap();
    let path = folder.path().join("boxes.mcap");
    boxes(&path, |recorder, step, [small, large]| match step {
        11 => recorder.bodies(step, &[body("a/b", small)]).unwrap(),
        12 => {
            recorder.remove_body(step, "a/b").unwrap();
            recorder.bodies(step, &[body("a/b", large)]).unwrap();
        }
        13 => recorder.remove_body(step, "a/b").unwrap(),
        _ => {}
    });
    let (_, rrd) = converted(&path);
    // One part of a path: its transforms are not those of something beneath `a`.
    let entity = r"/bodies/a\/b";
    let meshes: Vec<Row<components::Position3D>> =
        rrd.rows(entity, &Mesh3D::descriptor_vertex_positions());
    let time = |step: u64| at((step as f64 * DT * 1e9).round() as u64, step);
    let seen: Vec<_> =
        meshes.iter().map(|(time, corners)| (*time, corners[0].0.0[0].abs())).collect();
    assert_eq!(seen, [(time(11), 0.5), (time(12), 1.0)]);
    let cleared: Vec<Row<components::ClearIsRecursive>> =
        rrd.rows(entity, &Clear::descriptor_is_recursive());
    assert_eq!(cleared.iter().map(|(time, _)| *time).collect::<Vec<_>>(), [time(13)]);
}

#[test]
fn what_is_cut_off_or_damaged_is_refused_and_leaves_no_file() {
    let folder = TempDir::new().unwrap();
    let whole = fs::read(recorded(&folder)).unwrap();
    let out_folder = TempDir::new().unwrap();
    let out = out_folder.path().join("run.rrd");
    let path = folder.path().join("broken.mcap");
    let convert = |bytes: &[u8]| -> Result<(), String> {
        fs::write(&path, bytes).unwrap();
        let recording = Recording::open(&path).map_err(|error| error.to_string())?;
        write(&recording, &out).map(drop).map_err(|error| error.to_string())
    };
    let files = || fs::read_dir(out_folder.path()).unwrap().count();
    for part in 0..16 {
        let message = convert(&whole[..whole.len() * part / 16]).unwrap_err();
        assert!(message.contains("broken.mcap"), "{message}");
        assert!(part == 0 || message.contains("cranny recover"), "{message}");
        assert_eq!(files(), 0);
    }
    let mut refused = 0;
    for part in 1..24 {
        let mut damaged = whole.clone();
        damaged[whole.len() * part / 24] ^= 0x10;
        match convert(&damaged) {
            // Damage in the index costs nothing.
            Ok(()) => fs::remove_file(&out).unwrap(),
            Err(message) => {
                assert!(message.contains("broken.mcap"), "{message}");
                refused += 1;
            }
        }
        assert_eq!(files(), 0);
    }
    assert!(refused > 12, "{refused}");
    let empty = folder.path().join("empty.mcap");
    Recorder::create(&empty, &RecordingInfo::new(DT)).unwrap().finish().unwrap();
    let error = write(&Recording::open(&empty).unwrap(), &out).unwrap_err();
    assert!(matches!(error, RerunError::Empty { .. }), "{error}");
    assert_eq!(files(), 0);
}

#[test]
fn what_cannot_be_written_is_named_and_leaves_nothing() {
    let folder = TempDir::new().unwrap();
    let recording = Recording::open(recorded(&folder)).unwrap();
    let refused = |out: &Path| {
        let error = write(&recording, out).unwrap_err();
        assert!(matches!(error, RerunError::Write { .. }), "{error}");
        let message = error.to_string();
        assert!(message.contains(&out.display().to_string()), "{message}");
        message
    };
    refused(&folder.path().join("none/run.rrd"));
    let in_the_way = folder.path().join("folder.rrd");
    fs::create_dir(&in_the_way).unwrap();
    refused(&in_the_way);
    assert!(!folder.path().join("folder.rrd.partial").exists());
    #[cfg(target_os = "linux")]
    {
        let full = folder.path().join("full.rrd");
        let partial = folder.path().join("full.rrd.partial");
        std::os::unix::fs::symlink("/dev/full", partial).unwrap();
        assert!(refused(&full).contains("No space"));
        assert!(!full.exists());
    }
}

#[test]
fn nobody_who_listens_is_named() {
    let folder = TempDir::new().unwrap();
    let recording = Recording::open(recorded(&folder)).unwrap();
    // A port that was free a moment ago.
    let port = TcpListener::bind("127.0.0.1:0").unwrap().local_addr().unwrap().port();
    let closed = format!("rerun+http://127.0.0.1:{port}/proxy");
    for url in ["nowhere", "rerun+http://127.0.0.1:1/catalog", &closed] {
        let message = cranny_rerun::send(&recording, url).unwrap_err().to_string();
        assert!(message.contains(url) && message.contains("'rerun'"), "{message}");
    }
}
