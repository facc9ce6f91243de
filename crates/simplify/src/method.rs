//! The methods by name, each with its own options.

use secateur_model::{Foliage, PlantSkeleton};
use serde::{Deserialize, Serialize};

use crate::Error;
#[cfg(feature = "plant")]
use crate::by_branches::{ChainOptions, MergeOptions};
use crate::fsa::FsaOptions;
use crate::meshopt::MeshoptOptions;
use crate::select::{Select, Selection, Task};
use crate::stochastic::StochasticOptions;
use crate::vds::{Fast, Literal, VdsOptions};

/// How leaves are chosen.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
#[non_exhaustive]
pub enum Method {
    /// Viewpoint-driven simplification by the exact, fast engine.
    Vds(VdsOptions),
    /// VDS as the paper's Algorithm 1 is written: every view drawn anew for
    /// every candidate of every step. For checking, on a few hundred leaves.
    VdsReference(VdsOptions),
    /// Leaf collapse: the two leaves that are nearest and most in one plane
    /// become one ([`fsa`](crate::fsa)).
    Fsa(FsaOptions),
    /// Stochastic pruning: a random order, survivors grow alike
    /// ([`stochastic`](crate::stochastic)).
    Stochastic(StochasticOptions),
    /// The mesh simplifier of meshoptimizer on the mesh of all leaves
    /// ([`meshopt`](crate::meshopt)).
    Meshopt(MeshoptOptions),
    /// The multiresolution chain: branches go, the least branching length first.
    /// For plants with a skeleton.
    #[cfg(feature = "plant")]
    Chain(ChainOptions),
    /// Sticks and leaf clusters merge, the thinnest and highest first. For plants
    /// with a skeleton.
    #[cfg(feature = "plant")]
    Merge(MergeOptions),
}

impl Method {
    /// The name by which it is asked for.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Vds(_) => "vds",
            Self::VdsReference(_) => "vds-reference",
            Self::Fsa(_) => "fsa",
            Self::Stochastic(_) => "stochastic",
            Self::Meshopt(_) => "meshopt",
            #[cfg(feature = "plant")]
            Self::Chain(_) => "chain",
            #[cfg(feature = "plant")]
            Self::Merge(_) => "merge",
        }
    }

    /// The options of VDS, if it is that.
    pub fn vds(&self) -> Option<&VdsOptions> {
        match self {
            Self::Vds(options) | Self::VdsReference(options) => Some(options),
            Self::Fsa(_) | Self::Stochastic(_) | Self::Meshopt(_) => None,
            #[cfg(feature = "plant")]
            Self::Chain(_) | Self::Merge(_) => None,
        }
    }

    /// The options of VDS, to be changed.
    pub fn vds_mut(&mut self) -> Option<&mut VdsOptions> {
        match self {
            Self::Vds(options) | Self::VdsReference(options) => Some(options),
            Self::Fsa(_) | Self::Stochastic(_) | Self::Meshopt(_) => None,
            #[cfg(feature = "plant")]
            Self::Chain(_) | Self::Merge(_) => None,
        }
    }

    /// Whether it follows branches, and so needs a skeleton.
    pub fn needs_skeleton(&self) -> bool {
        match self {
            #[cfg(feature = "plant")]
            Self::Chain(_) | Self::Merge(_) => true,
            Self::Vds(_)
            | Self::VdsReference(_)
            | Self::Fsa(_)
            | Self::Stochastic(_)
            | Self::Meshopt(_) => false,
        }
    }

    /// Whether it removes a leaf a step, so that one run to few leaves gives every number of
    /// leaves above.
    pub fn removes_leaf_by_leaf(&self) -> bool {
        !matches!(self, Self::Meshopt(_))
    }

    /// Whether its options are in range, and the plant has what it needs.
    pub(crate) fn check(
        &self,
        foliage: &Foliage,
        skeleton: Option<&PlantSkeleton>,
    ) -> Result<(), Error> {
        self.select_by(|method| method.check(foliage, skeleton))
    }

    /// What the method selects for a task.
    pub(crate) fn select(
        &self,
        task: &Task<'_>,
        steps: &mut crate::select::Steps<'_>,
    ) -> Result<Selection, Error> {
        self.select_by(|method| method.select(task, steps))
    }

    fn select_by<T>(&self, work: impl FnOnce(&dyn Select) -> T) -> T {
        match self {
            Self::Vds(options) => work(&Fast(*options)),
            Self::VdsReference(options) => work(&Literal(*options)),
            Self::Fsa(options) => work(options),
            Self::Stochastic(options) => work(options),
            Self::Meshopt(options) => work(options),
            #[cfg(feature = "plant")]
            Self::Chain(options) => work(options),
            #[cfg(feature = "plant")]
            Self::Merge(options) => work(options),
        }
    }
}
