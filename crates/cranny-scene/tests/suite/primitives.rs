//! Primitives in scene files and robots: what they become, and what is refused, with its place.

use cranny_exact::{DVec3, Pose};
use cranny_primitives::{Ball, Capsule, Cone, Cylinder, HalfSpace, Primitive};
use cranny_scene::{LoadOptions, LoadedScene, SceneError, parse_scene, read_robot};
use cranny_world::Wanted;

fn parsed(text: &str) -> Result<LoadedScene, SceneError> {
    parse_scene(text.to_owned(), "s.ron".as_ref(), &LoadOptions::default())
}

fn primitive(shape: &str) -> Primitive {
    let text = format!("(bodies: [(name: \"a\", kind: Fixed, shape: Primitive({shape}))])");
    *parsed(&text).unwrap().description.bodies[0].primitive().unwrap()
}

#[test]
fn primitives_stand_along_z_about_the_origin() {
    let (center, axis) = (DVec3::ZERO, DVec3::Z);
    assert_eq!(primitive("Ball(radius: 0.5)"), Ball { center, radius: 0.5 }.into());
    let ends = [-DVec3::Z, DVec3::Z];
    let capsule = Capsule { ends, radius: 0.5 };
    assert_eq!(primitive("Capsule(radius: 0.5, length: 2)"), capsule.into());
    let (half_height, radius) = (0.5, 2.0);
    let cylinder = Cylinder { center, axis, half_height, radius, border: 0.0 };
    assert_eq!(primitive("Cylinder(radius: 2, height: 1)"), cylinder.into());
    let cone = Cone { center, axis, half_height, radius, border: 0.25 };
    assert_eq!(primitive("Cone(radius: 2, height: 1, border: 0.25)"), cone.into());
    let plane = HalfSpace { point: center, normal: axis };
    assert_eq!(primitive("HalfSpace()"), plane.into());
}

#[test]
fn what_is_wrong_is_told_with_line_field_and_value() {
    let error = |body: &str| {
        let text = format!("(bodies: [\n    (name: \"a\", {body}),\n])");
        parsed(&text).err().map(|error| error.to_string()).unwrap_or_default()
    };
    let negative = error("shape: Primitive(Ball(radius: -0.5))");
    assert!(negative.contains("s.ron, line 2,") && negative.contains("-0.5"), "{negative}");
    let unknown = error("shape: Primitive(Ball(size: 1))");
    assert!(unknown.contains("s.ron, line 2,") && unknown.contains("size"), "{unknown}");
    let falling = error("shape: Primitive(HalfSpace())");
    assert!(falling.contains("s.ron, line 2,"), "{falling}");
    assert!(falling.contains("\"a\": a half-space has no mass. Make it Fixed"), "{falling}");
    let shell = error("shape: Primitive(Ball(radius: 1)), mass: Shell(thickness: 0.1)");
    assert!(shell.contains("a ball has a solid: say `mass: Total"), "{shell}");
    let smooth = error("shape: Primitive(Ball(radius: 1)), normals: Smooth(crease_angle: 0.5)");
    assert!(smooth.contains("a ball has no facets to smooth"), "{smooth}");
    let dent = "effects: [Deformation(hardness: 1, radius: 1)]";
    let dented = error(&format!("shape: Primitive(Ball(radius: 1)), {dent}"));
    assert!(dented.contains("Deformation works on a mesh, but it is a ball"), "{dented}");
}

#[test]
fn a_total_mass_is_spread_over_the_primitive_and_not_over_its_picture() {
    let text = "(bodies: [(name: \"a\", shape: Primitive(Ball(radius: 2)), mass: Total(10))])";
    let scene = parsed(text).unwrap().description;
    let mass = scene.bodies[0].mass.unwrap();
    assert!((mass.mass - 10.0).abs() < 1e-12);
    // 2/5 m r².
    let moment = mass.inertia.x_axis.x;
    assert!((moment - 16.0).abs() < 1e-6, "{moment}");
}

#[test]
fn a_pile_may_have_primitives_and_a_visual_may_differ() {
    let text = "(groups: [Pile(name: \"p\", count: 5,
        shapes: [Primitive(Ball(radius: 0.5)), Generator(Cuboid())],
        region: (min: (-5, -5, 0), max: (5, 5, 10)))],
        bodies: [(name: \"a\", kind: Fixed, shape: Primitive(Ball(radius: 1)),
                  visual: Primitive(Cylinder(radius: 1, height: 1)))])";
    let scene = parsed(text).unwrap().description;
    let balls = scene.bodies.iter().filter(|body| body.primitive().is_some()).count();
    assert!((2..=5).contains(&balls), "{balls}");
    assert!(scene.bodies[0].visual.is_some());
}

/// Two links of a rail, a sphere and a cylinder, that a slide brings together.
const SLIDE: &str = "<robot name='slide'>
<link name='base'><collision><origin xyz='0 0 1'/><geometry><sphere radius='0.5'/></geometry></collision></link>
<link name='middle'/>
<link name='hand'><collision><origin xyz='0 0 1' rpy='1.5707963267948966 0 0'/>
  <geometry><cylinder radius='0.25' length='2'/></geometry></collision></link>
<joint name='rail' type='prismatic'><parent link='base'/><child link='middle'/><axis xyz='1 0 0'/>
  <limit lower='-9' upper='9' effort='1' velocity='1'/></joint>
<joint name='grip' type='fixed'><parent link='middle'/><child link='hand'/></joint>
</robot>";

#[test]
fn spheres_and_cylinders_of_a_robot_meet_as_what_they_are() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("r.urdf");
    std::fs::write(&path, SLIDE).unwrap();
    let robot = read_robot(&path).unwrap();
    let kinds: Vec<_> = robot.links.iter().map(|l| l.primitive.map(|p| p.name())).collect();
    assert_eq!(kinds, [Some("ball"), None, Some("cylinder")]);
    let mut links = robot.self_collisions(&[]).unwrap();
    let mut distance = |x: f64| {
        let positions = [("rail".to_owned(), x)].into();
        let poses: Vec<Pose> = robot.forward_kinematics(&positions).unwrap();
        links.at(&poses, Wanted::Nearest).unwrap().nearest.unwrap().distance
    };
    assert!((distance(2.0) - 1.25).abs() < 1e-9, "{}", distance(2.0));
    // Inscribed meshes of 32 sides would be farther apart than this.
    assert!(distance(0.75 + 1e-6) < 2e-6);
    assert_eq!(distance(0.75 - 1e-6), 0.0);
}

#[test]
fn a_robot_in_a_scene_has_primitives_where_a_link_is_one() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("r.urdf"), SLIDE).unwrap();
    let text = "(robots: [(path: \"r.urdf\", name: \"r\")])".to_owned();
    let at = folder.path().join("s.ron");
    let scene = parse_scene(text, &at, &LoadOptions::default()).unwrap().description;
    let kinds: Vec<_> =
        scene.bodies.iter().filter_map(|body| Some(body.primitive()?.name())).collect();
    assert_eq!(kinds, ["ball", "cylinder"]);
}
