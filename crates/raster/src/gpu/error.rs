//! What can go wrong with a GPU.

use crate::TooManyFragments;

/// Why a stage could not be run on a GPU.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum GpuError {
    /// There is no adapter of the kind asked for.
    #[error(
        "no {wanted} was found; install a Vulkan driver (for a software one, Mesa's lavapipe 23 \
         or newer), or run on the CPU"
    )]
    NoAdapter {
        /// The kind asked for, in words.
        wanted: &'static str,
    },
    /// The adapter gives wrong results without an error.
    #[error(
        "{adapter} (driver {driver}) ends long loops early and so computes wrong results; \
         install Mesa 23 or newer, or run on the CPU"
    )]
    Unsound {
        /// Name of the adapter as its driver gives it.
        adapter: String,
        /// Its driver and version.
        driver: String,
    },
    /// The adapter would not give a device.
    #[error("{adapter} could not be opened: {reason}; update its driver, or run on the CPU")]
    NotOpened {
        /// Name of the adapter as its driver gives it.
        adapter: String,
        /// What the driver said.
        reason: String,
    },
    /// The device went away while it was at work.
    #[error("the GPU was lost ({0}); run on the CPU")]
    Lost(String),
    /// The device has too little memory.
    #[error("the GPU ran out of memory; choose a lower resolution, or run on the CPU")]
    OutOfMemory,
    /// Something of the scene is larger than the adapter can bind.
    #[error("{what} need {bytes} bytes, and the GPU reads at most {limit} at once; run on the CPU")]
    TooLarge {
        /// What is too large, in words.
        what: &'static str,
        /// Its size in bytes.
        bytes: u64,
        /// The adapter's limit in bytes.
        limit: u64,
    },
    /// There are more fragments than the caller allows.
    #[error(transparent)]
    TooManyFragments(TooManyFragments),
    /// The driver or this library broke a rule of the other's.
    #[error("the GPU driver failed: {0}; run on the CPU")]
    Failed(String),
}
