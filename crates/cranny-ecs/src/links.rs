//! Which rings hold which: linking numbers, followed over a run, so that a chain that tears is
//! seen.
//!
//! A solver and its detector may let a thin link slip through another within a step; afterwards
//! nothing overlaps and no energy is wrong. The linking number of the centre circles shows the
//! slip.

use bevy_app::{App, Plugin};
use bevy_ecs::prelude::*;
use bevy_ecs::schedule::ScheduleLabel;
use bevy_transform::components::Transform;
use cranny_exact::{DVec3, Pose, RigidMap};
use cranny_world::BodyId;

use crate::body::{Bodies, pose_of};
use crate::clock::{CoreSystems, CrannyEnd, CrannyStep, SimulatedTime, StepSystems};

/// The centre circle of a body that is a ring: about z around the body's origin.
#[derive(Clone, Debug, PartialEq)]
pub struct Ring {
    /// Which body.
    pub body: String,
    /// Of the circle, units of length, > 0.
    pub radius: f64,
}

/// Two rings that were linked at the start.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Link {
    /// The ring with the lower id.
    pub a: BodyId,
    /// The other.
    pub b: BodyId,
    /// Steps completed when their linking number was first another than at the start.
    pub parted: Option<u64>,
}

/// Follows the links.
#[derive(Resource, Clone, Debug, Default)]
pub struct LinkLog {
    tracks: Vec<LinkTrack>,
}

#[derive(Clone, Copy, Debug)]
struct LinkTrack {
    link: Link,
    radii: [f64; 2],
    number: i32,
}

impl LinkLog {
    /// Of each pair that was linked at the start, by ascending ids.
    pub fn links(&self) -> impl ExactSizeIterator<Item = Link> {
        self.tracks.iter().map(|track| track.link)
    }

    fn of(rings: &[(BodyId, f64, Pose)]) -> Self {
        let pairs = rings
            .iter()
            .enumerate()
            .flat_map(|(i, first)| rings[i + 1..].iter().map(move |second| [first, second]));
        let tracks = pairs.filter_map(|[(a, r, pose_a), (b, s, pose_b)]| {
            let number = linking_number([pose_a, pose_b], [*r, *s]);
            let link = Link { a: *a, b: *b, parted: None };
            (number != 0).then_some(LinkTrack { link, radii: [*r, *s], number })
        });
        Self { tracks: tracks.collect() }
    }
}

/// How often the second circle passes through the disc of the first, upward less downward. Each
/// lies about z around its pose's origin.
///
/// A circle meets a plane in two points at most: they are computed, not searched.
fn linking_number(poses: [&Pose; 2], radii: [f64; 2]) -> i32 {
    let first_from_second = RigidMap::between(poses[0], poses[1]);
    let center = first_from_second.translation;
    let [x, y] = [DVec3::X, DVec3::Y].map(|axis| radii[1] * first_from_second.apply_vector(axis));
    // The height over the first plane is center.z + swing cos(angle - phase).
    let swing = x.z.hypot(y.z);
    if center.z.abs() >= swing {
        return 0;
    }
    let (phase, half) = (y.z.atan2(x.z), (-center.z / swing).acos());
    let through = |angle: f64| {
        let p = center + angle.cos() * x + angle.sin() * y;
        i32::from(p.truncate().length() < radii[0])
    };
    // On the way from the highest point down, and up again.
    through(phase - half) - through(phase + half)
}

/// Puts the [`LinkLog`] in.
#[derive(Clone, Debug, Default)]
pub(crate) struct LinkPlugin {
    pub(crate) rings: Vec<Ring>,
}

impl Plugin for LinkPlugin {
    fn build(&self, app: &mut App) {
        let bodies = app.world().resource::<Bodies>();
        let mut rings: Vec<(BodyId, f64, Pose)> = self
            .rings
            .iter()
            .filter_map(|ring| {
                let id = bodies.find(&ring.body)?;
                let transform = app.world().get::<Transform>(bodies.get(id)?.entity)?;
                Some((id, ring.radius, pose_of(transform)))
            })
            .collect();
        rings.sort_unstable_by_key(|(id, ..)| *id);
        let log = LinkLog::of(&rings);
        if log.tracks.is_empty() {
            return;
        }
        app.insert_resource(log);
        for label in [CrannyStep.intern(), CrannyEnd.intern()] {
            app.add_systems(
                label,
                follow_links.in_set(StepSystems::Report).in_set(CoreSystems::Motion),
            );
        }
    }
}

fn follow_links(
    bodies: Res<Bodies>,
    transforms: Query<&Transform>,
    time: Res<SimulatedTime>,
    mut log: ResMut<LinkLog>,
) {
    let pose = |id: BodyId| transforms.get(bodies.get(id)?.entity).ok().map(pose_of);
    for LinkTrack { link, radii, number } in &mut log.tracks {
        let (Some(a), Some(b)) = (pose(link.a), pose(link.b)) else { continue };
        if link.parted.is_none() && linking_number([&a, &b], *radii) != *number {
            link.parted = Some(time.steps());
        }
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use cranny_exact::DQuat;

    use super::*;

    fn pose(turn: DVec3, at: DVec3) -> Pose {
        Pose { rotation: DQuat::from_scaled_axis(turn), translation: at }
    }

    #[test]
    fn links_and_neighbours_differ() {
        let upright = pose(0.25 * TAU * DVec3::X, DVec3::X);
        let number = |other: &Pose| linking_number([&Pose::IDENTITY, other], [1.0, 1.0]);
        assert_eq!(number(&upright).abs(), 1);
        assert_eq!(number(&pose(-0.25 * TAU * DVec3::X, DVec3::X)), -number(&upright));
        // Beside it, above it, tilted around it, and of the same plane.
        assert_eq!(number(&Pose { translation: 2.5 * DVec3::X, ..upright }), 0);
        assert_eq!(number(&Pose { translation: 1.5 * DVec3::Z, ..upright }), 0);
        assert_eq!(number(&pose(0.1 * DVec3::Y, DVec3::ZERO)), 0);
        assert_eq!(number(&Pose::at(0.5 * DVec3::X)), 0);
        // A large ring around a small one passes through nothing; both ways through is 0 as well.
        assert_eq!(linking_number([&Pose::IDENTITY, &upright], [1.0, 2.5]), 0);
        assert_eq!(linking_number([&Pose::at(DVec3::X), &upright], [1.5, 1.0]), 0);
    }

    #[test]
    fn the_number_does_not_depend_on_who_is_asked_first() {
        // Twelve in a closed chain, every other turned by a quarter about the chain.
        let link = |k: u32| {
            let along = f64::from(k) / 12.0 * TAU;
            let around = DQuat::from_axis_angle(DVec3::Y, along);
            let twist = DQuat::from_axis_angle(DVec3::Z, 0.25 * TAU * f64::from(k % 2));
            let flat = DQuat::from_axis_angle(DVec3::X, 0.25 * TAU);
            Pose { rotation: around * twist * flat, translation: around * (2.608 * DVec3::X) }
        };
        let rings: Vec<_> = (0..12).map(|k| (BodyId(k), 1.0, link(k))).collect();
        let found: Vec<_> = LinkLog::of(&rings).links().map(|l| (l.a.0, l.b.0)).collect();
        let mut expected: Vec<_> = (0..11).map(|k| (k, k + 1)).collect();
        expected.insert(1, (0, 11));
        assert_eq!(found, expected);
        for (a, b) in expected {
            let poses = [&link(a), &link(b)];
            let back = linking_number([poses[1], poses[0]], [1.0, 1.0]);
            assert_eq!(linking_number(poses, [1.0, 1.0]), back);
        }
    }
}
