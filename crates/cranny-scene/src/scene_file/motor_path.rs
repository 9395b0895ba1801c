//! Motors of joints, and paths along which they lead.

use std::sync::Arc;

use cranny_world::description::{Motor, MotorPath};

use super::body_syntax::MotorPathFile;
use super::syntax::MotorFile;

/// Greatest velocity of a motor on a path, where none is stated, beside that of its path. Smaller:
/// a joint that was held back never catches up; larger: it does so with a jerk.
const CATCHES_UP: f64 = 2.0;

/// What is to lead a joint: where its motor pulls, and where it goes over time.
pub(super) struct Drive<'a> {
    pub(super) motor: Option<&'a MotorFile>,
    pub(super) target: Option<f64>,
    pub(super) path: Option<&'a MotorPathFile>,
}

impl Drive<'_> {
    /// The path of a joint with these limits, if it has one.
    ///
    /// # Errors
    ///
    /// A path beside another position, or one that leaves the limits.
    pub(super) fn path(&self, limits: Option<[f64; 2]>) -> Result<Option<Arc<MotorPath>>, String> {
        let Some(file) = self.path else { return Ok(None) };
        if let Some(other) = self.beside_path() {
            return Err(format!("it has a path and {other}. Keep one of the two"));
        }
        let path = file.path().map_err(|why| format!("its path: {why}"))?;
        let within = |at: f64| limits.is_none_or(|[low, high]| (low..=high).contains(&at));
        let outside = path.keyframes().iter().find(|keyframe| !within(keyframe.position));
        if let Some((outside, [low, high])) = outside.zip(limits) {
            return Err(format!(
                "its path is at {} at {} s, outside its limits, {low} to {high}. Correct the keyframe",
                outside.position, outside.time
            ));
        }
        Ok(Some(Arc::new(path)))
    }

    /// Fails if a motor leads to a position outside the joint's limits, or to two.
    ///
    /// # Errors
    ///
    /// The position and what it contradicts, in words.
    pub(super) fn check_position(&self, limits: Option<[f64; 2]>) -> Result<(), String> {
        let of_motor = self.motor.and_then(|motor| motor.position).map(|position| position.0);
        if let Some((target, position)) = self.target.zip(of_motor)
            && target != position
        {
            return Err(format!(
                "its target is {target}, but the position of its motor is {position}. Keep one of the two"
            ));
        }
        let stated = [("target", self.target), ("motor's position", of_motor)];
        let outside = stated.into_iter().find_map(|(what, at)| {
            let (at, [low, high]) = at.zip(limits)?;
            (!(low..=high).contains(&at)).then(|| {
                format!(
                    "its {what} is {at}, outside its limits, {low} to {high}. Correct it or the limits"
                )
            })
        });
        outside.map_or(Ok(()), Err)
    }

    /// What says where the joint goes beside a path.
    fn beside_path(&self) -> Option<&'static str> {
        let motor = self.motor.copied().unwrap_or_default();
        let of_motor = motor.position.map(|_| "a position of its motor");
        let turning = (motor.velocity.0 != 0.0).then_some("a velocity of its motor");
        self.target.map(|_| "a target").or(of_motor).or(turning)
    }

    /// The motor, within limits where the scene says none; `held`: where it holds the joint if
    /// nothing else says where.
    pub(super) fn motor(
        &self,
        limited: Motor,
        path: Option<&MotorPath>,
        held: Option<f64>,
    ) -> Option<Motor> {
        let target = path.map(|path| path.position_at(0.0)).or(self.target);
        let mut motor = match self.motor {
            Some(said) => said.motor(target, limited),
            None => Motor { position: Some(target.or(held)?), ..limited },
        };
        if motor.stiffness.is_none() && motor.max_velocity.is_none() {
            let fastest = path.and_then(MotorPath::fastest);
            motor.max_velocity = fastest.map(|(_, speed)| CATCHES_UP * speed);
        }
        Some(motor)
    }
}

/// What is to be known of a path that is faster than its joint may be.
pub(super) fn too_fast(path: &MotorPath, most: Option<f64>) -> Option<String> {
    let ((keyframe, speed), most) = path.fastest().zip(most)?;
    let time = path.keyframes()[keyframe].time;
    (speed > most).then(|| {
        format!("its path asks for a velocity of {speed} after {time} s, but {most} is its greatest: it lags behind. Give it more time, or a motor with a greater `max_velocity`")
    })
}

impl MotorFile {
    /// The motor that is said, within limits where it says none.
    fn motor(&self, target: Option<f64>, limited: Motor) -> Motor {
        Motor {
            position: self.position.map(|position| position.0).or(target),
            velocity: self.velocity.0,
            effort: self.effort.0,
            stiffness: self.stiffness.map(|stiffness| stiffness.0),
            damping: self.damping.map(|damping| damping.0),
            max_effort: self.max_effort.map(|most| most.0).or(limited.max_effort),
            max_velocity: self.max_velocity.map(|most| most.0).or(limited.max_velocity),
        }
    }
}
