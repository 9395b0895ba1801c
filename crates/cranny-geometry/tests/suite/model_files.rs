//! Saved models come back to the bit; whatever else is read is refused, or harmless.

use crate::body::Body;
use crate::meshes::{soup, turned};
use cranny_concavity::Cover;
use cranny_concavity::envelope::Probe;
use cranny_concavity::{CapId, Concavities};
use cranny_exact::{Aabb, DVec3};
use cranny_geometry::hull::{FacetId, HullVertexId};
use cranny_geometry::{
    BuildOptions, DecodeError, DeformError, EdgeId, FaceId, Flatness, HalfEdgeId, Mesh, Model,
    PatchId, Repair, VertexId,
};
use cranny_shapes::{
    Cuboid, Cup, Gear, GolfBall, IsoNut, NestedShells, PyramidInCavity, Shape, Torus,
};
use cranny_testkit::Rng;

/// Head of a file: magic, version, 0, length, checksum.
const HEAD: usize = 32;

fn built(mesh: &Mesh) -> Body {
    Body::build(mesh.clone(), &BuildOptions::default()).unwrap().0
}

/// A cube in a cube, turned inside out: a void.
fn hollow_cube() -> Mesh {
    let cube = |size| Cuboid { size: [size; 3] }.build().unwrap();
    let inner = cube(1.0);
    let faces = inner.faces().iter().map(|&[a, b, c]| [a, c, b]).collect();
    cube(3.0).joined(&Mesh::new(inner.vertices().to_vec(), faces).unwrap())
}

fn flat_square() -> Mesh {
    let vertices = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
    let vertices = vertices.map(|[x, y]| DVec3::new(x, y, -0.0)).to_vec();
    Mesh::new(vertices, vec![[0, 1, 2], [0, 2, 3]]).unwrap()
}

/// Bodies with every kind of concavity, an open surface, a plate, and soups.
fn bodies() -> Vec<Mesh> {
    let mut rng = Rng::new(5);
    let mut bodies = vec![
        Cuboid::default().build().unwrap(),
        Cup::default().build().unwrap(),
        turned(
            &Torus { major_segments: 24, minor_segments: 12, ..Torus::default() }.build().unwrap(),
        ),
        NestedShells { segments: 24, ..NestedShells::default() }.build().unwrap(),
        PyramidInCavity::default().build().unwrap(),
        turned(&IsoNut { segments: 18, ..IsoNut::default() }.build().unwrap()),
        GolfBall { dimples: 12, triangles: 1_000, ..GolfBall::default() }.build().unwrap(),
        Gear::default().build().unwrap(),
        hollow_cube(),
        flat_square(),
    ];
    let mut open = Cup::default().build().unwrap();
    open = Mesh::new(open.vertices().to_vec(), open.faces()[5..].to_vec()).unwrap();
    bodies.push(open);
    for faces in [6, 20, 60] {
        bodies.extend((0..4).map(|_| soup(&mut rng, faces)));
    }
    bodies.retain(|mesh| Body::build(mesh.clone(), &BuildOptions::default()).is_ok());
    bodies
}

/// Everything in a model, coordinates to the last digit and zeros with their signs, and what is
/// made late or by itself.
fn shown(model: &Model) -> String {
    model.prepare_all();
    let concavities = Concavities::of(model);
    format!(
        "{:?}",
        (
            (model.mesh(), model.topology(), model.hull(), model.tree(), model.patches()),
            (model.mass_properties(), model.radius(), model.digest()),
            &concavities,
        )
    )
}

#[test]
fn a_model_comes_back_to_the_bit() {
    for mesh in bodies() {
        let model = built(&mesh);
        let bytes = model.encode();
        let back = Body::decode(&bytes).unwrap_or_else(|error| panic!("{error}"));
        assert!(shown(&back) == shown(&model));
        assert!(back.encode() == bytes);
        assert!(Model::is_encoded(&bytes) && back.digest() == model.digest());
    }
}

#[test]
fn every_generator_comes_back_to_the_bit() {
    for shape in Shape::defaults() {
        let model = built(&shape.build().unwrap());
        let back = Body::decode(&model.encode()).unwrap();
        assert!(shown(&back) == shown(&model), "{}", shape.name());
    }
}

#[test]
fn a_loaded_model_is_surveyed_as_it_was_when_built() {
    for mesh in bodies() {
        let (model, report) = Body::build(mesh, &BuildOptions::default()).unwrap();
        let back = Body::decode(&model.encode()).unwrap();
        let mut survey = back.survey(None, true).unwrap();
        assert_eq!(survey.provenance, None, "what was filed and mended is not saved");
        survey.provenance = report.provenance.clone();
        assert_eq!(survey, report);
    }
}

#[test]
fn repaired_and_coarse_models_come_back() {
    let mut mesh = Cup::default().build().unwrap();
    mesh = mesh.clone().joined(&mesh); // every face twice: one of each goes
    let options = BuildOptions { repair: Repair::Full, leaf_size: 300, ..BuildOptions::default() };
    let (model, report) = Body::build(mesh, &options).unwrap();
    assert!(report.faces < report.provenance.unwrap().faces);
    let back = Body::decode(&model.encode()).unwrap();
    assert!(shown(&back) == shown(&model));
    let last = FaceId(report.faces as u32 - 1);
    assert_eq!(back.filed_face(last), model.filed_face(last));
}

#[test]
fn models_for_which_everything_is_flat_come_back() {
    for flatness in [0.0, f64::NAN, 0.1, 1e300, f64::INFINITY] {
        let flatness = Flatness::Relative(flatness);
        for mesh in [Cup::default().build().unwrap(), flat_square()] {
            let options = BuildOptions { flatness, ..BuildOptions::default() };
            let (model, _) = Body::build(mesh, &options).unwrap();
            let back =
                Body::decode(&model.encode()).unwrap_or_else(|e| panic!("{flatness:?}: {e}"));
            assert!(shown(&back) == shown(&model), "{flatness:?}");
        }
    }
}

#[test]
fn deformed_models_come_back() {
    for mut model in bodies().iter().map(built) {
        let mut rng = Rng::new(8);
        for _ in 0..4 {
            let Ok(_) = model.deform(&a_few_moves(&model, &mut rng)) else { continue };
            let back = Body::decode(&model.encode()).unwrap_or_else(|e| panic!("{e}"));
            assert!(shown(&back) == shown(&model));
        }
    }
}

/// Moves a few vertices by a tenth of the body's size, some of them onto a plane through the
/// origin.
fn a_few_moves(model: &Body, rng: &mut Rng) -> Vec<(VertexId, DVec3)> {
    let size = 0.1 * model.radius();
    let first = rng.below(model.mesh().vertices().len());
    let some = model.mesh().vertices().iter().enumerate().skip(first).take(3);
    some.map(|(v, &p)| {
        let mut by = || 0.5 * size * rng.unit();
        (VertexId(v as u32), (p + DVec3::new(by(), by(), by())) * DVec3::new(-0.0, 1.0, 1.0))
    })
    .collect()
}

#[test]
fn what_is_made_late_is_made_once_and_as_it_was_built() {
    for model in bodies().iter().map(built) {
        let rows = |model: &Body| -> Vec<Vec<HullVertexId>> {
            let vertices = 0..model.hull().vertex_count() as u32;
            vertices.map(|v| model.hull().neighbours(HullVertexId(v)).to_vec()).collect()
        };
        let late = |model: &Body| {
            let surface = (model.tree(), model.patches());
            format!("{:?}", (surface, rows(model)))
        };
        let back = Body::decode(&model.encode()).unwrap();
        // Whoever comes first, all get the same.
        let places: Vec<_> = std::thread::scope(|scope| {
            let ask = || {
                let surface = (std::ptr::from_ref(back.tree()), std::ptr::from_ref(back.patches()));
                (
                    surface.0 as usize,
                    surface.1 as usize,
                    std::ptr::from_ref(back.clusters()) as usize,
                )
            };
            let asking: Vec<_> = (0..4).map(|_| scope.spawn(ask)).collect();
            asking.into_iter().map(|wanted| wanted.join().unwrap()).collect()
        });
        assert!(places.iter().all(|place| *place == places[0]));
        // Known before any tree is.
        assert_eq!(back.bounds(), back.tree().node(0).bounds);
        assert_eq!(late(&back), late(&model));
        let forced = Body::decode(&model.encode()).unwrap();
        forced.prepare_all();
        assert_eq!(late(&forced), late(&model));
        // Made or not, the same is written.
        assert!(back.encode() == model.encode() && forced.encode() == model.encode());
    }
}

/// Moves a vertex a little.
fn nudge(model: &mut Body) {
    let place = model.mesh().position(VertexId(0)) + 1e-3 * model.radius() * DVec3::ONE;
    model.deform(&[(VertexId(0), place)]).unwrap();
}

#[test]
fn a_loaded_model_deforms_alike_whether_or_not_it_was_asked_before() {
    let mut rng = Rng::new(21);
    for model in bodies().iter().map(built) {
        let bytes = model.encode();
        let moves = a_few_moves(&model, &mut rng);
        let [wanted, fresh] = [true, false].map(|ask| {
            let mut back = Body::decode(&bytes).unwrap();
            if ask {
                back.prepare_all();
            }
            let change = back.deform(&moves);
            (format!("{change:?}"), shown(&back))
        });
        assert!(wanted == fresh);
        // All is made again as building makes it, so the same comes of the one that was built.
        let mut own = model.clone();
        let change = own.deform(&moves);
        assert!(fresh == (format!("{change:?}"), shown(&own)));
    }
}

#[test]
fn the_largest_leaves_come_back_and_deform() {
    let options = BuildOptions { leaf_size: usize::MAX, ..BuildOptions::default() };
    let (model, _) = Body::build(Cup::default().build().unwrap(), &options).unwrap();
    assert_eq!(model.tree().nodes().len(), 1);
    let mut back = Body::decode(&model.encode()).unwrap();
    assert!(shown(&back) == shown(&model));
    nudge(&mut back);
    use_all(&back);
}

#[test]
fn what_is_no_model_is_told_from_what_was_damaged() {
    let bytes = built(&Cuboid::default().build().unwrap()).encode();
    assert_eq!(Body::decode(b"").unwrap_err(), DecodeError::NotAModel);
    assert_eq!(Body::decode(b"v 0 0 0\nv 1 0 0\n").unwrap_err(), DecodeError::NotAModel);
    let with = |at: usize, byte: u8| {
        let mut other = bytes.clone();
        other[at] = byte;
        Body::decode(&other).unwrap_err()
    };
    // A whole file of another version is distinguished from a damaged one: its sections are others.
    assert_eq!(with(8, 11), DecodeError::Head { field: "version" });
    let mut foreign = bytes.clone();
    (foreign[8], foreign[HEAD]) = (11, b'X');
    let expected = DecodeError::Version { found: 11, supported: 10 };
    assert_eq!(Body::decode(&sealed(foreign)).unwrap_err(), expected);
    let reported = with(17, !bytes[17]).to_string();
    assert!(reported.contains("damaged") && reported.contains("length in its head"), "{reported}");
    assert_eq!(with(HEAD + 20, !bytes[HEAD + 20]), DecodeError::Checksum);
    assert_eq!(with(26, !bytes[26]), DecodeError::Checksum);
    let stated = bytes.len() as u64;
    let longer = [bytes.as_slice(), &[0]].concat();
    assert_eq!(
        Body::decode(&longer).unwrap_err(),
        DecodeError::Length { found: longer.len(), stated }
    );
}

#[test]
fn no_flipped_bit_goes_unnoticed() {
    let bytes = built(&Cuboid::default().build().unwrap()).encode();
    for bit in 0..8 * bytes.len() {
        let mut other = bytes.clone();
        other[bit / 8] ^= 1 << (bit % 8);
        let error = Body::decode(&other).unwrap_err();
        let expected = match bit / 8 {
            0..8 => error == DecodeError::Head { field: "beginning" },
            8..12 => error == DecodeError::Head { field: "version" },
            12..16 => error == DecodeError::Head { field: "reserved value" },
            16..24 => error == DecodeError::Head { field: "length" },
            _ => error == DecodeError::Checksum,
        };
        assert!(expected, "bit {bit}: {error}");
    }
}

#[test]
fn a_file_cut_off_anywhere_is_refused_checksum_or_not() {
    let bytes = built(&PyramidInCavity::default().build().unwrap()).encode();
    for length in (0..HEAD + 40).chain((HEAD..bytes.len()).step_by(7)) {
        let error = Body::decode(&bytes[..length]).unwrap_err();
        let expected = match length {
            0..8 => DecodeError::NotAModel,
            8..HEAD => DecodeError::Length { found: length, stated: HEAD as u64 },
            _ => DecodeError::Length { found: length, stated: bytes.len() as u64 },
        };
        assert_eq!(error, expected);
        if length >= HEAD {
            let error = Body::decode(&sealed(bytes[..length].to_vec())).unwrap_err();
            assert!(matches!(error, DecodeError::Section { .. }), "{length}: {error}");
        }
    }
}

/// The file with the length and the checksum that it should have.
fn sealed(mut bytes: Vec<u8>) -> Vec<u8> {
    let length = bytes.len() as u64;
    bytes[16..24].copy_from_slice(&length.to_le_bytes());
    let sum = checksum(&bytes[HEAD..]);
    bytes[24..HEAD].copy_from_slice(&sum.to_le_bytes());
    bytes
}

/// As the codec describes it, one word at a time.
fn checksum(bytes: &[u8]) -> u64 {
    let factor = 0x9E37_79B9_7F4A_7C15u64;
    let step = |lane: u64, word: u64| (lane ^ word).wrapping_mul(factor).rotate_left(32);
    let mut padded = bytes.to_vec();
    padded.resize(bytes.len().next_multiple_of(64), 0);
    let mut lanes: Vec<u64> = (1..=8).map(|i| factor.wrapping_mul(i)).collect();
    for (i, word) in padded.chunks(8).enumerate() {
        lanes[i % 8] = step(lanes[i % 8], u64::from_le_bytes(word.try_into().unwrap()));
    }
    lanes.into_iter().fold(0, step)
}

/// Where the bodies of sections are.
fn sections(bytes: &[u8]) -> Vec<std::ops::Range<usize>> {
    let (mut found, mut at) = (Vec::new(), HEAD);
    while at < bytes.len() {
        let length = u64::from_le_bytes(bytes[at + 4..at + 12].try_into().unwrap()) as usize;
        found.push(at + 12..at + 12 + length);
        at += 12 + length;
    }
    found
}

/// Changes a few bytes of a section as somebody would who wants to do harm.
fn harmed(bytes: &[u8], rng: &mut Rng) -> Vec<u8> {
    let mut bytes = bytes.to_vec();
    let mut sections = sections(&bytes);
    sections.retain(|section| !section.is_empty());
    let section = sections[rng.below(sections.len())].clone();
    for _ in 0..1 + rng.below(2) {
        let at = section.start + rng.below(section.len());
        let room = section.end - at;
        let from = section.start + rng.below(section.len());
        match rng.below(6) {
            0 => bytes[at] ^= 1 << rng.below(8),
            1 => bytes[at] = rng.bits() as u8,
            2 if room >= 4 => {
                let small = [0, 1, 2, u32::MAX, u32::MAX - 1, rng.below(400) as u32];
                let small = small[rng.below(small.len())];
                bytes[at..at + 4].copy_from_slice(&small.to_le_bytes());
            }
            3 if room >= 8 => {
                let odd = [f64::NAN, f64::INFINITY, -0.0, 1e300, -1e300, 5e-324, 0.5];
                bytes[at..at + 8].copy_from_slice(&odd[rng.below(odd.len())].to_le_bytes());
            }
            4 if room >= 4 && section.end - from >= 4 => bytes.copy_within(from..from + 4, at),
            _ => bytes.swap(at, from),
        }
    }
    sealed(bytes)
}

#[test]
fn whoever_writes_a_right_checksum_does_no_harm() {
    let mut rng = Rng::new(11);
    let (mut accepted, mut deformed) = (0, 0);
    let small: Vec<Body> =
        bodies().iter().filter(|mesh| mesh.faces().len() < 700).map(built).collect();
    // Deformed ones as well.
    let moved = small.iter().cloned().filter_map(|mut model| {
        let moves = a_few_moves(&model, &mut Rng::new(8));
        model.deform(&moves).is_ok().then_some(model)
    });
    let files: Vec<Vec<u8>> =
        small.iter().cloned().chain(moved).map(|model| model.encode()).collect();
    assert!(files.len() > small.len() + 10);
    for bytes in files {
        for _ in 0..400 {
            let other = harmed(&bytes, &mut rng);
            match Body::decode(&other) {
                Err(DecodeError::Section { .. }) => {}
                Err(error) => panic!("{error}"),
                Ok(mut model) => {
                    accepted += 1;
                    assert!(model.encode() == other);
                    use_all(&model);
                    let moves = a_few_moves(&model, &mut rng);
                    if model.deform(&moves).is_ok() {
                        deformed += 1;
                        use_all(&model);
                        let saved = model.encode();
                        assert!(Body::decode(&saved).is_ok_and(|m| m.encode() == saved));
                    }
                }
            }
        }
    }
    // Some change is always harmless: the last digit of a coordinate, say.
    assert!(accepted > 100 && deformed > 100, "{accepted}, {deformed}");
}

/// Found by forging: what a file said of the volume was believed, and the deformed body could not
/// be saved.
#[test]
fn a_body_whose_volume_was_forged_is_inside_out_when_it_deforms() {
    let corners = [DVec3::ZERO, 8.0 * DVec3::X, 8.0 * DVec3::Y, 8.0 * DVec3::Z];
    let faces = vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
    let cube = Cuboid { size: [0.5; 3] }.build().unwrap();
    let inward = cube.faces().iter().map(|&[a, b, c]| [a, c, b]).collect();
    let void = cube.vertices().iter().map(|&p| p - cube.bounds().center() + DVec3::ONE);
    let void = Mesh::new(void.collect(), inward).unwrap();
    let model = built(&Mesh::new(corners.to_vec(), faces).unwrap().joined(&void));
    // In the file the void is larger than what is around it.
    let mut bytes = model.encode();
    let first = sections(&bytes)[0].start + 32 + 8 + 8;
    for (v, &p) in (0..).map(VertexId).zip(model.mesh().vertices()) {
        if model.hull().vertex_of_source(v).is_none() {
            let place = DVec3::splat(4.0) + 12.0 * (p - DVec3::ONE);
            let at = first + 24 * v.index();
            let numbers = place.to_array().map(f64::to_le_bytes).concat();
            bytes[at..at + 24].copy_from_slice(&numbers);
        }
    }
    let mut forged = Model::decode(&sealed(bytes)).unwrap();
    let corner = forged.hull().sources()[0];
    let place = 1.25 * forged.mesh().position(corner) - DVec3::splat(0.25);
    let refused = forged.deform(&[(corner, place)]).unwrap_err();
    assert!(matches!(refused, DeformError::InsideOut { .. }), "{refused}");
}

#[test]
fn random_bytes_are_no_model() {
    let mut rng = Rng::new(3);
    let head = built(&Cuboid::default().build().unwrap()).encode()[..HEAD].to_vec();
    for length in 0..2_000 {
        let mut bytes = head.clone();
        bytes.extend((0..length).map(|_| rng.bits() as u8));
        assert!(matches!(Body::decode(&sealed(bytes)), Err(DecodeError::Section { .. })));
    }
}

/// Asks a model everything: nothing panics, nothing runs for ever.
fn use_all(model: &Body) {
    let mesh = model.mesh();
    let bounds = model.bounds();
    let everywhere = |_: &Aabb| true;
    let mut faces = 0;
    model.tree().visit(everywhere, |_| faces += 1);
    assert_eq!(faces, mesh.faces().len());
    for h in (0..3 * mesh.faces().len() as u32).map(HalfEdgeId) {
        let edge = model.topology().edge_of(h);
        assert!(model.topology().half_edges(edge).contains(&h));
        let _ = (model.topology().twin(h), model.topology().component_of(h.face()));
    }
    use_hull(model, bounds.center());
    use_concavities(model);
    let patches = model.patches();
    for face in (0..mesh.faces().len() as u32).map(FaceId) {
        let patch = patches.patch_of_face(face);
        assert!(patches.faces(patch).contains(&face));
        let _ = (model.features().facet_of(face), model.features().convex_set_of(face));
        let _ = model.filed_face(face);
    }
    for patch in (0..patches.len() as u32).map(PatchId) {
        let faces = patches.faces(patch);
        assert!(!faces.is_empty() && faces.iter().all(|&f| patches.patch_of_face(f) == patch));
        let bounds = patches.patch(patch).bounds;
        assert!(bounds.contains_point(bounds.center()));
    }
    for vertex in (0..mesh.vertices().len() as u32).map(VertexId) {
        let _ =
            (patches.patch_of_vertex(model.topology(), vertex), model.features().vertex(vertex));
    }
    for edge in (0..model.topology().edges().len() as u32).map(EdgeId) {
        let _ = (patches.patch_of_edge(model.topology(), edge), model.features().edge(edge));
    }
    let _ = (model.mass_properties(), model.radius());
}

fn use_hull(model: &Body, center: DVec3) {
    let hull = model.hull();
    for (i, &p) in hull.positions().iter().enumerate() {
        let direction = p - center;
        let top = hull.support(direction, Some(HullVertexId(i as u32))).unwrap();
        assert!(direction.dot(hull.position(top)) >= direction.dot(p));
        let _ = hull.locate(p);
    }
    for facet in hull.facets() {
        for (&corner, &neighbour) in facet.corners.iter().zip(facet.neighbours) {
            let _ = (hull.position(corner), hull.facet(neighbour).normal);
        }
        for &triangle in facet.triangles {
            let _ = hull.triangle(triangle as usize);
        }
    }
    let _ = (hull.volume(), hull.area(), hull.centroid());
}

fn use_concavities(model: &Body) {
    let concavities = model.concavities();
    for concavity in concavities.iter() {
        let mut ancestor = concavity.parent;
        while let Some(id) = ancestor {
            ancestor = concavities.get(id).parent;
        }
        for lid in concavity.lids() {
            assert_eq!(lid.concavity, concavity.id());
            let corners: usize = lid.outlines().map(|(_, outline)| outline.len()).sum();
            assert!(corners <= 3 * concavities.cap_count() + model.mesh().vertices().len());
            for &cap in lid.caps {
                assert_eq!(concavities.cap(cap).lid, Some(lid.id()));
            }
        }
        for boundary in concavity.loops() {
            for &vertex in boundary.vertices {
                let _ = model.mesh().position(vertex);
            }
            assert_eq!(boundary.vertices.len(), boundary.borders.len());
        }
        let index = concavity.id().index();
        assert_eq!(model.concavity_trees().faces(index).len(), concavity.faces.len());
        let envelope = model.envelopes().envelope(index);
        let corners = model.mesh().vertices();
        let thing = Probe::of_points(corners, 0.0);
        let mut seen = 0;
        envelope.for_each_face(&thing, |_| seen += 1);
        assert!(seen <= concavity.faces.len());
        if let Some(layer) = envelope.first_layer() {
            let _ = envelope.track(layer, &thing, None);
        }
    }
    for cap in (0..concavities.cap_count() as u32).map(CapId) {
        let _ = concavities.cap(cap);
    }
    for facet in (0..model.hull().facet_count() as u32).map(FacetId) {
        if let Cover::Lid(concavity) = concavities.cover(facet) {
            let _ = concavities.get(concavity);
        }
    }
}
