//! Finding a graphics adapter and opening it, without touching anything global.

use std::sync::{Arc, Mutex, PoisonError};

use crate::error::RenderError;
use crate::pipelines::DEPTH_FORMATS;

/// How a [`Renderer`](crate::Renderer) chooses its adapter.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct RendererOptions {
    /// Graphics interfaces to look at: `vulkan`, `gl`, `metal`, `dx12`, separated by commas.
    /// `None`: what the environment variable `WGPU_BACKEND` names in the same way, or all of them.
    pub backends: Option<String>,
    /// Accept software adapters only. They are slower, but the same on every machine.
    pub software: bool,
}

/// An opened adapter.
#[derive(Debug)]
pub(crate) struct Gpu {
    pub(crate) device: wgpu::Device,
    pub(crate) queue: wgpu::Queue,
    pub(crate) name: String,
    pub(crate) software: bool,
    pub(crate) depth_format: wgpu::TextureFormat,
    /// Whether shaders can read depths of several samples. wgpu 30 makes such a texture of the
    /// wrong kind under OpenGL, and all that is drawn to it fails.
    pub(crate) reads_depths: bool,
    /// Whether a face takes its flat values from its last corner: wgpu leaves OpenGL at that, where
    /// all others take the first.
    pub(crate) last_provokes: bool,
    /// The first error since it was last taken.
    error: Arc<Mutex<Option<String>>>,
}

impl Gpu {
    /// # Errors
    ///
    /// [`RenderError::UnknownBackend`], [`RenderError::NoAdapter`] or [`RenderError::Device`].
    pub(crate) fn open(options: &RendererOptions) -> Result<Self, RenderError> {
        let adapter =
            find_adapter(chosen_backends(options.backends.as_deref())?, options.software)?;
        let info = adapter.get_info();
        let name = format!("{} ({})", info.name, info.backend);
        let refused = |reason: String| RenderError::Device { adapter: name.clone(), reason };
        let [fine, coarse] = DEPTH_FORMATS;
        let has_fine = adapter.features().contains(wgpu::Features::DEPTH32FLOAT_STENCIL8);
        let wanted = wgpu::Features::DEPTH32FLOAT_STENCIL8;
        let request = wgpu::DeviceDescriptor {
            label: Some("cranny-render"),
            required_features: if has_fine { wanted } else { wgpu::Features::empty() },
            required_limits: adapter.limits(),
            ..Default::default()
        };
        let (device, queue) = pollster::block_on(adapter.request_device(&request))
            .map_err(|e| refused(e.to_string()))?;
        // Unhandled, an error of the graphics library would be a panic.
        let error = Arc::new(Mutex::new(None));
        let slot = error.clone();
        device.on_uncaptured_error(Arc::new(move |e: wgpu::Error| {
            let mut first = slot.lock().unwrap_or_else(PoisonError::into_inner);
            first.get_or_insert_with(|| e.to_string());
        }));
        tracing::debug!(adapter = %name, "graphics adapter opened");
        let software = info.device_type == wgpu::DeviceType::Cpu;
        let depth_format = if has_fine { fine } else { coarse };
        let (reads_depths, last_provokes) = match info.backend {
            wgpu::Backend::Gl => (false, true),
            _ => (true, false),
        };
        Ok(Self { device, queue, name, software, depth_format, reads_depths, last_provokes, error })
    }

    /// The first error that the graphics library reported since the last call.
    pub(crate) fn take_error(&self) -> Option<String> {
        self.error.lock().unwrap_or_else(PoisonError::into_inner).take()
    }

    pub(crate) fn failed(&self, reason: impl ToString) -> RenderError {
        RenderError::Failed { adapter: self.name.clone(), reason: reason.to_string() }
    }
}

fn find_adapter(backends: wgpu::Backends, software: bool) -> Result<wgpu::Adapter, RenderError> {
    let mut descriptor = wgpu::InstanceDescriptor::new_without_display_handle();
    // Validation layers are for those who debug graphics; the environment can switch them on.
    descriptor.flags = wgpu::InstanceFlags::empty();
    let mut descriptor = descriptor.with_env();
    descriptor.backends = backends;
    let request = wgpu::RequestAdapterOptions {
        power_preference: wgpu::PowerPreference::HighPerformance,
        force_fallback_adapter: software,
        ..Default::default()
    };
    let found = pollster::block_on(wgpu::Instance::new(descriptor).request_adapter(&request));
    found.map_err(|error| {
        let reason = error.to_string();
        RenderError::NoAdapter { backends: names(backends), reason }
    })
}

/// Those that can draw without a window; wgpu's `noop` draws nothing, and is none of them.
const DRAWING: [(wgpu::Backends, &str); 4] = [
    (wgpu::Backends::VULKAN, "vulkan"),
    (wgpu::Backends::GL, "gl"),
    (wgpu::Backends::METAL, "metal"),
    (wgpu::Backends::DX12, "dx12"),
];

fn chosen_backends(option: Option<&str>) -> Result<wgpu::Backends, RenderError> {
    let all = DRAWING.iter().fold(wgpu::Backends::empty(), |all, &(b, _)| all | b);
    let (origin, given) = match option {
        Some(list) => ("the renderer's option `backends`", list.to_owned()),
        None => match std::env::var("WGPU_BACKEND") {
            Ok(list) => ("the environment variable WGPU_BACKEND", list),
            Err(_) => return Ok(all),
        },
    };
    let chosen = wgpu::Backends::from_comma_list(&given) & all;
    if chosen.is_empty() { Err(RenderError::UnknownBackend { origin, given }) } else { Ok(chosen) }
}

fn names(backends: wgpu::Backends) -> String {
    let chosen = DRAWING.iter().filter(|(b, _)| backends.contains(*b));
    chosen.map(|&(_, name)| name).collect::<Vec<_>>().join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn backends_are_read_from_a_list() {
        let chosen = chosen_backends(Some("Vulkan, gl")).unwrap();
        assert_eq!(names(chosen), "vulkan, gl");
        let error = chosen_backends(Some("abacus")).unwrap_err();
        assert!(error.to_string().contains("\"abacus\""), "{error}");
        // An adapter that draws nothing would give empty pictures in silence.
        assert!(chosen_backends(Some("noop")).is_err());
    }

    #[test]
    fn without_an_adapter_the_error_says_what_to_install() {
        // No machine has both, and none has the other's.
        let foreign = if cfg!(target_os = "macos") { "dx12" } else { "metal" };
        let options = RendererOptions { backends: Some(foreign.to_owned()), software: false };
        let error = Gpu::open(&options).unwrap_err();
        assert!(matches!(error, RenderError::NoAdapter { .. }), "{error}");
        let message = error.to_string();
        for word in ["mesa-vulkan-drivers", "WGPU_BACKEND", foreign] {
            assert!(message.contains(word), "{message}");
        }
    }
}
