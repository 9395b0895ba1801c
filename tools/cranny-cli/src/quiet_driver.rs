//! Keeps a graphics driver's own messages off standard error.
//!
//! A layer of Mesa's Vulkan drivers prints `error: XDG_RUNTIME_DIR is invalid` where that variable
//! names no folder, though it needs none to draw. Only its environment leaves the layer out, and a
//! program cannot safely change its own: so the command starts itself anew, once, with one variable
//! more.

use crate::args::Command;

/// Leaves the layer out.
#[cfg(target_os = "linux")]
const WITHOUT_LAYER: &str = "NODEVICE_SELECT";

/// Starts this program anew in this process, where it is going to draw and the driver would
/// complain. Where that cannot be done it goes on as it is.
pub(crate) fn restart_without_noise(command: &Command) {
    #[cfg(target_os = "linux")]
    if draws(command) && std::env::var_os(WITHOUT_LAYER).is_none() && !has_runtime_folder() {
        use std::os::unix::process::CommandExt;
        if let Ok(program) = std::env::current_exe() {
            let mut again = std::process::Command::new(program);
            again.args(std::env::args_os().skip(1)).env(WITHOUT_LAYER, "1");
            let error = again.exec();
            tracing::debug!("the driver may print messages of its own: {error}");
        }
    }
    #[cfg(not(target_os = "linux"))]
    let _ = command;
}

#[cfg(target_os = "linux")]
fn draws(command: &Command) -> bool {
    match command {
        Command::Run(args) => {
            args.preview.is_some() || args.frames.is_some() || args.record.is_some()
        }
        Command::Replay(args) => args.render.is_some(),
        Command::Report(_) => true,
        Command::Inspect(args) => args.render.is_some(),
        Command::Accuracy(args) => args.mesh_b.is_none(),
        _ => false,
    }
}

#[cfg(target_os = "linux")]
fn has_runtime_folder() -> bool {
    std::env::var_os("XDG_RUNTIME_DIR").is_some_and(|folder| std::path::Path::new(&folder).is_dir())
}
