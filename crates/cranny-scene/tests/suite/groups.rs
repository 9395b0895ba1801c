//! Bodies made by rule, beside what stands there.

use std::path::Path;

use cranny_geometry::{BuildOptions, Mesh, Model};
use cranny_primitives::BodyShape;
use cranny_scene::{LoadOptions, LoadedScene, SceneError, parse_scene};
use cranny_world::description::SceneDescription;
use cranny_world::{Arrangement, Wanted};

/// A pillar and a bowl in the region of what is made, a floor beneath all.
const STANDING: &str = r#"
    (name: "pillar", shape: Generator(Cuboid(size: (1.5, 1.5, 9))), kind: Fixed, pose: (at: (0.3, 0, 4), euler_degrees: (0, 0, 30))),
    (name: "ring", shape: Generator(Torus(major_radius: 2, minor_radius: 0.3)), kind: Fixed, pose: (at: (0, 0, 2))),
    (name: "floor", shape: Primitive(HalfSpace()), kind: Fixed, pose: (at: (0, 0, 1))),
"#;

fn load(standing: &str, groups: &str) -> Result<LoadedScene, SceneError> {
    let text = format!("(bodies: [{standing}],\ngroups: [{groups}])");
    parse_scene(text, Path::new("s.ron"), &LoadOptions::default())
}

fn pile(count: u32, more: &str) -> String {
    let shapes = "[Generator(LPrism()), Primitive(Ball(radius: 0.3))]";
    format!(
        "Pile(name: \"p\", count: {count}, region: (min: (-3, -3, 0), max: (3, 3, 9)), shapes: {shapes}, {more})"
    )
}

/// All pairs with a body of a group that touch or overlap, exactly.
fn meetings(scene: &SceneDescription) -> Vec<[String; 2]> {
    let shape = |mesh: &Mesh| {
        let options = BuildOptions::default();
        BodyShape::from(Model::build(mesh.clone(), &options).unwrap().0)
    };
    let shapes = scene.bodies.iter();
    let shapes =
        shapes.map(|body| Some(body.shape.clone().unwrap_or_else(|| shape(&body.collision))));
    let made = |body: usize| scene.bodies[body].name.contains('_');
    let pairs = (0..scene.bodies.len()).flat_map(|b| (0..b).map(move |a| (a, b)));
    let pairs = pairs.filter(|&(a, b)| made(a) || made(b));
    let poses: Vec<_> = scene.bodies.iter().map(|body| body.pose).collect();
    let arranged = Arrangement::new(shapes.collect(), pairs).at(&poses, Wanted::Meeting).unwrap();
    let name = |body: usize| scene.bodies[body].name.clone();
    arranged.meeting.into_iter().map(|(a, b)| [name(a), name(b)]).collect()
}

#[test]
fn nothing_of_a_pile_touches_what_stands_in_its_region() {
    for seed in 0..4 {
        let seeded = format!("seed: {seed}");
        let clear = load(STANDING, &pile(24, &seeded)).unwrap().description;
        assert_eq!((clear.bodies.len(), meetings(&clear)), (27, Vec::new()));
        // Placed without it, bodies are in the way of what stands there.
        let mut blind = load("", &pile(24, &seeded)).unwrap().description;
        blind.bodies.extend(clear.bodies[..3].iter().cloned());
        assert!(meetings(&blind).len() > 3, "{:?}", meetings(&blind));
    }
}

/// Surfaces do not cross there.
#[test]
fn no_body_of_a_pile_lies_within_a_solid() {
    let block = "(name: \"block\", shape: Generator(Cuboid(size: (6, 6, 4))), kind: Fixed, pose: (at: (0, 0, 2)))";
    let clear = load(block, &pile(8, "")).unwrap().description;
    assert_eq!(meetings(&clear), Vec::<[String; 2]>::new());
}

#[test]
fn sensors_and_other_layers_are_not_in_the_way() {
    let free = load("", &pile(8, "seed: 2")).unwrap().description;
    for more in ["sensor: true", "layers: [\"b\"]"] {
        let block = format!(
            "(name: \"block\", shape: Generator(Cuboid(size: (9, 9, 9))), kind: Fixed, {more})"
        );
        let scene = load(&block, &pile(8, "seed: 2")).unwrap().description;
        assert_eq!(scene.bodies[1].pose, free.bodies[0].pose, "{more}");
    }
}

#[test]
fn a_pile_without_room_is_refused_with_what_is_in_the_way() {
    let block = "(name: \"block\", shape: Generator(Cuboid(size: (9, 9, 7))), kind: Fixed, pose: (at: (0, 0, 3)))";
    let error = load(block, &pile(20, "")).unwrap_err().to_string();
    for says in ["line 2", "pile \"p\"", "are clear", "its count is 20", "In the way: \"block\""] {
        assert!(error.contains(says), "{says}: {error}");
    }
}

#[test]
fn a_grid_leaves_out_what_would_meet_something() {
    let grid = |spacing: f64| {
        format!(
            "Grid(name: \"g\", count: (4, 3, 2), spacing: ({spacing}, 1.5, 1.5), pose: (at: (-1.5, 0, 2)), shapes: [Generator(Cuboid()), Primitive(Ball(radius: 0.4))], kind: Fixed)"
        )
    };
    let free = load("", &grid(1.5)).unwrap();
    assert_eq!((free.description.bodies.len(), free.warnings.len()), (24, 0));
    let last = &free.description.bodies[23];
    assert_eq!((last.name.as_str(), last.pose.translation.to_array()), ("g_23", [3.0, 3.0, 3.5]));
    assert!(last.primitive().is_some() && free.description.bodies[0].primitive().is_none());
    let beside = load(STANDING, &grid(1.5)).unwrap();
    assert_eq!(meetings(&beside.description), Vec::<[String; 2]>::new());
    let left_out = 27 - beside.description.bodies.len();
    let says = format!("grid \"g\": {left_out} of its 24 bodies are left out");
    assert!(left_out > 0 && beside.warnings.iter().any(|what| what.contains(&says)));
    let error = load("", &grid(0.75)).unwrap_err().to_string();
    assert!(error.contains("\"g_0\" and \"g_1\" meet") && error.contains("line 2"), "{error}");
}

/// A slip of the pen is refused before it takes memory.
#[test]
fn a_group_of_more_bodies_than_can_be_is_refused() {
    let region = "region: (min: (-1e9, -1e9, -1e9), max: (1e9, 1e9, 1e9))";
    let shapes = "shapes: [Generator(Cuboid())]";
    let pile = format!("Pile(name: \"p\", count: 4000000000, {region}, {shapes})");
    let thousands = "count: (100000, 100000, 100000), spacing: (2, 2, 2)";
    let grid = format!("Grid(name: \"g\", {thousands}, {shapes})");
    for (group, count) in [(pile, "4000000000"), (grid, "1000000000000000")] {
        let refused = load("", &group).unwrap_err().to_string();
        assert!(refused.contains(count) && refused.contains("1000000 at most"), "{refused}");
        assert!(refused.contains("line 2"), "{refused}");
    }
}
