//! Draw lists to images, headless.
//!
//! # Promises
//!
//! - A [`DrawList`] (bodies, lines, points, ground) and a [`Camera`] give an [`Image`]; no window,
//!   no window system, no global state. A graphics card or a software adapter will do.
//! - Precision does not depend on where the scene lies or how large it is: positions reach the
//!   adapter relative to the eye.
//! - No adapter, a lost adapter, too large a picture or a number that is not finite is a
//!   [`RenderError`] that says what to do; the caller can go on without pictures.
//! - A file is written under another name and renamed: it is whole or absent.
//!
//! # Non-promises
//!
//! Pictures of different adapters differ in a few pixels: compare with [`Image::difference`].
//! Translucent bodies that interleave are ordered by their centres only. The crate knows no world:
//! who draws one builds the list.
//!
//! ```
//! use std::sync::Arc;
//! use cranny_exact::{DVec3, Pose};
//! use cranny_render::*;
//!
//! let corners = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
//! let mesh = DrawMesh::new(&corners, &[[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])?;
//! let mut list = DrawList::new();
//! list.instances.push(Instance::solid(Arc::new(mesh), Pose::IDENTITY, palette(0)));
//! list.ground = Some(Ground::under(&list.bounds()));
//!
//! let size = ImageSize::new(320, 180)?;
//! let camera = Camera::fitted(Preset::Isometric, &list.bounds(), size)?;
//! match Renderer::new(&RendererOptions::default()) {
//!     Ok(mut renderer) => assert_eq!(renderer.render(&list, &camera, size)?.size(), size),
//!     Err(error) => assert!(matches!(error, RenderError::NoAdapter { .. })),
//! }
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod camera;
mod color;
mod device;
mod draw_list;
mod edges;
mod error;
mod file;
mod frame;
mod image;
mod label;
mod mesh;
mod outlines;
pub mod palette;
mod patch;
mod pipelines;
mod ramp;
mod renderer;
mod section;
mod sheet;
mod style;
mod target;
mod text;

pub use camera::{Camera, CameraError, Preset};
pub use color::Color;
pub use device::RendererOptions;
pub use draw_list::{DrawList, Ground, Instance, Line, Point};
pub use error::RenderError;
pub use file::{Animation, EncodeError, SaveError};
pub use image::{Difference, Image, ImageError, ImageSize, contact_sheet};
pub use label::{Anchor, Label};
pub use mesh::{DrawMesh, DrawMeshError};
pub use palette::palette;
pub use patch::Patch;
pub use ramp::Ramp;
pub use renderer::Renderer;
pub use section::Section;
pub use sheet::{Key, Mark, Panel, Sheet};
pub use style::{CREASE_DEGREES, Shading, Style};
pub use text::{text_height, text_width};
