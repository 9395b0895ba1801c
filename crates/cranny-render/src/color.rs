//! Colours as people write them: sRGB, eight bits a channel.

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

    /// This colour at an alpha over an opaque one, mixed in linear light as pictures are.
    #[must_use]
    pub fn over(self, behind: Self, alpha: u8) -> Self {
        let share = f32::from(alpha) / 255.0;
        let (front, back) = (self.to_linear(), behind.to_linear());
        let mixed = [0, 1, 2].map(|i: usize| back[i] + share * (front[i] - back[i]));
        Self::from_linear([mixed[0], mixed[1], mixed[2], 1.0])
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
}
