//! Colours as people write them (sRGB, eight bits), and a palette for bodies.

/// A colour in sRGB with straight (not premultiplied) alpha, eight bits a channel.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Color {
    /// Red.
    pub r: u8,
    /// Green.
    pub g: u8,
    /// Blue.
    pub b: u8,
    /// 0 is invisible, 255 opaque.
    pub a: u8,
}

impl Color {
    /// White, opaque.
    pub const WHITE: Self = Self::rgb(255, 255, 255);
    /// Black, opaque.
    pub const BLACK: Self = Self::rgb(0, 0, 0);

    /// An opaque colour.
    #[must_use]
    pub const fn rgb(r: u8, g: u8, b: u8) -> Self {
        Self { r, g, b, a: 255 }
    }

    /// The same colour with another alpha (255 is opaque).
    #[must_use]
    pub const fn with_alpha(self, a: u8) -> Self {
        Self { a, ..self }
    }

    /// Whether nothing behind it shows through.
    #[must_use]
    pub const fn is_opaque(self) -> bool {
        self.a == 255
    }

    /// Linear-light channels in 0..=1, alpha unchanged: what shaders and blending compute in.
    #[must_use]
    pub fn to_linear(self) -> [f32; 4] {
        let [r, g, b] = [self.r, self.g, self.b].map(linear_from_srgb);
        [r, g, b, f32::from(self.a) / 255.0]
    }

    /// The nearest colour to linear-light channels; values outside 0..=1 are clamped.
    #[must_use]
    pub fn from_linear([r, g, b, a]: [f32; 4]) -> Self {
        let [r, g, b] = [r, g, b].map(srgb_from_linear);
        Self { r, g, b, a: (a.clamp(0.0, 1.0) * 255.0).round() as u8 }
    }

    pub(crate) const fn to_bytes(self) -> [u8; 4] {
        [self.r, self.g, self.b, self.a]
    }
}

/// The sRGB transfer function (IEC 61966-2-1), decoding.
pub(crate) fn linear_from_srgb(encoded: u8) -> f32 {
    let c = f32::from(encoded) / 255.0;
    if c <= 0.04045 { c / 12.92 } else { ((c + 0.055) / 1.055).powf(2.4) }
}

/// The sRGB transfer function, encoding; clamps to 0..=1.
pub(crate) fn srgb_from_linear(linear: f32) -> u8 {
    let c = linear.clamp(0.0, 1.0);
    let encoded = if c <= 0.003_130_8 { c * 12.92 } else { 1.055 * c.powf(1.0 / 2.4) - 0.055 };
    (encoded * 255.0).round() as u8
}

/// Hue in degrees and lightness of the first eight palette colours: blue, orange, green, red,
/// violet, cyan, yellow, pink. Neighbours in this order are far apart, because bodies that touch
/// usually have neighbouring numbers.
const BASE: [(f32, f32); 8] = [
    (250.0, 0.62),
    (58.0, 0.72),
    (150.0, 0.68),
    (22.0, 0.58),
    (300.0, 0.60),
    (200.0, 0.74),
    (100.0, 0.85),
    (350.0, 0.72),
];

/// Colourfulness of the palette. Larger, and some hues leave sRGB and clip; smaller, and bodies
/// look grey under the hemispheric light.
const CHROMA: f32 = 0.135;

/// Turn and darkening of each further round through [`BASE`].
const NEXT_ROUND: (f32, f32) = (22.5, 0.11);

/// The colour of body number `index`: eight hues that are easy to tell apart, then the same eight
/// turned and darkened; repeats after 24.
///
/// The hues are equally colourful in OKLab (Ottosson 2020), so none shouts.
#[must_use]
pub fn palette(index: usize) -> Color {
    let (hue, lightness) = BASE[index % BASE.len()];
    let round = ((index / BASE.len()) % 3) as f32;
    let hue = (hue + round * NEXT_ROUND.0).to_radians();
    oklab(lightness - round * NEXT_ROUND.1, CHROMA * hue.cos(), CHROMA * hue.sin())
}

/// From OKLab to sRGB, with the matrices of Ottosson (2020).
fn oklab(lightness: f32, a: f32, b: f32) -> Color {
    let l = (lightness + 0.396_337_78 * a + 0.215_803_76 * b).powi(3);
    let m = (lightness - 0.105_561_346 * a - 0.063_854_17 * b).powi(3);
    let s = (lightness - 0.089_484_18 * a - 1.291_485_5 * b).powi(3);
    Color::from_linear([
        4.076_741_7 * l - 3.307_711_6 * m + 0.230_969_94 * s,
        -1.268_438 * l + 2.609_757_4 * m - 0.341_319_4 * s,
        -0.004_196_086_3 * l - 0.703_418_6 * m + 1.707_614_7 * s,
        1.0,
    ])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn srgb_survives_the_way_through_linear_light() {
        for value in 0..=255u8 {
            let color = Color { r: value, g: 255 - value, b: value / 2, a: value };
            assert_eq!(Color::from_linear(color.to_linear()), color);
        }
        assert_eq!(srgb_from_linear(7.0), 255);
        assert_eq!(srgb_from_linear(-7.0), 0);
        // Middle grey: 18 % of the light is code 118.
        assert_eq!(srgb_from_linear(0.18), 118);
    }

    #[test]
    fn oklab_white_and_grey_are_neutral() {
        assert_eq!(oklab(1.0, 0.0, 0.0), Color::WHITE);
        let grey = oklab(0.5, 0.0, 0.0);
        assert!(grey.r == grey.g && grey.g == grey.b && grey.r == 99, "{grey:?}");
    }

    #[test]
    fn palette_colours_can_be_told_apart() {
        let distance = |a: Color, b: Color| {
            let d = |x: u8, y: u8| (f32::from(x) - f32::from(y)).powi(2);
            (d(a.r, b.r) + d(a.g, b.g) + d(a.b, b.b)).sqrt()
        };
        for i in 0..24 {
            for j in 0..i {
                let (a, b) = (palette(i), palette(j));
                let least = if i < 8 { 50.0 } else { 18.0 };
                assert!(distance(a, b) > least, "{i} and {j}: {a:?} {b:?}");
            }
            let next = distance(palette(i), palette(i + 1));
            assert!(next > 80.0, "{i} and its neighbour: {next}");
        }
        assert_eq!(palette(3), palette(27));
    }
}
