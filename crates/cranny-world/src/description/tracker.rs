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
    /// Poses a second, > 0 and at most a million.
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

const NOT_NEGATIVE: &str = "a finite number of at least 0";
/// Larger: a step waits for ever for the poses of one device; smaller: a real one is refused.
const GREATEST_RATE: f64 = 1e6;
const POSITIVE: &str = "a finite number greater than 0";

fn check(name: &'static str, value: f64, range: &'static str) -> Result<(), TrackerError> {
    let least = if range == POSITIVE { value > 0.0 } else { value >= 0.0 };
    let held = least && value.is_finite();
    held.then_some(()).ok_or(TrackerError::Number { name, value, range })
}

impl TrackerSettings {
    /// Whether all numbers are in range.
    ///
    /// # Errors
    ///
    /// [`TrackerError::Number`], [`TrackerError::ExtrapolatedLost`].
    pub fn check(&self) -> Result<(), TrackerError> {
        check("delay", self.delay, NOT_NEGATIVE)?;
        check("lost_after", self.lost_after, POSITIVE)?;
        check("extrapolate", self.extrapolate, NOT_NEGATIVE)?;
        let Self { extrapolate, lost_after, .. } = *self;
        if extrapolate > lost_after {
            return Err(TrackerError::ExtrapolatedLost { extrapolate, lost_after });
        }
        let Some(OneEuro { min_cutoff, per_speed }) = self.smoothing else { return Ok(()) };
        check("min_cutoff", min_cutoff, POSITIVE)?;
        check("per_speed", per_speed, NOT_NEGATIVE)
    }
}

impl SimulatedDevice {
    /// The age of its newest pose at most, seconds, where none is missing.
    #[must_use]
    pub fn greatest_age(&self) -> f64 {
        self.latency + self.latency_spread + 1.0 / self.rate
    }
}

impl TrackerDescription {
    /// Whether all numbers are in range and go together, in steps of so many seconds.
    ///
    /// # Errors
    ///
    /// [`TrackerError`].
    pub fn check(&self, step: f64) -> Result<(), TrackerError> {
        self.settings.check()?;
        let device = &self.device;
        check("rate", device.rate, POSITIVE)?;
        if device.rate > GREATEST_RATE {
            let range = "at most 1000000";
            return Err(TrackerError::Number { name: "rate", value: device.rate, range });
        }
        check("jitter", device.jitter, NOT_NEGATIVE)?;
        check("latency", device.latency, NOT_NEGATIVE)?;
        check("latency_spread", device.latency_spread, NOT_NEGATIVE)?;
        check("occlusions", device.occlusions, NOT_NEGATIVE)?;
        check("occluded_for", device.occluded_for, NOT_NEGATIVE)?;
        if !(0.0..=1.0).contains(&device.dropouts) {
            let range = "a number from 0 to 1";
            return Err(TrackerError::Number { name: "dropouts", value: device.dropouts, range });
        }
        // What is there as a step begins is shown at its end, and poses farther apart than the
        // limit are no motion, however long they are waited for.
        let age = device.greatest_age() + step - self.settings.delay;
        let (age, lost_after) = (age.max(1.0 / device.rate), self.settings.lost_after);
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
    fn what_would_take_for_ever_or_drift_while_lost_is_refused() {
        let fast = SimulatedDevice { rate: 1e300, ..DEVICE };
        let fast = checked(TrackerSettings::default(), fast, 1.0 / 60.0);
        assert!(fast.starts_with("`rate` is 1000") && fast.ends_with("at most 1000000"), "{fast}");
        let far = TrackerSettings { extrapolate: 0.2, ..TrackerSettings::default() };
        let far = checked(far, DEVICE, 1.0 / 60.0);
        assert!(far.starts_with("`extrapolate` is 0.2") && far.contains("lost after 0.1 s"));
    }
}
