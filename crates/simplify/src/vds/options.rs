//! What can be chosen about VDS; the defaults are those of the command line.

use secateur_model::BoundingSphere;
use secateur_raster::ViewSet;

/// F of Eq. 4: the foliage that a candidate is compared with.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Reference {
    /// The original foliage, as Algorithm 1 computes it once before its loop.
    #[default]
    Original,
    /// The foliage before the step.
    Previous,
}

/// The share of a pruned leaf's area that its neighbours gain. Eq. 5 only says
/// that it lies in 0..=1.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Resize {
    /// The cost over the largest cost of any leaf in this step.
    #[default]
    Normalised,
    /// The cost in bits, at most 1.
    Literal,
    /// All of it: the share is 1.
    Full,
    /// 1 while the sum over the views of VMI, less that of the original
    /// foliage, is negative without the leaf; else 0.
    Deficit,
    /// 0: leaves are only removed.
    None,
}

/// Which of several leaves of the same least cost goes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Ties {
    /// The lowest leaf number, as Algorithm 1's strict comparison has it.
    #[default]
    Order,
    /// The lowest of a fixed mix of the leaf number's bits, so that ties are
    /// drawn from all over the crown.
    Spread,
}

/// Where VDS looks from.
#[derive(Clone, Debug, PartialEq)]
pub enum ViewPlan {
    /// The same views throughout.
    Fixed(ViewSet),
    /// The paper's variable number of cameras about this sphere: 20 up to 10 %
    /// simplification, 12 up to 30 %, 8 up to 50 %, then 6 (section 4.2).
    Variable(BoundingSphere),
}

/// When a run stops: at a number of leaves, or earlier at an error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stop {
    /// At this many leaves.
    pub leaves: usize,
    /// Before the first step after which the VMI error on the driving views
    /// would exceed this many per cent.
    pub max_error_percent: Option<f64>,
}

/// The settings of a VDS run.
#[derive(Clone, Debug, PartialEq)]
pub struct VdsOptions {
    /// Where it looks from.
    pub views: ViewPlan,
    /// Image width and height in pixels.
    pub resolution: u32,
    /// What candidates are compared with.
    pub reference: Reference,
    /// How much neighbours grow.
    pub resize: Resize,
    /// How many nearest neighbours share the growth, at least 1.
    pub neighbours: usize,
    /// Nothing grows while the views together show this many times as much
    /// foliage as at first, in pixels, or more; at least 0, no limit if `None`.
    pub max_coverage: Option<f64>,
    /// Which of equals goes.
    pub ties: Ties,
    /// The number of leaves or the error at which the run stops.
    pub stop: Stop,
}

impl VdsOptions {
    /// The defaults, with these views at this resolution, down to this many
    /// leaves.
    pub fn new(views: ViewSet, resolution: u32, leaves: usize) -> Self {
        Self {
            views: ViewPlan::Fixed(views),
            resolution,
            reference: Reference::default(),
            resize: Resize::default(),
            neighbours: 1,
            max_coverage: None,
            ties: Ties::default(),
            stop: Stop {
                leaves,
                max_error_percent: None,
            },
        }
    }
}
