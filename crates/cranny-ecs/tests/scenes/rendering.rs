//! Pictures of a run; where no adapter is found, that the run says so.

use cranny_ecs::*;
use cranny_world::description::{CameraDescription, CameraView, Effect};

use crate::build::gate;

#[test]
fn pictures_are_written_or_said_to_be_skipped() {
    let folder = tempfile::tempdir().unwrap();
    let (frames, preview) = (folder.path().join("new/frames"), folder.path().join("preview.png"));
    let mut scene = gate(&[Effect::Contacts { margin: 0.1 }]);
    scene.cameras = [("front", CameraView::Front), ("top", CameraView::Top)]
        .map(|(name, view)| CameraDescription { name: name.into(), view })
        .into();
    let options = RunOptions {
        duration: Some(1.0),
        pictures: PictureOptions {
            frames: Some(frames.clone()),
            preview: Some(preview.clone()),
            ..PictureOptions::default()
        },
        ..RunOptions::default()
    };
    let mut app = SceneApp::new(&scene, &options).unwrap();
    while app.step().unwrap() {}
    let summary = app.finish().unwrap();
    if let Some(skipped) = summary.skipped.iter().find(|skipped| skipped.what == "pictures") {
        assert!(!skipped.why.is_empty() && summary.outputs.is_empty() && !preview.exists());
        return;
    }
    assert_eq!(summary.outputs.len(), 2);
    // Four steps of a quarter of a second, and the end; two cameras.
    for number in 0..5 {
        for camera in ["front", "top"] {
            let path = frame_path(&frames, camera, number);
            assert!(std::fs::read(&path).unwrap().starts_with(b"\x89PNG"), "{path:?}");
        }
    }
    assert!(!frame_path(&frames, "front", 5).exists());
    let animation = std::fs::read(&preview).unwrap();
    assert!(animation.windows(4).any(|chunk| chunk == b"acTL"));
    assert!(summary.time_ms.render > 0.0);
}

#[test]
fn pictures_read_points_in_the_steps_that_they_show_and_at_the_end() {
    let folder = tempfile::tempdir().unwrap();
    let mut scene = gate(&[Effect::Contacts { margin: 0.1 }]);
    scene.step = 0.05;
    let preview = Some(folder.path().join("preview.png"));
    let options = RunOptions {
        plugins: PluginOptions { contact_fields: ContactFields::NONE, ..PluginOptions::default() },
        pictures: PictureOptions { preview, ..PictureOptions::default() },
        ..RunOptions::default()
    };
    let mut app = SceneApp::new(&scene, &options).unwrap();
    let painted = |app: &SceneApp| app.app().world().get_resource::<Painter>().map(Painter::drawn);
    let read = |app: &SceneApp| {
        let readers = app.app().world().resource::<ContactReaders>();
        readers.of(ContactReaders::PICTURES).points
    };
    let Some(mut before) = painted(&app) else { return };
    for _ in 0..12 {
        app.step().unwrap();
        let now = painted(&app).unwrap();
        assert_eq!(read(&app), now > before, "step {}", app.steps_done());
        before = now;
    }
    assert!(before > 1 && before < 12, "{before} of 12 steps are shown");
}

#[test]
fn an_unwritable_picture_is_refused_before_anything_runs() {
    let folder = tempfile::tempdir().unwrap();
    let preview = folder.path().join("missing/preview.png");
    let file = folder.path().join("file");
    std::fs::write(&file, "").unwrap();
    for pictures in [
        PictureOptions { preview: Some(preview.clone()), ..PictureOptions::default() },
        PictureOptions { frames: Some(file.clone()), ..PictureOptions::default() },
    ] {
        let path = pictures.preview.clone().or(pictures.frames.clone()).unwrap();
        let options = RunOptions { pictures, ..RunOptions::default() };
        let error = SceneApp::new(&gate(&[]), &options).err().unwrap().to_string();
        assert!(error.contains(&path.display().to_string()), "{error}");
    }
}

/// A software adapter; `None` where the machine has none.
fn renderer() -> Option<cranny_render::Renderer> {
    use cranny_render::{RenderError, Renderer, RendererOptions};
    match Renderer::new(&RendererOptions { software: true, ..RendererOptions::default() }) {
        Ok(renderer) => Some(renderer),
        Err(RenderError::NoAdapter { .. }) => {
            #[expect(clippy::print_stderr, reason = "a skipped test says so")]
            {
                eprintln!("skipped: no software graphics adapter (install mesa-vulkan-drivers)");
            }
            None
        }
        Err(error) => panic!("{error}"),
    }
}

const SIZE: [u32; 2] = [240, 160];

fn moment(poses: &[f64]) -> Moment {
    let place = |(i, x): (u32, &f64)| {
        (BodyId(i), cranny_exact::Pose::at(cranny_exact::DVec3::new(*x, 0.0, 0.0)))
    };
    Moment { poses: (0..).zip(poses).map(place).collect(), ..Moment::default() }
}

#[test]
fn what_stands_still_before_what_moves_lets_it_be_seen() {
    let Some(mut renderer) = renderer() else { return };
    let mut scene = gate(&[]);
    scene.cameras = vec![CameraDescription { name: "side".into(), view: CameraView::Side }];
    // The camera looks along −x: the gate stands before the guest, or behind it.
    for (gate_at, hidden) in [(2.0, true), (-2.0, false)] {
        let size = ScenePainter::camera_size(ScenePainterView::Scene, SIZE).unwrap();
        let mut picture = |with_guest: bool, quality| {
            let mut painter = ScenePainter::new(&scene, size, quality).unwrap();
            let mut moment = moment(&[gate_at, 0.0]);
            let both = painter.draw(&mut renderer, &moment, ScenePainterView::Scene, SIZE).unwrap();
            if !with_guest {
                moment.poses.pop_last();
                return painter
                    .draw(&mut renderer, &moment, ScenePainterView::Scene, SIZE)
                    .unwrap();
            }
            both
        };
        let (with, without) =
            (picture(true, PictureQuality::Draft), picture(false, PictureQuality::Draft));
        let change = with.difference(&without, 12).unwrap().differing;
        assert!(change > 0.03, "seen, hidden: {hidden}: {change}");
    }
}

/// A guest that comes from the left leaves its way and ghosts; a run that begins anew has none.
#[test]
fn a_view_of_motion_shows_where_bodies_were() {
    let Some(mut renderer) = renderer() else { return };
    let mut scene = gate(&[]);
    scene.cameras = vec![CameraDescription { name: "top".into(), view: CameraView::Top }];
    let view = ScenePainterView::Motion;
    let size = ScenePainter::camera_size(view, SIZE).unwrap();
    let mut painter = ScenePainter::new(&scene, size, PictureQuality::Draft).unwrap();
    let at = |time: f64, x: f64| Moment { time, ..moment(&[2.0, x]) };
    let mut draw = |time: f64, x: f64| painter.draw(&mut renderer, &at(time, x), view, SIZE);
    let alone = draw(0.2, 1.0).unwrap();
    let early = [draw(0.0, -3.0), draw(0.1, -1.0)].map(Result::unwrap);
    let late = draw(0.2, 1.0).unwrap();
    assert!(late.difference(&alone, 12).unwrap().differing > 0.02);
    let again = draw(0.0, -3.0).unwrap();
    assert_eq!(again.difference(&early[0], 0).unwrap().differing, 0.0);
    assert!(again.difference(&early[1], 12).unwrap().differing > 0.01);
}

/// Of two rings that hang in each other a search from nothing looks at more than that of the next
/// frame: the left half of the picture is painted more.
#[test]
fn a_view_of_heat_shows_what_a_search_looks_at() {
    let Some(mut renderer) = renderer() else { return };
    let mut scene = gate(&[]);
    let ring = std::sync::Arc::new(cranny_shapes::Torus::default().build().unwrap());
    let options = cranny_geometry::BuildOptions::default();
    let (model, _) = cranny_geometry::Model::build((*ring).clone(), &options).unwrap();
    for body in &mut scene.bodies {
        body.collision = ring.clone();
        body.shape = Some(model.clone().into());
    }
    let (view, size) = (ScenePainterView::Heat, [480, 160]);
    let camera_size = ScenePainter::camera_size(view, size).unwrap();
    let mut painter = ScenePainter::new(&scene, camera_size, PictureQuality::Draft).unwrap();
    let at = |k: u32| {
        let mut moment = Moment { time: f64::from(k), ..moment(&[0.0, 0.0]) };
        let guest = moment.poses.get_mut(&BodyId(1)).unwrap();
        guest.rotation = cranny_exact::DQuat::from_rotation_x(1.5);
        guest.translation.x = 0.7 - 0.0005 * f64::from(k);
        moment
    };
    let painted = |image: &cranny_render::Image| {
        let width = image.size().width() as usize;
        let mut halves = [0; 2];
        for (at, p) in image.pixels().chunks_exact(4).take(width * 160).enumerate() {
            // Blue and green, not grey.
            let is = p[2] > p[0].saturating_add(60);
            halves[usize::from(at % width >= width / 2)] += usize::from(is);
        }
        halves
    };
    let first = painter.draw(&mut renderer, &at(0), view, size).unwrap();
    let [cold, same] = painted(&first);
    assert!(cold > 100 && cold.abs_diff(same) < 10, "nothing is remembered yet: {cold}, {same}");
    (1..12).for_each(|k| painter.follow(f64::from(k), &at(k).poses));
    let image = painter.draw(&mut renderer, &at(12), view, size).unwrap();
    let [cold, warm] = painted(&image);
    assert!(4 * cold > 5 * warm, "{cold} and {warm} pixels");
    assert!(image.size().height() > 200, "words stand below the pictures");
}

#[test]
fn an_x_ray_has_its_words() {
    let Some(mut renderer) = renderer() else { return };
    let scene = gate(&[]);
    for view in [ScenePainterView::XRay, ScenePainterView::Wireframe] {
        let size = ScenePainter::camera_size(view, SIZE).unwrap();
        let mut painter = ScenePainter::new(&scene, size, PictureQuality::Draft).unwrap();
        let image = painter.draw(&mut renderer, &moment(&[2.0, 0.0]), view, SIZE).unwrap();
        let [width, height] = SIZE;
        assert!(image.size().width() == width && image.size().height() > height + 60);
    }
}

/// Another name is another picture where the body touches another, and the same where it does not.
#[test]
fn an_x_ray_names_the_bodies_that_touch() {
    use cranny_narrow_phase::Answer;
    let Some(mut renderer) = renderer() else { return };
    let mut drawn = |name: &str, touches: bool| {
        let mut scene = gate(&[]);
        scene.bodies[1].name = name.to_owned();
        let mut moment = moment(&[2.0, 0.0]);
        let [a, b] = [0, 1].map(BodyId);
        let pair = MeetingPair { a, b, answer: Answer::nothing(), impulse: 0.0, sensed: false };
        moment.pairs.extend(touches.then_some(pair));
        let view = ScenePainterView::XRay;
        let size = ScenePainter::camera_size(view, SIZE).unwrap();
        let mut painter = ScenePainter::new(&scene, size, PictureQuality::Draft).unwrap();
        let image = painter.draw(&mut renderer, &moment, view, SIZE).unwrap();
        // Without the title above and the legend below.
        let row = 4 * image.size().width() as usize;
        image.pixels()[40 * row..SIZE[1] as usize * row].to_vec()
    };
    assert_ne!(drawn("gate", true), drawn("another", true));
    assert_eq!(drawn("gate", false), drawn("another", false));
}

#[test]
fn a_section_shows_what_two_bodies_share() {
    use cranny_narrow_phase::{Demand, PairMemory, Placed, Query, query};
    let Some(mut renderer) = renderer() else { return };
    let mut scene = gate(&[]);
    let (model, _) = cranny_geometry::Model::build(
        (*scene.bodies[0].collision).clone(),
        &cranny_geometry::BuildOptions::default(),
    )
    .unwrap();
    for body in &mut scene.bodies {
        body.shape = Some(model.clone().into());
    }
    let red = |image: &cranny_render::Image| {
        let is = |p: &&[u8]| p[0] > 150 && p[1] < 40 && p[2] < 100;
        image.pixels().chunks_exact(4).filter(is).count()
    };
    let mut counts = Vec::new();
    for x in [0.7, 1.2] {
        let mut moment = moment(&[0.0, x]);
        let [a, b] = [0, 1].map(|i| moment.poses[&BodyId(i)]);
        let placed = |pose| Placed { model: &model, pose };
        let question = Query::of(Demand::Regions { margin: 0.5 });
        let answer = query(placed(a), placed(b), &question, &mut PairMemory::default()).unwrap();
        let [a, b] = [0, 1].map(BodyId);
        moment.pairs = vec![MeetingPair { a, b, answer, impulse: 0.0, sensed: false }];
        let size = ScenePainter::camera_size(ScenePainterView::Section, SIZE).unwrap();
        let mut painter = ScenePainter::new(&scene, size, PictureQuality::Draft).unwrap();
        let image = painter.draw(&mut renderer, &moment, ScenePainterView::Section, SIZE).unwrap();
        counts.push(red(&image));
        let page =
            painter.draw(&mut renderer, &moment, ScenePainterView::Page, [480, 160]).unwrap();
        assert!(page.size().height() > 200, "words stand below the pictures");
    }
    assert!(counts[0] > 1000, "0.3 of a body is shared: {counts:?}");
    assert!(counts[1] < 200, "nothing is, but for the mark's own point: {counts:?}");
}

#[test]
fn pictures_change_nothing_in_a_run() {
    let folder = tempfile::tempdir().unwrap();
    let scene = gate(&[Effect::Contacts { margin: 0.1 }]);
    let hash = |preview| {
        let pictures = PictureOptions { preview, ..PictureOptions::default() };
        let options = RunOptions { pictures, ..RunOptions::default() };
        let mut app = SceneApp::new(&scene, &options).unwrap();
        while app.step().unwrap() {}
        app.finish().unwrap().state_hash
    };
    assert_eq!(hash(None), hash(Some(folder.path().join("preview.png"))));
}
