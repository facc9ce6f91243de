//! How one level of a plant is made.

use secateur_levels::{CutoffChoice, MaterialChange};
use secateur_simplify::whole::WoodMode;
use secateur_simplify::{Options, Target};
use serde::{Deserialize, Serialize};

use crate::PartLevel;

/// How a level is made.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LevelOptions {
    /// How many triangles or leaves it has, and how leaves are chosen. A skeleton and memory that it lacks are the
    /// plant's.
    pub simplify: Options,
    /// Which alpha cutoffs its materials have.
    #[serde(default)]
    pub cutoffs: CutoffChoice,
    /// Which colours clear texels of its textures have.
    #[serde(default)]
    pub colors: ColorChoice,
    /// Parts that keep a share of their triangles of their own; the target is the rest's. Of parts that several name
    /// the last counts. A plant whose wood is ignored has leaves alone to name.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub level_of: Vec<PartLevel>,
    /// Whether it is looked at for how far it is from the plant: a first answer need not be.
    #[serde(default = "yes")]
    pub judged: bool,
}

fn yes() -> bool {
    true
}

/// Which colours clear texels of leaf textures have in a level.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
#[serde(rename_all = "kebab-case")]
pub enum ColorChoice {
    /// [`Self::Dilate`] where cutoffs are chosen, else [`Self::Keep`].
    #[default]
    #[cfg_attr(feature = "cli", value(skip))]
    Auto,
    /// Colours of the leaves near them, where mip maps would mix in others.
    Dilate,
    /// Colours of the tree.
    Keep,
}

impl LevelOptions {
    /// The level for the look with this target.
    pub fn to(target: Target) -> Self {
        Self::of(Options::to(target))
    }

    /// The level for the look with a share of all triangles, above 0 to 1.
    pub fn triangles(share: f64) -> Self {
        Self::to(Target::triangle_share(share))
    }

    /// The level of these options, with cutoffs and colours as suit them.
    pub fn of(simplify: Options) -> Self {
        Self {
            simplify,
            cutoffs: CutoffChoice::default(),
            colors: ColorChoice::default(),
            level_of: Vec::new(),
            judged: true,
        }
    }

    /// What becomes of the wood where nothing else is said: a budget of triangles is the whole plant's, other targets
    /// are of leaves.
    pub fn usual_wood(target: Target) -> WoodMode {
        match target {
            Target::Triangles(_) => WoodMode::Auto,
            Target::Leaves(_) | Target::MaxErrorPercent(_) => WoodMode::Ignore,
        }
    }

    /// What may be done to cutoffs; none where they stay.
    pub(crate) fn change(&self) -> Option<MaterialChange> {
        self.cutoffs.change(&self.simplify)
    }

    pub(crate) fn dilates(&self) -> bool {
        match self.colors {
            ColorChoice::Auto => self.change().is_some(),
            ColorChoice::Dilate => true,
            ColorChoice::Keep => false,
        }
    }
}
