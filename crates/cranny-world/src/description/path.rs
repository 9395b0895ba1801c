//! Keyframed motion: poses at times, and what lies between them.

use cranny_exact::{DQuat, Pose};
use thiserror::Error;

use super::keyframes::{Keyed, Keyframes, Span};

/// A pose at a time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Keyframe {
    /// Seconds since the path began, >= 0.
    pub time: f64,
    /// `world_from_body`.
    pub pose: Pose,
}

impl Keyed for Keyframe {
    fn time(&self) -> f64 {
        self.time
    }

    fn check(&self, index: usize) -> Result<(), PathError> {
        let checked = Pose::checked(self.pose.rotation, self.pose.translation);
        checked.map(|_| ()).map_err(|_| PathError::Pose { index })
    }
}

/// How a path gets from one keyframe to the next. Both ways pass through the same poses: the body's
/// origin moves along a straight line, and the rotation turns about one axis by at most half a
/// turn.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Interpolation {
    /// At constant linear and angular velocity.
    #[default]
    Linear,
    /// From rest to rest: the share `u` of the time is the share `3 u² - 2 u³` of the way.
    Eased,
}

/// What a path does after its last keyframe.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum PathEnd {
    /// It stays there.
    #[default]
    Hold,
    /// It begins again with the first keyframe. Where the two poses differ, the body jumps.
    Loop,
}

/// Why keyframes make no path.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum PathError {
    /// There are none.
    #[error("it has no keyframes: give at least one")]
    Empty,
    /// A time that is negative or no number.
    #[error("keyframe {index} is at {time} s: times are finite and at least 0")]
    Time {
        /// Which, from 0.
        index: usize,
        /// Its time.
        time: f64,
    },
    /// A time that is not after the one before.
    #[error("keyframe {index} is at {time} s, not after {before} s of the one before: times rise")]
    Order {
        /// Which, from 0.
        index: usize,
        /// Its time.
        time: f64,
        /// The time of the keyframe before.
        before: f64,
    },
    /// A rotation that is no unit quaternion.
    #[error("keyframe {index}: its rotation is no unit quaternion, or its place is not finite")]
    Pose {
        /// Which, from 0.
        index: usize,
    },
    /// A joint's position that is no number.
    #[error("keyframe {index}: its position {position} is not finite")]
    Position {
        /// Which, from 0.
        index: usize,
        /// Its position.
        position: f64,
    },
    /// A loop that takes no time.
    #[error("it loops, but its last keyframe is at 0 s: let it last longer, or hold")]
    NoLoop,
}

/// A path in the world. A kinematic body follows it and pushes away what it meets.
#[derive(Clone, Debug, PartialEq)]
pub struct KeyframedPath(Keyframes<Keyframe>);

impl KeyframedPath {
    /// A path through keyframes; before the first one it is there.
    ///
    /// # Errors
    ///
    /// [`PathError`]: no keyframe, times that do not rise, a pose that is none.
    pub fn new(
        keyframes: Vec<Keyframe>,
        interpolation: Interpolation,
        end: PathEnd,
    ) -> Result<Self, PathError> {
        Keyframes::new(keyframes, interpolation, end).map(Self)
    }

    /// The keyframes, times rising.
    #[must_use]
    pub fn keyframes(&self) -> &[Keyframe] {
        &self.0.list
    }

    /// How it gets from one to the next.
    #[must_use]
    pub fn interpolation(&self) -> Interpolation {
        self.0.interpolation
    }

    /// What it does after the last one.
    #[must_use]
    pub fn end(&self) -> PathEnd {
        self.0.end
    }

    /// Seconds to the last keyframe, or of one round.
    #[must_use]
    pub fn duration(&self) -> f64 {
        self.0.duration()
    }

    /// The pose at a time, seconds since the path began; a keyframe's own at the keyframe's time.
    #[must_use]
    pub fn pose_at(&self, seconds: f64) -> Pose {
        match self.0.span(seconds) {
            Span::At(keyframe) => keyframe.pose,
            Span::Between { from, to, of_time } => {
                between(&from.pose, &to.pose, self.0.interpolation.of_way(of_time))
            }
        }
    }

    /// Whether the path goes on from `before` to `after` (seconds) without a jump.
    #[must_use]
    pub fn is_continuous(&self, before: f64, after: f64) -> bool {
        let round = |seconds: f64| self.0.round_of(seconds).0;
        let closed = || self.0.first().pose == self.0.last().pose;
        self.0.end == PathEnd::Hold || round(before) == round(after) || closed()
    }
}

/// A share of the way from one pose to another.
fn between(from: &Pose, to: &Pose, share: f64) -> Pose {
    let rotation = turned(from.rotation, to.rotation, share);
    Pose { rotation, translation: from.translation.lerp(to.translation, share) }
}

/// After so many halvings of at most half a turn, the chord is the arc to rounding. Fewer: the
/// rotation does not turn evenly; more: nothing changes but the time.
const HALVINGS: u32 = 20;

/// A share of the shorter turn from one rotation to another, at constant rate, by halving the arc:
/// without sines, so that all machines agree.
fn turned(from: DQuat, to: DQuat, share: f64) -> DQuat {
    let unit = |q: DQuat| q * (1.0 / q.length());
    let to = if from.dot(to) < 0.0 { -to } else { to };
    let (mut ends, mut share) = ([from, to], share);
    for _ in 0..HALVINGS {
        let middle = unit(ends[0] + ends[1]);
        share *= 2.0;
        if share < 1.0 {
            ends[1] = middle;
        } else {
            ends[0] = middle;
            share -= 1.0;
        }
    }
    unit(ends[0] * (1.0 - share) + ends[1] * share)
}

#[cfg(test)]
mod tests {
    use cranny_exact::DVec3;

    use super::*;

    fn key(time: f64, x: f64, degrees: f64) -> Keyframe {
        let rotation = DQuat::from_rotation_z(degrees.to_radians());
        Keyframe { time, pose: Pose { rotation, translation: DVec3::X * x } }
    }

    fn path(keys: &[Keyframe], interpolation: Interpolation, end: PathEnd) -> KeyframedPath {
        KeyframedPath::new(keys.to_vec(), interpolation, end).unwrap()
    }

    fn turned(pose: &Pose) -> f64 {
        2.0 * pose.rotation.z.atan2(pose.rotation.w).to_degrees()
    }

    #[test]
    fn a_path_waits_goes_straight_and_holds() {
        let keys = [key(1.0, 2.0, 0.0), key(3.0, 6.0, 90.0)];
        let path = path(&keys, Interpolation::Linear, PathEnd::Hold);
        let x = |time: f64| path.pose_at(time).translation.x;
        assert_eq!([0.0, 1.0, 1.5, 2.0, 3.0, 99.0].map(x), [2.0, 2.0, 3.0, 4.0, 6.0, 6.0]);
        assert!((turned(&path.pose_at(1.5)) - 22.5).abs() < 1e-12);
        assert_eq!(path.pose_at(3.0), keys[1].pose);
    }

    #[test]
    fn an_eased_path_starts_and_ends_at_rest_and_is_as_far_half_way() {
        let keys = [key(0.0, 0.0, 0.0), key(2.0, 1.0, 0.0)];
        let path = path(&keys, Interpolation::Eased, PathEnd::Hold);
        let x = |time: f64| path.pose_at(time).translation.x;
        assert_eq!([x(0.0), x(1.0), x(2.0)], [0.0, 0.5, 1.0]);
        assert!(x(0.01) < 1e-4 && x(1.99) > 1.0 - 1e-4 && x(0.5) < 0.25);
    }

    /// Multiples of 0.1 s are not whole numbers of steps of 0.01 s to the last bit.
    #[test]
    fn no_step_that_goes_on_crosses_the_jump() {
        let keys = [key(0.0, 0.0, 0.0), key(0.1, 1.0, 0.0)];
        let path = path(&keys, Interpolation::Linear, PathEnd::Loop);
        let mut jumps = 0;
        for step in 0..2_000u32 {
            let [before, after] = [step, step + 1].map(|step| f64::from(step) * 0.01);
            let [from, to] = [before, after].map(|time| path.pose_at(time).translation.x);
            let goes_on = path.is_continuous(before, after);
            assert_eq!(goes_on, to > from, "{before}: {from} to {to}");
            jumps += usize::from(!goes_on);
        }
        assert!((199..=200).contains(&jumps), "{jumps}");
    }

    #[test]
    fn a_loop_begins_again_and_says_where_it_jumps() {
        let keys = [key(0.0, 0.0, 0.0), key(1.0, 1.0, 0.0), key(2.0, 0.5, 0.0)];
        let open = path(&keys, Interpolation::Linear, PathEnd::Loop);
        assert_eq!(open.pose_at(2.5), open.pose_at(0.5));
        assert!(open.is_continuous(0.1, 1.9) && !open.is_continuous(1.9, 2.1));
        let keys = [key(0.0, 0.0, 0.0), key(1.0, 1.0, 0.0), key(2.0, 0.0, 0.0)];
        assert!(path(&keys, Interpolation::Linear, PathEnd::Loop).is_continuous(1.9, 2.1));
        assert!(path(&keys, Interpolation::Linear, PathEnd::Hold).is_continuous(1.9, 2.1));
    }

    #[test]
    fn the_shorter_turn_is_taken() {
        let mut keys = [key(0.0, 0.0, 170.0), key(1.0, 0.0, 190.0)];
        keys[1].pose.rotation = -keys[1].pose.rotation;
        let path = path(&keys, Interpolation::Linear, PathEnd::Hold);
        assert!((turned(&path.pose_at(0.5)).abs() - 180.0).abs() < 1e-9);
    }

    #[test]
    fn keyframes_that_make_no_path_are_refused() {
        let new = |keys: &[Keyframe], end| {
            KeyframedPath::new(keys.to_vec(), Interpolation::Linear, end).unwrap_err()
        };
        assert_eq!(new(&[], PathEnd::Hold), PathError::Empty);
        assert_eq!(
            new(&[key(1.0, 0.0, 0.0), key(1.0, 1.0, 0.0)], PathEnd::Hold),
            PathError::Order { index: 1, time: 1.0, before: 1.0 }
        );
        assert_eq!(
            new(&[key(-1.0, 0.0, 0.0)], PathEnd::Hold),
            PathError::Time { index: 0, time: -1.0 }
        );
        assert_eq!(new(&[key(0.0, f64::NAN, 0.0)], PathEnd::Hold), PathError::Pose { index: 0 });
        assert_eq!(new(&[key(0.0, 0.0, 0.0)], PathEnd::Loop), PathError::NoLoop);
    }
}
