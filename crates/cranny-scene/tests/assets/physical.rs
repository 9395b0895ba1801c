//! Scenes whose outcome is known beforehand: what they end in stands in `tests/scenes` of the
//! workspace, but for the wheel and the ball of triangles, which `tools/soak` judges by overlap and
//! energy alone.

use std::f64::consts::{FRAC_PI_2, PI, TAU};
use std::fmt::Write as _;

use crate::generated::number;

/// Path under `assets/` and content.
pub(crate) fn files() -> Vec<(String, String)> {
    [
        ("l_on_slab", l_on_slab()),
        ("ball_on_floor", ball_on_floor()),
        ("peg_in_hole", peg_in_hole()),
        ("hook_on_ring", hook_on_ring()),
        ("gears", gears()),
        ("stack_of_cups", stack_of_cups()),
        ("wheel_on_stairs", wheel_on_stairs()),
        ("key_in_lock", key_in_lock()),
    ]
    .map(|(name, text)| (format!("scenes/{name}.ron"), text))
    .into()
}

/// A turn about a coordinate axis (0 to 2), as a scene file says it.
fn turned(axis: usize, angle: f64) -> String {
    let (sin, cos) = (0.5 * angle).sin_cos();
    let mut numbers = [0.0, 0.0, 0.0, cos];
    numbers[axis] = sin;
    format!("rotation: ({})", numbers.map(number).join(", "))
}

/// What stands before the bodies: comment lines, then the settings that they share.
fn head(comment: &str, gravity: &str, hertz: u32, duration: f64) -> String {
    let comment: String = comment.lines().map(|line| format!("// {line}\n")).collect();
    format!(
        "{comment}(\n    version: 1,\n    gravity: (0, 0, {gravity}),\n    step: {}, // 1/{hertz} s\n    duration: {},\n    bodies: [\n",
        1.0 / f64::from(hertz),
        number(duration)
    )
}

/// What follows the bodies and whatever else the scene has.
fn tail(margin: f64, eye: [f64; 3], target: [f64; 3]) -> String {
    let list = |p: [f64; 3]| p.map(number).join(", ");
    format!(
        "    effects: [Response(), Contacts(margin: {})],\n    cameras: [(name: \"main\", look_at: (eye: ({}), target: ({}), field_of_view: 0.6))],\n    record: (every: 4),\n)\n",
        number(margin),
        list(eye),
        list(target)
    )
}

/// From an L's centroid to its lower side: arms of 1, 0.3 thick.
const L_BELOW: f64 = (0.3 * 0.15 + 0.21 * 0.65) / 0.51;

fn l_on_slab() -> String {
    let mut s = head(
        "Four Ls and a slab, 1 thick, its top at z = 0: released 0.3 above it, 0.3 deep and 0.8 deep in it, and wholly\n\
         inside, 0.15 below the top and 0.35 above the bottom. On the left with sides of two triangles, on the right\n\
         the same cut fine.",
        "-9.81",
        240,
        3.0,
    );
    for (name, y, shape) in [
        ("slab", -2.0, "Cuboid(size: (14, 4, 1))"),
        ("slab_fine", 2.0, "Floor(size: (14, 4, 1), squares: (28, 8))"),
    ] {
        let z = if name == "slab" { -0.5 } else { 0.0 };
        let _ = writeln!(
            s,
            "        (name: \"{name}\", shape: Generator({shape}), kind: Fixed, pose: (at: (0, {}, {})), material: (friction: 0.5)),",
            number(y),
            number(z)
        );
    }
    let upright = turned(0, FRAC_PI_2);
    let flat = turned(0, 0.0);
    for (suffix, y, shape) in
        [("", -2.0, "Generator(LPrism())"), ("_fine", 2.0, "Mesh(path: \"../meshes/l.obj\")")]
    {
        for (name, x, z, rotation) in [
            ("above", -4.5, L_BELOW + 0.3, &upright),
            ("shallow", -1.5, L_BELOW - 0.3, &upright),
            ("deep", 1.5, L_BELOW - 0.8, &upright),
            ("inside", 4.5, -0.4, &flat),
        ] {
            let _ = writeln!(
                s,
                "        (name: \"{name}{suffix}\", shape: {shape}, pose: (at: ({}, {}, {}), {rotation}), material: (friction: 0.5)),",
                number(x),
                number(y),
                number(z)
            );
        }
    }
    s + "    ],\n" + &tail(0.01, [1.0, -16.0, 8.0], [0.0, 0.0, 0.0])
}

fn ball_on_floor() -> String {
    head(
        "A ball rolls over a floor of 20,000 triangles, askew to their edges.",
        "-9.81",
        240,
        3.0,
    ) + "        (name: \"floor\", shape: Generator(Floor(size: (20, 10, 0.5), squares: (100, 100))), kind: Fixed, material: (friction: 0.5)),
        (
            name: \"ball\",
            shape: Generator(GolfBall(radius: 0.5, dimples: 0, triangles: 5120)),
            pose: (at: (-6, -0.4, 0.5)),
            velocity: (linear: (2, 0.3, 0), angular: (-0.6, 4, 0)),
            material: (friction: 0.5),
        ),
    ],
" + &tail(0.01, [0.0, -12.0, 7.0], [0.0, 0.0, 0.0])
}

fn peg_in_hole() -> String {
    let tilt = 0.2f64.to_radians();
    head(
        "A peg of 10 mm falls into a hole of 10.1 mm, from where its end is 1.5 mm in: askew by 0.2 degrees, the end\n\
         0.01 mm off the axis. One unit is a millimetre, gravity is that of the earth.",
        "-9810",
        960,
        0.5,
    ) + &format!(
        "        (
            name: \"block\",
            shape: Generator(Cup(radius: 12, height: 20, wall: 6.95, floor: 5, segments: 96)),
            kind: Fixed,
            material: (friction: 0.1),
        ),
        (
            name: \"peg\",
            shape: Generator(Cylinder(radius: 5, height: 25, chamfer: 0.5, segments: 96)),
            pose: (at: ({}, 0, {}), {}),
            material: (density: 0.00000785, friction: 0.1),
        ),
    ],
",
        number(0.01 + 12.5 * tilt.sin()),
        number(20.0 - 1.5 + 12.5 * tilt.cos()),
        turned(1, tilt)
    ) + &tail(0.01, [0.0, -70.0, 60.0], [0.0, 0.0, 16.0])
}

/// Of the hook: its centroid's distance from the shank's outer side, and from the bar's lower side.
fn hook_centroid() -> [f64; 2] {
    // Shank, bar right of it, tip: area, x, y above the shank's end.
    let parts = [(0.36, 0.15, 0.6), (0.3, 0.8, 1.05), (0.15, 1.15, 0.65)];
    let area: f64 = parts.iter().map(|p| p.0).sum();
    let x = parts.iter().map(|p| p.0 * p.1).sum::<f64>() / area;
    let y = parts.iter().map(|p| p.0 * p.2).sum::<f64>() / area;
    [x, 0.9 - y]
}

fn hook_on_ring() -> String {
    let [_, below] = hook_centroid();
    head(
        "A hook falls 0.005 onto a level ring that it hangs on, its centroid under where the bar lies on the ring.",
        "-9.81",
        240,
        2.0,
    ) + &format!(
        "        (
            name: \"ring\",
            shape: Generator(Torus(major_radius: 1, minor_radius: 0.2, major_segments: 64, minor_segments: 16)),
            kind: Fixed,
            material: (friction: 0.5),
        ),
        (
            name: \"hook\",
            shape: Generator(Hook(length: 1.2, opening: 0.7, tip: 0.5, thickness: 0.3, depth: 0.3)),
            pose: (at: (0.997, 0, {}), {}),
            material: (friction: 0.5),
        ),
    ],
",
        number(0.2 + 0.005 - below),
        turned(0, FRAC_PI_2)
    ) + &tail(0.01, [3.0, -4.5, 1.6], [0.7, 0.0, -0.2])
}

fn gears() -> String {
    head(
        "A gear of 16 teeth, turned at half a turn a second, drives one of 24 on a free axle: pitch circles touch, teeth\n\
         are thinner by 0.004. They start at speed, a tooth of one in the middle of a gap of the other.",
        "-9.81",
        240,
        4.0,
    ) + &format!(
        "        (name: \"frame\", shape: Generator(Cuboid(size: (4.4, 1, 0.2))), kind: Fixed, pose: (at: (1, 0, -0.4))),
        (
            name: \"driver\",
            shape: Generator(Gear(teeth: 16, module: 0.1, thickness: 0.3, bore: 0.3, backlash: 0.004, flank_segments: 4)),
            kind: Kinematic,
            velocity: (angular: (0, 0, {})),
            material: (friction: 0.1),
        ),
        (
            name: \"driven\",
            shape: Generator(Gear(teeth: 24, module: 0.1, thickness: 0.3, bore: 0.3, backlash: 0.004, flank_segments: 4)),
            pose: (at: (2, 0, 0), {}),
            velocity: (angular: (0, 0, {})),
            material: (friction: 0.1),
        ),
    ],
    joints: [
        (
            name: \"axle\",
            parent: \"frame\",
            child: \"driven\",
            parent_anchor: (at: (1, 0, 0.4)),
            kind: Revolute(axis: (0, 0, 1)),
        ),
    ],
",
        number(PI),
        turned(2, TAU / 48.0),
        number(-PI * 16.0 / 24.0)
    ) + &tail(0.005, [1.0, -4.0, 5.0], [1.0, 0.0, 0.0])
}

fn stack_of_cups() -> String {
    let mut s = head(
        "Ten cups, let go 0.005 above each other: each stands on the rim of the one below.",
        "-9.81",
        240,
        3.0,
    );
    s += "        (name: \"table\", shape: Generator(Cuboid(size: (6, 6, 0.5))), kind: Fixed, pose: (at: (0, 0, -0.25)), material: (friction: 0.5)),\n";
    for k in 0..10 {
        let k = f64::from(k);
        let _ = writeln!(
            s,
            "        (name: \"cup_{k}\", shape: Generator(Cup(radius: 0.5, height: 0.6, wall: 0.1, floor: 0.1, segments: 32)), pose: (at: (0, 0, {})), material: (friction: 0.5)),",
            number(0.6 * k + 0.005 * (k + 1.0))
        );
    }
    s + "    ],\n" + &tail(0.01, [7.0, -12.0, 5.5], [0.0, 0.0, 2.8])
}

fn wheel_on_stairs() -> String {
    let upright = turned(0, FRAC_PI_2);
    head(
        "A wheel rolls off a landing, down five stairs, over a floor and against a wall.",
        "-9.81",
        240,
        6.0,
    ) + &format!(
        "        (
            name: \"stairs\",
            shape: Generator(Stairs(steps: 5, rise: 0.12, tread: 0.5, landing: 1, depth: 1)),
            kind: Fixed,
            pose: ({upright}),
            material: (friction: 0.5),
        ),
        (name: \"floor\", shape: Generator(Cuboid(size: (7, 2, 0.2))), kind: Fixed, pose: (at: (2.5, 0, -0.1)), material: (friction: 0.5)),
        (name: \"wall\", shape: Generator(Cuboid(size: (0.2, 2, 1))), kind: Fixed, pose: (at: (5.1, 0, 0.5)), material: (friction: 0)),
        (
            name: \"wheel\",
            shape: Generator(Cylinder(radius: 0.4, height: 0.3, segments: 32)),
            pose: (at: (-0.5, 0, {}), {upright}),
            velocity: (linear: (1.2, 0, 0), angular: (0, 3, 0)),
            material: (friction: 0.5),
        ),
    ],
",
        number(0.72 + 0.4)
    ) + &tail(0.01, [2.5, -8.0, 3.5], [2.2, 0.0, 0.4])
}

fn key_in_lock() -> String {
    let plug = "Generator(LockPlug(radius: 1, width: 0.8, height: 0.8, thickness: 0.3, clearance: 0.01, depth: 0.5))";
    let key = |thickness: &str| {
        format!("Generator(LPrism(width: 0.8, height: 0.8, thickness: {thickness}, depth: 1.2))")
    };
    head(
        "Three locks. In the first a motor turns the key by a quarter, and the plug with it; into the second the key falls\n\
         through its keyway, 0.01 wider on every side, down to the plate; the third key is 0.04 too thick.",
        "-9.81",
        960,
        3.0,
    ) + &format!(
        "        (name: \"plate\", shape: Generator(Cuboid(size: (9, 3, 0.2))), kind: Fixed, pose: (at: (0, 0, -0.4)), material: (friction: 0.2)),
        (name: \"plug_turned\", shape: {plug}, pose: (at: (-3, 0, 0)), material: (density: 0.2, friction: 0.2)),
        (name: \"key_turned\", shape: {right}, pose: (at: (-3, 0, 0.4)), material: (friction: 0.2)),
        (name: \"plug_entered\", shape: {plug}, kind: Fixed, material: (friction: 0.2)),
        (name: \"key_entered\", shape: {right}, pose: (at: (0, 0, 0.6)), material: (friction: 0.2)),
        (name: \"plug_barred\", shape: {plug}, kind: Fixed, pose: (at: (3, 0, 0)), material: (friction: 0.2)),
        (name: \"key_barred\", shape: {wrong}, pose: (at: (3, 0, 0.87)), material: (friction: 0.2)),
    ],
    joints: [
        (name: \"plug\", parent: \"plate\", child: \"plug_turned\", parent_anchor: (at: (-3, 0, 0.4)), kind: Revolute(axis: (0, 0, 1))),
        (
            name: \"motor\",
            parent: \"plate\",
            child: \"key_turned\",
            parent_anchor: (at: (-3, 0, 0.8)),
            kind: Revolute(axis: (0, 0, 1)),
            target: {target},
        ),
    ],
",
        right = key("0.3"),
        wrong = key("0.34"),
        target = number(FRAC_PI_2)
    ) + &tail(0.005, [0.0, -8.0, 7.0], [0.0, 0.0, 0.0])
}
