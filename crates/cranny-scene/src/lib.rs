//! Scene files, mesh files, robots and generated worlds.
//!
//! # Promises
//!
//! - Mesh files of seven kinds are read at full precision, each broken one refused with its file,
//!   its line, byte or element, the value found and what to do ([`mesh_file`]). No input panics.
//! - URDF robots become links, joints and poses ([`robot`]).
//! - Scene files become the neutral descriptions of `cranny-world`, with every name, number and
//!   file checked, and errors that carry line and column ([`scene_file`]). The same text, files and
//!   seed give the same scene.
//!
//! # Non-promises
//!
//! - [`read_mesh`] repairs nothing: meshes may be open, degenerate or inside out. Those of scenes
//!   are mended by `cranny_geometry`.
//! - Materials, textures, skins, animations, inertia tensors and joint friction are not read.
//!
//! ```
//! use cranny_scene::{LoadOptions, parse_scene};
//! let text = r#"(
//!     bodies: [(name: "ring", shape: Generator(Torus(major_radius: 1)))],
//!     effects: [Response()],
//! )"#;
//! let scene = parse_scene(text.to_owned(), "ring.ron".as_ref(), &LoadOptions::default())?;
//! assert_eq!(scene.description.bodies[0].collision.faces().len(), 2048);
//! # Ok::<(), cranny_scene::SceneError>(())
//! ```

pub mod mesh_file;
pub mod robot;
pub mod scene_file;
mod text_file;
mod xml;

pub use mesh_file::{
    DecodeError, MODEL_EXTENSION, MeshFile, MeshFileError, MeshFormat, decode_mesh, encode_obj,
    is_saved_model, read_mesh,
};
pub use robot::{Robot, RobotError, read_robot};
pub use scene_file::{
    LoadOptions, LoadedScene, SceneError, Setting, load_scene, load_scene_with, parse_scene,
};
pub use text_file::{read_text, remedy, without_mark};

// The example of the README must compile and run as well.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
