//! Bodies that a device tracks: how its poses are taken, and a device that is simulated.

use thiserror::Error;

/// How a body takes the poses that a device reports.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TrackerSettings {
    /// How long it waits for poses that come late or out of order, seconds, >= 0: it is where it
    /// was so long ago. What comes later than that is left out.
    pub delay: f64,
    /// From which age of the newest pose on the body counts as lost, seconds, > 0.
    pub lost_after: f64,
    /// How long it moves on at the speed that it had where poses are missing, seconds, from 0 to
    /// `lost_after`; then it stays.
    pub extrapolate: f64,
    /// How poses are smoothed; `None`: they are taken as they come.
    pub smoothing: Option<OneEuro>,
}

impl Default for TrackerSettings {
    fn default() -> Self {
        Self { delay: 0.0, lost_after: 0.1, extrapolate: 0.0, smoothing: None }
    }
}

/// The 1 euro filter (Casiez, Roussel and Vogel, CHI 2012): a low pass whose cutoff rises with
/// speed, so that what is still does not shake and what is fast does not lag.
///
/// Its output is a mean of the poses that it got. So it shakes by no more than they do, and it
/// never overshoots, as filters that predict do: a hand that stops before a wall stays before it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OneEuro {
    /// Cutoff of a body at rest, hertz, > 0. Lower: it shakes less and lags more.
    pub min_cutoff: f64,
    /// By how much the cutoff rises with the speed of the body's fastest point, hertz a unit of
    /// length a second, >= 0.
    pub per_speed: f64,
}

/// A tracking device that is simulated: it measures a body on its path, and errs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SimulatedDevice {
    /// Poses a second, > 0; in a step and in the tracker's delay at most
    /// [`TrackerSettings::MOST_WAITING`].
    pub rate: f64,
    /// By how much it misplaces a point of the body at most, units of length, >= 0: a random share
    /// by moving the body, the rest by turning it about its origin.
    pub jitter: f64,
    /// Seconds from a measurement to its arrival at least, >= 0.
    pub latency: f64,
    /// By how much an arrival varies beyond that, seconds, >= 0. Poses that vary by more than their
    /// distance in time arrive out of order.
    pub latency_spread: f64,
    /// The share of poses that never arrive, from 0 to 1.
    pub dropouts: f64,
    /// How often a second the body is hidden from it, >= 0.
    pub occlusions: f64,
    /// How long each time, seconds, >= 0.
    pub occluded_for: f64,
    /// Of all that is left to chance.
    pub seed: u64,
}

/// How a body on a path is seen by a device.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TrackerDescription {
    /// How its poses are taken.
    pub settings: TrackerSettings,
    /// What measures it.
    pub device: SimulatedDevice,
}

/// Why a body cannot be tracked so.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum TrackerError {
    /// A number that is out of range.
    #[error("`{name}` is {value}, but must be {range}")]
    Number {
        /// Which.
        name: &'static str,
        /// What it is.
        value: f64,
        /// What it may be.
        range: &'static str,
    },
    /// A body that would move on while nobody knows where it is.
    #[error(
        "`extrapolate` is {extrapolate}, but the body counts as lost after {lost_after} s: lower it, or raise `lost_after`"
    )]
    ExtrapolatedLost {
        /// How long it would move.
        extrapolate: f64,
        /// The limit.
        lost_after: f64,
    },
    /// A device that measures more often than a tracker keeps poses.
    #[error(
        "`rate` is {rate}: up to {poses:.0} poses wait in a step and in `delay`, and no more than {most} may: lower `rate` or `delay`"
    )]
    TooManyWaiting {
        /// Poses a second.
        rate: f64,
        /// How many would wait.
        poses: f64,
        /// [`TrackerSettings::MOST_WAITING`].
        most: usize,
    },
    /// A device whose every pose is too old when it comes.
    #[error(
        "its poses are {age} s old before the next one is shown, and it counts as lost after {lost_after} s: raise `lost_after` or `delay`"
    )]
    AlwaysLost {
        /// The age at the end of a step, as the body is delayed.
        age: f64,
        /// The limit.
        lost_after: f64,
    },
}

fn number(
    name: &'static str,
    value: f64,
    range: &'static str,
    is_in_range: bool,
) -> Result<(), TrackerError> {
    is_in_range.then_some(()).ok_or(TrackerError::Number { name, value, range })
}

fn not_negative(name: &'static str, value: f64) -> Result<(), TrackerError> {
    number(name, value, "a finite number of at least 0", value >= 0.0 && value.is_finite())
}

fn positive(name: &'static str, value: f64) -> Result<(), TrackerError> {
    number(name, value, "a finite number greater than 0", value > 0.0 && value.is_finite())
}

impl TrackerSettings {
    /// How many poses wait for their time to come at most. More: a clock that is ahead fills
    /// memory; fewer: a device of 1 kHz cannot be delayed by seconds.
    pub const MOST_WAITING: usize = 4096;

    /// Whether all numbers are in range.
    ///
    /// # Errors
    ///
    /// [`TrackerError::Number`], [`TrackerError::ExtrapolatedLost`].
    pub fn check(&self) -> Result<(), TrackerError> {
        not_negative("delay", self.delay)?;
        positive("lost_after", self.lost_after)?;
        not_negative("extrapolate", self.extrapolate)?;
        let Self { extrapolate, lost_after, .. } = *self;
        if extrapolate > lost_after {
            return Err(TrackerError::ExtrapolatedLost { extrapolate, lost_after });
        }
        let Some(OneEuro { min_cutoff, per_speed }) = self.smoothing else { return Ok(()) };
        positive("min_cutoff", min_cutoff)?;
        not_negative("per_speed", per_speed)
    }
}

impl SimulatedDevice {
    /// The age of the pose that arrived last at most, seconds, where none is missing: one that
    /// takes longest, until the next that is measured after its arrival takes as long.
    #[must_use]
    pub fn greatest_age(&self) -> f64 {
        self.latency + 2.0 * self.latency_spread + 1.0 / self.rate
    }

    fn check(&self) -> Result<(), TrackerError> {
        positive("rate", self.rate)?;
        not_negative("jitter", self.jitter)?;
        not_negative("latency", self.latency)?;
        not_negative("latency_spread", self.latency_spread)?;
        let is_share = (0.0..=1.0).contains(&self.dropouts);
        number("dropouts", self.dropouts, "a number from 0 to 1", is_share)?;
        not_negative("occlusions", self.occlusions)?;
        not_negative("occluded_for", self.occluded_for)
    }
}

impl TrackerDescription {
    /// The age of the pose at which the body is shown at most, seconds, in steps of so many
    /// seconds, where none is missing: what is there as a step begins is shown at its end.
    #[must_use]
    pub fn greatest_age(&self, step: f64) -> f64 {
        self.settings.delay + self.age_beyond_delay(step)
    }

    /// By how much such a pose is older than the delay, at most.
    fn age_beyond_delay(&self, step: f64) -> f64 {
        let SimulatedDevice { rate, latency, latency_spread, .. } = self.device;
        (latency + latency_spread + step - self.settings.delay).max(0.0) + 1.0 / rate
    }

    /// Whether all numbers are in range and go together, in steps of so many seconds.
    ///
    /// # Errors
    ///
    /// [`TrackerError`].
    pub fn check(&self, step: f64) -> Result<(), TrackerError> {
        self.settings.check()?;
        self.device.check()?;
        let TrackerSettings { delay, lost_after, .. } = self.settings;
        let rate = self.device.rate;
        let (poses, most) = (rate * (delay + step), TrackerSettings::MOST_WAITING);
        if poses > most as f64 {
            return Err(TrackerError::TooManyWaiting { rate, poses, most });
        }
        // A body that is delayed counts as lost by the age beyond its delay.
        let age = self.age_beyond_delay(step);
        if age >= lost_after {
            return Err(TrackerError::AlwaysLost { age, lost_after });
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const DEVICE: SimulatedDevice = SimulatedDevice {
        rate: 240.0,
        jitter: 0.0,
        latency: 0.0,
        latency_spread: 0.0,
        dropouts: 0.0,
        occlusions: 0.0,
        occluded_for: 0.0,
        seed: 0,
    };

    fn checked(settings: TrackerSettings, device: SimulatedDevice, step: f64) -> String {
        let tracker = TrackerDescription { settings, device };
        tracker.check(step).map_or_else(|error| error.to_string(), |()| "well".to_owned())
    }

    #[test]
    fn a_step_ages_poses_too() {
        let settings = |delay| TrackerSettings { lost_after: 0.01, delay, ..Default::default() };
        assert_eq!(checked(settings(0.0), DEVICE, 1.0 / 240.0), "well");
        let lost = checked(settings(0.0), DEVICE, 1.0 / 60.0);
        assert!(lost.contains("lost after 0.01 s: raise `lost_after` or `delay`"), "{lost}");
        assert_eq!(checked(settings(0.02), DEVICE, 1.0 / 60.0), "well");
        let rare = checked(settings(1.0), SimulatedDevice { rate: 50.0, ..DEVICE }, 1.0 / 60.0);
        assert!(rare.contains("its poses are 0.02 s old"), "{rare}");
    }

    #[test]
    fn more_poses_than_may_wait_are_refused() {
        let at = |rate, delay| {
            let settings = TrackerSettings { delay, ..TrackerSettings::default() };
            checked(settings, SimulatedDevice { rate, ..DEVICE }, 1.0 / 64.0)
        };
        assert_eq!(at(4096.0, 63.0 / 64.0), "well");
        let waiting = at(4096.0, 1.0);
        assert_eq!(
            waiting,
            "`rate` is 4096: up to 4160 poses wait in a step and in `delay`, and no more than 4096 may: lower `rate` or `delay`"
        );
        assert!(at(1e300, 0.0).contains("no more than 4096"));
    }

    #[test]
    fn what_would_drift_while_lost_is_refused() {
        let far = TrackerSettings { extrapolate: 0.2, ..TrackerSettings::default() };
        let far = checked(far, DEVICE, 1.0 / 60.0);
        assert!(far.starts_with("`extrapolate` is 0.2") && far.contains("lost after 0.1 s"));
    }

    /// A tracker of which one field is the value.
    type Change = fn(&mut TrackerDescription, f64);

    const FIELDS: [(&str, Change); 12] = [
        ("delay", |tracker, value| tracker.settings.delay = value),
        ("lost_after", |tracker, value| tracker.settings.lost_after = value),
        ("extrapolate", |tracker, value| tracker.settings.extrapolate = value),
        ("min_cutoff", |tracker, value| smoothing(tracker).min_cutoff = value),
        ("per_speed", |tracker, value| smoothing(tracker).per_speed = value),
        ("rate", |tracker, value| tracker.device.rate = value),
        ("jitter", |tracker, value| tracker.device.jitter = value),
        ("latency", |tracker, value| tracker.device.latency = value),
        ("latency_spread", |tracker, value| tracker.device.latency_spread = value),
        ("dropouts", |tracker, value| tracker.device.dropouts = value),
        ("occlusions", |tracker, value| tracker.device.occlusions = value),
        ("occluded_for", |tracker, value| tracker.device.occluded_for = value),
    ];

    fn smoothing(tracker: &mut TrackerDescription) -> &mut OneEuro {
        tracker.settings.smoothing.get_or_insert(OneEuro { min_cutoff: 1.0, per_speed: 0.0 })
    }

    #[test]
    fn numbers_out_of_range_are_refused_by_name() {
        for (name, change) in FIELDS {
            for value in [-1.0, f64::NAN] {
                let mut tracker =
                    TrackerDescription { settings: TrackerSettings::default(), device: DEVICE };
                change(&mut tracker, value);
                let refused = tracker.check(1.0 / 60.0).unwrap_err().to_string();
                let expected = format!("`{name}` is {value}, but must be a");
                assert!(refused.starts_with(&expected), "{refused}");
            }
        }
    }
}
