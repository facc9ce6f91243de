//! Ctrl-C, and the signals by which systems end programs (SIGTERM, SIGHUP): the first time a clean
//! stop, the second time at once.

use secateur::SimplifyError;
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, Ordering};

static WANTED: AtomicBool = AtomicBool::new(false);
static WRITING: AtomicBool = AtomicBool::new(false);

/// From now on these ask for a stop.
pub(crate) fn listen() {
    let handler = || {
        let again = WANTED.swap(true, Ordering::Relaxed);
        // Never in the middle of a file.
        if again && !WRITING.load(Ordering::Relaxed) {
            std::process::exit(1);
        }
    };
    if let Err(reason) = ctrlc::set_handler(handler) {
        tracing::debug!("Ctrl-C will stop at once: {reason}");
    }
}

/// Whether to go on.
pub(crate) fn check() -> Result<(), SimplifyError> {
    match WANTED.load(Ordering::Relaxed) {
        true => Err(SimplifyError::Stopped),
        false => Ok(()),
    }
}

/// Whether to go on, for callbacks.
pub(crate) fn flow() -> ControlFlow<()> {
    match WANTED.load(Ordering::Relaxed) {
        true => ControlFlow::Break(()),
        false => ControlFlow::Continue(()),
    }
}

/// From now on only whole files are left behind, and all of them.
pub(crate) fn writing() -> Result<(), SimplifyError> {
    check()?;
    WRITING.store(true, Ordering::Relaxed);
    Ok(())
}

/// The files are there, and work goes on: a second signal may end it at once again.
pub(crate) fn written() {
    WRITING.store(false, Ordering::Relaxed);
}
