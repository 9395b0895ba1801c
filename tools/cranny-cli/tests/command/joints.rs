//! Joints of scenes, as they hold in a run.

use crate::harness::{Folder, run};

/// A lamp on a slack rope, a bob on a spring, and a rod that a ball joint holds by its upper end.
const SCENE: &str = r#"(
    gravity: (0, 0, -10), step: 0.002, duration: 6,
    bodies: [
        (name: "ceiling", shape: Generator(Cuboid(size: (9, 9, 1))), kind: Fixed),
        (name: "lamp", shape: Generator(Cuboid()), pose: (at: (-3, 0, -2))),
        (name: "bob", shape: Generator(Cuboid()), pose: (at: (0, 0, -2))),
        (name: "rod", shape: Generator(Cuboid(size: (0.2, 0.2, 2))), pose: (at: (3, 0, -2))),
    ],
    joints: [
        (name: "rope", parent: "ceiling", child: "lamp", parent_anchor: (at: (-3, 0, 0)), kind: Rope(length: 3)),
        (name: "coil", parent: "ceiling", child: "bob", kind: Spring(length: 2, stiffness: 40, damping: 12)),
        (name: "hook", parent: "ceiling", child: "rod", parent_anchor: (at: (3, 0, -1)),
         child_anchor: (at: (0, 0, 1)), kind: Ball()),
    ],
    effects: [Response()],
)"#;

#[test]
fn ropes_springs_and_balls_hold_what_hangs_on_them() {
    let folder = Folder::new();
    let scene = folder.write("s.ron", SCENE);
    let summary = &run(&["run", &scene, "--format", "json"]).json_lines()[0];
    let height = |body: &str| {
        let motion = summary["motion"].as_array().unwrap();
        let motion = motion.iter().find(|motion| motion["body"] == body);
        motion.map_or(0.0, |motion| motion["displacement"][2].as_f64().unwrap())
    };
    assert!((height("lamp") + 1.0).abs() < 0.01, "{summary}");
    // Weight over stiffness: 10 / 40.
    assert!((height("bob") + 0.25).abs() < 0.01, "{summary}");
    assert!(height("rod").abs() < 0.01, "{summary}");
    // What the spring takes up is no loss of the bob's before it is damped, and never a gain.
    assert!(summary["energy_drift"].as_f64().unwrap() < 0.02, "{summary}");
}

#[test]
fn a_rod_on_a_ball_joint_swings_through_and_gains_no_energy() {
    let folder = Folder::new();
    let scene = folder.write("s.ron", SCENE);
    let tilted = [
        "--set",
        "bodies.rod.pose=(at: (3.7071067811865475, 0, -1.7071067811865475), euler_degrees: (0, -45, 0))",
        "--set",
        "duration=1",
    ];
    let arguments = [&["run", &scene, "--format", "json"], &tilted[..]].concat();
    let summary = &run(&arguments).json_lines()[0];
    let rod = summary["motion"].as_array().unwrap().iter().find(|motion| motion["body"] == "rod");
    let moved = rod.unwrap()["displacement"][0].as_f64().unwrap();
    assert!(moved < -0.5, "it swings through: {moved}");
    assert!(summary["energy_drift"].as_f64().unwrap() < 0.02, "{summary}");
}

/// Where a step of a path has a joint be, it is, with a load and at any step.
#[test]
fn motors_lead_joints_along_their_paths() {
    const PATH: &str = "keyframes: [(time: 0, position: 0), (time: 1, position: 1), (time: 2, position: 0.25)], interpolation: Eased";
    let folder = Folder::new();
    folder.write("arm.urdf", r#"<robot name="arm"><link name="base"/><link name="hand"><collision><geometry><box size="0.2 0.2 0.2"/></geometry></collision></link><joint name="lift" type="prismatic"><parent link="base"/><child link="hand"/><axis xyz="0 0 1"/></joint></robot>"#);
    let scene = folder.write("s.ron", format!(r#"(
        step: 0.005, duration: 1,
        bodies: [
            (name: "rail", shape: Generator(Cuboid()), kind: Fixed, pose: (at: (5, 0, 0))),
            (name: "cart", shape: Generator(Cuboid()), pose: (at: (5, 0, 0))),
        ],
        joints: [(name: "slide", parent: "rail", child: "cart", kind: Prismatic(axis: (0, 1, 0)), path: ({PATH}))],
        robots: [(path: "arm.urdf", name: "arm", paths: {{"lift": ({PATH})}})],
        effects: [Response()],
    )"#));
    let displacement = |duration: &str, body: &str, axis: usize| {
        let set = format!("duration={duration}");
        let summary = &run(&["run", &scene, "--format", "json", "--set", &set]).json_lines()[0];
        let motion = summary["motion"].as_array().unwrap();
        let motion = motion.iter().find(|motion| motion["body"] == body).cloned();
        motion.map_or(f64::NAN, |motion| motion["displacement"][axis].as_f64().unwrap())
    };
    for (duration, expected) in [("0.5", 0.5), ("1", 1.0), ("1.5", 0.625), ("3", 0.25)] {
        let [lift, slide] =
            [("arm/hand", 2), ("cart", 1)].map(|(b, i)| displacement(duration, b, i));
        assert!((lift - expected).abs() < 1e-2, "after {duration} s: {lift}");
        assert!((slide - expected).abs() < 3e-2, "after {duration} s: {slide}");
    }
}

/// A hinge between two bodies is known up to whole turns, and so is how far off its motor it is.
#[test]
fn a_hinge_that_turns_past_half_a_turn_is_not_a_turn_off() {
    let folder = Folder::new();
    let scene = |drive: &str| {
        let text = format!(
            r#"(gravity: (0, 0, 0), step: 0.004, duration: 4,
            bodies: [(name: "base", shape: Generator(Cuboid()), kind: Fixed),
                     (name: "arm", shape: Generator(Cuboid()))],
            joints: [(name: "hinge", parent: "base", child: "arm", kind: Revolute(axis: (0, 0, 1)), {drive})],
            effects: [Response()])"#
        );
        folder.write("hinge.ron", text)
    };
    let path = |to: f64| {
        format!(
            "path: (keyframes: [(time: 0, position: 0), (time: 2, position: {to}), (time: 4, position: 0)])"
        )
    };
    for (drive, most) in
        [(path(3.2), 0.2), (path(6.25), 0.4), ("target: 4".to_owned(), 2.3), (path(1.0), 0.2)]
    {
        let summary = &run(&["run", &scene(&drive), "--format", "json"]).json_lines()[0];
        let [off_max, off] =
            ["off_max", "off"].map(|key| summary["joints"][0][key].as_f64().unwrap());
        assert!(off_max < most && off < 0.05, "{drive}: at most {off_max} off, {off} at the end");
    }
}
