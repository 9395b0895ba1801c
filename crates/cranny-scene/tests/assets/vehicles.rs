//! An automobile into which an arm reaches, and a submarine into which a drone dives. z is up, bows
//! are at +x; metres and kilogrammes.

use crate::house::{boxes, cuboid, lathe};
use crate::worlds::{Place, Stop, World, list};

const STEEL: f64 = 2000.0;

/// Height of the shell's floor over the ground.
const RAISED: f64 = 0.22;

pub(crate) fn automobile() -> String {
    let mut world = World::default();
    world.fixed("ground", &cuboid([9.0, 7.0, 0.2]), Place([0.0, 0.0, -0.1], 0.0));
    world.fixed("body", "CarBody(segments: 40)", Place([0.0, 0.0, RAISED], 0.0));
    seats(&mut world);
    engine(&mut world);
    wheels(&mut world);
    world.walker("arm", &arm(), &reach(), "effects: [Trigger()],");
    let settings = "    gravity: (0, 0, -9.81),\n    step: 0.008333333333333333, // 1/120 s\n    duration: 8,\n";
    let rest = "    effects: [Response()],\n    cameras: [\n        (name: \"main\", look_at: (eye: (4.6, 4.4, 3.2), target: (0.1, 0.1, 0.6), field_of_view: 0.72)),\n        (name: \"cabin\", look_at: (eye: (-1.1, -0.2, 1.25), target: (0.4, 0.45, 0.85), field_of_view: 1.1)),\n    ],\n    record: (every: 2),\n";
    world.file(
        "An automobile: a shell with a cabin and open windows, seats, an engine in its open bay, wheels that turn on their\n\
         hubs. An arm reaches in through the driver's window and turns the steering wheel; it meets neither shell nor seats:\n\
         a swept test proves it.",
        settings,
        rest,
    )
}

fn seats(world: &mut World) {
    let seat = boxes(&[
        [-0.24, -0.25, 0.0, 0.26, 0.25, 0.2],
        [-0.32, -0.25, 0.0, -0.2, 0.25, 0.62],
        [-0.3, -0.12, 0.58, -0.22, 0.12, 0.8],
    ]);
    for (side, y) in [("driver", 0.38), ("passenger", -0.38)] {
        world.fixed(&format!("seat_{side}"), &seat, Place([-0.3, y, RAISED + 0.11], 0.0));
    }
    let bench =
        boxes(&[[-0.15, -0.62, 0.0, 0.16, 0.62, 0.16], [-0.2, -0.62, 0.0, -0.1, 0.62, 0.5]]);
    world.fixed("bench", &bench, Place([-1.18, 0.0, RAISED + 0.59], 0.0));
}

/// A block with cylinder heads, ribs and a pulley.
fn engine(world: &mut World) {
    let mut all = vec![
        [-0.36, -0.2, 0.0, 0.36, 0.2, 0.26],
        [-0.3, -0.14, 0.2, 0.3, 0.14, 0.36],
        [0.3, -0.04, 0.08, 0.46, 0.04, 0.16],
        [0.42, -0.12, 0.02, 0.46, 0.12, 0.22],
    ];
    for k in 0..6 {
        let x = -0.28 + 0.1 * f64::from(k);
        all.push([x, -0.3, 0.1, x + 0.03, 0.3, 0.3]);
        all.push([x, -0.05, 0.3, x + 0.05, 0.05, 0.42]);
    }
    world.fixed("engine", &boxes(&all), Place([1.36, 0.0, RAISED + 0.15], 0.0));
}

fn wheels(world: &mut World) {
    let spin = |speed: f64| {
        format!(
            "material: (density: {}, friction: 0.6), velocity: (angular: (0, {speed}, 0))",
            list(&[STEEL])
        )
    };
    for (end, x) in [("front", 1.34), ("rear", -1.4)] {
        for (side, y) in [("left", 0.79), ("right", -0.79)] {
            let name = format!("wheel_{end}_{side}");
            let shape =
                "SpokedWheel(radius: 0.27, width: 0.14, rim: 0.07, spokes: 7, segments: 56)";
            world.posed(
                &name,
                shape,
                [x, y, 0.3],
                [90.0, 0.0, 0.0],
                &spin(if x > 0.0 { 6.0 } else { 0.0 }),
            );
            world.axle(["body", &name], [x, y, 0.3 - RAISED], [90.0, 0.0, 0.0], 0.02);
        }
    }
    let steering = "SpokedWheel(radius: 0.17, width: 0.025, rim: 0.025, spokes: 3, segments: 48)";
    let (at, tilt) = ([0.2, 0.38, 0.97], [0.0, -65.0, 0.0]);
    world.posed("steering_wheel", steering, at, tilt, "material: (density: 900, friction: 0.6)");
    world.axle(["body", "steering_wheel"], [at[0], at[1], at[2] - RAISED], tilt, 0.01);
}

/// A hand at the origin, the arm along +y, a finger that points forward.
fn arm() -> String {
    boxes(&[
        [-0.05, -0.05, -0.02, 0.045, 0.1, 0.02],
        [0.03, -0.02, -0.012, 0.14, 0.0, 0.012],
        [-0.05, -0.03, -0.05, -0.02, 0.0, 0.01],
        [-0.035, 0.08, -0.035, 0.035, 0.9, 0.035],
    ])
}

/// In through the window, behind the wheel's rim; the finger goes in beside a spoke and pushes it.
fn reach() -> Vec<Stop> {
    let (behind, within, z) = (0.04, 0.12, 1.06);
    let stops = [
        (0.0, [behind, 1.5, z]),
        (1.6, [behind, 0.475, z]),
        (2.0, [within, 0.475, z]),
        (3.4, [within, 0.35, z]),
        (4.4, [within, 0.45, z]),
        (4.8, [behind, 0.45, z]),
        (6.4, [behind, 1.5, z]),
    ];
    stops.into_iter().map(|(time, at)| Stop(time, Place(at, 0.0))).collect()
}

pub(crate) fn submarine() -> String {
    let mut world = World::default();
    world.fixed("hull", "SubmarineHull(segments: 64)", Place([0.0; 3], 0.0));
    decks(&mut world);
    tubes(&mut world);
    crew_room(&mut world);
    let spin = "kind: Kinematic, velocity: (angular: (3, 0, 0))";
    let shape = "Propeller(radius: 0.95, blades: 5, segments: 80)";
    world.posed("propeller", shape, [-8.35, 0.0, 0.0], [0.0, 90.0, 0.0], spin);
    world.walker("drone", &drone(), &dive(), "effects: [Trigger()],");
    let settings = "    gravity: (0, 0, -9.81),\n    step: 0.008333333333333333, // 1/120 s\n    duration: 12,\n";
    let rest = "    effects: [Response()],\n    cameras: [\n        (name: \"main\", look_at: (eye: (7, -15, 8), target: (-0.4, 0, 0.2), field_of_view: 0.72)),\n        (name: \"inside\", look_at: (eye: (-2.6, -0.9, 0.6), target: (2, 0.2, -0.2), field_of_view: 1.1)),\n    ],\n    record: (every: 4),\n";
    world.file(
        "A submarine: a hollow hull with sail, hatches, bulkheads, decks, tubes and fins. A drone dives\n\
         through the hatch of the sail, then forward through that of a bulkhead, and pushes a chair away; it meets\n\
         neither hull nor deck: a swept test proves it.",
        settings,
        rest,
    )
}

/// Top of the decks.
const DECK: f64 = -0.76;

fn decks(world: &mut World) {
    for (name, from, to, half) in
        [("stern", -5.2, -3.06, 1.3), ("middle", -2.86, 2.86, 1.5), ("bow", 3.06, 5.2, 1.3)]
    {
        let size = [to - from, 2.0 * half, 0.08];
        let at = [0.5 * (from + to), 0.0, DECK - 0.04];
        world.fixed(&format!("deck_{name}"), &cuboid(size), Place(at, 0.0));
    }
}

fn tubes(world: &mut World) {
    let tube = lathe(&[[0.27, -1.2], [0.32, -1.2], [0.32, 1.2], [0.27, 1.2]], 28);
    for (k, y) in [-0.75, 0.75].into_iter().enumerate() {
        let at = [4.2, y, DECK + 0.36];
        world.posed(&format!("tube_{k}"), &tube, at, [0.0, 90.0, 0.0], "kind: Fixed");
        let torpedo =
            [[0.0, -1.0], [0.12, -0.95], [0.24, -0.7], [0.24, 0.7], [0.18, 0.9], [0.0, 1.0]];
        let rest = format!("material: (density: {}, friction: 0.2)", list(&[STEEL]));
        world.posed(
            &format!("torpedo_{k}"),
            &lathe(&torpedo, 24),
            [at[0], y, at[2] - 0.02],
            [0.0, 90.0, 0.0],
            &rest,
        );
    }
    let motor = boxes(&[
        [-0.9, -0.5, 0.0, 0.6, 0.5, 0.3],
        [-0.7, -0.35, 0.2, 0.4, 0.35, 0.8],
        [-0.6, -0.55, 0.4, -0.4, 0.55, 0.6],
        [0.1, -0.55, 0.4, 0.3, 0.55, 0.6],
        [-1.2, -0.08, 0.7, -0.6, 0.08, 0.76],
    ]);
    world.fixed("motor", &motor, Place([-4.1, 0.0, DECK], 0.0));
}

fn crew_room(world: &mut World) {
    let bunks = "Shelf(size: (1.9, 0.7, 1.3), levels: 2, board: 0.04)";
    world.fixed("bunks", bunks, Place([-1.7, 1.0, DECK], 0.0));
    world.loose(
        "table",
        "Table(size: (1, 0.6, 0.65), thickness: 0.04)",
        Place([-1.5, -0.9, DECK + 0.001], 0.0),
        500.0,
    );
    for k in 0..3 {
        let cup = "Cup(radius: 0.05, height: 0.1, wall: 0.01, floor: 0.01, segments: 24)";
        let at = [-1.8 + 0.3 * f64::from(k), -0.9, DECK + 0.6515];
        world.loose(&format!("cup_{k}"), cup, Place(at, 0.0), STEEL);
    }
    world.loose("stool", "Chair()", Place([-0.6, -0.8, DECK + 0.001], -90.0), 500.0);
    world.loose("chair", "Chair()", Place([4.3, 0.0, DECK + 0.001], 90.0), 500.0);
}

/// A drone: a body with a nose, two skids and a ring of fins.
fn drone() -> String {
    boxes(&[
        [-0.3, -0.18, -0.15, 0.3, 0.18, 0.15],
        [0.25, -0.08, -0.08, 0.42, 0.08, 0.08],
        [-0.25, -0.25, -0.26, 0.25, -0.2, -0.2],
        [-0.25, 0.2, -0.26, 0.25, 0.25, -0.2],
        [-0.2, -0.25, -0.22, -0.14, 0.25, -0.12],
        [0.14, -0.25, -0.22, 0.2, 0.25, -0.12],
        [-0.3, -0.02, 0.12, -0.1, 0.02, 0.32],
    ])
}

fn dive() -> Vec<Stop> {
    let stops = [
        (0.0, [1.0, -2.5, 4.2], 90.0),
        (1.5, [1.0, 0.0, 4.0], 90.0),
        (2.3, [1.0, 0.0, 3.6], 0.0),
        (5.5, [1.0, 0.0, 0.0], 0.0),
        (8.5, [3.9, 0.0, 0.0], 0.0),
        (10.5, [4.9, 0.0, 0.0], 0.0),
    ];
    stops.into_iter().map(|(time, at, turn)| Stop(time, Place(at, turn))).collect()
}
