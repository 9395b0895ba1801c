//! Motions of a body near another one, from frame to frame.

use cranny_exact::{DQuat, DVec3, Pose};

use crate::random::Rng;

/// How far a body goes in a frame, as shares of its reach, and how far it turns, in radians. The
/// slowest rest but for rounding; faster ones than the fastest are jumps.
const PACES: [f64; 4] = [1e-9, 1e-4, 1e-3, 1e-2];

/// A walk that keeps near a first body at the origin: it drifts, turns, rests, turns back and
/// jumps.
#[derive(Clone, Copy, Debug)]
pub struct Walk {
    /// Where the second body is: first_from_second.
    pub pose: Pose,
    drift: DVec3,
    spin: DQuat,
}

impl Walk {
    /// A walk that begins within `reach` of the origin: the sum of the bodies' radii.
    pub fn new(rng: &mut Rng, reach: f64) -> Self {
        let far = [0.05, 0.5, 0.8, 0.8][rng.below(4)] * reach;
        let pose = Pose { rotation: DQuat::IDENTITY, translation: far * rng.direction() };
        let mut walk = Self { pose, drift: DVec3::ZERO, spin: DQuat::IDENTITY };
        walk.turn(rng, reach);
        walk
    }

    fn turn(&mut self, rng: &mut Rng, reach: f64) {
        let pace = PACES[rng.below(4)];
        let home = self.pose.translation.length() > 0.9 * reach;
        let way = if home { -self.pose.translation.normalize() } else { rng.direction() };
        self.drift = pace * reach * way;
        self.spin = DQuat::from_axis_angle(rng.direction(), pace);
    }

    /// Goes on by a frame.
    pub fn step(&mut self, rng: &mut Rng, reach: f64) {
        match rng.below(40) {
            0 => *self = Self::new(rng, reach),
            1 => (self.drift, self.spin) = (-self.drift, self.spin.conjugate()),
            2 => (self.drift, self.spin) = (DVec3::ZERO, DQuat::IDENTITY),
            3..=5 => self.turn(rng, reach),
            _ => {}
        }
        self.pose.translation += self.drift;
        self.pose.rotation = (self.spin * self.pose.rotation).normalize();
    }
}
