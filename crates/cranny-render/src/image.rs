//! Pictures in memory: size, pixels, scaling, contact sheets and comparison.

use thiserror::Error;

use crate::color::{Color, linear_from_srgb, srgb_from_linear};

/// Width and height of a picture in pixels, each from 1 to [`MAX_SIDE`](Self::MAX_SIDE).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct ImageSize {
    width: u32,
    height: u32,
}

/// A picture that cannot be made.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum ImageError {
    /// A side of 0 pixels, or too many.
    #[error(
        "an image of {width} x {height} pixels: each side must have 1 to {} pixels",
        ImageSize::MAX_SIDE
    )]
    Size {
        /// The width.
        width: u32,
        /// The height.
        height: u32,
    },
    /// Not four bytes a pixel.
    #[error("{found} bytes were given for an image that has {expected}")]
    PixelCount {
        /// Bytes given.
        found: usize,
        /// Bytes needed: 4 x width x height.
        expected: usize,
    },
    /// Two pictures that must have the same size have not.
    #[error("images of different size: {left} and {right}")]
    Mismatch {
        /// Of the first.
        left: ImageSize,
        /// Of the other.
        right: ImageSize,
    },
    /// A sheet of no frames, or of no columns.
    #[error("a contact sheet needs at least one frame and one column")]
    NoFrames,
}

impl ImageSize {
    /// The longest accepted side. Longer ones exceed what adapters draw at once.
    pub const MAX_SIDE: u32 = 16_384;

    /// A size in pixels.
    ///
    /// # Errors
    ///
    /// [`ImageError::Size`] where a side is 0 or longer than [`MAX_SIDE`](Self::MAX_SIDE).
    pub fn new(width: u32, height: u32) -> Result<Self, ImageError> {
        let valid = 1..=Self::MAX_SIDE;
        if valid.contains(&width) && valid.contains(&height) {
            Ok(Self { width, height })
        } else {
            Err(ImageError::Size { width, height })
        }
    }

    /// Pixels from left to right.
    #[must_use]
    pub fn width(self) -> u32 {
        self.width
    }

    /// Pixels from top to bottom.
    #[must_use]
    pub fn height(self) -> u32 {
        self.height
    }

    /// Width divided by height.
    #[must_use]
    pub fn aspect(self) -> f64 {
        f64::from(self.width) / f64::from(self.height)
    }

    /// Number of pixels.
    #[must_use]
    pub fn pixel_count(self) -> usize {
        self.width as usize * self.height as usize
    }
}

impl std::fmt::Display for ImageSize {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{} x {} pixels", self.width, self.height)
    }
}

/// A picture: rows from top to bottom, pixels from left to right, sRGB with alpha.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Image {
    size: ImageSize,
    pixels: Vec<u8>,
}

/// How far two pictures differ.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Difference {
    /// Mean of the absolute differences over all channels, in steps of 0..=255.
    pub mean_error: f64,
    /// Fraction (0..=1) of the pixels that differ by more than the threshold in some channel.
    pub differing: f64,
}

impl Image {
    /// A picture from its pixels: red, green, blue and alpha in a byte each.
    ///
    /// # Errors
    ///
    /// [`ImageError::PixelCount`] where there are not exactly four bytes a pixel.
    pub fn from_pixels(size: ImageSize, pixels: Vec<u8>) -> Result<Self, ImageError> {
        let expected = 4 * size.pixel_count();
        if pixels.len() == expected {
            Ok(Self { size, pixels })
        } else {
            Err(ImageError::PixelCount { found: pixels.len(), expected })
        }
    }

    /// A picture of one colour.
    #[must_use]
    pub fn filled(size: ImageSize, color: Color) -> Self {
        Self { size, pixels: color.to_bytes().repeat(size.pixel_count()) }
    }

    /// Width and height.
    #[must_use]
    pub fn size(&self) -> ImageSize {
        self.size
    }

    /// Four bytes a pixel, row by row from the top.
    #[must_use]
    pub fn pixels(&self) -> &[u8] {
        &self.pixels
    }

    /// The pixel in column `x` and row `y`, counted from the top left; `None` outside.
    #[must_use]
    pub fn pixel(&self, x: u32, y: u32) -> Option<Color> {
        if x >= self.size.width || y >= self.size.height {
            return None;
        }
        let at = 4 * (y as usize * self.size.width as usize + x as usize);
        let [r, g, b, a] = self.pixels[at..at + 4].try_into().ok()?;
        Some(Color { r, g, b, a })
    }

    /// Lays a colour over a pixel, as much of it as `share` (0 to 1) says beside its alpha; nothing
    /// outside the picture.
    pub(crate) fn blend(&mut self, [x, y]: [i32; 2], color: Color, share: f32) {
        let (Ok(x), Ok(y)) = (u32::try_from(x), u32::try_from(y)) else { return };
        if x >= self.size.width || y >= self.size.height || share <= 0.0 {
            return;
        }
        let at = 4 * (y as usize * self.size.width as usize + x as usize);
        let share = (share * f32::from(color.a) / 255.0).min(1.0);
        for (below, above) in self.pixels[at..at + 3].iter_mut().zip([color.r, color.g, color.b]) {
            let mixed = f32::from(*below) + share * (f32::from(above) - f32::from(*below));
            *below = mixed.round() as u8;
        }
    }

    /// How far `other` differs; pixels count as differing where a channel is more than `threshold`
    /// apart. Graphics drivers round and sample differently, so the same draw list gives pictures
    /// that are close, not equal.
    ///
    /// # Errors
    ///
    /// [`ImageError::Mismatch`] where the sizes differ.
    pub fn difference(&self, other: &Self, threshold: u8) -> Result<Difference, ImageError> {
        if self.size != other.size {
            return Err(ImageError::Mismatch { left: self.size, right: other.size });
        }
        let (mut total, mut differing) = (0u64, 0u64);
        for (a, b) in self.pixels.chunks_exact(4).zip(other.pixels.chunks_exact(4)) {
            let errors = a.iter().zip(b).map(|(a, b)| a.abs_diff(*b));
            differing += u64::from(errors.clone().any(|e| e > threshold));
            total += errors.map(u64::from).sum::<u64>();
        }
        let pixels = self.size.pixel_count() as f64;
        let mean_error = total as f64 / (4.0 * pixels);
        Ok(Difference { mean_error, differing: differing as f64 / pixels })
    }

    /// The picture scaled down to the given width (1 at least), its proportions kept; each new
    /// pixel is the mean of the light that falls on it. A picture that is not wider is returned as
    /// it is.
    #[must_use]
    pub fn scaled_down(&self, width: u32) -> Self {
        let width = width.max(1);
        if width >= self.size.width {
            return self.clone();
        }
        let ratio = f64::from(width) / f64::from(self.size.width);
        let height = ((f64::from(self.size.height) * ratio).round() as u32).max(1);
        let decode: [f32; 256] = std::array::from_fn(|i| linear_from_srgb(i as u8));
        let columns = coverage(self.size.width, width);
        let rows = coverage(self.size.height, height);
        let stride = 4 * self.size.width as usize;
        let mut pixels = Vec::with_capacity(4 * width as usize * height as usize);
        for row in &rows {
            // One row of the result, still at full width, in linear light.
            let mut light = vec![0.0f32; stride];
            for &(y, weight) in row {
                let source = &self.pixels[y * stride..(y + 1) * stride];
                for (i, (sum, &byte)) in light.iter_mut().zip(source).enumerate() {
                    let value = if i % 4 == 3 { f32::from(byte) } else { decode[byte as usize] };
                    *sum += weight * value;
                }
            }
            for column in &columns {
                let channel = |c: usize| -> f32 {
                    column.iter().map(|&(x, weight)| weight * light[4 * x + c]).sum()
                };
                pixels.extend([0, 1, 2].map(|c| srgb_from_linear(channel(c))));
                pixels.push(channel(3).round() as u8);
            }
        }
        Self { size: ImageSize { width, height }, pixels }
    }

    /// The picture in the upper left corner of one of another size, cut off or filled up.
    #[must_use]
    pub fn on_canvas(&self, size: ImageSize, background: Color) -> Self {
        if size == self.size {
            return self.clone();
        }
        let mut canvas = Self::filled(size, background);
        let bytes = 4 * size.width.min(self.size.width) as usize;
        let rows = self.pixels.chunks_exact(4 * self.size.width as usize);
        let places = canvas.pixels.chunks_exact_mut(4 * size.width as usize);
        places.zip(rows).for_each(|(to, from)| to[..bytes].copy_from_slice(&from[..bytes]));
        canvas
    }

    /// Copies `tile` to column `x`, row `y`; it must fit.
    pub(crate) fn place(&mut self, tile: &Self, x: u32, y: u32) {
        let bytes = 4 * tile.size.width as usize;
        for (row, source) in tile.pixels.chunks_exact(bytes).enumerate() {
            let at = (y as usize + row) * self.size.width as usize + x as usize;
            self.pixels[4 * at..4 * at + bytes].copy_from_slice(source);
        }
    }
}

/// For each of `to` cells, which of `from` smaller cells it covers, with weights that sum to 1.
fn coverage(from: u32, to: u32) -> Vec<Vec<(usize, f32)>> {
    let step = f64::from(from) / f64::from(to);
    (0..to)
        .map(|i| {
            let (start, end) = (f64::from(i) * step, f64::from(i + 1) * step);
            let cells = start.floor() as usize..(end.ceil() as usize).min(from as usize);
            let overlap =
                |cell: usize| (end.min(cell as f64 + 1.0) - start.max(cell as f64)) / step;
            cells.map(|cell| (cell, overlap(cell).max(0.0) as f32)).collect()
        })
        .collect()
}

/// A sheet of pictures of the same size, in rows from left to right, `gap` pixels apart and from
/// the margin.
///
/// # Errors
///
/// [`ImageError::NoFrames`] without frames or columns, [`ImageError::Mismatch`] where a frame
/// differs in size from the first, [`ImageError::Size`] where the sheet would be too large.
pub fn contact_sheet(
    frames: &[Image],
    columns: u32,
    gap: u32,
    background: Color,
) -> Result<Image, ImageError> {
    let first = frames.first().filter(|_| columns > 0).ok_or(ImageError::NoFrames)?.size;
    if let Some(odd) = frames.iter().find(|frame| frame.size != first) {
        return Err(ImageError::Mismatch { left: first, right: odd.size });
    }
    let count = u32::try_from(frames.len()).unwrap_or(u32::MAX);
    let columns = columns.min(count);
    let side =
        |cells: u32, cell: u32| cells.saturating_mul(cell.saturating_add(gap)).saturating_add(gap);
    let (width, height) = (side(columns, first.width), side(count.div_ceil(columns), first.height));
    let mut sheet = Image::filled(ImageSize::new(width, height)?, background);
    for (i, frame) in (0..count).zip(frames) {
        let (column, row) = (i % columns, i / columns);
        sheet.place(frame, gap + column * (first.width + gap), gap + row * (first.height + gap));
    }
    Ok(sheet)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn size(width: u32, height: u32) -> ImageSize {
        ImageSize::new(width, height).unwrap()
    }

    #[test]
    fn sizes_and_pixel_counts_are_checked() {
        assert!(ImageSize::new(0, 5).is_err() && ImageSize::new(5, 20_000).is_err());
        let error = Image::from_pixels(size(2, 2), vec![0; 15]).unwrap_err();
        assert_eq!(error, ImageError::PixelCount { found: 15, expected: 16 });
        assert_eq!(Image::filled(size(2, 2), Color::WHITE).pixel(2, 0), None);
    }

    #[test]
    fn differences_are_counted_per_pixel_and_averaged_per_channel() {
        let a = Image::filled(size(2, 1), Color::BLACK);
        let b = Image::from_pixels(size(2, 1), vec![0, 0, 0, 255, 9, 0, 0, 255]).unwrap();
        let difference = a.difference(&b, 8).unwrap();
        assert_eq!(difference, Difference { mean_error: 9.0 / 8.0, differing: 0.5 });
        assert_eq!(a.difference(&b, 9).unwrap().differing, 0.0);
        let other = Image::filled(size(1, 2), Color::BLACK);
        assert!(matches!(a.difference(&other, 0), Err(ImageError::Mismatch { .. })));
    }

    #[test]
    fn a_canvas_cuts_off_and_fills_up() {
        let red = Color::rgb(200, 0, 0);
        let image = Image::filled(size(3, 2), red);
        let wide = image.on_canvas(size(5, 1), Color::WHITE);
        let row: Vec<Color> = (0..5).filter_map(|x| wide.pixel(x, 0)).collect();
        assert_eq!(row, [red, red, red, Color::WHITE, Color::WHITE]);
        let high = image.on_canvas(size(2, 3), Color::WHITE);
        assert_eq!((high.pixel(1, 1), high.pixel(1, 2)), (Some(red), Some(Color::WHITE)));
    }

    #[test]
    fn scaling_down_averages_light_not_codes() {
        let checker = [0u8, 0, 0, 255, 255, 255, 255, 255];
        let image = Image::from_pixels(size(2, 2), checker.repeat(2)).unwrap();
        // Half the light of white is code 188, not 128.
        assert_eq!(image.scaled_down(1).pixel(0, 0), Some(Color::rgb(188, 188, 188)));
        assert_eq!(image.scaled_down(2), image);
    }

    #[test]
    fn scaling_down_by_an_odd_ratio_keeps_an_even_colour() {
        let color = Color::rgb(10, 120, 240);
        let scaled = Image::filled(size(7, 5), color).scaled_down(3);
        assert_eq!(scaled.size(), size(3, 2));
        assert_eq!(scaled, Image::filled(size(3, 2), color));
    }

    #[test]
    fn a_contact_sheet_places_frames_row_by_row() {
        let colors = [Color::rgb(1, 0, 0), Color::rgb(2, 0, 0), Color::rgb(3, 0, 0)];
        let frames = colors.map(|c| Image::filled(size(4, 3), c));
        let sheet = contact_sheet(&frames, 2, 1, Color::WHITE).unwrap();
        assert_eq!(sheet.size(), size(11, 9));
        assert_eq!(sheet.pixel(0, 0), Some(Color::WHITE));
        assert_eq!(sheet.pixel(1, 1), Some(colors[0]));
        assert_eq!(sheet.pixel(6, 3), Some(colors[1]));
        assert_eq!(sheet.pixel(4, 7), Some(colors[2]));
        assert_eq!(sheet.pixel(6, 7), Some(Color::WHITE));
        assert_eq!(contact_sheet(&[], 2, 1, Color::WHITE), Err(ImageError::NoFrames));
        let odd = [frames[0].clone(), Image::filled(size(4, 4), Color::BLACK)];
        assert!(contact_sheet(&odd, 2, 1, Color::WHITE).is_err());
    }
}
