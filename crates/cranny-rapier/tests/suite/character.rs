//! rapier's character controller over our shapes, z up: where it ends is said before it walks, and rapier's own triangle
//! mesh of the same scene ends there too.

use cranny_geometry::Model;
use cranny_rapier::{Detector, MeshShape};
use cranny_shapes::{Cup, Stairs};
use rapier3d::control::{
    CharacterAutostep, CharacterLength, EffectiveCharacterMovement, KinematicCharacterController,
};
use rapier3d::math::{Pose, Real, Rotation, Vector};
use rapier3d::parry::shape::SharedShape;
use rapier3d::prelude::{QueryFilter, RigidBodyBuilder};

use crate::world::{World, cuboid, model, ours, tessellated_slab, up};

/// What the controllers of the tests keep clear of everything.
const GAP: Real = 0.02;
/// How far a place may be off: the controller nudges itself off what it meets by 1e-4 each time.
const NEAR: Real = 5e-3;

fn controller() -> KinematicCharacterController {
    KinematicCharacterController {
        up: Vector::Z,
        offset: CharacterLength::Absolute(GAP),
        snap_to_ground: Some(CharacterLength::Absolute(0.3)),
        autostep: Some(CharacterAutostep {
            max_height: CharacterLength::Absolute(0.3),
            min_width: CharacterLength::Absolute(0.1),
            include_dynamic_bodies: true,
        }),
        ..KinematicCharacterController::default()
    }
}

/// A standing capsule and a box, both 0.6 wide and 1.8 high.
fn characters() -> [(&'static str, SharedShape); 2] {
    [("capsule", SharedShape::capsule_z(0.6, 0.3)), ("cuboid", SharedShape::cuboid(0.3, 0.3, 0.9))]
}

/// The height of their middle above their feet.
const HALF: Real = 0.9;

fn walkable(model: &Model) -> SharedShape {
    SharedShape::new(MeshShape::new(model, 0).expect("parry takes it").walkable())
}

/// Ours, and what rapier has for the same model.
fn detectors() -> [(&'static str, fn(&Model) -> SharedShape); 2] {
    fn mesh(model: &Model) -> SharedShape {
        Detector::RapierTrimesh.shape(model, 0).expect("parry takes it")
    }
    [("ours", walkable), ("rapier's mesh", mesh)]
}

/// Who walks.
struct Walker<'a> {
    world: &'a mut World,
    shape: &'a SharedShape,
    controller: KinematicCharacterController,
    at: Vector,
    last: EffectiveCharacterMovement,
}

impl<'a> Walker<'a> {
    fn new(world: &'a mut World, shape: &'a SharedShape, at: Vector) -> Self {
        let last = EffectiveCharacterMovement {
            translation: Vector::ZERO,
            grounded: false,
            is_sliding_down_slope: false,
        };
        Self { world, shape, controller: controller(), at, last }
    }

    /// So many steps of 1/60 s, each of which wants to go by `step`.
    fn walk(&mut self, steps: usize, step: Vector) -> &mut Self {
        for _ in 0..steps {
            self.world.0.step();
            let world = &self.world.0;
            let queries = world.broad_phase.as_query_pipeline(
                world.narrow_phase.query_dispatcher(),
                &world.bodies,
                &world.colliders,
                QueryFilter::default(),
            );
            let pose = Pose::from_translation(self.at);
            let shape = &*self.shape.0;
            self.last =
                self.controller.move_shape(1.0 / 60.0, &queries, shape, &pose, step, |_| {});
            self.at += self.last.translation;
            assert!(self.at.is_finite());
        }
        self
    }

    #[track_caller]
    fn is_at(&self, expected: Vector, what: &str) {
        let off = (self.at - expected).abs();
        assert!(off.max_element() < NEAR, "{what}: at {}, not at {expected}", self.at);
    }
}

/// Forward by 3 m/s, and down by 3 m/s as an app has it that pulls its character to the ground.
const STEP: Vector = Vector::new(0.05, 0.0, -0.05);

#[test]
fn it_walks_over_a_tessellated_floor() {
    for ((whose, shape), (name, character)) in
        detectors().into_iter().flat_map(|d| characters().map(|c| (d, c)))
    {
        let what = format!("{name} on {whose}");
        let mut world = World::new();
        world.fixed(&shape(&tessellated_slab(20, 4.0)), up(0.0));
        let mut walker = Walker::new(&mut world, &character, Vector::new(-3.0, 0.1, HALF + 0.1));
        // It lands from 0.1 above, and its feet are then GAP above the floor all the way.
        walker.walk(10, Vector::new(0.0, 0.0, -0.05));
        walker.is_at(Vector::new(-3.0, 0.1, HALF + GAP), &what);
        for step in 1..=100 {
            walker.walk(1, STEP);
            assert!(walker.last.grounded, "{what}: lost the ground in step {step}");
            assert!((walker.at.z - HALF - GAP).abs() < NEAR, "{what}: {}", walker.at);
        }
        // 5.0 by 100 steps; the controller's own nudges may cost a hundredth of that.
        assert!((walker.at.x - 2.0).abs() < 0.05, "{what}: {}", walker.at);
        assert!((walker.at.y - 0.1).abs() < NEAR, "{what}: {}", walker.at);
    }
}

/// Up to a landing, six steps of 0.2 above the floor; not a single one of 0.4, which is more than it can.
#[test]
fn it_climbs_stairs_that_are_low_enough() {
    for (whose, shape) in detectors() {
        for (name, character) in characters() {
            for (rise, foot) in [(0.2, 1.2), (0.4, 0.0)] {
                let what = format!("{name} on {whose}, steps of {rise}");
                let stairs = Stairs { steps: 5, rise, tread: 0.6, landing: 4.0, depth: 4.0 };
                let mut world = World::new();
                let upright = Rotation::from_rotation_x(std::f64::consts::FRAC_PI_2 as Real);
                let pose = Pose::from_parts(Vector::ZERO, upright);
                world.fixed(&shape(&model(stairs)), pose);
                world.fixed(&shape(&cuboid(12.0, 12.0, 1.0)), up(-0.5));
                // Its lowest riser is at x = 3.
                let start = Vector::new(4.0, 0.0, HALF + GAP);
                let mut walker = Walker::new(&mut world, &character, start);
                walker.walk(120, Vector::new(-0.05, 0.0, -0.05));
                println!("{what}: {} {}", walker.at, walker.last.grounded);
                let height = walker.at.z - HALF - GAP;
                assert!((height - foot).abs() < NEAR, "{what}: at {}", walker.at);
                assert!(walker.last.grounded, "{what}");
                match foot > 0.0 {
                    true => assert!(walker.at.x < -1.0, "{what}: at {}", walker.at),
                    false => walker.is_at(Vector::new(3.0 + 0.3 + GAP, 0.0, start.z), &what),
                }
            }
        }
    }
}

/// A wall across the way at x = 1 with a door of 1 by 2.5: what runs against it beside the door slides along, and what
/// runs at the door goes through, as no hull would let it.
#[test]
fn it_slides_along_a_wall_and_goes_through_its_door() {
    let wall = door(1.0, 2.5);
    for ((whose, shape), (name, character)) in
        detectors().into_iter().flat_map(|d| characters().map(|c| (d, c)))
    {
        let what = format!("{name} on {whose}");
        let mut world = World::new();
        world.fixed(&shape(&tessellated_slab(20, 4.0)), up(0.0));
        world.fixed(&shape(&wall), Pose::translation(1.0, 0.0, 0.0));
        let start = Vector::new(-1.0, -2.5, HALF + GAP);
        let mut walker = Walker::new(&mut world, &character, start);
        // Straight at it: it stops GAP before the wall's face at x = 0.9.
        walker.walk(60, STEP);
        walker.is_at(Vector::new(0.9 - 0.3 - GAP, -2.5, HALF + GAP), &what);
        // Aslant: along it by 0.02 a step.
        walker.walk(50, Vector::new(0.05, 0.02, -0.05));
        let along = walker.at.y + 2.5;
        assert!((along - 1.0).abs() < 0.05, "{what}: slid by {along}");
        assert!((walker.at.x - (0.9 - 0.3 - GAP)).abs() < NEAR, "{what}: {}", walker.at);
        // Through the door, 40 steps of 0.05 from 0 to 2.
        walker.at = Vector::new(0.0, 0.0, HALF + GAP);
        walker.walk(40, STEP);
        assert!((walker.at.x - 2.0).abs() < 0.05, "{what}: {}", walker.at);
        assert!((walker.at.z - HALF - GAP).abs() < NEAR, "{what}: {}", walker.at);
        // As fast as 100 in a step: it is stopped all the same.
        walker.at = Vector::new(-1.0, -2.5, HALF + GAP);
        walker.walk(1, Vector::new(100.0, 0.0, 0.0));
        walker.is_at(Vector::new(0.9 - 0.3 - GAP, -2.5, HALF + GAP), &what);
    }
}

/// A wall 0.2 thick about x = 0, 8 wide, 3 high, with a door in its middle: three blocks as one mesh.
fn door(width: f64, height: f64) -> Model {
    use cranny_exact::DVec3;
    use cranny_geometry::Mesh;
    // The outline in y and z, round the door; faces to both sides, and edges between them.
    let (side, half) = (4.0, 0.5 * width);
    let outline = [
        (-side, 0.0),
        (-half, 0.0),
        (-half, height),
        (half, height),
        (half, 0.0),
        (side, 0.0),
        (side, 3.0),
        (-side, 3.0),
    ];
    let n = outline.len() as u32;
    let ring = |x: f64| outline.map(|(y, z)| DVec3::new(x, y, z));
    let vertices = [ring(-0.1), ring(0.1)].concat();
    let front = [[0, 1, 2], [0, 2, 7], [2, 3, 6], [2, 6, 7], [3, 4, 5], [3, 5, 6]];
    let mut faces: Vec<[u32; 3]> = Vec::new();
    for [a, b, c] in front {
        faces.push([a, c, b]);
        faces.push([a + n, b + n, c + n]);
    }
    for a in 0..n {
        let b = (a + 1) % n;
        faces.extend([[a, b, b + n], [a, b + n, a + n]]);
    }
    let model = crate::world::built(Mesh::new(vertices, faces).expect("indices are in range"));
    let mass = model.mass_properties().expect("it is closed");
    assert!((mass.volume - 0.2 * (8.0 * 3.0 - width * height)).abs() < 1e-9, "{}", mass.volume);
    model
}

/// In a cup of radius 2 with a wall of 0.2 and a floor of 0.3: it stands on that floor, and runs as far as the wall lets it.
#[test]
fn it_stands_and_walks_in_a_cup() {
    let cup = model(Cup { radius: 2.0, height: 3.0, wall: 0.2, floor: 0.3, segments: 64 });
    for (whose, shape) in detectors() {
        let (name, character) = &characters()[0];
        let what = format!("{name} in {whose}");
        let mut world = World::new();
        world.fixed(&shape(&cup), up(0.0));
        let mut walker = Walker::new(&mut world, character, Vector::new(0.0, 0.0, 2.0));
        walker.walk(40, Vector::new(0.0, 0.0, -0.05));
        println!("{what} {} {:?}", walker.at, cup.bounds());
        assert!(walker.last.grounded, "{what}");
        let floor = walker.at.z;
        walker.walk(100, STEP);
        println!("{what} {} {floor}", walker.at);
    }
}

/// What stands still and is pushed into, as by a wall that moves, is moved out of the way by the controller.
#[test]
fn what_overlaps_is_pushed_out() {
    for (whose, shape) in detectors() {
        for (name, character) in characters() {
            let what = format!("{name} on {whose}");
            let mut world = World::new();
            world.fixed(&shape(&cuboid(4.0, 4.0, 4.0)), up(0.0));
            // 0.05 deep in its face x = 2.
            let mut walker = Walker::new(&mut world, &character, Vector::new(2.25, 0.3, 0.2));
            walker.walk(1, Vector::ZERO);
            walker.is_at(Vector::new(2.3 + GAP, 0.3, 0.2), &what);
        }
    }
}

/// A platform that moves by 0.02 a step carries who stands on it.
#[test]
fn a_platform_carries_it() {
    for (whose, shape) in detectors() {
        let mut world = World::new();
        let body = RigidBodyBuilder::kinematic_velocity_based()
            .pose(up(-0.5))
            .linvel(Vector::new(0.0, 1.2, 0.0));
        world.insert(body, &shape(&cuboid(4.0, 8.0, 1.0)));
        let (name, character) = &characters()[0];
        let mut walker = Walker::new(&mut world, character, Vector::new(0.0, 0.0, HALF + GAP));
        walker.walk(50, Vector::new(0.0, 0.0, -0.05));
        println!("{name} on {whose}: {}", walker.at);
    }
}

/// A shape that was not said to be walkable stops a character as well, but is no ground to it.
#[test]
fn ground_is_what_is_walkable() {
    for (name, shape, expected) in [
        ("plain", ours(&cuboid(8.0, 8.0, 1.0)), false),
        ("walkable", walkable(&cuboid(8.0, 8.0, 1.0)), true),
    ] {
        let mut world = World::new();
        world.fixed(&shape, up(-0.5));
        let character = &characters()[0].1;
        let mut walker = Walker::new(&mut world, character, Vector::new(0.0, 0.0, HALF + 0.1));
        walker.walk(10, STEP);
        assert!((walker.at.z - HALF - GAP).abs() < NEAR, "{name}: {}", walker.at);
        assert_eq!(walker.last.grounded, expected, "{name}");
    }
}
