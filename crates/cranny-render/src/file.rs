//! Pictures on disk: PNG, animated PNG, and files that are whole or absent.

use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};

use thiserror::Error;

use crate::image::{Image, ImageError, ImageSize};

/// A picture that could not be encoded.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum EncodeError {
    /// An animation without frames.
    #[error("the animation has no frames")]
    NoFrames,
    /// The PNG encoder refused.
    #[error("PNG encoding: {0}")]
    Png(#[from] png::EncodingError),
}

/// A picture that could not be saved. Nothing is left under its name.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum SaveError {
    /// Encoding failed.
    #[error("{}: {source}", path.display())]
    Encode {
        /// The file that was to be written.
        path: PathBuf,
        /// What went wrong.
        source: EncodeError,
    },
    /// Writing failed.
    #[error("cannot write {}: {source}", path.display())]
    Write {
        /// The file that was to be written.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
}

impl Image {
    /// The picture as a PNG file's bytes (8 bits, RGBA).
    ///
    /// # Errors
    ///
    /// [`EncodeError::Png`] where the encoder refuses, which a valid picture gives it no reason to.
    pub fn encode_png(&self) -> Result<Vec<u8>, EncodeError> {
        let mut bytes = Vec::new();
        let mut encoder = png::Encoder::new(&mut bytes, self.size().width(), self.size().height());
        encoder.set_color(png::ColorType::Rgba);
        encoder.set_depth(png::BitDepth::Eight);
        encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
        let mut writer = encoder.write_header()?;
        writer.write_image_data(self.pixels())?;
        writer.finish()?;
        Ok(bytes)
    }

    /// Writes the picture as PNG: under `PATH.partial` first, then renamed, so that a file of that
    /// name is always whole. The folder must exist.
    ///
    /// # Errors
    ///
    /// [`SaveError`], naming the path; neither file is left behind.
    pub fn save_png(&self, path: &Path) -> Result<(), SaveError> {
        save(path, self.encode_png())
    }
}

/// Frames that are shown one after the other, for ever: an animated PNG, which every browser plays.
///
/// Of each frame only the rectangle that changed is kept, without alpha.
#[derive(Clone, Debug)]
pub struct Animation {
    delay_ms: u16,
    last: Option<Image>,
    frames: Vec<Change>,
}

/// What a frame changes: a rectangle, its pixels in three bytes each.
#[derive(Clone, Debug)]
struct Change {
    x: u32,
    y: u32,
    width: u32,
    height: u32,
    rgb: Vec<u8>,
}

impl Animation {
    /// An animation that shows each frame for so many milliseconds.
    #[must_use]
    pub fn new(delay_ms: u16) -> Self {
        Self { delay_ms, last: None, frames: Vec::new() }
    }

    /// Number of frames so far.
    #[must_use]
    pub fn frame_count(&self) -> usize {
        self.frames.len()
    }

    /// Adds a frame.
    ///
    /// # Errors
    ///
    /// [`ImageError::Mismatch`] where its size is not that of the first frame.
    pub fn push(&mut self, frame: Image) -> Result<(), ImageError> {
        if let Some(last) = &self.last
            && last.size() != frame.size()
        {
            return Err(ImageError::Mismatch { left: last.size(), right: frame.size() });
        }
        self.frames.push(Change::between(self.last.as_ref(), &frame));
        self.last = Some(frame);
        Ok(())
    }

    /// The animation as an animated PNG file's bytes. Programs that do not know animation show the
    /// first frame.
    ///
    /// # Errors
    ///
    /// [`EncodeError::NoFrames`] where there are none.
    pub fn encode(&self) -> Result<Vec<u8>, EncodeError> {
        let size: ImageSize = self.last.as_ref().ok_or(EncodeError::NoFrames)?.size();
        let count = u32::try_from(self.frames.len()).unwrap_or(u32::MAX);
        let mut bytes = Vec::new();
        let mut encoder = png::Encoder::new(&mut bytes, size.width(), size.height());
        encoder.set_color(png::ColorType::Rgb);
        encoder.set_depth(png::BitDepth::Eight);
        encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
        encoder.set_animated(count, 0)?;
        encoder.set_frame_delay(self.delay_ms, 1000)?;
        let mut writer = encoder.write_header()?;
        for frame in &self.frames {
            writer.reset_frame_position()?;
            writer.set_frame_dimension(frame.width, frame.height)?;
            writer.set_frame_position(frame.x, frame.y)?;
            writer.write_image_data(&frame.rgb)?;
        }
        writer.finish()?;
        Ok(bytes)
    }

    /// Writes the animation as [`Image::save_png`] does.
    ///
    /// # Errors
    ///
    /// [`SaveError`], naming the path; no partial file is left behind.
    pub fn save(&self, path: &Path) -> Result<(), SaveError> {
        save(path, self.encode())
    }
}

impl Change {
    /// The smallest rectangle that turns `before` into `after`; all of it without a `before`, and
    /// one pixel where nothing changed (a frame of an animation cannot be empty).
    fn between(before: Option<&Image>, after: &Image) -> Self {
        let stride = 4 * after.size().width() as usize;
        let (mut columns, mut rows) = (None::<[usize; 2]>, None::<[usize; 2]>);
        let widen = |range: &mut Option<[usize; 2]>, first: usize, last: usize| {
            let [start, end] = range.unwrap_or([first, last]);
            *range = Some([start.min(first), end.max(last)]);
        };
        match before {
            None => {
                widen(&mut columns, 0, after.size().width() as usize - 1);
                widen(&mut rows, 0, after.size().height() as usize - 1);
            }
            Some(before) => {
                let pairs = before.pixels().chunks_exact(4).zip(after.pixels().chunks_exact(4));
                for (i, _) in pairs.enumerate().filter(|(_, (old, new))| old != new) {
                    let (x, y) = (i % (stride / 4), i / (stride / 4));
                    widen(&mut columns, x, x);
                    widen(&mut rows, y, y);
                }
            }
        }
        let ([left, right], [top, bottom]) = (columns.unwrap_or([0; 2]), rows.unwrap_or([0; 2]));
        let row = |y: usize| &after.pixels()[y * stride + 4 * left..y * stride + 4 * (right + 1)];
        let rgb = (top..=bottom)
            .flat_map(|y| row(y).chunks_exact(4).flat_map(|p| [p[0], p[1], p[2]]))
            .collect();
        Self {
            x: left as u32,
            y: top as u32,
            width: (right + 1 - left) as u32,
            height: (bottom + 1 - top) as u32,
            rgb,
        }
    }
}

fn save(path: &Path, encoded: Result<Vec<u8>, EncodeError>) -> Result<(), SaveError> {
    let bytes = encoded.map_err(|source| SaveError::Encode { path: path.to_owned(), source })?;
    // Renaming onto a device or a pipe would replace it.
    if fs::metadata(path).is_ok_and(|found| !found.is_file()) {
        let source = std::io::Error::other("something that is no file stands there");
        return Err(SaveError::Write { path: path.to_owned(), source });
    }
    write_whole(path, &bytes).map_err(|source| SaveError::Write { path: path.to_owned(), source })
}

/// Writes `PATH.partial` and renames it; on failure removes what it created.
fn write_whole(path: &Path, bytes: &[u8]) -> std::io::Result<()> {
    let mut partial = path.as_os_str().to_owned();
    partial.push(".partial");
    let partial = PathBuf::from(partial);
    let mut file = fs::File::create(&partial)?;
    let written = file.write_all(bytes).and_then(|()| file.sync_all());
    drop(file);
    let renamed = written.and_then(|()| fs::rename(&partial, path));
    if renamed.is_err() {
        // The first failure is the one to report; a second one here would only hide it.
        let _ = fs::remove_file(&partial);
    }
    renamed
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::color::Color;

    fn gradient(width: u32, height: u32, shift: u8) -> Image {
        let pixels = (0..height)
            .flat_map(|y| (0..width).flat_map(move |x| [x as u8, y as u8, shift, 255]))
            .collect();
        Image::from_pixels(ImageSize::new(width, height).unwrap(), pixels).unwrap()
    }

    /// Decodes an animated PNG the way a viewer shows it.
    fn play(bytes: &[u8]) -> Vec<Image> {
        let mut reader = png::Decoder::new(std::io::Cursor::new(bytes)).read_info().unwrap();
        let size = ImageSize::new(reader.info().width, reader.info().height).unwrap();
        let count = reader.info().animation_control().unwrap().num_frames;
        let mut canvas = Image::filled(size, Color::BLACK).pixels().to_vec();
        let mut buffer = vec![0; reader.output_buffer_size().unwrap()];
        (0..count)
            .map(|_| {
                let frame = reader.next_frame(&mut buffer).unwrap();
                let control = *reader.info().frame_control().unwrap();
                assert_eq!((control.delay_num, control.delay_den), (40, 1000));
                for y in 0..frame.height {
                    for x in 0..frame.width {
                        let from = 3 * (y * frame.width + x) as usize;
                        let column = x + control.x_offset;
                        let to = 4 * ((y + control.y_offset) * size.width() + column) as usize;
                        canvas[to..to + 3].copy_from_slice(&buffer[from..from + 3]);
                    }
                }
                Image::from_pixels(size, canvas.clone()).unwrap()
            })
            .collect()
    }

    #[test]
    fn png_decodes_to_the_same_pixels() {
        let image = gradient(37, 11, 200);
        let bytes = image.encode_png().unwrap();
        let mut reader = png::Decoder::new(std::io::Cursor::new(bytes)).read_info().unwrap();
        let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
        let info = reader.next_frame(&mut pixels).unwrap();
        assert_eq!((info.width, info.height), (37, 11));
        assert_eq!(pixels, image.pixels());
    }

    #[test]
    fn an_animation_plays_back_frame_by_frame() {
        let first = gradient(20, 10, 0);
        let mut pixels = first.pixels().to_vec();
        pixels[4 * (3 * 20 + 5)] ^= 255;
        pixels[4 * (7 * 20 + 11) + 1] ^= 255;
        let second = Image::from_pixels(first.size(), pixels).unwrap();
        let third = gradient(20, 10, 9);
        let frames = [first, second.clone(), second, third];
        let mut animation = Animation::new(40);
        for frame in &frames {
            animation.push(frame.clone()).unwrap();
        }
        let changed = &animation.frames[1];
        let rectangle = (changed.x, changed.y, changed.width, changed.height);
        assert_eq!(rectangle, (5, 3, 7, 5));
        assert_eq!(animation.frames[2].rgb.len(), 3, "nothing changed: one pixel");
        assert_eq!(play(&animation.encode().unwrap()), frames);
    }

    #[test]
    fn frames_of_another_size_and_empty_animations_are_refused() {
        let mut animation = Animation::new(40);
        assert!(matches!(animation.encode(), Err(EncodeError::NoFrames)));
        animation.push(gradient(4, 4, 0)).unwrap();
        assert!(matches!(animation.push(gradient(4, 5, 0)), Err(ImageError::Mismatch { .. })));
        assert_eq!(animation.frame_count(), 1);
    }

    #[test]
    fn files_are_whole_or_absent() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("picture.png");
        let image = gradient(8, 8, 1);
        image.save_png(&path).unwrap();
        assert_eq!(fs::read(&path).unwrap(), image.encode_png().unwrap());
        gradient(8, 8, 2).save_png(&path).unwrap();
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1, "no partial file stays");

        let missing = folder.path().join("nowhere/picture.png");
        let error = image.save_png(&missing).unwrap_err().to_string();
        assert!(error.contains("nowhere"), "{error}");

        // A folder in the way: the partial file can be written, the rename fails.
        let blocked = folder.path().join("blocked.png");
        fs::create_dir_all(blocked.join("inside")).unwrap();
        assert!(matches!(image.save_png(&blocked), Err(SaveError::Write { .. })));
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 2, "no partial file stays");
    }
}
