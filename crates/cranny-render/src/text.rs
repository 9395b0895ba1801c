//! Words in pictures, in one embedded font: the same on every machine.

use ab_glyph::{Font, FontRef, ScaleFont};

use crate::color::Color;
use crate::image::Image;

/// Roboto Medium: ASCII and signs of measurement (`fonts/README.md`).
const FONT: &[u8] = include_bytes!("../fonts/Roboto-Medium-ascii.ttf");

/// Pixels around letters that a halo covers. Smaller: letters drown in hatching; larger: they hide
/// what they name.
const HALO: i32 = 2;

/// Width of a line of text in pixels, `size` pixels high.
#[must_use]
pub fn text_width(text: &str, size: f32) -> f32 {
    let mut end = 0.0;
    layout(text, size, |_, x, advance| end = x + advance);
    end
}

/// From one line's top to the next one's, in pixels.
#[must_use]
pub fn text_height(size: f32) -> f32 {
    1.25 * size
}

/// Passes each glyph with where it stands and how wide it is. Characters that the font has not are
/// shown as its sign for those.
fn layout(text: &str, size: f32, mut each: impl FnMut(ab_glyph::Glyph, f32, f32)) {
    // Checked by `the_embedded_font_is_whole`; without it nothing would be written.
    let Ok(font) = FontRef::try_from_slice(FONT) else { return };
    let scaled = font.as_scaled(size);
    let (mut x, mut before) = (0.0, None);
    for letter in text.chars() {
        let id = scaled.glyph_id(letter);
        x += before.map_or(0.0, |before| scaled.kern(before, id));
        let at = ab_glyph::point(x, scaled.ascent());
        each(id.with_scale_and_position(size, at), x, scaled.h_advance(id));
        x += scaled.h_advance(id);
        before = Some(id);
    }
}

/// How much of each pixel letters cover, 0 to 1, in a box that has room for a halo.
struct Mask {
    width: i32,
    height: i32,
    covered: Vec<f32>,
}

impl Mask {
    fn of(text: &str, size: f32) -> Self {
        let width = text_width(text, size).ceil() as i32 + 2 * HALO + 1;
        let height = text_height(size).ceil() as i32 + 2 * HALO;
        let mut mask = Self { width, height, covered: vec![0.0; (width * height) as usize] };
        // Checked where the font is laid out.
        let Ok(font) = FontRef::try_from_slice(FONT) else { return mask };
        layout(text, size, |glyph, _, _| {
            let Some(outline) = font.outline_glyph(glyph) else { return };
            let corner = outline.px_bounds().min;
            outline.draw(|x, y, covered| {
                mask.add(
                    corner.x as i32 + x as i32 + HALO,
                    corner.y as i32 + y as i32 + HALO,
                    covered,
                );
            });
        });
        mask
    }

    fn add(&mut self, x: i32, y: i32, covered: f32) {
        if (0..self.width).contains(&x) && (0..self.height).contains(&y) {
            let pixel = &mut self.covered[(y * self.width + x) as usize];
            *pixel = (*pixel + covered).min(1.0);
        }
    }

    fn at(&self, x: i32, y: i32) -> f32 {
        let inside = (0..self.width).contains(&x) && (0..self.height).contains(&y);
        if inside { self.covered[(y * self.width + x) as usize] } else { 0.0 }
    }

    /// The most that is covered within a halo of a pixel.
    fn around(&self, x: i32, y: i32) -> f32 {
        let round = (-HALO..=HALO).flat_map(|dy| (-HALO..=HALO).map(move |dx| (dx, dy)));
        round
            .filter(|(dx, dy)| dx * dx + dy * dy <= HALO * HALO + 1)
            .map(|(dx, dy)| self.at(x + dx, y + dy))
            .fold(0.0, f32::max)
    }
}

impl Image {
    /// Writes a line of text, its top left corner at a pixel. A halo sets it off from what is
    /// behind. What lies outside the picture is left out.
    pub fn write(
        &mut self,
        [x, y]: [i32; 2],
        text: &str,
        size: f32,
        color: Color,
        halo: Option<Color>,
    ) {
        let mask = Mask::of(text, size);
        let pixels = (0..mask.height).flat_map(|my| (0..mask.width).map(move |mx| (mx, my)));
        for (mx, my) in pixels {
            let at = [x + mx - HALO, y + my - HALO];
            if let Some(halo) = halo {
                self.blend(at, halo, 0.85 * mask.around(mx, my));
            }
            self.blend(at, color, mask.at(mx, my));
        }
    }

    /// Fills a rectangle: its top left corner, width and height in pixels.
    pub fn fill(&mut self, [x, y]: [i32; 2], [width, height]: [i32; 2], color: Color) {
        let cells = (0..height.max(0)).flat_map(|dy| (0..width.max(0)).map(move |dx| (dx, dy)));
        for (dx, dy) in cells {
            self.blend([x + dx, y + dy], color, 1.0);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::ImageSize;

    #[test]
    fn the_embedded_font_is_whole() {
        let font = FontRef::try_from_slice(FONT).unwrap();
        let signs = (' '..='~').chain("°±²³µ·×–…−≤≥".chars());
        for letter in signs {
            assert_ne!(font.glyph_id(letter).0, 0, "{letter}");
        }
    }

    #[test]
    fn width_grows_with_text_and_size() {
        assert_eq!(text_width("", 12.0), 0.0);
        assert!(text_width("iii", 12.0) < text_width("mmm", 12.0));
        let (small, large) = (text_width("depth", 10.0), text_width("depth", 20.0));
        assert!((large - 2.0 * small).abs() < 0.5, "{small} {large}");
    }

    #[test]
    fn letters_are_where_they_were_put_and_nowhere_else() {
        let size = ImageSize::new(60, 40).unwrap();
        let mut image = Image::filled(size, Color::WHITE);
        image.write([20, 10], "H", 16.0, Color::BLACK, None);
        let dark = |x: u32, y: u32| image.pixel(x, y).unwrap().r < 128;
        let all: Vec<(u32, u32)> = (0..40)
            .flat_map(|y| (0..60).map(move |x| (x, y)))
            .filter(|&(x, y)| dark(x, y))
            .collect();
        assert!(all.len() > 20, "{all:?}");
        assert!(
            all.iter().all(|&(x, y)| (20..33).contains(&x) && (10..30).contains(&y)),
            "{all:?}"
        );
    }

    #[test]
    fn a_halo_covers_what_is_behind_letters_and_text_may_leave_the_picture() {
        let size = ImageSize::new(40, 30).unwrap();
        let mut image = Image::filled(size, Color::BLACK);
        image.write([5, 5], "l", 16.0, Color::BLACK, Some(Color::WHITE));
        assert!(image.pixels().chunks_exact(4).any(|p| p[0] > 200));
        let before = image.clone();
        image.write([-500, 4], "out", 16.0, Color::WHITE, Some(Color::WHITE));
        image.write([4, 900], "out", 16.0, Color::WHITE, None);
        assert_eq!(image, before);
    }
}
