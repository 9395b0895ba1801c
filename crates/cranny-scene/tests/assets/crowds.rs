//! Scenes of many bodies: triggers alone, golf balls, dented cans, movers among what stands still.

use std::f64::consts::TAU;

use crate::generated::number;
use crate::house::{cuboid, lathe};
use crate::worlds::{Place, Stop, World, list};

/// Path under `assets/` and content.
pub(crate) fn files() -> Vec<(String, String)> {
    [
        ("triggers_only", triggers_only()),
        ("golf_balls", golf_balls()),
        ("dented_cans", dented_cans()),
        ("moving_among_stationary", moving_among_stationary()),
    ]
    .map(|(name, text)| (format!("scenes/{name}.ron"), text))
    .into()
}

fn settings(hertz: u32, duration: f64) -> String {
    let step = 1.0 / f64::from(hertz);
    format!(
        "    gravity: (0, 0, -9.81),\n    step: {step}, // 1/{hertz} s\n    duration: {},\n",
        number(duration)
    )
}

fn rest(effects: &str, eye: [f64; 3], target: [f64; 3]) -> String {
    format!(
        "    effects: [{effects}],\n    cameras: [(name: \"main\", look_at: (eye: ({}), target: ({}), field_of_view: 0.7))],\n",
        list(&eye),
        list(&target)
    )
}

/// A course of hoops, each with a sensor in its hole, along which a hook flies, round and round.
fn triggers_only() -> String {
    const HOOPS: u32 = 12;
    let mut world = World::default();
    let mut stops = Vec::new();
    let at = |part: f64| {
        let (sin, cos) = (TAU * part).sin_cos();
        [5.0 * cos, 5.0 * sin, 1.5 + 0.8 * (2.0 * TAU * part).sin()]
    };
    for k in 0..HOOPS {
        let part = f64::from(k) / f64::from(HOOPS);
        let turn = [90.0, 0.0, 360.0 * part];
        let hoop =
            "Torus(major_radius: 1, minor_radius: 0.12, major_segments: 48, minor_segments: 12)";
        world.posed(&format!("hoop_{k}"), hoop, at(part), turn, "kind: Fixed");
        let hole = "Cylinder(radius: 0.85, height: 0.05, chamfer: 0.01)";
        world.posed(&format!("gate_{k}"), hole, at(part), turn, "kind: Fixed, sensor: true");
    }
    for k in 0..=2 * HOOPS {
        let part = f64::from(k) / f64::from(2 * HOOPS);
        stops.push(Stop(8.0 * part, Place(at(part), 360.0 * part)));
    }
    world.walker("hook", "Hook(length: 0.9, opening: 0.3, tip: 0.4, thickness: 0.18)", &stops, "");
    world.file(
        "A hook flies through twelve hoops, round and round, and through the sensors in their holes. Nothing but\n\
         Trigger is asked for: no solver, no contacts.",
        &settings(60, 16.0),
        &rest("Trigger()", [9.0, -9.0, 8.0], [0.0, 0.0, 1.0]),
    )
    .replace("            ]),\n        ),\n    ],\n", "            ], end: Loop),\n        ),\n    ],\n")
}

fn golf_balls() -> String {
    let mut world = World::default();
    let bowl = [
        [0.0, -0.2],
        [1.5, -0.1],
        [2.8, 0.6],
        [3.4, 1.8],
        [3.2, 1.85],
        [2.6, 0.75],
        [1.4, 0.1],
        [0.0, 0.0],
    ];
    world.fixed("bowl", &lathe(&bowl, 48), Place([0.0; 3], 0.0));
    let ball = "GolfBall(radius: 0.5, dimples: 72, dimple_depth: 0.03, triangles: 2880)";
    let groups = format!(
        "    groups: [Pile(\n        name: \"ball\", count: 24, region: (min: (-1.9, -1.9, 1.2), max: (1.9, 1.9, 5.4)),\n        shapes: [Generator({ball})],\n        material: (density: 1, friction: 0.3, restitution: 0.4),\n    )],\n"
    );
    world.file(
        "Two dozen golf balls, dimples and all, dropped into a bowl.",
        &settings(120, 5.0),
        &(groups + &rest("Response()", [5.0, -6.5, 5.5], [0.0, 0.0, 1.0])),
    )
}

/// A full can: a shoulder above and below, its side in bands that can yield.
fn can() -> String {
    let mut profile = vec![[0.0, 0.04], [0.36, 0.04], [0.38, 0.0], [0.42, 0.0]];
    profile.extend((0..=12).map(|k| [0.5, 0.1 + f64::from(k) * 0.1]));
    profile.extend([[0.42, 1.4], [0.38, 1.4], [0.36, 1.36], [0.0, 1.36]]);
    lathe(&profile, 32)
}

fn dented_cans() -> String {
    let mut world = World::default();
    world.fixed("floor", &cuboid([14.0, 14.0, 1.0]), Place([0.0, 0.0, -0.5], 0.0));
    let anvil = "Boxes(add: [((-3.5, -0.5, 0), (3.5, 0.5, 0.4)), ((-0.5, -3, 0), (0.5, 3, 0.4)), ((-3.5, -0.3, 0), (3.5, 0.3, 0.6))])";
    world.fixed("anvil", anvil, Place([0.0; 3], 0.0));
    for k in 0..8 {
        let (row, column) = (k / 4, k % 4);
        let at = [
            -2.6 + 1.75 * f64::from(column),
            if row == 0 { -0.25 } else { 0.3 },
            2.0 + 1.6 * f64::from(row) + 0.3 * f64::from(column),
        ];
        let angles = [90.0 + 20.0 * f64::from(row), 15.0 * f64::from(column), 40.0 * f64::from(k)];
        let rest = "velocity: (linear: (0, 0, -6)), material: (density: 1, friction: 0.4), effects: [Deformation(hardness: 3000, radius: 0.35)]";
        world.posed(&format!("can_{k}"), &can(), at, angles, rest);
    }
    world.file(
        "Cans thrown down upon a cross of edges: they keep the dents, and the dents are met later.",
        &settings(240, 3.0),
        &rest("Response()", [5.0, -6.0, 4.5], [0.0, 0.0, 0.5]),
    )
}

/// A lattice of bodies that stand still, through which others fall.
fn moving_among_stationary() -> String {
    const LAYERS: u32 = 6;
    const SIDE: u32 = 7;
    let shapes = [
        "Torus(major_radius: 0.5, minor_radius: 0.15, major_segments: 24, minor_segments: 10)",
        "CPrism(segments: 24)",
        "LPrism()",
        "Gear(teeth: 12, module: 0.08, thickness: 0.3, bore: 0.2)",
    ];
    let mut world = World::default();
    world.fixed("floor", &cuboid([22.0, 22.0, 1.0]), Place([0.0, 0.0, -0.5], 0.0));
    for k in 0..LAYERS * SIDE * SIDE {
        let [i, j, layer] = [k % SIDE, k / SIDE % SIDE, k / (SIDE * SIDE)];
        let shift = if layer % 2 == 0 { 0.0 } else { 1.1 };
        let along = |n: u32| 2.2 * (f64::from(n) - 3.0) - 0.55 + shift;
        let at = [along(i), along(j), 1.5 + 2.0 * f64::from(layer)];
        let turn = [37.0 * f64::from(i), 53.0 * f64::from(j), 71.0 * f64::from(layer)];
        let shape = shapes[(k % 4) as usize];
        world.posed(&format!("still_{k}"), shape, at, turn, "kind: Fixed");
    }
    let groups = format!(
        "    groups: [Pile(\n        name: \"mover\", count: 100, region: (min: (-7, -7, 13.5), max: (7, 7, 19)),\n        shapes: [{}],\n        material: (density: 1, friction: 0.3, restitution: 0.2),\n    )],\n",
        [
            "Generator(UPrism(width: 0.7, height: 0.7, thickness: 0.2, depth: 0.3))",
            "Generator(Cup(radius: 0.3, height: 0.6, wall: 0.08, floor: 0.08, segments: 24))",
            "Generator(GolfBall(radius: 0.3, dimples: 20, dimple_depth: 0.03, triangles: 720))",
        ]
        .join(", ")
    );
    world.file(
        "A hundred bodies fall through a lattice of 294 that stand still. `cranny run` reports the time of each phase:\n\
         pairs of bodies that stand still cost nothing.",
        &settings(60, 6.0),
        &(groups + &rest("Response()", [20.0, -24.0, 18.0], [0.0, 0.0, 6.0])),
    )
}
