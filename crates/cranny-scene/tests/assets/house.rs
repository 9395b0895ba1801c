//! A house of two storeys, furnished, through which somebody walks. x is east, y north, z up;
//! metres and kilogrammes.

use crate::worlds::{Place, Stop, World, list};

/// Outer measures.
const WIDTH: f64 = 10.0;
const DEPTH: f64 = 8.0;
/// From floor to floor.
const STOREY: f64 = 2.7;
const WALL: f64 = 0.2;
/// South edge of the upper floor: before it the living room is open to the roof.
const GALLERY: f64 = 4.45;
/// Nobody's feet touch the floor.
const FLOAT: f64 = 0.01;
const WOOD: f64 = 500.0;
const CERAMICS: f64 = 2000.0;

pub(crate) fn house() -> String {
    let mut world = World::default();
    shell(&mut world);
    upstairs(&mut world);
    staircase(&mut world);
    doors(&mut world);
    living_room(&mut world);
    kitchen(&mut world);
    bathroom_and_bedroom(&mut world);
    world.walker("visitor", &figure(), &walk(), "effects: [Trigger()],");
    world.file(
        "A furnished house, its roof left out. A visitor comes in by the front door, pushes a chair away, climbs the\n\
         stairs and goes through the gallery into the bathroom; both doors hang on hinges and are pushed open. Its path\n\
         meets no wall: a swept test proves it.",
        "    gravity: (0, 0, -9.81),\n    step: 0.008333333333333333, // 1/120 s\n    duration: 24,\n",
        "    effects: [Response()],\n    cameras: [\n        (name: \"above\", look_at: (eye: (3.4, -9.5, 13.5), target: (5, 3.5, 1), field_of_view: 0.66)),\n        (name: \"inside\", look_at: (eye: (9.4, 0.6, 2.4), target: (3, 3.4, 1.2), field_of_view: 1.05)),\n        (name: \"kitchen\", look_at: (eye: (9.3, 5.1, 2.1), target: (4, 6.8, 0.8), field_of_view: 1)),\n    ],\n    record: (every: 4),\n",
    )
}

/// A wall along x, or along y where it is turned by 90 degrees.
fn wall(
    world: &mut World,
    name: &str,
    [length, height]: [f64; 2],
    openings: &[[f64; 4]],
    place: Place,
) {
    let openings: Vec<String> = openings.iter().map(|o| format!("({})", list(o))).collect();
    let shape = format!(
        "Wall(length: {}, height: {}, thickness: {WALL}, openings: [{}])",
        list(&[length]),
        list(&[height]),
        openings.join(", ")
    );
    world.fixed(name, &shape, place);
}

pub(crate) fn cuboid(size: [f64; 3]) -> String {
    format!("Cuboid(size: ({}))", list(&size))
}

pub(crate) fn boxes(all: &[[f64; 6]]) -> String {
    let all: Vec<String> =
        all.iter().map(|b| format!("(({}), ({}))", list(&b[..3]), list(&b[3..]))).collect();
    format!("Boxes(add: [{}])", all.join(", "))
}

pub(crate) fn lathe(profile: &[[f64; 2]], segments: u32) -> String {
    let points: Vec<String> = profile.iter().map(|p| format!("({})", list(p))).collect();
    format!("Lathe(profile: [{}], segments: {segments})", points.join(", "))
}

fn shell(world: &mut World) {
    let (half, high) = (0.5 * WALL, 2.0 * STOREY - 0.3);
    let window = |x: f64, z: f64| [x, z + 0.9, x + 1.4, z + 2.1];
    world.fixed("ground", &cuboid([15.0, 14.0, 0.2]), Place([5.0, 3.5, -0.1], 0.0));
    let south = [[1.0, 0.0, 2.0, 2.1], window(3.2, 0.0), window(5.4, 0.0), window(7.6, 0.0)];
    wall(world, "wall_south", [WIDTH, 2.5], &south, Place([0.0, half, 0.0], 0.0));
    let north: Vec<[f64; 4]> = [0.0, STOREY]
        .into_iter()
        .flat_map(|z| [0.8, 3.0, 5.2, 7.6].map(|x| window(x, z)))
        .collect();
    wall(world, "wall_north", [WIDTH, high], &north, Place([0.0, DEPTH - half, 0.0], 0.0));
    let back = DEPTH - WALL - GALLERY;
    for (side, x) in [("west", half), ("east", WIDTH - half)] {
        let front = [window(1.3, 0.0)];
        let size = [GALLERY - WALL, 2.5];
        wall(world, &format!("wall_{side}_front"), size, &front, Place([x, WALL, 0.0], 90.0));
        let rear = [window(1.0, 0.0), window(1.0, STOREY)];
        wall(
            world,
            &format!("wall_{side}_rear"),
            [back, high],
            &rear,
            Place([x, GALLERY, 0.0], 90.0),
        );
    }
    // Beneath the gallery's edge: an arch into the kitchen, a serving hatch behind the stairs.
    let arch = [[0.7, 0.0, 3.1, 2.1], [4.0, 1.0, 5.2, 2.0]];
    wall(
        world,
        "wall_kitchen",
        [WIDTH - 2.0 * WALL, STOREY - 0.2],
        &arch,
        Place([WALL, 4.6, 0.0], 0.0),
    );
}

fn upstairs(world: &mut World) {
    let (x, y) = (WIDTH - 2.0 * WALL, DEPTH - WALL - GALLERY);
    let at = [0.5 * WIDTH, GALLERY + 0.5 * y, STOREY - 0.1];
    world.fixed("upper_floor", &cuboid([x, y, 0.2]), Place(at, 0.0));
    wall(world, "wall_bathroom_south", [3.1, 1.1], &[], Place([WALL, GALLERY + 0.15, STOREY], 0.0));
    let door = [[0.5, 0.0, 1.4, 2.05]];
    wall(
        world,
        "wall_bathroom_east",
        [y - 0.1, 2.3],
        &door,
        Place([3.4, GALLERY + 0.1, STOREY], 90.0),
    );
}

/// Steps of the stairs, below the landing.
const STEPS: u32 = 14;
const RISE: f64 = STOREY / (STEPS + 1) as f64;
const TREAD: f64 = 0.26;
/// Where the uppermost step ends, and the middle of the stairs.
const TOP: [f64; 2] = [8.1, 3.95];

fn staircase(world: &mut World) {
    let shape = format!(
        "Stairs(steps: {STEPS}, rise: {}, tread: {TREAD}, landing: 1.7, depth: 1)",
        list(&[RISE])
    );
    world.posed("stairs", &shape, [TOP[0], TOP[1], 0.0], [90.0, 0.0, 180.0], "kind: Fixed");
    let baluster = baluster();
    let mut count = 0;
    let mut put = |world: &mut World, at: [f64; 3]| {
        world.fixed(&format!("baluster_{count}"), &baluster, Place(at, 0.0));
        count += 1;
    };
    let (from, to, edge) = (3.6, 8.0, GALLERY + 0.08);
    for k in 0..20 {
        put(world, [from + (to - from) * (f64::from(k) + 0.5) / 20.0, edge, STOREY]);
    }
    let rail = 0.92;
    world.fixed(
        "rail_gallery",
        &cuboid([to - from, 0.07, 0.05]),
        Place([0.5 * (from + to), edge, STOREY + rail], 0.0),
    );
    let south = TOP[1] - 0.45;
    for k in 0..STEPS {
        let x = TOP[0] - TREAD * (f64::from(k) + 0.5);
        put(world, [x, south, STOREY - RISE * f64::from(k + 1)]);
    }
    for k in 0..8 {
        put(world, [TOP[0] + 0.1 + 0.2 * f64::from(k), south, STOREY]);
    }
    world.fixed(
        "rail_landing",
        &cuboid([1.7, 0.07, 0.05]),
        Place([TOP[0] + 0.85, south, STOREY + rail], 0.0),
    );
    let run = TREAD * f64::from(STEPS);
    let (length, slope) = (run.hypot(RISE * f64::from(STEPS)), (RISE / TREAD).atan());
    let middle = [TOP[0] - 0.5 * run, south, 0.5 * STOREY + rail - 0.5 * RISE];
    world.posed(
        "rail_stairs",
        &cuboid([length, 0.07, 0.05]),
        middle,
        [0.0, -slope.to_degrees(), 0.0],
        "kind: Fixed",
    );
}

fn baluster() -> String {
    let profile = [
        [0.0, 0.0],
        [0.035, 0.0],
        [0.035, 0.08],
        [0.02, 0.1],
        [0.018, 0.14],
        [0.028, 0.22],
        [0.036, 0.32],
        [0.03, 0.42],
        [0.018, 0.52],
        [0.014, 0.62],
        [0.02, 0.7],
        [0.026, 0.76],
        [0.018, 0.8],
        [0.03, 0.84],
        [0.03, 0.9],
        [0.0, 0.9],
    ];
    lathe(&profile, 20)
}

/// A leaf of a door: it hangs on its left edge at the origin, framed panels and a handle.
fn leaf(width: f64) -> String {
    let (w, h) = (width, 2.0);
    boxes(&[
        [0.02, -0.02, 0.01, 0.12, 0.02, h],
        [w - 0.1, -0.02, 0.01, w, 0.02, h],
        [0.02, -0.02, 0.01, w, 0.02, 0.2],
        [0.02, -0.02, 1.0, w, 0.02, 1.12],
        [0.02, -0.02, h - 0.12, w, 0.02, h],
        [0.02, -0.01, 0.01, w, 0.01, h],
        [w - 0.07, -0.07, 1.04, w - 0.04, 0.07, 1.07],
        [w - 0.16, -0.07, 1.04, w - 0.04, -0.05, 1.07],
        [w - 0.16, 0.05, 1.04, w - 0.04, 0.07, 1.07],
    ])
}

fn doors(world: &mut World) {
    let front = Place([1.01, 0.5 * WALL, 0.0], 0.0);
    world.loose("front_door", &leaf(0.96), front, WOOD);
    // The wall's frame begins at the house's corner, in the middle of its thickness.
    world.hinge(["wall_south", "front_door"], Place([1.01, 0.0, 0.0], 0.0), 1.9);
    let bath = Place([3.4, GALLERY + 0.61, STOREY], 90.0);
    world.loose("bathroom_door", &leaf(0.86), bath, WOOD);
    world.hinge(["wall_bathroom_east", "bathroom_door"], Place([0.51, 0.0, 0.0], 0.0), 1.9);
}

/// A book: two covers, a spine, and pages that are smaller.
fn book([thickness, depth, height]: [f64; 3]) -> String {
    let (t, d, h, cover) = (thickness, 0.5 * depth, height, 0.004);
    boxes(&[
        [0.0, -d, 0.0, cover, d, h],
        [t - cover, -d, 0.0, t, d, h],
        [0.0, -d, 0.0, t, -d + cover, h],
        [0.0, -d, 0.008, t, d - 0.008, h - 0.008],
    ])
}

/// A shelf full of books; they stand in groups, with room to topple.
fn bookshelf(world: &mut World, name: &str, Place(at, degrees): Place, levels: u32, books: u32) {
    let size = [1.0, 0.28, 0.36 * f64::from(levels)];
    world.fixed(
        name,
        &format!("Shelf(size: ({}), levels: {levels}, board: 0.02)", list(&size)),
        Place(at, degrees),
    );
    let kinds = [[0.03, 0.16, 0.24], [0.045, 0.18, 0.28], [0.025, 0.14, 0.2], [0.06, 0.2, 0.26]];
    let high = (size[2] - 0.02) / f64::from(levels);
    let (sin, cos) = degrees.to_radians().sin_cos();
    for level in 0..levels {
        let mut x = -0.46;
        for k in 0..books {
            let kind = kinds[((level * 5 + k * 3) % 4) as usize];
            let [px, py] = [x, -0.02];
            let at = [
                at[0] + cos * px - sin * py,
                at[1] + sin * px + cos * py,
                at[2] + 0.02 + high * f64::from(level) + 0.0005,
            ];
            world.loose(
                &format!("{name}_book_{level}_{k}"),
                &book(kind),
                Place(at, degrees),
                700.0,
            );
            x += kind[0] + 0.004;
        }
    }
}

fn living_room(world: &mut World) {
    bookshelf(world, "shelf_a", Place([0.36, 3.7, 0.0], 90.0), 5, 10);
    bookshelf(world, "shelf_b", Place([0.36, 2.65, 0.0], 90.0), 5, 10);
    // In the visitor's way.
    world.loose("chair_in_the_way", "Chair()", Place([2.75, 1.95, 0.001], -70.0), WOOD);
    let sofa = boxes(&[
        [-1.0, -0.45, 0.08, 1.0, 0.45, 0.42],
        [-1.0, 0.25, 0.08, 1.0, 0.45, 0.85],
        [-1.0, -0.45, 0.08, -0.8, 0.45, 0.62],
        [0.8, -0.45, 0.08, 1.0, 0.45, 0.62],
        [-0.95, -0.4, 0.0, -0.85, -0.3, 0.1],
        [0.85, -0.4, 0.0, 0.95, -0.3, 0.1],
        [-0.95, 0.3, 0.0, -0.85, 0.4, 0.1],
        [0.85, 0.3, 0.0, 0.95, 0.4, 0.1],
    ]);
    world.loose("sofa", &sofa, Place([7.2, 2.75, 0.001], 0.0), 120.0);
    world.loose(
        "low_table",
        "Table(size: (1.2, 0.6, 0.42), thickness: 0.03)",
        Place([7.1, 1.6, 0.001], 0.0),
        WOOD,
    );
    world.loose(
        "armchair",
        "Chair(width: 0.7, seat: 0.42, back: 0.95, thickness: 0.08)",
        Place([5.4, 1.5, 0.001], 70.0),
        250.0,
    );
    world.loose("lamp_sofa", "Lamp()", Place([8.8, 2.9, 0.001], 0.0), 800.0);
    world.loose("lamp_window", "Lamp(height: 1.4)", Place([9.3, 0.7, 0.001], 0.0), 800.0);
    for (k, [x, y]) in [[6.8, 1.6], [7.3, 1.75], [7.4, 1.45]].into_iter().enumerate() {
        world.loose(&format!("mug_{k}"), MUG, Place([x, y, 0.4215], 0.0), CERAMICS);
    }
    world.loose("bowl_low", &bowl(), Place([7.05, 1.65, 0.4215], 0.0), CERAMICS);
}

const MUG: &str = "Cup(radius: 0.045, height: 0.1, wall: 0.008, floor: 0.01, segments: 24)";
const PLATE: &str = "Cup(radius: 0.12, height: 0.03, wall: 0.012, floor: 0.01, segments: 32)";

fn bowl() -> String {
    let profile = [
        [0.0, 0.0],
        [0.06, 0.0],
        [0.11, 0.035],
        [0.14, 0.09],
        [0.128, 0.09],
        [0.1, 0.044],
        [0.055, 0.014],
        [0.0, 0.012],
    ];
    lathe(&profile, 28)
}

fn bottle() -> String {
    let profile = [
        [0.0, 0.0],
        [0.038, 0.0],
        [0.04, 0.19],
        [0.016, 0.24],
        [0.015, 0.3],
        [0.01, 0.3],
        [0.011, 0.236],
        [0.033, 0.186],
        [0.032, 0.012],
        [0.0, 0.012],
    ];
    lathe(&profile, 20)
}

fn kitchen(world: &mut World) {
    let table = [3.4, 6.2];
    world.loose(
        "dining_table",
        "Table(size: (2, 0.95, 0.75))",
        Place([table[0], table[1], 0.001], 0.0),
        WOOD,
    );
    for (k, x) in [-0.65, 0.0, 0.65].into_iter().enumerate() {
        for (side, y, turn) in [("south", -0.72, 180.0), ("north", 0.72, 0.0)] {
            let name = format!("chair_{side}_{k}");
            world.loose(&name, "Chair()", Place([table[0] + x, table[1] + y, 0.001], turn), WOOD);
            let at = |y: f64| [table[0] + x, table[1] + y, 0.7515];
            let near = 0.3 * y.signum();
            world.loose(&format!("plate_{side}_{k}"), PLATE, Place(at(near), 0.0), CERAMICS);
            let mug = [table[0] + x + 0.2, table[1] + near, 0.7515];
            world.loose(&format!("cup_{side}_{k}"), MUG, Place(mug, 0.0), CERAMICS);
        }
        world.loose(
            &format!("bottle_{k}"),
            &bottle(),
            Place([table[0] + x + 0.3, table[1], 0.7515], 0.0),
            1200.0,
        );
    }
    world.loose("bowl_table", &bowl(), Place([table[0], table[1], 0.7515], 0.0), CERAMICS);
    // A worktop with a hole for the sink, along the north wall.
    let top = "Boxes(add: [((-1.5, -0.3, 0), (1.5, 0.3, 0.9))], cut: [((-0.4, -0.22, 0.6), (0.4, 0.22, 2)), ((-1.45, -0.4, 0.1), (-0.5, 0.25, 0.8)), ((0.5, -0.4, 0.1), (1.45, 0.25, 0.8))])";
    world.fixed("worktop", top, Place([7.4, 7.48, 0.0], 0.0));
    let sink =
        "Tub(size: (0.78, 0.42, 0.2), wall: 0.015, roundness: 0.5, taper: 0.85, segments: 16)";
    world.fixed("kitchen_sink", sink, Place([7.4, 7.48, 0.71], 0.0));
    world.fixed("kitchen_tap", &tap(), Place([7.4, 7.68, 0.9], -90.0));
    for k in 0..3 {
        let x = 6.25 + 0.28 * f64::from(k);
        for n in 0..4 {
            let z = 0.901 + 0.031 * f64::from(n);
            world.loose(
                &format!("stacked_plate_{k}_{n}"),
                PLATE,
                Place([x, 7.45, z], 0.0),
                CERAMICS,
            );
        }
    }
    world.loose("plate_in_sink", PLATE, Place([7.3, 7.47, 0.728], 0.0), CERAMICS);
    world.loose("cup_in_sink", MUG, Place([7.55, 7.47, 0.728], 0.0), CERAMICS);
    let shelf = [9.62, 6.0];
    world.fixed(
        "dresser",
        "Shelf(size: (1.6, 0.34, 1.9), levels: 5, columns: 2, board: 0.03)",
        Place([shelf[0], shelf[1], 0.0], -90.0),
    );
    for level in 0..5 {
        for k in 0..8 {
            // Facing west: along the shelf is along y.
            let z = 0.031 + 0.374 * f64::from(level);
            let y = shelf[1] - 0.63 + 0.18 * f64::from(k);
            let shape = if level % 2 == 0 { MUG.to_owned() } else { bottle() };
            let high = if level % 2 == 0 { CERAMICS } else { 1200.0 };
            world.loose(
                &format!("on_dresser_{level}_{k}"),
                &shape,
                Place([shelf[0] - 0.02, y, z], 0.0),
                high,
            );
        }
    }
}

/// A tap: a post and a spout that bends down.
fn tap() -> String {
    boxes(&[
        [-0.02, -0.02, 0.0, 0.02, 0.02, 0.3],
        [-0.02, -0.015, 0.27, 0.2, 0.015, 0.3],
        [0.17, -0.015, 0.22, 0.2, 0.015, 0.3],
        [-0.02, -0.06, 0.05, 0.02, 0.06, 0.08],
    ])
}

fn bathroom_and_bedroom(world: &mut World) {
    let z = STOREY;
    world.fixed("bathtub", "Tub(segments: 24)", Place([1.3, 7.3, z], 0.0));
    world.fixed("bath_tap", &tap(), Place([0.38, 7.3, z + 0.4], 0.0));
    let foot = [[0.0, 0.0], [0.16, 0.0], [0.08, 0.08], [0.07, 0.6], [0.14, 0.72], [0.0, 0.72]];
    world.fixed("washstand", &lathe(&foot, 24), Place([0.5, 5.6, z], 0.0));
    world.fixed(
        "washbasin",
        "Tub(size: (0.6, 0.45, 0.16), wall: 0.02, segments: 20)",
        Place([0.5, 5.6, z + 0.7], 90.0),
    );
    world.loose(
        "soap_dish",
        "Tub(size: (0.14, 0.09, 0.03), wall: 0.007, segments: 8)",
        Place([0.5, 5.6, z + 0.721], 0.0),
        1200.0,
    );
    let duck = "Sphere(radius: 0.06, segments: 20, rings: 10)";
    for k in 0..5 {
        let x = 0.9 + 0.2 * f64::from(k);
        world.loose(&format!("ball_in_tub_{k}"), duck, Place([x, 7.3, z + 0.2], 0.0), 150.0);
    }
    let bed = boxes(&[
        [-1.0, -0.7, 0.25, 1.0, 0.7, 0.5],
        [-1.05, -0.72, 0.0, -1.0, 0.72, 1.0],
        [1.0, -0.72, 0.0, 1.05, 0.72, 0.65],
        [-1.05, -0.72, 0.2, 1.05, 0.72, 0.3],
        [-0.95, -0.5, 0.45, -0.6, 0.5, 0.58],
    ]);
    world.fixed("bed", &bed, Place([4.7, 7.05, z], 0.0));
    world.fixed(
        "wardrobe",
        "Shelf(size: (1.4, 0.5, 1.9), levels: 3, columns: 2, board: 0.03)",
        Place([8.9, 7.5, z], 0.0),
    );
    bookshelf(world, "shelf_c", Place([7.2, 7.6, z], 0.0), 4, 12);
    world.loose("bedroom_chair", "Chair()", Place([6.25, 7.3, z + 0.001], 0.0), WOOD);
    world.loose(
        "bedroom_lamp",
        "Lamp(height: 1.2, shade: 0.2)",
        Place([3.62 + 0.25, 5.0, z + 0.001], 0.0),
        800.0,
    );
}

/// Somebody, looking along y, the right arm stretched out.
fn figure() -> String {
    boxes(&[
        [-0.2, -0.1, 0.0, -0.04, 0.13, 0.08],
        [0.04, -0.1, 0.0, 0.2, 0.13, 0.08],
        [-0.18, -0.08, 0.0, -0.05, 0.08, 0.85],
        [0.05, -0.08, 0.0, 0.18, 0.08, 0.85],
        [-0.2, -0.11, 0.8, 0.2, 0.11, 1.0],
        [-0.23, -0.12, 0.95, 0.23, 0.12, 1.45],
        [-0.06, -0.06, 1.4, 0.06, 0.06, 1.52],
        [-0.1, -0.11, 1.5, 0.1, 0.11, 1.76],
        [-0.025, 0.1, 1.58, 0.025, 0.15, 1.64],
        [-0.33, -0.06, 0.85, -0.21, 0.06, 1.42],
        [0.21, -0.06, 1.28, 0.33, 0.06, 1.42],
        [0.22, -0.05, 1.28, 0.32, 0.5, 1.38],
        [0.21, 0.48, 1.27, 0.33, 0.6, 1.4],
    ])
}

/// Where the visitor goes, at about a metre a second.
fn walk() -> Vec<Stop> {
    let up = STOREY + 2.0 * FLOAT;
    // The stairs' slope, behind the nosings by what feet reach forward.
    let (foot, top) = (0.16, TOP[0] - 0.16);
    let slope = RISE / TREAD;
    let start = top - TREAD * f64::from(STEPS) - (RISE + FLOAT) / slope + foot - 0.14;
    let stations: [([f64; 3], f64, f64); 14] = [
        ([1.5, -1.7, FLOAT], 0.0, 0.0),
        ([1.5, 1.3, FLOAT], 0.0, 3.4),
        ([1.5, 1.9, FLOAT], -90.0, 1.2),
        ([3.1, 1.9, FLOAT], -90.0, 2.0),
        ([3.3, 2.9, FLOAT], -45.0, 1.2),
        ([3.5, TOP[1], FLOAT], -90.0, 1.2),
        ([start, TOP[1], FLOAT], -90.0, 0.6),
        ([top, TOP[1], up], -90.0, 5.0),
        ([8.8, TOP[1], up], -90.0, 0.8),
        ([8.9, 4.3, up], 0.0, 1.0),
        ([8.9, 5.2, up], 0.0, 0.9),
        ([8.6, 5.5, up], 90.0, 1.0),
        ([2.5, 5.5, up], 90.0, 4.2),
        ([2.2, 5.6, up], 0.0, 1.0),
    ];
    let mut time = 0.0;
    let stop = |(at, degrees, seconds): ([f64; 3], f64, f64)| {
        time += seconds;
        // Written with few digits, as a person would.
        let round = |x: f64| (x * 1e3).round() / 1e3;
        Stop(round(time), Place(at.map(round), degrees))
    };
    stations.into_iter().map(stop).collect()
}
