//! A page of pictures that explains itself: title, panels with their scales, legend, caption.

use crate::color::Color;
use crate::draw_list::round_length;
use crate::image::{Image, ImageError, ImageSize};
use crate::palette::{INK, PAPER};
use crate::ramp::Ramp;
use crate::text::{text_height, text_width};

/// A page: panels side by side, a title above, a legend and a caption below.
#[derive(Clone, Debug, Default)]
pub struct Sheet {
    /// The first line; empty for none.
    pub title: String,
    /// From left to right; all of the height of the first.
    pub panels: Vec<Panel>,
    /// What colours and marks mean.
    pub keys: Vec<Key>,
    /// Lines below.
    pub caption: Vec<String>,
}

/// A picture of a page.
#[derive(Clone, Debug)]
pub struct Panel {
    /// The picture.
    pub image: Image,
    /// Written in its corner; empty for nothing.
    pub title: String,
    /// Units of length a pixel, where the camera looks; `None` draws no scale bar.
    pub scale: Option<f64>,
}

/// An entry of a legend.
#[derive(Clone, Debug, PartialEq)]
pub struct Key {
    /// How it looks.
    pub mark: Mark,
    /// What it means.
    pub text: String,
}

/// How something looks in a picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Mark {
    /// A body.
    Body(Color),
    /// A body that is cut open.
    Hatched(Color),
    /// A line.
    Line(Color),
    /// An arrow.
    Arrow(Color),
    /// A scale of colours.
    Ramp(Ramp),
}

/// Pixels between panels, and around words.
const GAP: i32 = 6;
const TITLE: f32 = 19.0;
const WORDS: f32 = 14.0;
/// Pixels that a mark of the legend takes.
const MARK: [i32; 2] = [26, 12];
/// The most that a scale bar takes of a panel's width.
const BAR: f64 = 0.3;

impl Sheet {
    /// The page as one picture.
    ///
    /// # Errors
    ///
    /// [`ImageError::NoFrames`] without panels, [`ImageError::Mismatch`] where panels differ in
    /// height, [`ImageError::Size`] where the page would be too large.
    pub fn compose(&self) -> Result<Image, ImageError> {
        let first = self.panels.first().ok_or(ImageError::NoFrames)?.image.size();
        let odd = self.panels.iter().find(|p| p.image.size().height() != first.height());
        if let Some(odd) = odd {
            return Err(ImageError::Mismatch { left: first, right: odd.image.size() });
        }
        let widths: i32 = self.panels.iter().map(|p| p.image.size().width() as i32 + GAP).sum();
        let width = widths - GAP;
        let top = if self.title.is_empty() { 0 } else { line(TITLE) + GAP };
        let rows = self.legend_rows(width);
        let below = line(WORDS) * (rows.len() + self.caption.len()) as i32;
        let below = if below == 0 { 0 } else { below + 2 * GAP };
        let height = top + first.height() as i32 + below;
        let mut page = Image::filled(ImageSize::new(width as u32, height as u32)?, PAPER);
        page.write([GAP, GAP / 2], &self.title, TITLE, INK, None);
        self.place_panels(&mut page, top);
        let mut y = top + first.height() as i32 + GAP;
        for row in rows {
            let mut x = GAP;
            for key in row {
                x += key.draw(&mut page, [x, y]) + 2 * GAP;
            }
            y += line(WORDS);
        }
        for words in &self.caption {
            page.write([GAP, y], words, WORDS, INK, None);
            y += line(WORDS);
        }
        Ok(page)
    }

    fn place_panels(&self, page: &mut Image, top: i32) {
        let mut x = 0;
        for panel in &self.panels {
            let mut image = panel.image.clone();
            image.write([GAP, GAP], &panel.title, WORDS, INK, Some(PAPER));
            if let Some(scale) = panel.scale {
                draw_scale(&mut image, scale);
            }
            page.place(&image, x as u32, top as u32);
            x += image.size().width() as i32 + GAP;
        }
    }

    /// As many entries a row as fit.
    fn legend_rows(&self, width: i32) -> Vec<Vec<&Key>> {
        let mut rows: Vec<Vec<&Key>> = Vec::new();
        let mut room = 0;
        for key in &self.keys {
            let needed = key.width() + 2 * GAP;
            if needed > room || rows.is_empty() {
                rows.push(Vec::new());
                room = width - GAP;
            }
            room -= needed;
            if let Some(row) = rows.last_mut() {
                row.push(key);
            }
        }
        rows
    }
}

impl Key {
    /// An entry.
    #[must_use]
    pub fn new(mark: Mark, text: impl Into<String>) -> Self {
        Self { mark, text: text.into() }
    }

    fn width(&self) -> i32 {
        MARK[0] + GAP + text_width(&self.text, WORDS).ceil() as i32
    }

    /// Returns the width.
    fn draw(&self, page: &mut Image, [x, y]: [i32; 2]) -> i32 {
        let top = y + (line(WORDS) - MARK[1]) / 2 - 1;
        self.mark.draw(page, [x, top]);
        page.write([x + MARK[0] + GAP, y], &self.text, WORDS, INK, None);
        self.width()
    }
}

impl Mark {
    fn draw(self, page: &mut Image, [x, y]: [i32; 2]) {
        let [width, height] = MARK;
        let middle = y + height / 2;
        match self {
            Self::Body(color) => page.fill([x, y], MARK, color),
            Self::Hatched(color) => {
                page.fill([x, y], MARK, color);
                let dark = Color { r: color.r / 2, g: color.g / 2, b: color.b / 2, a: 255 };
                let lines = (0..width).flat_map(|dx| (0..height).map(move |dy| (dx, dy)));
                for (dx, dy) in lines.filter(|(dx, dy)| (dx + dy) % 6 == 0) {
                    page.blend([x + dx, y + dy], dark, 1.0);
                }
            }
            Self::Line(color) => page.fill([x, middle - 1], [width, 3], color),
            Self::Arrow(color) => {
                page.fill([x, middle - 1], [width - 8, 3], color);
                for i in 0..9 {
                    let half = (9 - i) / 2;
                    page.fill([x + width - 9 + i, middle - half], [1, 2 * half + 1], color);
                }
            }
            Self::Ramp(ramp) => {
                for dx in 0..width {
                    let share = f64::from(dx) / f64::from(width - 1);
                    page.fill([x + dx, y], [1, height], ramp.color(share));
                }
            }
        }
    }
}

/// Of a line of text, in pixels.
fn line(size: f32) -> i32 {
    text_height(size).ceil() as i32 + 2
}

/// A bar of a round length in the lower left corner, `scale` units a pixel.
fn draw_scale(image: &mut Image, scale: f64) {
    let (width, height) = (image.size().width(), image.size().height() as i32);
    let most = BAR * f64::from(width) * scale;
    if !most.is_normal() {
        return;
    }
    // The nearest round length may be longer than there is room for.
    let length = [0.62, 0.4].map(|part| round_length(part * most)).into_iter().find(|&l| l <= most);
    let Some(length) = length else { return };
    let pixels = (length / scale).round() as i32;
    let (x, y) = (2 * GAP, height - 2 * GAP);
    image.fill([x - 2, y - 6], [pixels + 4, 10], PAPER);
    image.fill([x, y - 2], [pixels, 3], INK);
    for end in [x, x + pixels - 1] {
        image.fill([end, y - 5], [1, 8], INK);
    }
    let unit = if length == 1.0 { "unit" } else { "units" };
    let words = format!("{} {unit}", round_number(length));
    image.write([x, y - 8 - line(WORDS)], &words, WORDS, INK, Some(PAPER));
}

/// A length of one digit, without the tail of its binary form.
fn round_number(length: f64) -> String {
    if (1e-4..1e6).contains(&length) {
        let text = format!("{length:.5}");
        text.trim_end_matches('0').trim_end_matches('.').to_owned()
    } else {
        format!("{length:.0e}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn panel(width: u32, height: u32, scale: Option<f64>) -> Panel {
        let image = Image::filled(ImageSize::new(width, height).unwrap(), Color::WHITE);
        Panel { image, title: String::new(), scale }
    }

    #[test]
    fn a_page_has_room_for_all_its_parts() {
        let mut sheet =
            Sheet { panels: vec![panel(200, 100, None), panel(80, 100, None)], ..Sheet::default() };
        assert_eq!(sheet.compose().unwrap().size(), ImageSize::new(286, 100).unwrap());
        sheet.title = "Cups".to_owned();
        let titled = sheet.compose().unwrap().size().height();
        assert!(titled > 115, "{titled}");
        sheet.keys = vec![Key::new(Mark::Line(OVERLAP), "a rather long name of a thing"); 3];
        let rows = sheet.legend_rows(286).len();
        assert_eq!(rows, 3);
        sheet.caption = vec!["one".to_owned(), "two".to_owned()];
        let all = sheet.compose().unwrap().size().height();
        assert!(all >= titled + 5 * 16, "{all}");
    }

    use crate::palette::OVERLAP;

    #[test]
    fn panels_must_match_and_be_there() {
        assert_eq!(Sheet::default().compose(), Err(ImageError::NoFrames));
        let panels = vec![panel(20, 30, None), panel(20, 31, None)];
        let error = Sheet { panels, ..Sheet::default() }.compose().unwrap_err();
        assert!(matches!(error, ImageError::Mismatch { .. }), "{error}");
    }

    #[test]
    fn a_scale_bar_is_as_long_as_it_says() {
        for (scale, pixels) in [(0.01, 50), (0.004, 50), (1e-7, 50), (3e5, 33)] {
            let mut image = panel(300, 100, None).image;
            draw_scale(&mut image, scale);
            let row = (0..300).filter(|&x| image.pixel(x, 87).is_some_and(|c| c == INK)).count();
            assert!(row.abs_diff(pixels) < 40 && row > 20, "{scale}: {row}");
            let length = row as f64 * scale;
            let digits = length / 10f64.powf(length.log10().floor());
            let round = [1.0, 2.0, 5.0, 10.0].map(|r: f64| (digits / r - 1.0).abs());
            assert!(round.iter().any(|&off| off < 0.03), "{scale}: {length}");
        }
        assert_eq!((round_number(0.5), round_number(20.0)), ("0.5".to_owned(), "20".to_owned()));
        assert_eq!(round_number(2e-9), "2e-9");
    }
}
