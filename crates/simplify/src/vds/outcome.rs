//! What a run of VDS gives back.

use secateur_model::{OverMemory, RemovalOrder};
use secateur_raster::{AreaTable, RasterError, ViewSet};

use crate::vmi::Vmi;

/// Where a run stands; passed to the caller after every step.
#[derive(Clone, Copy, Debug)]
pub struct Progress {
    /// Leaves removed so far.
    pub steps: usize,
    /// Steps to do at most.
    pub steps_at_most: usize,
}

/// Why a run could not be made.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum VdsError {
    /// The caller asked to stop.
    #[error("stopped before the end")]
    Cancelled,
    /// A view set without views.
    #[error("there is no view to measure the foliage from")]
    NoViews,
    /// The resolution or the number of pixels is out of range.
    #[error(
        "{views} views of {resolution} x {resolution} pixels are out of range: at least 1 and at most {max} x {max}, and at most 2^29 pixels over all views"
    )]
    Resolution {
        /// Views of the set.
        views: usize,
        /// Width and height in pixels that were asked for.
        resolution: u32,
        /// The largest width and height in pixels that can be had.
        max: u32,
    },
    /// The A-buffer could not be made.
    #[error("{0}")]
    Raster(#[source] RasterError),
    /// The A-buffer takes more memory than is allowed.
    #[error("{0}")]
    Memory(#[source] OverMemory),
    /// [`VdsOptions::neighbours`](super::VdsOptions::neighbours) is 0.
    #[error("growth must be shared by at least one neighbour")]
    NoNeighbours,
    /// `max_coverage` is negative or not a number.
    #[error("the coverage up to which leaves may grow, {0}, must be a number of at least 0")]
    MaxCoverage(f64),
}

impl VdsError {
    pub(crate) fn from_raster(error: RasterError) -> Self {
        match error.downcast::<OverMemory>() {
            Ok(over) => Self::Memory(*over),
            Err(other) => Self::Raster(other),
        }
    }
}

/// A removal order, and what the views show at its end.
#[derive(Clone, Debug, PartialEq)]
pub struct VdsOutcome {
    /// Which leaf each step removed, and which grew for it.
    pub order: RemovalOrder,
    /// The cost of each step: the sum over the views of `P * |change of VMI|`,
    /// in units of 2^-27 bits (see [`vmi`](crate::vmi)).
    pub costs_scaled: Vec<i64>,
    /// Whether it ended since the next step would have exceeded the error asked for.
    pub is_at_max_error: bool,
    /// The views of the last step.
    pub views: ViewSet,
    /// Areas of the foliage at the end in those views.
    pub areas: AreaTable,
    /// VMI of the original foliage in those views.
    pub vmi_original: Vmi,
    /// VMI of the foliage at the end in those views.
    pub vmi_final: Vmi,
}
