//! Meshes as people have them: open, cracked, prepared before; and what bodies of them weigh.

use std::fs;
use std::path::PathBuf;

use cranny_exact::{DMat3, DVec3};
use cranny_geometry::{BuildOptions, Mesh, Model};
use cranny_scene::{LoadOptions, LoadedScene, SceneError, parse_scene};
use cranny_world::description::StatedMass;

/// A unit cube from (0, 0, 0), of squares.
const CUBE: [[usize; 4]; 6] =
    [[1, 4, 3, 2], [5, 6, 7, 8], [1, 2, 6, 5], [2, 3, 7, 6], [3, 4, 8, 7], [4, 1, 5, 8]];

struct Files(tempfile::TempDir);

impl Files {
    /// `cube.obj`; `open.obj`, which lacks its lid; `cracked.obj`, with an edge that has a
    /// vertex in its middle on one side only; `flat.obj`.
    fn new() -> Self {
        let files = Self(tempfile::tempdir().unwrap());
        let corners = (0..8).map(|i| {
            let (x, y) = ([0, 1, 1, 0][i % 4], [0, 0, 1, 1][i % 4]);
            format!("v {x} {y} {}\n", i / 4)
        });
        let corners: String = corners.collect();
        let face = |square: &[usize]| {
            let corners: Vec<String> = square.iter().map(usize::to_string).collect();
            format!("f {}\n", corners.join(" "))
        };
        let all = |squares: &[[usize; 4]]| squares.iter().map(|s| face(s)).collect::<String>();
        files.write("cube.obj", &format!("{corners}{}", all(&CUBE)));
        let open = [&CUBE[..1], &CUBE[2..]].concat();
        files.write("open.obj", &format!("{corners}{}", all(&open)));
        let split = "v 0.5 0 0\nf 1 4 9\nf 9 4 3\nf 9 3 2\n";
        files.write("cracked.obj", &format!("{corners}{split}{}", all(&CUBE[1..])));
        files.write("flat.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
        files
    }

    fn write(&self, name: &str, text: &str) {
        fs::write(self.path(name), text).unwrap();
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    /// A scene of one body with this mesh file.
    fn body(&self, shape: &str, fields: &str) -> Result<LoadedScene, SceneError> {
        let text = format!("(bodies: [\n(name: \"a\", shape: Mesh(path: {shape}){fields})])");
        parse_scene(text, &self.path("s.ron"), &LoadOptions::default())
    }

    fn refused(&self, shape: &str, fields: &str) -> String {
        self.body(shape, fields).unwrap_err().to_string()
    }

    fn mass(&self, shape: &str, fields: &str) -> Option<StatedMass> {
        self.body(shape, fields).unwrap().description.bodies[0].mass
    }
}

#[test]
fn a_closed_mesh_weighs_what_its_solid_weighs() {
    let files = Files::new();
    let loaded = files.body("\"cube.obj\"", "").unwrap();
    assert_eq!((loaded.description.bodies[0].mass, loaded.warnings.len()), (None, 0));
    let model = loaded.description.bodies[0].shape.as_ref().unwrap().model().unwrap();
    assert_eq!(model.mass_properties().unwrap().volume, 1.0);
}

#[test]
fn an_open_mesh_weighs_what_its_hull_weighs_and_says_so() {
    let files = Files::new();
    let loaded = files.body("\"open.obj\"", ", material: (density: 3)").unwrap();
    let mass = loaded.description.bodies[0].mass.unwrap();
    assert!((mass.mass - 3.0).abs() < 1e-12, "{mass:?}");
    assert!((mass.center - DVec3::splat(0.5)).length() < 1e-12);
    assert!((mass.inertia - DMat3::from_diagonal(DVec3::splat(0.5))).x_axis.length() < 1e-12);
    let said = loaded.warnings.join("\n");
    for words in [
        "body \"a\"",
        "4 x open edge",
        "a surface",
        "counter-clockwise",
        "convex hull",
        "mass: Total",
    ] {
        assert!(said.contains(words), "{words}: {said}");
    }
    // What does not move needs no mass.
    assert_eq!(files.mass("\"open.obj\"", ", kind: Fixed"), None);
    assert!(files.refused("\"flat.obj\"", "").contains("flat"));
}

#[test]
fn faces_within_a_solid_are_told_of_with_what_it_weighs() {
    let files = Files::new();
    let cube = fs::read_to_string(files.path("cube.obj")).unwrap();
    for (name, low, high, kind) in [
        ("cross.obj", 0.5, 1.5, "self intersection"),
        ("nested.obj", 0.25, 0.75, "1 x nested solid"),
    ] {
        let corner = |i: usize| {
            let at = |upper: bool| if upper { high } else { low };
            format!("v {} {} {}\n", at(matches!(i % 4, 1 | 2)), at(i % 4 > 1), at(i > 3))
        };
        let second: String = (0..8).map(corner).collect();
        let faces = CUBE.map(|[a, b, c, d]| format!("f {} {} {} {}\n", a + 8, b + 8, c + 8, d + 8));
        files.write(name, &format!("{cube}{second}{}", faces.concat()));
        let loaded = files.body(&format!("\"{name}\""), "").unwrap();
        let warnings = loaded.warnings.join("\n");
        assert!(warnings.contains(kind), "{warnings}");
        assert!(warnings.contains("body \"a\"") && warnings.contains(name), "{warnings}");
        assert!(warnings.contains("collides by its outer skin"), "{warnings}");
        assert!(warnings.contains("say `mass: Total(…)`"), "{warnings}");
    }
}

#[test]
fn a_body_weighs_what_the_scene_says() {
    let files = Files::new();
    let open = |mass: &str| files.mass("\"open.obj\"", &format!(", mass: {mass}")).unwrap();
    let total = open("Total(2.5)");
    // Of a shell of five squares: its centre lies below the middle.
    assert!((total.mass - 2.5).abs() < 1e-12);
    assert!((total.center - DVec3::new(0.5, 0.5, 0.4)).length() < 1e-12, "{total:?}");
    let shell = open("Shell(thickness: 0.1), material: (density: 3)");
    assert!((shell.mass - 1.5).abs() < 1e-12);
    assert!((shell.inertia * (2.5 / 1.5) - total.inertia).x_axis.length() < 1e-12);
    assert!((open("Hull(), material: (density: 2)").mass - 2.0).abs() < 1e-12);
    let solid = files.mass("\"cube.obj\"", ", mass: Total(6)").unwrap();
    assert!((solid.inertia - DMat3::IDENTITY).x_axis.length() < 1e-12, "{solid:?}");
    let stated =
        open("Stated(mass: 2, center: (0, 0, 1), inertia: (3, 4, 5), products: (0.1, 0.2, 0.3))");
    assert_eq!((stated.mass, stated.center), (2.0, DVec3::Z));
    let expected = [[3.0, 0.1, 0.3], [0.1, 4.0, 0.2], [0.3, 0.2, 5.0]];
    assert_eq!(stated.inertia.to_cols_array_2d(), expected);
    // A shell of a flat sheet has a mass where its hull has none.
    assert!(
        (files.mass("\"flat.obj\"", ", mass: Shell(thickness: 2)").unwrap().mass - 1.0).abs()
            < 1e-12
    );
    for (fields, words) in [
        (", mass: Total(0)", "greater than 0"),
        (", mass: Stated(mass: 1, inertia: (1, 1, 1), products: (2, 0, 0))", "principal moments"),
        (", mass: Stated(mass: 1, inertia: (0.1, 0.1, 0.9))", "the sum of the other two"),
        (", mass: Stated(mass: 1)", "inertia"),
        (", mass: Total(1), kind: Fixed", "only a Dynamic body"),
        (", mass: Hull(), kind: Kinematic", "only a Dynamic body"),
    ] {
        let refused = files.refused("\"cube.obj\"", fields);
        assert!(refused.contains("line 2") && refused.contains(words), "{words}: {refused}");
    }
}

#[test]
fn cracks_are_mended_unless_the_scene_says_otherwise() {
    let files = Files::new();
    let mended = files.body("\"cracked.obj\"", "").unwrap();
    let volume = |loaded: &LoadedScene| {
        let model = loaded.description.bodies[0].shape.as_ref().unwrap().model().unwrap();
        // Faces that are parted elsewhere round elsewhere.
        model.mass_properties().map(|solid| (1e9 * solid.volume).round() / 1e9)
    };
    assert_eq!((volume(&mended), mended.warnings.len()), (Some(1.0), 0));
    let notes = mended.notes.join("\n");
    assert!(notes.contains("cracked.obj: mended:"), "{notes}");
    let filed = files.body("\"cracked.obj\", repair: None", "").unwrap();
    assert_eq!(volume(&filed), None);
    assert!(filed.warnings.iter().any(|w| w.contains("t vertex")), "{:?}", filed.warnings);
    assert_eq!(volume(&files.body("\"cracked.obj\", repair: Full", "").unwrap()), Some(1.0));
    assert!(files.refused("\"cube.obj\", repair: All", "").contains("line 2"));
}

#[test]
fn a_saved_model_is_taken_as_it_was_saved() {
    let files = Files::new();
    let corners = vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
    let faces = vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
    let mesh = Mesh::new(corners, faces).unwrap();
    let model = Model::build(mesh, &BuildOptions::default()).unwrap().0;
    fs::write(files.path("t.cranny"), model.encode()).unwrap();
    let loaded = files.body("\"t.cranny\"", "").unwrap();
    let body = &loaded.description.bodies[0];
    assert_eq!(body.shape.as_ref().unwrap().model().unwrap().digest(), model.digest());
    assert_eq!((&*body.collision, loaded.files.len()), (model.mesh(), 1));
    for (shape, words) in [
        ("\"t.cranny\", scale: 2", "a saved model"),
        ("\"t.cranny\", repair: Full", "a saved model"),
        ("\"t.cranny\", recenter: true", "a saved model"),
        ("\"none.cranny\"", "cannot be read"),
    ] {
        let refused = files.refused(shape, "");
        assert!(refused.contains("line 2") && refused.contains(words), "{words}: {refused}");
    }
    fs::write(files.path("bad.cranny"), b"no model").unwrap();
    assert!(files.refused("\"bad.cranny\"", "").contains("bad.cranny"));
}
