//! What can be chosen about VDS.

use secateur_model::BoundingSphere;
use secateur_raster::ViewSet;
use serde::{Deserialize, Serialize};

use crate::Target;

/// F of Eq. 4: the foliage that a candidate is compared with.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Reference {
    /// The original foliage, as Algorithm 1 computes it once before its loop.
    #[default]
    Original,
    /// The foliage before the step.
    Previous,
}

/// The share of a pruned leaf's area that its neighbours gain. Eq. 5 only says
/// that it lies in 0..=1.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
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
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
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

impl ViewPlan {
    /// The views that it begins with.
    pub(crate) fn first(&self) -> ViewSet {
        match self {
            Self::Fixed(views) => views.clone(),
            Self::Variable(sphere) => ViewSet::dodecahedron(*sphere),
        }
    }
}

/// How VDS chooses leaves and lets others grow. The defaults are a plain reading of the paper,
/// with growth in proportion to cost.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct VdsOptions {
    /// F of Eq. 4: what candidates are compared with.
    pub reference: Reference,
    /// Eq. 5: the share of a pruned leaf's area that its neighbours gain.
    pub resize: Resize,
    /// How many nearest neighbours share the growth, at least 1.
    pub neighbours: usize,
    /// Nothing grows while the driving views together show this many times as much
    /// foliage as at first, in pixels, or more; at least 0, no limit if `None`.
    pub max_coverage: Option<f64>,
    /// Which of equally cheap leaves goes first.
    pub ties: Ties,
}

impl Default for VdsOptions {
    fn default() -> Self {
        Self {
            reference: Reference::default(),
            resize: Resize::default(),
            neighbours: 1,
            max_coverage: None,
            ties: Ties::default(),
        }
    }
}

/// One run of VDS, as its two implementations take it.
#[derive(Clone, Debug, PartialEq)]
pub struct VdsRun {
    /// How leaves are chosen.
    pub options: VdsOptions,
    /// Where it looks from.
    pub views: ViewPlan,
    /// Image width and height in pixels.
    pub resolution: u32,
    /// When to stop. With a number of triangles it goes on until whichever leaves are left have
    /// no more than that.
    pub target: Target,
}

impl VdsRun {
    /// With the default options, from these views at this resolution, down to this many leaves.
    pub fn to_leaves(views: ViewSet, resolution: u32, leaves: u64) -> Self {
        Self {
            options: VdsOptions::default(),
            views: ViewPlan::Fixed(views),
            resolution,
            target: Target::leaves(leaves),
        }
    }
}
