//! Methods that follow the plant's branches: the multiresolution chain (Lluch et al., ICCS
//! 2010) and the merging of sticks and leaf clusters (Hughes et al.).

use secateur_model::{Foliage, PlantSkeleton};
use secateur_plant::{ClusterSize, Metric, chain_order, check_depth, merge_order};
use serde::{Deserialize, Serialize};

use crate::Error;
use crate::select::{Select, Selection, Steps, Task};

/// What can be chosen about the multiresolution chain.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(clap::Args))]
pub struct ChainOptions {
    /// chain: what is counted of a branch; those with the least go first.
    #[cfg_attr(feature = "cli", arg(long, value_enum, default_value_t))]
    #[serde(with = "MetricName", default)]
    pub branch_metric: Metric,
}

/// How a metric of branches is spelled.
#[derive(Serialize, Deserialize)]
#[serde(remote = "Metric", rename_all = "kebab-case")]
enum MetricName {
    Children,
    Descendants,
    LongestPath,
    BranchingLength,
}

/// What can be chosen about merging.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(clap::Args))]
pub struct MergeOptions {
    /// merge: how large clusters of leaves are.
    #[cfg_attr(feature = "cli", arg(long, value_enum, default_value_t))]
    #[serde(with = "ClusterSizeName")]
    pub cluster_size: ClusterSize,
}

/// How a size of clusters is spelled.
#[derive(Serialize, Deserialize)]
#[serde(remote = "ClusterSize", rename_all = "kebab-case")]
enum ClusterSizeName {
    Paper,
    Area,
}

impl Select for ChainOptions {
    fn check(&self, foliage: &Foliage, skeleton: Option<&PlantSkeleton>) -> Result<(), Error> {
        checked("chain", foliage, skeleton).map(|_| ())
    }

    fn select(&self, task: &Task<'_>, _: &mut Steps<'_>) -> Result<Selection, Error> {
        let skeleton = checked("chain", task.foliage, task.skeleton)?;
        let leaves = task.target.leaves_to_stop_at(task.foliage);
        let order = chain_order(task.foliage, skeleton, self.branch_metric, leaves);
        Ok(Selection::unseen(order))
    }
}

impl Select for MergeOptions {
    fn check(&self, foliage: &Foliage, skeleton: Option<&PlantSkeleton>) -> Result<(), Error> {
        checked("merge", foliage, skeleton).map(|_| ())
    }

    fn select(&self, task: &Task<'_>, _: &mut Steps<'_>) -> Result<Selection, Error> {
        let skeleton = checked("merge", task.foliage, task.skeleton)?;
        let leaves = task.target.leaves_to_stop_at(task.foliage);
        let order = merge_order(task.foliage, skeleton, self.cluster_size, leaves);
        Ok(Selection::unseen(order))
    }
}

/// The skeleton, if there is one, of this foliage.
fn checked<'a>(
    method: &'static str,
    foliage: &Foliage,
    skeleton: Option<&'a PlantSkeleton>,
) -> Result<&'a PlantSkeleton, Error> {
    let skeleton = skeleton.ok_or(Error::NoSkeleton { method })?;
    skeleton.check(foliage.leaves().len())?;
    check_depth(&skeleton.segments)?;
    Ok(skeleton)
}
