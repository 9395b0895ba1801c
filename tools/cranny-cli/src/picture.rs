//! A single picture, as a file.

use std::fmt::Display;
use std::path::Path;

use cranny_exact::{Aabb, DVec3};
use cranny_render::{
    Camera, CameraError, DrawList, DrawMeshError, Image, ImageError, ImageSize, Key, Panel, Preset,
    RenderError, Renderer, RendererOptions, Section, Sheet, text_width,
};

use crate::failure::Failure;
use crate::progress;

/// Width and height in pixels.
const SIZE: [u32; 2] = [1280, 960];

/// Height of the letters below a picture, in pixels: those of a [`Sheet`].
const WORDS: f32 = 14.0;

/// Pixels that words below a picture leave free.
const MARGIN: f32 = 20.0;

/// A picture of several side by side.
#[derive(Clone, Debug)]
pub(crate) struct PictureView {
    pub(crate) list: DrawList,
    /// Written in its corner; empty for nothing.
    pub(crate) title: String,
    /// Where the camera is, seen from what is drawn.
    pub(crate) from: DVec3,
}

impl PictureView {
    /// A whole scene.
    pub(crate) fn of(list: DrawList) -> Self {
        Self { list, title: String::new(), from: Preset::Isometric.direction() }
    }
}

/// What is drawn, and the words about it.
#[derive(Clone, Debug, Default)]
pub(crate) struct Drawing {
    /// From left to right.
    pub(crate) views: Vec<PictureView>,
    /// Above the picture; empty for a picture without words.
    pub(crate) title: String,
    /// Marks and what they mean.
    pub(crate) keys: Vec<Key>,
    /// Below.
    pub(crate) caption: Vec<String>,
}

/// Why there is no picture.
pub(crate) enum Trouble {
    /// No graphics adapter that could draw: the work goes on without.
    NoGraphics(String),
    /// Everything else.
    Failed(Failure),
}

/// Draws what is listed and writes the picture as PNG: whole, or not at all. `listed` is called
/// only where there is something to draw with.
pub(crate) fn draw(
    path: &Path,
    listed: impl FnOnce() -> Result<Drawing, DrawMeshError>,
) -> Result<(), Trouble> {
    let waiting = progress::spinner(format!("drawing {}", path.display()));
    let mut renderer = match Renderer::new(&RendererOptions::default()) {
        Ok(renderer) => renderer,
        Err(error @ RenderError::UnknownBackend { .. }) => {
            return Err(Trouble::Failed(Failure::input(error)));
        }
        Err(error) => return Err(Trouble::NoGraphics(error.to_string())),
    };
    let failed = |error: &dyn Display| {
        Trouble::Failed(Failure::run(format!("picture {}: {error}", path.display())))
    };
    let drawing = listed().map_err(|error| failed(&error))?;
    tracing::info!("{}: drawing with {}", path.display(), renderer.adapter_name());
    let width = SIZE[0] / drawing.views.len().max(1) as u32;
    let size = ImageSize::new(width, SIZE[1]).map_err(|error| failed(&error))?;
    let mut panels = Vec::new();
    for view in &drawing.views {
        let camera = view.camera(size).map_err(|error| failed(&error))?;
        let image = renderer.render(&view.list, &camera, size).map_err(|error| failed(&error))?;
        let high = 2.0 * camera.distance() * (0.5 * camera.field_of_view()).tan();
        let scale = Some(high / f64::from(size.height()));
        panels.push(Panel { image, title: view.title.clone(), scale });
    }
    let image = drawing.page(panels).map_err(|error| failed(&error))?;
    image.save_png(path).map_err(|error| {
        let advice = "Check the folder, its rights and its space, or choose another.";
        Trouble::Failed(Failure::run(format!("picture: {error}. {advice}")))
    })?;
    waiting.finish_and_clear();
    Ok(())
}

impl PictureView {
    fn camera(&self, size: ImageSize) -> Result<Camera, CameraError> {
        match &self.list.section {
            Some(section) => {
                Camera::fitted_from(facing(section), &behind(section, &self.list.bounds()), size)
            }
            None if self.from == Preset::Isometric.direction() => {
                Camera::fitted_to(Preset::Isometric, &self.list, size)
            }
            None => Camera::fitted_from(self.from, &self.list.bounds(), size),
        }
    }
}

impl Drawing {
    /// The pictures with their words; without a title one picture alone.
    fn page(self, mut panels: Vec<Panel>) -> Result<Image, ImageError> {
        if self.title.is_empty() && panels.len() == 1 {
            return Ok(panels.remove(0).image);
        }
        let width = SIZE[0] as f32 - MARGIN;
        let caption = self.caption.iter().flat_map(|words| wrapped(words, width)).collect();
        Sheet { title: self.title, panels, keys: self.keys, caption }.compose()
    }
}

/// The direction from which a cut face is seen best: nearly from in front of it, and from above.
fn facing(section: &Section) -> DVec3 {
    let side =
        if section.normal.z.abs() > 0.5 { DVec3::NEG_Y } else { section.normal.cross(DVec3::Z) };
    section.normal + 0.35 * side + 0.45 * DVec3::Z
}

/// The box of what a section leaves of a box.
fn behind(section: &Section, bounds: &Aabb) -> Aabb {
    let corner = |i: usize| {
        let of = |axis: usize| [bounds.min, bounds.max][i >> axis & 1][axis];
        let corner = DVec3::new(of(0), of(1), of(2));
        corner - section.before(corner).max(0.0) * section.normal
    };
    Aabb::of_points((0..8).map(corner))
}

/// Lines that are no wider than so many pixels, unless a single word is.
fn wrapped(words: &str, width: f32) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in words.split_whitespace() {
        match lines.last_mut() {
            Some(line) if text_width(&format!("{line} {word}"), WORDS) <= width => {
                line.push(' ');
                line.push_str(word);
            }
            _ => lines.push(word.to_owned()),
        }
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_camera_is_fitted_to_what_a_cut_leaves() {
        let bounds = Aabb { min: DVec3::ZERO, max: DVec3::new(2.0, 3.0, 4.0) };
        let overlap = cranny_render::Color::WHITE;
        let cut = |normal| Section::through(DVec3::ONE, normal, overlap).unwrap();
        let left = behind(&cut(DVec3::NEG_Y), &bounds);
        assert_eq!((left.min, left.max), (DVec3::Y, bounds.max));
        let left = behind(&cut(DVec3::Z), &bounds);
        assert_eq!((left.min, left.max), (DVec3::ZERO, DVec3::new(2.0, 3.0, 1.0)));
        for normal in [DVec3::X, DVec3::NEG_Y, DVec3::Z] {
            assert!(facing(&cut(normal)).normalize().dot(normal) > 0.8, "{normal}");
        }
    }

    #[test]
    fn long_lines_are_broken_between_words() {
        let words = "one two three four five six seven eight nine ten";
        let width = text_width("one two three four", WORDS);
        let lines = wrapped(words, width);
        assert_eq!(lines[0], "one two three four");
        assert_eq!(lines.join(" "), words);
        assert!(lines.iter().all(|line| text_width(line, WORDS) <= width), "{lines:?}");
        assert_eq!(wrapped("incomprehensibilities", 10.0), ["incomprehensibilities"]);
    }
}
