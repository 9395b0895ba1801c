//! Signals that would end the command without a word.

/// Has a file that grows beyond the limit of the shell (`ulimit -f`) fail as one on a full disk
/// does, which is reported, instead of ending the command.
pub(crate) fn report_size_limits() {
    #[cfg(unix)]
    {
        // The write itself fails with the error; that the signal came is never read.
        let reached = std::sync::Arc::default();
        if let Err(error) = signal_hook::flag::register(signal_hook::consts::SIGXFSZ, reached) {
            tracing::debug!("a limit on the size of files will end the command ({error})");
        }
    }
}
