//! What can be chosen about VDS.

use secateur_model::BoundingSphere;
use secateur_raster::ViewSet;
use serde::{Deserialize, Serialize};

use crate::Target;

/// F of Eq. 4: the foliage that a candidate is compared with.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
#[serde(rename_all = "kebab-case")]
pub enum Reference {
    /// Compare with the original foliage.
    ///
    /// Algorithm 1 computes it once before its loop.
    #[default]
    Original,
    /// Compare with the foliage before the step.
    Previous,
}

/// The share of a pruned leaf's area that its neighbours gain. Eq. 5 only says
/// that it lies in 0..=1.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
#[serde(rename_all = "kebab-case")]
pub enum Resize {
    /// The cost over the largest cost of the step.
    #[default]
    Normalised,
    /// Like `normalised`, scaled so that other numbers of views grow about as much as 20 do.
    ///
    /// `max(0, 1 - (1 - cost / largest cost) sqrt(V / 20))` with V views, 20 or more, and
    /// `(cost / largest cost) ^ sqrt(V / 20)` with fewer; 0 where the cost is 0. As
    /// [`Self::Normalised`] with 20 views. A cost is a sum over the views, so costs differ the less in proportion
    /// the more views there are, and their ratio comes nearer to 1; this undoes that.
    Steady,
    /// The cost in bits, at most 1.
    Literal,
    /// 1: neighbours take over the whole area.
    Full,
    /// 1 while the views together have lost information, else 0.
    ///
    /// 1 while the sum over the views of VMI, less that of the original
    /// foliage, is negative without the leaf; else 0.
    Deficit,
    /// 0: no leaf grows.
    None,
}

/// Which of several leaves of the same least cost goes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
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
    /// These views throughout.
    Fixed(ViewSet),
    /// One set after the other, at least one.
    Staged(Vec<ViewStage>),
}

/// A set of views, and how long it is looked from.
#[derive(Clone, Debug, PartialEq)]
pub struct ViewStage {
    /// The views that drive this stage.
    pub views: ViewSet,
    /// The stage ends when this part of the leaves is gone, in thousandths; the last stage of a plan
    /// ends where the run does.
    pub gone_per_mille: usize,
}

/// What is left at the ends of the stages of [`ViewPlan::turning`], in thousandths of the leaves.
const LEFT_AFTER_TURNS: [usize; 16] = [
    700, 500, 350, 250, 175, 125, 90, 60, 40, 28, 20, 14, 10, 7, 5, 0,
];

impl ViewPlan {
    /// The paper's variable number of cameras about a sphere: 20 up to 10 % simplification, 12 up
    /// to 30 %, 8 up to 50 %, then 6 (section 4.2). Its icosahedron is one that judges nothing.
    pub fn variable(sphere: BoundingSphere) -> Self {
        let stages = [
            (ViewSet::dodecahedron(sphere), 100),
            (ViewSet::driving_icosahedron(sphere), 300),
            (ViewSet::cube(sphere), 500),
            (ViewSet::octahedron(sphere), 1000),
        ];
        Self::Staged(stages.map(ViewStage::from).into())
    }

    /// The dodecahedron and three turned ones, one after the other and over again; each until
    /// three in ten of the leaves that it found are gone. What one of them does not see another
    /// does, at the cost of 20 views at a time.
    pub fn turning(sphere: BoundingSphere) -> Self {
        let mut rigs = vec![ViewSet::dodecahedron(sphere)];
        rigs.extend(ViewSet::turned_dodecahedra(sphere));
        let stages = LEFT_AFTER_TURNS.iter().zip(rigs.iter().cycle());
        let stages = stages.map(|(left, rig)| ViewStage::from((rig.clone(), 1000 - left)));
        Self::Staged(stages.collect())
    }

    /// The views that it begins with.
    pub(crate) fn first(&self) -> ViewSet {
        match self {
            Self::Fixed(views) => views.clone(),
            Self::Staged(stages) => stages[0].views.clone(),
        }
    }

    /// All sets that it looks from, each once.
    pub fn sets(&self) -> Vec<ViewSet> {
        match self {
            Self::Fixed(views) => vec![views.clone()],
            Self::Staged(stages) => {
                let mut sets: Vec<ViewSet> = Vec::new();
                for stage in stages {
                    if !sets.contains(&stage.views) {
                        sets.push(stage.views.clone());
                    }
                }
                sets
            }
        }
    }

    /// This plan with other sets in the place of its own.
    pub(crate) fn map(self, of: impl Fn(&ViewSet) -> ViewSet) -> Self {
        match self {
            Self::Fixed(views) => Self::Fixed(of(&views)),
            Self::Staged(stages) => {
                let with = |stage: ViewStage| ViewStage {
                    views: of(&stage.views),
                    ..stage
                };
                Self::Staged(stages.into_iter().map(with).collect())
            }
        }
    }
}

impl From<(ViewSet, usize)> for ViewStage {
    fn from((views, gone_per_mille): (ViewSet, usize)) -> Self {
        Self {
            views,
            gone_per_mille,
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
