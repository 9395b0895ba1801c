//! What a scene file says of a body that a device tracks.

use cranny_world::Random;
use cranny_world::description::{OneEuro, SimulatedDevice, TrackerDescription, TrackerSettings};
use serde::Deserialize;

use super::values::{Fraction, NotNegative, Positive};

/// How a body's poses are taken, and what measures them.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields, rename = "Tracker")]
pub(super) struct TrackerFile {
    #[serde(default)]
    delay: Option<NotNegative>,
    #[serde(default)]
    lost_after: Option<Positive>,
    #[serde(default)]
    extrapolate: Option<NotNegative>,
    #[serde(default)]
    smoothing: Option<OneEuroFile>,
    device: DeviceFile,
}

/// The 1 euro filter.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields, rename = "Smoothing")]
struct OneEuroFile {
    min_cutoff: Positive,
    #[serde(default = "nothing")]
    per_speed: NotNegative,
}

/// A device and its errors.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields, rename = "Device")]
struct DeviceFile {
    rate: Positive,
    #[serde(default = "nothing")]
    jitter: NotNegative,
    #[serde(default = "nothing")]
    latency: NotNegative,
    #[serde(default = "nothing")]
    latency_spread: NotNegative,
    #[serde(default = "no_share")]
    dropouts: Fraction,
    #[serde(default = "nothing")]
    occlusions: NotNegative,
    #[serde(default = "nothing")]
    occluded_for: NotNegative,
    /// Instead of one of the scene's and the body's name.
    #[serde(default)]
    seed: Option<u64>,
}

fn nothing() -> NotNegative {
    NotNegative(0.0)
}

fn no_share() -> Fraction {
    Fraction(0.0)
}

/// Of a body's own device: bodies of one scene do not err alike. FNV-1a of the name, mixed with the
/// scene's seed.
fn seed_of(body: &str, seed: u64) -> u64 {
    let mix = |hash: u64, byte| (hash ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3);
    let name = body.bytes().fold(0xcbf2_9ce4_8422_2325, mix);
    Random::new(name ^ Random::new(seed).bits()).bits()
}

impl TrackerFile {
    /// Of a body, in a scene of some seed.
    pub(super) fn description(&self, body: &str, seed: u64) -> TrackerDescription {
        let default = TrackerSettings::default();
        let smoothing = self.smoothing.map(|OneEuroFile { min_cutoff, per_speed }| OneEuro {
            min_cutoff: min_cutoff.0,
            per_speed: per_speed.0,
        });
        let settings = TrackerSettings {
            delay: self.delay.map_or(default.delay, |delay| delay.0),
            lost_after: self.lost_after.map_or(default.lost_after, |after| after.0),
            extrapolate: self.extrapolate.map_or(default.extrapolate, |time| time.0),
            smoothing,
        };
        let file = &self.device;
        let device = SimulatedDevice {
            rate: file.rate.0,
            jitter: file.jitter.0,
            latency: file.latency.0,
            latency_spread: file.latency_spread.0,
            dropouts: file.dropouts.0,
            occlusions: file.occlusions.0,
            occluded_for: file.occluded_for.0,
            seed: file.seed.unwrap_or_else(|| seed_of(body, seed)),
        };
        TrackerDescription { settings, device }
    }
}
