//! A single picture, as a file.

use std::fmt::Display;
use std::path::Path;

use cranny_render::{
    Camera, DrawList, DrawMeshError, ImageSize, Preset, RenderError, Renderer, RendererOptions,
};

use crate::failure::Failure;
use crate::progress;

/// Width and height in pixels.
const SIZE: [u32; 2] = [1280, 960];

/// Why there is no picture.
pub(crate) enum Trouble {
    /// No graphics adapter that could draw: the work goes on without.
    NoGraphics(String),
    /// Everything else.
    Failed(Failure),
}

/// Draws what a list says, which is asked for it where there is something to draw with, and writes
/// the picture as PNG: whole, or not at all.
pub(crate) fn draw(
    path: &Path,
    listed: impl FnOnce() -> Result<DrawList, DrawMeshError>,
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
    let size = ImageSize::new(SIZE[0], SIZE[1]).map_err(|error| failed(&error))?;
    let list = listed().map_err(|error| failed(&error))?;
    let camera =
        Camera::fitted_to(Preset::Isometric, &list, size).map_err(|error| failed(&error))?;
    tracing::info!("{}: drawing with {}", path.display(), renderer.adapter_name());
    let image = renderer.render(&list, &camera, size).map_err(|error| failed(&error))?;
    image.save_png(path).map_err(|error| {
        let advice = "Check the folder, its rights and its space, or choose another.";
        Trouble::Failed(Failure::run(format!("picture: {error}. {advice}")))
    })?;
    waiting.finish_and_clear();
    Ok(())
}
