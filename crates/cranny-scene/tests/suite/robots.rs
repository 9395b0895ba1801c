//! URDF robots: what is read, what is refused, and what becomes of them in a scene.

use std::path::PathBuf;

use cranny_exact::{DMat3, DVec3, Pose};
use cranny_scene::robot::PositionError;
use cranny_scene::{
    LoadOptions, LoadedScene, Robot, RobotError, SceneError, parse_scene, read_robot,
};
use cranny_world::description::{
    BodyKind, JointDescription, JointKind, JointPositions, SceneDescription,
};

/// A tetrahedron, beside the URDF as `m.OBJ`.
const MESH: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n";

struct Files {
    folder: tempfile::TempDir,
}

impl Files {
    fn new() -> Self {
        let folder = tempfile::tempdir().unwrap();
        std::fs::create_dir_all(folder.path().join("pkg/urdf")).unwrap();
        std::fs::write(folder.path().join("pkg/m.OBJ"), MESH).unwrap();
        Self { folder }
    }

    fn path(&self) -> PathBuf {
        self.folder.path().join("pkg/urdf/r.urdf")
    }

    fn read(&self, urdf: &str) -> Result<Robot, RobotError> {
        std::fs::write(self.path(), urdf).unwrap();
        read_robot(&self.path())
    }

    fn scene(&self, urdf: &str, robot: &str) -> Result<SceneDescription, SceneError> {
        self.loaded(urdf, robot).map(|loaded| loaded.description)
    }

    fn loaded(&self, urdf: &str, robot: &str) -> Result<LoadedScene, SceneError> {
        std::fs::write(self.path(), urdf).unwrap();
        let text = format!("(robots: [(path: \"pkg/urdf/r.urdf\", name: \"r\", {robot})])");
        let at = self.folder.path().join("s.ron");
        parse_scene(text, &at, &LoadOptions::default())
    }
}

const BOX: &str = "<collision><geometry><box size=\"0.1 0.1 0.1\"/></geometry></collision>";

fn urdf(body: &str) -> String {
    format!("<?xml version=\"1.0\"?>\n<robot name=\"arm\">\n{body}\n</robot>\n")
}

fn joint(name: &str, kind: &str, parent: &str, child: &str, rest: &str) -> String {
    format!(
        "<joint name=\"{name}\" type=\"{kind}\"><parent link=\"{parent}\"/><child link=\"{child}\"/>{rest}</joint>"
    )
}

/// root —(turn)— a —(slide)— b, and b's twin c that follows.
fn arm() -> String {
    urdf(&format!(
        "<link name=\"root\">{BOX}</link><link name=\"a\">{BOX}<inertial><mass value=\"3\"/><inertia ixx=\"1\" ixy=\"0\" ixz=\"0\" iyy=\"1\" iyz=\"0\" izz=\"1\"/></inertial></link><link name=\"b\">{BOX}</link><link name=\"c\">{BOX}</link>{}{}{}",
        joint(
            "turn",
            "revolute",
            "root",
            "a",
            "<origin xyz=\"0 0 1\"/><axis xyz=\"0 0 2\"/><limit lower=\"-2\" upper=\"2\" effort=\"1\" velocity=\"1\"/>"
        ),
        joint(
            "slide",
            "prismatic",
            "a",
            "b",
            "<origin xyz=\"1 0 0\"/><axis xyz=\"1 0 0\"/><limit lower=\"0\" upper=\"1\" effort=\"1\" velocity=\"1\"/>"
        ),
        joint(
            "follow",
            "continuous",
            "a",
            "c",
            "<axis xyz=\"0 0 1\"/><mimic joint=\"turn\" multiplier=\"-2\" offset=\"0.5\"/>"
        ),
    ))
}

/// Where a motor holds a joint.
fn held(joint: &JointDescription) -> Option<f64> {
    joint.motor?.position
}

fn positions(list: &[(&str, f64)]) -> JointPositions {
    list.iter().map(|&(name, value)| (name.to_owned(), value)).collect()
}

#[test]
fn forward_kinematics_turns_slides_and_follows() {
    let robot = Files::new().read(&arm()).unwrap();
    assert_eq!((robot.name.as_str(), robot.links.len(), robot.root), ("arm", 4, 0));
    assert_eq!(robot.links[1].mass, Some(3.0));
    assert_eq!(robot.links[2].mass, None);
    assert_eq!(robot.adjacent_links(), [(0, 1), (1, 2), (1, 3)]);
    let quarter = std::f64::consts::FRAC_PI_2;
    let poses = robot.forward_kinematics(&positions(&[("turn", quarter), ("slide", 0.5)])).unwrap();
    let at = |link: usize, p: DVec3| poses[link].world_from_body().apply(p);
    assert!((at(1, DVec3::X) - DVec3::new(0.0, 1.0, 1.0)).length() < 1e-15);
    assert!((at(2, DVec3::ZERO) - DVec3::new(0.0, 1.5, 1.0)).length() < 1e-15);
    // c: quarter + (0.5 - 2 quarter) = 0.5 - quarter.
    let angle: f64 = 0.5 - quarter;
    assert!((at(3, DVec3::X) - DVec3::new(angle.cos(), angle.sin(), 1.0)).length() < 1e-15);
    let refused = |list| robot.forward_kinematics(&positions(list)).unwrap_err();
    assert!(
        matches!(refused(&[("spin", 0.0)]), PositionError::UnknownJoint { movable, .. } if movable == "turn, slide")
    );
    assert!(matches!(refused(&[("follow", 0.0)]), PositionError::NotFree { .. }));
    assert!(matches!(refused(&[("turn", f64::NAN)]), PositionError::NotFinite { .. }));
}

#[test]
fn roll_pitch_yaw_turns_about_fixed_axes() {
    let text = urdf(&format!(
        "<link name=\"a\">{BOX}</link><link name=\"b\">{BOX}</link>{}",
        joint("j", "fixed", "a", "b", "<origin xyz=\"1 2 3\" rpy=\"0.3 -0.4 0.5\"/>")
    ));
    let robot = Files::new().read(&text).unwrap();
    let b = robot.forward_kinematics(&JointPositions::new()).unwrap()[1].world_from_body();
    let (sr, cr) = 0.3f64.sin_cos();
    let (sp, cp) = (-0.4f64).sin_cos();
    let (sy, cy) = 0.5f64.sin_cos();
    // Rz(yaw) · Ry(pitch) · Rx(roll), written out.
    let rows = [
        DVec3::new(cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr),
        DVec3::new(sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr),
        DVec3::new(-sp, cp * sr, cp * cr),
    ];
    let p = DVec3::new(0.7, -1.1, 0.4);
    let expected = DVec3::new(1.0, 2.0, 3.0) + DVec3::from_array(rows.map(|row| row.dot(p)));
    assert!((b.apply(p) - expected).length() < 1e-15);
}

#[test]
fn collision_elements_are_joined_and_mirrored_meshes_turned() {
    let text = urdf(
        "<link name=\"a\"><collision><origin xyz=\"5 0 0\"/><geometry><sphere radius=\"0.5\"/></geometry></collision>\
         <collision><geometry><mesh filename=\"package://pkg/m.OBJ\" scale=\"-1 1 2\"/></geometry></collision>\
         <collision><geometry><cylinder radius=\"1\" length=\"2\"/></geometry></collision>\
         <collision><geometry><capsule radius=\"1\" length=\"2\"/></geometry></collision>\
         <visual><geometry><mesh filename=\"package://pkg/none.dae\"/></geometry></visual>\
         <visual><geometry><box size=\"1 1 1\"/></geometry></visual></link>",
    );
    let files = Files::new();
    let robot = files.read(&text).unwrap();
    let mesh = robot.links[0].collision.as_ref().unwrap();
    let sphere = 2 * 32 * 15;
    assert_eq!(mesh.faces().len(), sphere + 4 + 128 + 2 * 32 * 16);
    let filed = mesh.faces()[sphere].map(|i| mesh.vertices()[i as usize]);
    // Face 1 3 2 of the file, mirrored in x, stretched in z, turned.
    assert_eq!(filed, [DVec3::ZERO, DVec3::NEG_X, DVec3::Y]);
    assert_eq!(robot.links[0].visual.as_ref().unwrap().faces().len(), 12);
    assert!(robot.notes.len() == 1 && robot.notes[0].contains("none.dae"), "{:?}", robot.notes);
    assert_eq!(robot.files.len(), 2);
    let upper = text.replace("package://pkg/m.OBJ", "../m.OBJ");
    assert_eq!(files.read(&upper).unwrap().links[0].collision, robot.links[0].collision);
}

#[test]
fn broken_robots_say_what_is_wrong() {
    let files = Files::new();
    let links = format!("<link name=\"a\">{BOX}</link><link name=\"b\">{BOX}</link>");
    let cases = [
        (String::new(), "XML"),
        ("<robot name=\"x\">".to_owned(), "line 1"),
        ("<scene/>".to_owned(), "expected 'robot'"),
        (urdf(""), "no links"),
        (urdf("<link/>"), "line 3, column 1: a link has no name"),
        (urdf("<link name=\"a\"/><link name=\"a\"/>"), "two of them have this name"),
        (urdf(&links), "2 links without parent (a, b)"),
        (urdf(&format!("{links}{}", joint("j", "fixed", "a", "z", ""))), "names the link \"z\""),
        (
            urdf(&format!("{links}{}", joint("j", "spherical", "a", "b", ""))),
            "joint \"j\": its type is spherical",
        ),
        (
            urdf(&format!("{links}\n{}", joint("j", "bendy", "a", "b", ""))),
            "line 4, column 1: joint \"j\" has the type \"bendy\"",
        ),
        (
            urdf("<link name=\"a\"><inertial>\n<mass value=\"${m}\"/></inertial></link>"),
            "line 4, column 1: link \"a\": the attribute \"value\" of its element \"mass\" is \"${m}\", expected a number. This is xacro",
        ),
        (
            urdf("<link name=\"a\"><collision><geometry><mesh/></geometry></collision></link>"),
            "has no attribute \"filename\"",
        ),
        (
            urdf("<link name=\"a\"><collision><geometry><cone/></geometry></collision></link>"),
            "a geometry of [\"cone\"]",
        ),
        (urdf("<xacro:arm xmlns:xacro=\"http://ros.org/wiki/xacro\"/>"), "run xacro on it first"),
        (
            urdf(&format!(
                "{links}{}{}",
                joint("j", "fixed", "a", "b", ""),
                joint("k", "fixed", "a", "b", "")
            )),
            "child of joint \"j\" and of joint \"k\"",
        ),
        (
            urdf(&format!(
                "{links}{}{}",
                joint("j", "fixed", "a", "b", ""),
                joint("k", "fixed", "b", "a", "")
            )),
            "joint \"j\": the joints \"j\", \"k\" lead in a circle",
        ),
        (
            urdf(&format!(
                "{links}{}",
                joint("j", "continuous", "a", "b", "<axis xyz=\"0 0 0\"/>")
            )),
            "has no direction",
        ),
        (
            urdf(&format!("{links}{}", joint("j", "continuous", "a", "b", "<mimic joint=\"j\"/>"))),
            "which follows another joint itself",
        ),
        (
            urdf(&format!(
                "{links}{}",
                joint(
                    "j",
                    "revolute",
                    "a",
                    "b",
                    "<limit lower=\"1\" upper=\"0\" effort=\"1\" velocity=\"1\"/>"
                )
            )),
            "lower limit 1 is not below",
        ),
        (
            urdf(&format!("{links}{}", joint("j", "fixed", "a", "b", "<origin xyz=\"0 nan 0\"/>"))),
            "coordinate y is NaN",
        ),
        (
            urdf(
                "<link name=\"a\"><collision><geometry><mesh filename=\"package://pkg/x.stl\"/></geometry></collision></link>",
            ),
            "\"package://pkg/x.stl\" was not found. Looked for",
        ),
        (
            urdf(
                "<link name=\"a\"><collision><geometry><mesh filename=\"../m.OBJ\" scale=\"0 1 1\"/></geometry></collision></link>",
            ),
            "flattens it",
        ),
        (
            urdf(
                "<link name=\"a\"><collision><geometry><sphere radius=\"-1\"/></geometry></collision></link>",
            ),
            "radius is -1",
        ),
        (
            urdf(
                "<link name=\"a\"><collision><geometry><cylinder radius=\"0\" length=\"1\"/></geometry></collision></link>",
            ),
            "greater than 0",
        ),
    ];
    for (text, says) in cases {
        let error = files.read(&text).map(|_| ()).unwrap_err().to_string();
        assert!(error.contains(says) && error.contains("r.urdf"), "{says}: {error}");
    }
    std::fs::write(files.folder.path().join("pkg/bad.stl"), [0; 100]).unwrap();
    let text = urdf(
        "<link name=\"a\"><collision><geometry><mesh filename=\"../bad.stl\"/></geometry></collision></link>",
    );
    let error = files.read(&text).unwrap_err();
    assert!(matches!(error, RobotError::Mesh { .. }));
    assert!(matches!(
        read_robot(&files.folder.path().join("none.urdf")),
        Err(RobotError::Unreadable { .. })
    ));
}

#[test]
fn no_prefix_of_a_robot_panics() {
    let files = Files::new();
    let text = arm();
    for length in 0..text.trim_end().len() {
        assert!(files.read(&text[..length]).is_err(), "{length}");
    }
    let deep =
        format!("<robot name=\"x\">{}{}</robot>", "<a>".repeat(100_000), "</a>".repeat(100_000));
    assert!(files.read(&deep).unwrap_err().to_string().contains("nested deeper"));
}

#[test]
fn robots_become_bodies_and_joints() {
    let files = Files::new();
    let robot = "pose: (at: (0, 0, 5)), positions: {\"turn\": 0.5}, targets: {\"slide\": 0.25}";
    let scene = files.scene(&arm(), robot).unwrap();
    let names: Vec<_> = scene.bodies.iter().map(|body| (body.name.as_str(), body.kind)).collect();
    use BodyKind::{Dynamic, Fixed};
    assert_eq!(names, [("r/root", Fixed), ("r/a", Dynamic), ("r/b", Dynamic), ("r/c", Dynamic)]);
    assert_eq!(scene.bodies[0].pose.translation, DVec3::new(0.0, 0.0, 5.0));
    assert_eq!(scene.bodies[1].pose.translation, DVec3::new(0.0, 0.0, 6.0));
    let mass = scene.bodies[1].mass.unwrap();
    assert_eq!((mass.mass, mass.center, mass.inertia), (3.0, DVec3::ZERO, DMat3::IDENTITY));
    assert!((scene.bodies[2].mass.unwrap().mass - 0.001).abs() < 1e-12, "by its volume");
    assert_eq!(scene.excluded_pairs, [(0, 1), (1, 2), (1, 3)]);
    let joints: Vec<_> =
        scene.joints.iter().map(|j| (j.name.as_str(), j.parent, j.child, held(j))).collect();
    assert_eq!(
        joints,
        [("r/turn", 0, 1, Some(0.5)), ("r/slide", 1, 2, Some(0.25)), ("r/follow", 1, 3, None)]
    );
    assert_eq!(scene.joints[2].mimic.as_ref().unwrap().joint, "r/turn");
    // Body poses agree with the joints' anchors at the starting positions.
    let j = &scene.joints[0];
    let joint = scene.bodies[j.parent].pose.compose(&j.parent_anchor);
    assert_eq!(joint.translation, scene.bodies[j.child].pose.compose(&j.child_anchor).translation);
    let free = files.scene(&arm(), "fixed_base: false, hold: false").unwrap();
    assert_eq!(free.bodies[0].kind, Dynamic);
    assert!(free.joints.iter().all(|joint| held(joint).is_none()));
}

#[test]
fn links_without_geometry_are_carried() {
    let text = urdf(&format!(
        "<link name=\"world\"/><link name=\"base\">{BOX}</link><link name=\"frame\"/><link name=\"tool\">{BOX}</link><link name=\"tip\"/><link name=\"cam\">{BOX}</link>{}{}{}{}{}",
        joint("j0", "fixed", "world", "base", "<origin xyz=\"0 0 1\"/>"),
        joint("j1", "fixed", "base", "frame", "<origin xyz=\"1 0 0\"/>"),
        joint("j2", "continuous", "frame", "tool", "<origin xyz=\"0 1 0\"/>"),
        joint("j3", "continuous", "tool", "tip", ""),
        joint("j4", "fixed", "frame", "cam", "<origin xyz=\"0 2 0\"/>"),
    ));
    let files = Files::new();
    let scene = files.scene(&text, "").unwrap();
    let bodies: Vec<_> = scene.bodies.iter().map(|body| (body.name.as_str(), body.kind)).collect();
    use BodyKind::{Dynamic, Fixed};
    assert_eq!(bodies, [("r/base", Fixed), ("r/tool", Dynamic), ("r/cam", Fixed)]);
    assert_eq!(scene.joints.len(), 2);
    assert_eq!(scene.joints[0].parent_anchor.translation, DVec3::new(1.0, 1.0, 0.0));
    assert_eq!(scene.joints[1].kind, JointKind::Fixed);
    assert_eq!(scene.excluded_pairs, [(0, 1), (0, 2)]);
    let bare = files.scene(&urdf("<link name=\"a\"/>"), "").unwrap_err().to_string();
    assert!(bare.contains("none of its links"), "{bare}");
}

#[test]
fn an_empty_name_of_a_robot_is_refused() {
    let files = Files::new();
    let text = "(robots: [(path: \"arm.urdf\", name: \"\")])";
    std::fs::write(files.folder.path().join("arm.urdf"), arm()).unwrap();
    let parsed =
        parse_scene(text.to_owned(), &files.folder.path().join("s.ron"), &LoadOptions::default());
    let error = parsed.unwrap_err().to_string();
    assert!(
        error.contains("line 1, column") && error.contains("the name \"\" is empty"),
        "{error}"
    );
}

#[test]
fn wrong_positions_are_placed_in_the_scene() {
    let files = Files::new();
    for (robot, says) in [
        (
            "positions: {\"turn\": 2.5}",
            "position 2.5 of joint \"turn\" is outside its limits, -2 to 2",
        ),
        ("targets: {\"slide\": -1}", "target -1 of joint \"slide\""),
        (
            "motors: {\"turn\": (position: 3)}",
            "joint \"turn\": its motor's position is 3, outside its limits, -2 to 2",
        ),
        (
            "targets: {\"turn\": 1}, motors: {\"turn\": (position: -1)}",
            "joint \"turn\": its target is 1, but the position of its motor is -1",
        ),
        ("positions: {\"bend\": 0}", "no joint \"bend\"; its movable joints are turn, slide"),
        ("positions: {\"follow\": 0}", "follows joint"),
    ] {
        let error = files.scene(&arm(), robot).unwrap_err().to_string();
        assert!(error.contains(says) && error.contains("line 1, column 43"), "{error}");
    }
}

/// The mass of a link, its centre and the turn of its tensor.
fn inertial(mass: f64, origin: &str, tensor: [f64; 3]) -> String {
    let [ixx, iyy, izz] = tensor;
    format!(
        "<inertial>{origin}<mass value=\"{mass}\"/><inertia ixx=\"{ixx}\" ixy=\"0\" ixz=\"0\" iyy=\"{iyy}\" iyz=\"0\" izz=\"{izz}\"/></inertial>"
    )
}

#[test]
fn a_stated_tensor_is_turned_by_its_origin() {
    let quarter = std::f64::consts::FRAC_PI_2;
    let origin = format!("<origin xyz=\"0.1 0.2 0.3\" rpy=\"0 0 {quarter}\"/>");
    let text =
        urdf(&format!("<link name=\"a\">{BOX}{}</link>", inertial(2.0, &origin, [1.0, 2.0, 2.5])));
    let stated = Files::new().read(&text).unwrap().links[0].inertial.unwrap();
    assert_eq!((stated.mass, stated.center), (2.0, DVec3::new(0.1, 0.2, 0.3)));
    let turned = DMat3::from_diagonal(DVec3::new(2.0, 1.0, 2.5));
    assert!((stated.inertia - turned).x_axis.length() < 1e-15);
    assert!((stated.inertia - turned).y_axis.length() < 1e-15);
    assert_eq!(stated.inertia.z_axis, turned.z_axis);
}

/// base (fixed) - frame (nothing) - arm (mass alone) - plate (open mesh, mass stated) - tag (fixed,
/// a mass without geometry).
fn bare() -> String {
    let open = "<collision><geometry><mesh filename=\"../sheet.obj\"/></geometry></collision>";
    let arm = inertial(2.0, "<origin xyz=\"0.5 0 0\"/>", [0.1, 0.1, 0.1]);
    let plate = inertial(1.0, "", [0.1, 0.1, 0.1]);
    urdf(&format!(
        "<link name=\"base\"/><link name=\"frame\"/><link name=\"arm\">{arm}</link><link name=\"plate\">{open}{plate}</link><link name=\"tag\">{plate}</link>{}{}{}{}",
        joint("j0", "continuous", "base", "frame", "<axis xyz=\"0 0 1\"/>"),
        joint("j1", "continuous", "frame", "arm", "<axis xyz=\"0 1 0\"/>"),
        joint("j2", "continuous", "arm", "plate", "<origin xyz=\"1 0 0\"/><axis xyz=\"0 1 0\"/>"),
        joint("j3", "fixed", "plate", "tag", "<origin xyz=\"0 0 2\"/>"),
    ))
}

#[test]
fn links_without_geometry_are_masses_and_frames() {
    let files = Files::new();
    let sheet = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    std::fs::write(files.folder.path().join("pkg/sheet.obj"), sheet).unwrap();
    let loaded = files.loaded(&bare(), "").unwrap();
    let scene = loaded.description;
    let bodies: Vec<_> = scene.bodies.iter().map(|b| (b.name.as_str(), b.layers.len())).collect();
    assert_eq!(bodies, [("r/base", 0), ("r/frame", 0), ("r/arm", 0), ("r/plate", 1)]);
    assert_eq!(scene.bodies[0].kind, BodyKind::Fixed);
    assert_eq!(scene.bodies[1].mass.unwrap().mass, 1e-3);
    assert_eq!(scene.bodies[2].mass.unwrap().center, DVec3::new(0.5, 0.0, 0.0));
    // The plate and the tag 2 above it as one: m (1^2 + 1^2) about the middle.
    let both = scene.bodies[3].mass.unwrap();
    assert_eq!((both.mass, both.center), (2.0, DVec3::new(0.0, 0.0, 1.0)));
    let diagonal = DVec3::new(both.inertia.x_axis.x, both.inertia.y_axis.y, both.inertia.z_axis.z);
    assert!((diagonal - DVec3::new(2.2, 2.2, 0.2)).length() < 1e-15, "{diagonal}");
    assert_eq!(scene.joints.len(), 3);
    assert!(scene.joints.iter().all(|joint| joint.reduced));
    let said = loaded.warnings.join("\n");
    assert!(said.contains("\"r/frame\" move and have neither mass nor geometry"), "{said}");
    assert!(said.contains("meet nothing: \"base\", \"frame\", \"arm\""), "{said}");
}

#[test]
fn an_open_mesh_without_a_mass_weighs_like_its_box_and_is_named() {
    let files = Files::new();
    let sheet = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\nf 1 2 4\n";
    std::fs::write(files.folder.path().join("pkg/sheet.obj"), sheet).unwrap();
    let open = "<collision><geometry><mesh filename=\"../sheet.obj\"/></geometry></collision>";
    let text = urdf(&format!("<link name=\"lid\">{open}</link>"));
    let loaded = files.loaded(&text, "fixed_base: false, material: (density: 4)").unwrap();
    let mass = loaded.description.bodies[0].mass.unwrap();
    assert_eq!((mass.mass, mass.center), (4.0, DVec3::splat(0.5)));
    assert!(loaded.warnings[0].contains("r.urdf: link \"lid\""), "{:?}", loaded.warnings);
}

#[test]
fn what_is_harmless_is_mended_and_said() {
    let files = Files::new();
    let big =
        MESH.replace(" 1 0 0", " 30 0 0").replace("0 1 0", "0 30 0").replace("0 0 1", "0 0 30");
    std::fs::write(files.folder.path().join("pkg/big.obj"), big).unwrap();
    let links = format!("<link name=\"a\">{BOX}</link><link name=\"b\">{BOX}</link>");
    let follows = joint("j", "continuous", "a", "b", "<mimic joint=\"q\"/>");
    for (text, says) in [
        (
            urdf("<link name=\"a\" foo:x=\"1\"/>"),
            "line 3: the prefix \"foo\" is bound to no namespace",
        ),
        (
            urdf(&format!("{links}{follows}")),
            "line 3: joint \"j\" follows joint \"q\", which is not in the file",
        ),
        (
            urdf("<link name=\"a\"><visual><geometry><mesh/></geometry></visual></link>"),
            "a visual element was left out",
        ),
        (
            urdf("<link name=\"a\"><inertial><mass value=\"2\"/></inertial></link>"),
            "link \"a\" states a mass and no inertia",
        ),
        (
            urdf(&format!("<link name=\"a\">{}</link>", inertial(-3.7, "", [1.0; 3]))),
            "line 3: link \"a\" states the mass -3.7, which is not above 0",
        ),
        (
            urdf(&format!("<link name=\"a\">{}</link>", inertial(0.0, "", [1.0; 3]))),
            "link \"a\" states the mass 0, which is not above 0",
        ),
        (
            urdf(&format!("<link name=\"a\">{}</link>", inertial(2.0, "", [1e-19, 0.1, 0.1]))),
            "which no body of 2 kg has",
        ),
        (
            urdf(
                "<link name=\"a\"><collision><geometry><mesh filename=\"../big.obj\"/></geometry></collision></link>",
            ),
            "link \"a\" has the mesh \"../big.obj\", whose box is 52 m across. Where it is in millim",
        ),
    ] {
        let robot = files.read(&text).unwrap();
        assert!(robot.notes.iter().any(|note| note.contains(says)), "{says}: {:?}", robot.notes);
    }
    // What nobody reads may be as it likes; limits without bounds bound nothing.
    let text = urdf(&format!(
        "{links}{}<material><texture/></material><gazebo><plugin/></gazebo><transmission/>",
        joint("j", "revolute", "a", "b", "<limit/><dynamics damping=\"0.5\" friction=\"0.25\"/>")
    ));
    let robot = files.read(&text).unwrap();
    assert!(robot.notes.is_empty(), "{:?}", robot.notes);
    assert_eq!(robot.joints[0].limits(), None);
    assert_eq!(
        (robot.joints[0].resistance.damping, robot.joints[0].resistance.friction),
        (0.5, 0.25)
    );
}

#[test]
fn links_without_a_mass_are_named_with_the_density_that_they_get() {
    let warnings = |said: &str| Files::new().loaded(&arm(), said).unwrap().warnings.join("\n");
    let found = warnings("material: (density: 700)");
    let says =
        "links without a stated mass weigh what their collision geometry weighs at density 700";
    assert!(found.contains(says), "{found}");
    assert!(
        found.contains("states the mass): \"b\", \"c\""),
        "not the root, which stands: {found}"
    );
}

#[test]
fn visual_meshes_that_are_missing_are_one_note() {
    let files = Files::new();
    let notes = |links: &[&str]| {
        let link = |name: &&str| {
            format!(
                "<link name=\"{name}\"><visual><geometry><mesh filename=\"{name}.stl\"/></geometry></visual></link>"
            )
        };
        let links: String = links.iter().map(link).collect();
        let joints: String = ["b", "c"].map(|child| joint(child, "fixed", "a", child, "")).concat();
        let joints = if links.contains("\"c\"") { joints } else { String::new() };
        files.read(&urdf(&format!("{links}{joints}"))).unwrap().notes
    };
    let one = notes(&["a"]);
    assert!(one.len() == 1 && one[0].contains("is drawn without the mesh \"a.stl\""), "{one:?}");
    let three = notes(&["a", "b", "c"]);
    assert!(three.len() == 1 && three[0].contains("3 visual meshes were not found"), "{three:?}");
    assert!(three[0].contains("the first is \"a.stl\" of link \"a\""), "{three:?}");
}

#[test]
fn motors_have_the_limits_of_the_robot_and_the_gains_of_the_scene() {
    let files = Files::new();
    let said = "motors: {\"turn\": (position: 0.5, stiffness: 30, damping: 2, max_effort: 9)}, targets: {\"slide\": 0.5}";
    let scene = files.scene(&arm(), said).unwrap();
    let turn = scene.joints[0].motor.unwrap();
    assert_eq!((turn.position, turn.stiffness, turn.damping), (Some(0.5), Some(30.0), Some(2.0)));
    assert_eq!((turn.max_effort, turn.max_velocity), (Some(9.0), Some(1.0)));
    let slide = scene.joints[1].motor.unwrap();
    assert_eq!((slide.position, slide.stiffness, slide.max_effort), (Some(0.5), None, Some(1.0)));
    let error = files.scene(&arm(), "motors: {\"bend\": ()}").unwrap_err().to_string();
    assert!(error.contains("no joint \"bend\""), "{error}");
}

#[test]
fn paths_lead_motors_from_where_they_begin() {
    let files = Files::new();
    let said = "hold: false, motors: {\"turn\": (stiffness: 30)}, paths: {\"turn\": (keyframes: [(time: 0, position: 0.25), (time: 2, position: 1.25)])}";
    let scene = files.scene(&arm(), said).unwrap();
    let turn = &scene.joints[0];
    let motor = turn.motor.unwrap();
    assert_eq!((turn.start, motor.position, motor.stiffness), (0.25, Some(0.25), Some(30.0)));
    assert_eq!(turn.path.as_ref().unwrap().position_at(1.0), 0.75);
    assert_eq!((scene.joints[1].motor, scene.joints[1].path.is_none()), (None, true));
    let elsewhere = files.scene(&arm(), &format!("positions: {{\"turn\": 1}}, {said}")).unwrap();
    assert_eq!((elsewhere.joints[0].start, held(&elsewhere.joints[0])), (1.0, Some(0.25)));
}

#[test]
fn paths_that_contradict_a_robot_are_refused_with_line_and_value() {
    let path = |joint: &str, keys: &str| format!("paths: {{\"{joint}\": (keyframes: [{keys}])}}");
    let at = |position: f64| path("turn", &format!("(time: 0, position: {position})"));
    for (said, says) in [
        (at(2.5), "is at 2.5 at 0 s, outside its limits, -2 to 2"),
        (
            format!("targets: {{\"turn\": 1}}, {}", at(1.0)),
            "joint \"turn\": it has a path and a target",
        ),
        (
            format!("motors: {{\"turn\": (velocity: 1)}}, {}", at(1.0)),
            "and a velocity of its motor",
        ),
        (path("turn", ""), "it has no keyframes"),
        (
            path("turn", "(time: 1, position: 0), (time: 1, position: 1)"),
            "keyframe 1 is at 1 s, not after 1 s",
        ),
        (path("follow", "(time: 0, position: 0)"), "follows joint \"turn\""),
        (path("bend", "(time: 0, position: 0)"), "no joint \"bend\""),
    ] {
        let error = Files::new().scene(&arm(), &said).unwrap_err().to_string();
        assert!(error.contains(says) && error.contains("s.ron, line 1,"), "{said}: {error}");
    }
}

#[test]
fn links_that_meet_along_a_path_and_paths_that_are_too_fast_are_warned_of() {
    // The twin turns about the arm's root, and the hand is a unit away from it.
    let text = arm().replace("lower=\"0\" upper=\"1\"", "lower=\"-1\" upper=\"1\"");
    let path = |to: f64| {
        format!(
            "paths: {{\"slide\": (keyframes: [(time: 1, position: 0), (time: 3, position: {to})])}}"
        )
    };
    let warnings = |to: f64| Files::new().loaded(&text, &path(to)).unwrap().warnings;
    let meets =
        |to: f64| warnings(to).iter().any(|what| what.contains("b - c (first seen at 2.766"));
    assert!(meets(-1.0) && !meets(-0.5), "{:?}", warnings(-1.0));
    let fast = path(-1.0).replace("time: 3", "time: 1.5");
    let loaded = Files::new().loaded(&text, &fast).unwrap();
    let says =
        "joint \"slide\": its path asks for a velocity of 2 after 1 s, but 1 is its greatest";
    assert!(loaded.warnings.iter().any(|what| what.contains(says)), "{:?}", loaded.warnings);
}

#[test]
fn links_have_the_color_of_the_material_with_the_greatest_surface() {
    let visual = |size: f64, material: &str| {
        format!("<visual><geometry><box size=\"{size} 1 1\"/></geometry>{material}</visual>")
    };
    let named = "<material name=\"paint\"/>";
    let own = "<material name=\"own\"><color rgba=\"0 0 1 1\"/></material>";
    let bytes = "<material name=\"bytes\"><color rgba=\"255 0 0 255\"/></material>";
    let text = urdf(&format!(
        "<link name=\"a\">{}{}{}</link><link name=\"b\">{}</link><link name=\"c\">{}</link>{}{}<material name=\"paint\"><color rgba=\"1 0.5 0 0.5\"/></material>",
        visual(2.0, own),
        visual(3.0, named),
        visual(9.0, ""),
        visual(1.0, bytes),
        visual(1.0, "<material name=\"none\"/>"),
        joint("j", "fixed", "a", "b", ""),
        joint("k", "fixed", "a", "c", "")
    ));
    let robot = Files::new().read(&text).unwrap();
    let colors: Vec<_> = robot.links.iter().map(|link| link.color.map(|color| color.0)).collect();
    assert_eq!(colors, [Some([255, 128, 0]), None, None]);
    let says = "line 3: link \"b\" has the color \"255 0 0 255\", which is not four numbers";
    assert!(robot.notes.iter().any(|note| note.contains(says)), "{:?}", robot.notes);
}

#[test]
fn joints_start_within_their_limits() {
    let text = arm().replace("lower=\"-2\" upper=\"2\"", "lower=\"-2\" upper=\"-0.5\"");
    let loaded = Files::new().loaded(&text, "").unwrap();
    assert_eq!(held(&loaded.description.joints[0]), Some(-0.5));
    assert!(loaded.warnings.iter().any(|what| what.contains("limits of \"turn\"")));
}

#[test]
fn a_robot_starts_in_a_named_state_of_its_srdf() {
    let files = Files::new();
    let state = |joints: &str| {
        let text = format!(
            "<robot name=\"r\">\n<group_state name=\"up\" group=\"g\">{joints}</group_state></robot>"
        );
        std::fs::write(files.folder.path().join("r.srdf"), text).unwrap();
    };
    state("<joint name=\"turn\" value=\"0.75\"/>");
    let turn = |robot: &str| held(&files.scene(&arm(), robot).unwrap().joints[0]);
    assert_eq!(turn("srdf: \"r.srdf\", state: \"up\""), Some(0.75));
    assert_eq!(turn("srdf: \"r.srdf\", state: \"up\", positions: {\"turn\": 0.5}"), Some(0.5));
    assert_eq!(turn("srdf: \"r.srdf\""), Some(0.0));
    let refused = |robot: &str| files.scene(&arm(), robot).unwrap_err().to_string();
    let none = refused("state: \"up\"");
    assert!(none.contains("starts in the state \"up\", but names no `srdf`"), "{none}");
    let unknown = refused("srdf: \"r.srdf\", state: \"down\"");
    assert!(unknown.contains("r.srdf has no state \"down\". Its states are up"), "{unknown}");
    state("<joint name=\"turn\" value=\"9\"/>");
    let beyond = refused("srdf: \"r.srdf\", state: \"up\"");
    assert!(beyond.contains("turn") && beyond.contains('9'), "{beyond}");
    state("<joint name=\"turn\"/>");
    let half = refused("srdf: \"r.srdf\", state: \"up\"");
    assert!(half.contains("r.srdf: line 2: an element 'joint' has no \"value\""), "{half}");
}

#[test]
fn a_state_leaves_out_joints_with_several_values_and_says_so() {
    let files = Files::new();
    let srdf = "<robot name=\"r\"><group_state name=\"up\" group=\"g\"><joint name=\"base\" value=\"0 0 1 0 0 0 1\"/><joint name=\"turn\" value=\"0.75\"/></group_state></robot>";
    std::fs::write(files.folder.path().join("r.srdf"), srdf).unwrap();
    let loaded = files.loaded(&arm(), "srdf: \"r.srdf\", state: \"up\"").unwrap();
    assert_eq!(held(&loaded.description.joints[0]), Some(0.75));
    let says = "the state \"up\" of r.srdf gives several values each to \"base\"";
    assert!(loaded.warnings.iter().any(|what| what.contains(says)), "{:?}", loaded.warnings);
    let silent = files.loaded(&arm(), "srdf: \"r.srdf\"").unwrap().warnings;
    assert!(!silent.iter().any(|what| what.contains("several values")), "{silent:?}");
}

#[test]
fn robots_of_one_file_need_names() {
    let files = Files::new();
    // Beside the first one, which is "r": two more, the last of them without a name.
    let thrice = |named: &str| {
        let more = format!("), (path: \"pkg/urdf/r.urdf\", {named}), (path: \"pkg/urdf/r.urdf\"");
        files.scene(&arm(), &more).map_err(|error| error.to_string())
    };
    for (named, name) in [("", "arm"), ("name: \"r\"", "r")] {
        let error = thrice(named).err().unwrap();
        for says in ["line 1", &format!("two robots are called {name:?}"), "name: \"second\""] {
            assert!(error.contains(says), "{says}: {error}");
        }
    }
    assert_eq!(thrice("name: \"left\"").err(), None);
}

#[test]
fn groups_of_an_srdf_stand_for_their_links_and_joints() {
    let files = Files::new();
    let srdf = "<robot name=\"r\">\n<group name=\"all\"><joint name=\"turn\"/><joint name=\"slide\"/></group>\n<group name=\"hand\"><link name=\"b\"/><link name=\"c\"/></group>\n<group name=\"lost\"><link name=\"z\"/></group></robot>";
    std::fs::write(files.folder.path().join("r.srdf"), srdf).unwrap();
    let motor = |robot: &str| {
        let scene = files.scene(&arm(), &format!("srdf: \"r.srdf\", {robot}"))?;
        let gains = scene.joints.iter().map(|joint| joint.motor.and_then(|motor| motor.damping));
        Ok(gains.collect::<Vec<_>>())
    };
    let refused = |result: Result<Vec<Option<f64>>, SceneError>| result.unwrap_err().to_string();
    assert_eq!(motor("motors: {\"all\": (damping: 7)}").unwrap()[..2], [Some(7.0); 2]);
    let own = motor("motors: {\"all\": (damping: 7), \"turn\": (damping: 3)}").unwrap();
    assert_eq!(own[..2], [Some(3.0), Some(7.0)]);
    let twice = refused(motor("motors: {\"all\": (damping: 7), \"hand\": (damping: 3)}"));
    assert!(
        twice.contains("groups \"all\" and \"hand\", which both have the joint \"slide\""),
        "{twice}"
    );
    let lost = refused(motor("motors: {\"lost\": ()}"));
    assert!(lost.contains("r.srdf: line 4: the group \"lost\" names the link \"z\""), "{lost}");
    let none = refused(motor("motors: {\"elbow\": ()}"));
    assert!(none.contains("no joint \"elbow\""), "{none}");
    let pairs = |pair: &str| {
        std::fs::write(files.path(), arm()).unwrap();
        let robot =
            "path: \"pkg/urdf/r.urdf\", name: \"r\", srdf: \"r.srdf\", self_collisions: All";
        let floor = "(name: \"floor\", shape: Generator(Cuboid()), kind: Fixed)";
        let text = format!("(bodies: [{floor}], robots: [({robot})], pairs: [({pair})])");
        let at = files.folder.path().join("s.ron");
        parse_scene(text, &at, &LoadOptions::default()).map(|loaded| loaded.description)
    };
    // Bodies: the floor, root, a, b, c.
    let apart = pairs("a: \"r/hand\", b: \"floor\", collide: false").unwrap();
    assert_eq!(apart.excluded_pairs, [(0, 3), (0, 4)]);
    let lost = pairs("a: \"floor\", b: \"r/lost\"").unwrap_err().to_string();
    assert!(
        lost.contains("r.srdf: line 4: the group \"lost\"") && lost.contains("s.ron, line 1"),
        "{lost}"
    );
}

#[test]
fn links_that_meet_at_rest_are_left_out_and_said() {
    let files = Files::new();
    // b slides from 1 away to a's place; c lies in a, and meets nothing else.
    let text = arm().replace("<origin xyz=\"1 0 0\"/><axis", "<origin xyz=\"0.05 0 0\"/><axis");
    let pairs = |robot: &str| files.scene(&text, robot).unwrap().excluded_pairs;
    assert_eq!(pairs(""), [(0, 1), (1, 2), (1, 3), (2, 3)]);
    let said = files.loaded(&text, "").unwrap().warnings.join("\n");
    assert!(
        said.contains("1 pair of links meets where the robot starts, never to collide: \"b - c\""),
        "{said}"
    );
    assert_eq!(pairs("self_collisions: Adjacent"), [(0, 1), (1, 2), (1, 3)]);
    assert_eq!(pairs("self_collisions: All"), []);
    assert_eq!(pairs("self_collisions: None").len(), 6);
    let srdf = "<robot name=\"r\"><disable_collisions link1=\"b\" link2=\"root\"/></robot>";
    std::fs::write(files.folder.path().join("r.srdf"), srdf).unwrap();
    assert_eq!(pairs("self_collisions: All, srdf: \"r.srdf\""), [(0, 2)]);
    assert!(files.scene(&text, "srdf: \"none.srdf\"").is_err());
}

#[test]
fn floating_links_are_free_and_planar_ones_slide() {
    let links = format!(
        "<link name=\"a\">{BOX}</link><link name=\"b\">{BOX}</link><link name=\"c\">{BOX}</link>"
    );
    let text = urdf(&format!(
        "{links}{}{}",
        joint("j", "floating", "a", "b", "<origin xyz=\"0 0 1\"/>"),
        joint("k", "planar", "a", "c", "<origin xyz=\"1 0 0\"/><axis xyz=\"0 0 1\"/>")
    ));
    let scene = Files::new().scene(&text, "").unwrap();
    assert_eq!(scene.bodies[1].pose, Pose::at(DVec3::Z));
    assert_eq!(scene.joints.len(), 1);
    assert_eq!(scene.joints[0].kind, JointKind::Planar { normal: DVec3::Z });
}

#[test]
fn a_robot_of_visual_meshes_alone_meets_by_them() {
    let shown = BOX.replace("collision", "visual");
    let loaded =
        Files::new().loaded(&urdf(&format!("<link name=\"a\">{shown}</link>")), "").unwrap();
    assert_eq!(loaded.description.bodies[0].collision.faces().len(), 12);
    assert!(loaded.warnings[0].contains("visual meshes stand for it"), "{:?}", loaded.warnings);
}
