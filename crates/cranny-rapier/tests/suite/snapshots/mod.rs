//! A world that was written and read again goes on to the bit as if nobody had stopped it.

mod refused;
mod simulations;
mod worlds;

use std::hash::{DefaultHasher, Hash, Hasher};

use cranny_geometry::Model;
use cranny_rapier::{restore, snapshot};
use rapier3d::math::{Real, Vector};
use rapier3d::prelude::PhysicsWorld;

use crate::world::World;

/// Of all poses and velocities, to the bit, and of who is asleep.
fn state(world: &PhysicsWorld) -> u64 {
    let mut hasher = DefaultHasher::new();
    for (handle, body) in world.bodies.iter() {
        handle.into_raw_parts().hash(&mut hasher);
        let pose = body.position();
        let rotation = pose.rotation.to_array();
        rotation.map(Real::to_bits).hash(&mut hasher);
        for v in [pose.translation, body.linvel(), body.angvel()] {
            Vector::to_array(&v).map(Real::to_bits).hash(&mut hasher);
        }
        body.is_sleeping().hash(&mut hasher);
    }
    hasher.finish()
}

/// Runs a scene for `before` steps, writes it, and runs it, what was read, and one that nobody
/// wrote for `after` steps more; `disturb` does something to each when that many of these are done.
#[track_caller]
fn goes_on_as_if_nothing_had_happened(
    scene: impl Fn() -> (World, Vec<Model>),
    [before, after]: [usize; 2],
    disturb: impl Fn(&mut PhysicsWorld),
) -> [PhysicsWorld; 2] {
    let (mut unwritten, _) = scene();
    let (mut written, models) = scene();
    unwritten.run(before);
    written.run(before);
    let (mut unwritten, mut written) = (unwritten.0, written.0);
    let bytes = snapshot(&written).expect("between two steps");
    let mut restored = restore(&bytes, &models).expect("just written");
    assert_eq!(state(&restored), state(&written), "as it was");
    for step in 0..after {
        if step == after / 2 {
            for world in [&mut unwritten, &mut written, &mut restored] {
                disturb(world);
            }
        }
        unwritten.step();
        written.step();
        restored.step();
        assert_eq!(state(&written), state(&unwritten), "writing disturbs, step {step}");
        assert_eq!(state(&restored), state(&unwritten), "step {step} after it was read");
    }
    let again = snapshot(&restored).expect("between two steps");
    assert!(again == snapshot(&written).expect("between two steps"), "written the same");
    [written, restored]
}
