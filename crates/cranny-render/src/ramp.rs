//! Numbers as colours.

use crate::color::Color;
use crate::palette::COLD;

/// A scale of colours from 0 to 1 whose lightness falls all the way, so that it is read in grey and
/// by every eye.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Ramp {
    /// How deep bodies overlap: amber, red, dark red ('YlOrRd' of Brewer and Harrower 2003).
    Depth,
    /// How much was computed: pale, teal, dark blue ('YlGnBu').
    Heat,
}

const DEPTH: [Color; 5] = [
    Color::rgb(0xFE, 0xB2, 0x4C),
    Color::rgb(0xFD, 0x8D, 0x3C),
    Color::rgb(0xFC, 0x4E, 0x2A),
    Color::rgb(0xCB, 0x18, 0x1D),
    Color::rgb(0x6F, 0x00, 0x20),
];

const HEAT: [Color; 5] = [
    Color::rgb(0xED, 0xF3, 0xD0),
    Color::rgb(0xA1, 0xDA, 0xB4),
    Color::rgb(0x41, 0xB6, 0xC4),
    Color::rgb(0x22, 0x5E, 0xA8),
    Color::rgb(0x08, 0x1D, 0x58),
];

impl Ramp {
    /// The colour of a share; shares outside 0..=1 count as the nearer end.
    #[must_use]
    pub fn color(self, share: f64) -> Color {
        let stops = match self {
            Self::Depth => DEPTH,
            Self::Heat => HEAT,
        };
        let at = share.clamp(0.0, 1.0) as f32 * (stops.len() - 1) as f32;
        let below = (at.floor() as usize).min(stops.len() - 2);
        let mixed = |a: u8, b: u8| {
            let (a, b) = (f32::from(a), f32::from(b));
            (a + (b - a) * (at - below as f32)).round() as u8
        };
        let (a, b) = (stops[below], stops[below + 1]);
        Color::rgb(mixed(a.r, b.r), mixed(a.g, b.g), mixed(a.b, b.b))
    }

    /// The colour of a count, by its logarithm, from none to `most`: for counts of which a few are
    /// a hundred times as large as the others. [`COLD`](crate::palette::COLD) where it is 0.
    #[must_use]
    pub fn color_of_count(self, count: u64, most: u64) -> Color {
        let log = |count: u64| (count as f64).ln_1p();
        if count == 0 { COLD } else { self.color(log(count) / log(most)) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counts_have_colours_from_none_to_the_most() {
        assert_eq!(Ramp::Heat.color_of_count(0, 5), COLD);
        assert_eq!(Ramp::Heat.color_of_count(5, 5), Ramp::Heat.color(1.0));
        assert_ne!(Ramp::Heat.color_of_count(1, 5), Ramp::Heat.color_of_count(2, 5));
        assert_eq!(Ramp::Heat.color_of_count(1, 1), Ramp::Heat.color(1.0));
    }

    #[test]
    fn lightness_falls_all_the_way() {
        for ramp in [Ramp::Depth, Ramp::Heat] {
            let light = |share: f64| {
                let [r, g, b, _] = ramp.color(share).to_linear();
                0.2126 * r + 0.7152 * g + 0.0722 * b
            };
            for i in 0..100 {
                let (a, b) = (light(f64::from(i) / 100.0), light(f64::from(i + 1) / 100.0));
                assert!(b < a + 1e-3, "{ramp:?} at {i}: {a} {b}");
            }
            assert!(light(0.0) > 3.0 * light(1.0));
        }
        assert_eq!(Ramp::Depth.color(-1.0), Ramp::Depth.color(0.0));
        assert_eq!(Ramp::Depth.color(2.0), DEPTH[4]);
    }
}
