//! rapier's character controller over our shapes, z up: where it ends is said before it walks, and
//! rapier's own triangle mesh of the same scene ends there too.

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

/// What a model becomes in a world, by the detector's name.
type Maker = (&'static str, fn(&Model) -> SharedShape);

/// Ours, and what rapier has for the same model.
fn detectors() -> [Maker; 2] {
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

/// Plays a scene with our shapes and with rapier's mesh: characters end at the same place.
#[track_caller]
fn both(play: impl Fn(fn(&Model) -> SharedShape, &str) -> Vector) {
    let [(own, ours), (mesh, theirs)] = detectors();
    let (mesh, own) = (play(theirs, mesh), play(ours, own));
    assert!((own - mesh).length() < 1e-4, "ours: {own}, rapier's mesh: {mesh}");
}

/// How far it came of what it wanted: rapier's controller loses up to a tenth by stopping short of
/// what it meets again and again (its own test asks for 0.93 of a kilometre).
#[track_caller]
fn came(along: Real, wanted: Real, what: &str) {
    assert!(along > 0.9 * wanted && along < wanted + NEAR, "{what}: {along} of {wanted}");
}

#[test]
fn it_walks_over_a_tessellated_floor() {
    for (name, character) in characters() {
        both(|shape, whose| {
            let what = format!("{name} on {whose}");
            let mut world = World::new();
            world.fixed(&shape(&tessellated_slab(20, 4.0)), up(0.0));
            let start = Vector::new(-3.0, 0.1, HALF + 0.1);
            let mut walker = Walker::new(&mut world, &character, start);
            // It lands from 0.1 above, and its feet are then GAP above the floor all the way.
            walker.walk(10, Vector::new(0.0, 0.0, -0.05));
            walker.is_at(Vector::new(-3.0, 0.1, HALF + GAP), &what);
            for step in 1..=100 {
                walker.walk(1, STEP);
                assert!(walker.last.grounded, "{what}: lost the ground in step {step}");
                assert!((walker.at.z - HALF - GAP).abs() < NEAR, "{what}: {}", walker.at);
            }
            came(walker.at.x + 3.0, 5.0, &what);
            assert!((walker.at.y - 0.1).abs() < NEAR, "{what}: {}", walker.at);
            walker.at
        });
    }
}

/// Stairs with a landing six rises above a floor, the lowest riser at x = 3.
fn stairs(world: &mut World, shape: fn(&Model) -> SharedShape, rise: f64) {
    let stairs = Stairs { steps: 5, rise, tread: 0.6, landing: 4.0, depth: 4.0 };
    let upright = Rotation::from_rotation_x(std::f64::consts::FRAC_PI_2 as Real);
    world.fixed(&shape(&model(stairs)), Pose::from_parts(Vector::ZERO, upright));
    world.fixed(&shape(&cuboid(12.0, 12.0, 1.0)), up(-0.5));
}

/// A box climbs what it may step over, a capsule besides what is no steeper to its round foot than
/// 45 degrees, which is up to 0.088; neither climbs more, nor the box without autostep.
#[test]
fn it_climbs_stairs_that_are_low_enough() {
    let [capsule, cuboid] = characters().map(|(_, shape)| shape);
    for (name, character, rise, steps_up, climbs) in [
        ("capsule", &capsule, 0.08, false, true),
        ("capsule", &capsule, 0.4, true, false),
        ("cuboid", &cuboid, 0.2, true, true),
        ("cuboid", &cuboid, 0.2, false, false),
        ("cuboid", &cuboid, 0.4, true, false),
    ] {
        both(|shape, whose| {
            let what = format!("{name} on {whose}, rise {rise}, steps up: {steps_up}");
            let mut world = World::new();
            stairs(&mut world, shape, rise);
            let start = Vector::new(4.0, 0.0, HALF + GAP);
            let mut walker = Walker::new(&mut world, character, start);
            if !steps_up {
                walker.controller.autostep = None;
            }
            walker.walk(160, Vector::new(-0.05, 0.0, -0.05));
            assert!(walker.last.grounded, "{what}");
            if climbs {
                let landing = 6.0 * rise as Real;
                assert!((walker.at.z - landing - start.z).abs() < NEAR, "{what}: {}", walker.at);
                assert!(walker.at.x < -0.5, "{what}: {}", walker.at);
            } else {
                walker.is_at(Vector::new(3.0 + 0.3 + GAP, 0.0, start.z), &what);
            }
            walker.at
        });
    }
}

/// From the landing down six rises of 0.2 and along the floor, though it never wants to go down:
/// each is less than what it snaps over.
#[test]
fn it_snaps_to_stairs_that_it_goes_down() {
    for (name, character) in characters().into_iter().take(1) {
        both(|shape, whose| {
            let what = format!("{name} on {whose}");
            let mut world = World::new();
            stairs(&mut world, shape, 0.2);
            let start = Vector::new(-1.0, 0.0, 1.2 + HALF + GAP);
            let mut walker = Walker::new(&mut world, &character, start);
            let mut lost = 0;
            for _ in 0..110 {
                walker.walk(1, Vector::new(0.05, 0.0, 0.0));
                lost += u32::from(!walker.last.grounded);
            }
            // A box loses it at the edge of a step in f64, on rapier's mesh as well: a capsule does
            // not.
            assert!(lost == 0, "{what}: lost the ground in {lost} steps");
            assert!((walker.at.z - HALF - GAP).abs() < NEAR, "{what}: {}", walker.at);
            came(walker.at.x + 1.0, 5.5, &what);
            walker.at
        });
    }
}

/// A wall across the way at x = 1 with a door of 1 by 2.5: what runs against it beside the door
/// slides along, and what runs at the door goes through, as no hull would let it.
#[test]
fn it_slides_along_a_wall_and_goes_through_its_door() {
    let wall = door(1.0, 2.5);
    let before = 0.9 - 0.3 - GAP; // of the wall's face
    for (name, character) in characters() {
        both(|shape, whose| {
            let what = format!("{name} on {whose}");
            let mut world = World::new();
            world.fixed(&shape(&tessellated_slab(20, 4.0)), up(0.0));
            world.fixed(&shape(&wall), Pose::translation(1.0, 0.0, 0.0));
            let start = Vector::new(-1.0, -2.5, HALF + GAP);
            let mut walker = Walker::new(&mut world, &character, start);
            walker.walk(60, STEP);
            walker.is_at(Vector::new(before, -2.5, HALF + GAP), &what);
            // Aslant: along it by 0.02 a step.
            walker.walk(50, Vector::new(0.05, 0.02, -0.05));
            came(walker.at.y + 2.5, 1.0, &what);
            assert!((walker.at.x - before).abs() < NEAR, "{what}: {}", walker.at);
            let slid = walker.at;
            walker.at = Vector::new(0.0, 0.0, HALF + GAP);
            walker.walk(40, STEP);
            came(walker.at.x, 2.0, &what);
            assert!((walker.at.z - HALF - GAP).abs() < NEAR, "{what}: {}", walker.at);
            // As fast as 100 in a step: it is stopped all the same, and a normal that is off by
            // 3e-4 lets a little of 100 slide.
            walker.at = start;
            walker.walk(1, Vector::new(100.0, 0.0, 0.0));
            assert!((walker.at.x - before).abs() < NEAR, "{what}: {}", walker.at);
            assert!((walker.at - start).with_x(0.0).length() < 0.05, "{what}: {}", walker.at);
            slid
        });
    }
}

/// A wall 0.2 thick about x = 0, 8 wide, 3 high, with a door in its middle: three blocks as one
/// mesh.
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

/// In a cup of radius 2 with a wall of 0.2 and a floor of 0.3: it stands on that floor, and runs as
/// far as the wall lets it, which is a flat of 64.
#[test]
fn it_stands_and_walks_in_a_cup() {
    let cup = model(Cup { radius: 2.0, height: 3.0, wall: 0.2, floor: 0.3, segments: 64 });
    let character = &characters()[0].1;
    both(|shape, whose| {
        let mut world = World::new();
        world.fixed(&shape(&cup), up(0.0));
        let mut walker = Walker::new(&mut world, character, Vector::new(0.0, 0.0, 2.0));
        walker.walk(40, Vector::new(0.0, 0.0, -0.05));
        assert!(walker.last.grounded, "{whose}");
        walker.is_at(Vector::new(0.0, 0.0, 0.3 + HALF + GAP), whose);
        walker.walk(100, STEP);
        walker.is_at(Vector::new(1.8 - 0.3 - GAP, 0.0, 0.3 + HALF + GAP), whose);
        walker.at
    });
}

/// What stands still and is pushed into, as by a wall that moves, is moved out of the way by the
/// controller.
#[test]
fn what_overlaps_is_pushed_out() {
    for (name, character) in characters() {
        both(|shape, whose| {
            let mut world = World::new();
            world.fixed(&shape(&cuboid(4.0, 4.0, 4.0)), up(0.0));
            // 0.05 deep in its face x = 2.
            let mut walker = Walker::new(&mut world, &character, Vector::new(2.25, 0.3, 0.2));
            walker.walk(1, Vector::ZERO);
            walker.is_at(Vector::new(2.3 + GAP, 0.3, 0.2), &format!("{name} on {whose}"));
            walker.at
        });
    }
}

/// A platform that goes 1.0 in 50 steps carries who stands on it; rapier's controller slips by a
/// little over a tenth.
#[test]
fn a_platform_carries_it() {
    let character = &characters()[0].1;
    both(|shape, whose| {
        let mut world = World::new();
        let body = RigidBodyBuilder::kinematic_velocity_based()
            .pose(up(-0.5))
            .linvel(Vector::new(0.0, 1.2, 0.0));
        world.insert(body, &shape(&cuboid(4.0, 8.0, 1.0)));
        let mut walker = Walker::new(&mut world, character, Vector::new(0.0, 0.0, HALF + GAP));
        walker.walk(50, Vector::new(0.0, 0.0, -0.05));
        assert!((0.85..=1.0).contains(&walker.at.y), "{whose}: {}", walker.at);
        walker.at
    });
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
