//! Ctrl-C, and the signals by which systems end programs (SIGTERM, SIGHUP): the first time a clean
//! stop, the second time at once.

use super::failure::INTERRUPTED;
use super::log;
use secateur::SimplifyError;
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, Ordering};

static WANTED: AtomicBool = AtomicBool::new(false);
static WRITING: AtomicBool = AtomicBool::new(false);
static READING: AtomicBool = AtomicBool::new(false);

/// From now on these ask for a stop.
pub(crate) fn listen() {
    let handler = || {
        let again = WANTED.swap(true, Ordering::Relaxed);
        // An input may never come, and nothing is there yet that could be left behind.
        if READING.load(Ordering::Relaxed) {
            log::error(&SimplifyError::Stopped.into());
            std::process::exit(INTERRUPTED.into());
        }
        // Never in the middle of a file.
        if again && !WRITING.load(Ordering::Relaxed) {
            std::process::exit(INTERRUPTED.into());
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

/// Reads an input: what ends programs ends this one at once.
pub(crate) fn reading<T>(read: impl FnOnce() -> T) -> T {
    READING.store(true, Ordering::Relaxed);
    let read = read();
    READING.store(false, Ordering::Relaxed);
    read
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
