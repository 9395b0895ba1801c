//! Keyframed targets of a joint's motor.

use super::keyframes::{Keyed, Keyframes, Span};
use super::{Interpolation, PathEnd, PathError};

/// A joint's position at a time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MotorKeyframe {
    /// Seconds since the path began, >= 0.
    pub time: f64,
    /// Radians, or units of length.
    pub position: f64,
}

impl Keyed for MotorKeyframe {
    fn time(&self) -> f64 {
        self.time
    }

    fn check(&self, index: usize) -> Result<(), PathError> {
        let MotorKeyframe { position, .. } = *self;
        if position.is_finite() { Ok(()) } else { Err(PathError::Position { index, position }) }
    }
}

/// Where a motor leads its joint over time.
#[derive(Clone, Debug, PartialEq)]
pub struct MotorPath(Keyframes<MotorKeyframe>);

impl MotorPath {
    /// A path through keyframes; before the first one it waits there.
    ///
    /// # Errors
    ///
    /// [`PathError`]: no keyframe, times that do not rise, a position that is not finite.
    pub fn new(
        keyframes: Vec<MotorKeyframe>,
        interpolation: Interpolation,
        end: PathEnd,
    ) -> Result<Self, PathError> {
        Keyframes::new(keyframes, interpolation, end).map(Self)
    }

    /// The keyframes, times rising.
    #[must_use]
    pub fn keyframes(&self) -> &[MotorKeyframe] {
        &self.0.list
    }

    /// Seconds to the last keyframe, or of one round.
    #[must_use]
    pub fn duration(&self) -> f64 {
        self.0.duration()
    }

    /// The position at a time, seconds since the path began.
    #[must_use]
    pub fn position_at(&self, seconds: f64) -> f64 {
        match self.0.span(seconds) {
            Span::At(keyframe) => keyframe.position,
            Span::Between { from, to, of_time } => {
                let share = self.0.interpolation.of_way(of_time);
                from.position + share * (to.position - from.position)
            }
        }
    }

    /// The velocity at a time; 0 at a keyframe and where the path waits.
    #[must_use]
    pub fn velocity_at(&self, seconds: f64) -> f64 {
        match self.0.span(seconds) {
            Span::At(_) => 0.0,
            Span::Between { from, to, of_time } => {
                self.0.interpolation.pace(of_time) * slope(&from, &to)
            }
        }
    }

    /// The first keyframe that the path leaves the fastest, by index, and that speed; `None` where
    /// it stays at one position.
    #[must_use]
    pub fn fastest(&self) -> Option<(usize, f64)> {
        let speeds = self.0.list.windows(2).map(|two| slope(&two[0], &two[1]).abs());
        let moving = speeds.enumerate().filter(|(_, speed)| *speed > 0.0);
        let fastest = moving.reduce(|best, next| if next.1 > best.1 { next } else { best });
        fastest.map(|(index, speed)| (index, self.0.interpolation.greatest_pace() * speed))
    }
}

/// Mean velocity between two keyframes.
fn slope(from: &MotorKeyframe, to: &MotorKeyframe) -> f64 {
    (to.position - from.position) / (to.time - from.time)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn path(keys: &[(f64, f64)], interpolation: Interpolation, end: PathEnd) -> MotorPath {
        let keys = keys.iter().map(|&(time, position)| MotorKeyframe { time, position });
        MotorPath::new(keys.collect(), interpolation, end).unwrap()
    }

    #[test]
    fn a_motor_path_waits_goes_straight_and_holds() {
        let path = path(&[(1.0, 2.0), (3.0, 6.0)], Interpolation::Linear, PathEnd::Hold);
        assert_eq!(
            [0.0, 1.0, 1.5, 3.0, 9.0].map(|t| path.position_at(t)),
            [2.0, 2.0, 3.0, 6.0, 6.0]
        );
        assert_eq!([0.0, 1.5, 9.0].map(|t| path.velocity_at(t)), [0.0, 2.0, 0.0]);
        assert_eq!(path.fastest(), Some((0, 2.0)));
    }

    #[test]
    fn an_eased_motor_path_is_fastest_half_way_and_a_loop_begins_again() {
        let keys = [(0.0, 0.0), (1.0, 0.5), (3.0, -3.5)];
        let path = path(&keys, Interpolation::Eased, PathEnd::Loop);
        assert_eq!((path.position_at(2.0), path.velocity_at(2.0)), (-1.5, -3.0));
        assert_eq!((path.position_at(5.0), path.fastest()), (-1.5, Some((1, 3.0))));
        // The velocity is the derivative of the position.
        let step = 1e-6;
        let slope = (path.position_at(0.3 + step) - path.position_at(0.3 - step)) / (2.0 * step);
        assert!((slope - path.velocity_at(0.3)).abs() < 1e-8, "{slope}");
    }

    #[test]
    fn a_position_that_is_not_finite_is_refused() {
        let keys = vec![MotorKeyframe { time: 0.0, position: f64::INFINITY }];
        let refused = MotorPath::new(keys, Interpolation::Linear, PathEnd::Hold).unwrap_err();
        assert_eq!(refused, PathError::Position { index: 0, position: f64::INFINITY });
    }
}
