//! What can go wrong between a draw list and its picture.

use thiserror::Error;

/// A picture that could not be drawn. All of these leave the caller free to go on without pictures.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum RenderError {
    /// A name that is no graphics interface.
    #[error(
        "{origin} is {given:?}, which names no graphics interface: use one or more of vulkan, gl, metal, dx12, separated by commas"
    )]
    UnknownBackend {
        /// Where the name came from.
        origin: &'static str,
        /// What it says.
        given: String,
    },
    /// No graphics adapter, neither hardware nor software.
    #[error(
        "no graphics adapter found (looked for: {backends}). On Debian and Ubuntu, `apt-get install mesa-vulkan-drivers` brings a software one; the environment variable WGPU_BACKEND (vulkan, gl, metal, dx12) chooses where to look. Details: {reason}"
    )]
    NoAdapter {
        /// The interfaces that were tried.
        backends: String,
        /// What the graphics library says.
        reason: String,
    },
    /// The adapter could not be opened, or lacks something that is needed.
    #[error("the graphics adapter {adapter} cannot be used: {reason}")]
    Device {
        /// Its name.
        adapter: String,
        /// What is wrong.
        reason: String,
    },
    /// The adapter draws no picture of this size.
    #[error(
        "a picture of {width} x {height} pixels is too large for the graphics adapter: at most {limit} a side"
    )]
    ImageTooLarge {
        /// The width.
        width: u32,
        /// The height.
        height: u32,
        /// The adapter's longest side.
        limit: u32,
    },
    /// The adapter has no buffer of this size.
    #[error(
        "{what} take {bytes} bytes, more than the graphics adapter holds in one piece ({limit}): draw fewer or simpler bodies"
    )]
    TooMuch {
        /// Of what there is too much.
        what: &'static str,
        /// Size needed.
        bytes: u64,
        /// The adapter's largest buffer.
        limit: u64,
    },
    /// An entry of the draw list is not finite, or too far from the camera to be placed.
    #[error(
        "{what} {index} of the draw list cannot be placed: its numbers must be finite, and within about 1e38 camera distances"
    )]
    NotFinite {
        /// Which of the draw list's kinds.
        what: &'static str,
        /// Its index among them.
        index: usize,
    },
    /// The adapter failed while drawing.
    #[error("drawing failed on {adapter}: {reason}")]
    Failed {
        /// The adapter's name.
        adapter: String,
        /// What the graphics library says.
        reason: String,
    },
}
