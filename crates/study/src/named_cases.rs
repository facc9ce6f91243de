//! Cases that plans have in common, by name.

use secateur_plant::{ClusterSize, Metric};
use secateur_simplify::by_branches::{ChainOptions, MergeOptions};
use secateur_simplify::fsa::{FsaOptions, Hausdorff};
use secateur_simplify::meshopt::{Borders, MeshoptOptions, Mode};
use secateur_simplify::stochastic::StochasticOptions;
use secateur_simplify::vds::{Reference, Resize};
use secateur_simplify::{Method, Preset};

use crate::Case;

/// The default of the program: a result that looks like the original.
pub(crate) fn look() -> Case {
    Case::vds(Preset::Look)
}

/// The least VMI error: growth in proportion to cost.
pub(crate) fn information() -> Case {
    Case::vds(Preset::Information)
}

/// FSA as it is published, which is what comparisons call by that name.
pub(crate) fn fsa() -> Case {
    Case::of(Method::Fsa(FsaOptions::published()))
}

/// What makes of FSA what this program does unasked: corners that make no slivers.
pub(crate) fn fsa_without_slivers() -> Case {
    Case::of(Method::Fsa(FsaOptions::default()))
}

/// FSA by the distances of surfaces.
pub(crate) fn fsa_of_surfaces() -> Case {
    Case::of(Method::Fsa(FsaOptions {
        hausdorff: Hausdorff::Surface,
        ..FsaOptions::published()
    }))
}

/// The paper as it is written, in one reading of its Eq. 5.
pub(crate) fn paper(preset: Preset) -> Case {
    Case::vds(preset)
}

pub(crate) fn stochastic() -> Case {
    Case::of(Method::Stochastic(StochasticOptions::default()))
}

pub(crate) fn stochastic_of_half_area() -> Case {
    Case::of(Method::Stochastic(StochasticOptions {
        area_weight: 0.5,
        ..StochasticOptions::default()
    }))
}

pub(crate) fn stochastic_of_seed(seed: u64) -> Case {
    Case::of(Method::Stochastic(StochasticOptions {
        seed,
        ..StochasticOptions::default()
    }))
}

pub(crate) fn meshopt(borders: Borders) -> Case {
    Case::of(Method::Meshopt(MeshoptOptions {
        borders,
        ..MeshoptOptions::default()
    }))
}

/// meshoptimizer's example of cluster LODs with the dilation of its own.
pub(crate) fn clusterlod() -> Case {
    Case::of(Method::Meshopt(MeshoptOptions {
        mode: Mode::Clusters,
        borders: Borders::Dilate,
    }))
}

/// [`information`] where what a leaf has lost goes to 4 neighbours, measured against the step
/// before.
pub(crate) fn shared_deficit() -> Case {
    information().with_vds(|vds| {
        vds.reference = Reference::Previous;
        vds.resize = Resize::Deficit;
        vds.neighbours = 4;
    })
}

/// [`shared_deficit`], kept from making crowns denser than they were.
pub(crate) fn coverage_kept() -> Case {
    shared_deficit().with_vds(|vds| vds.max_coverage = Some(1.0))
}

pub(crate) fn resized(resize: Resize) -> Case {
    information().with_vds(|vds| vds.resize = resize)
}

/// What trees that know their branches get beside the rest, in every plan that compares methods.
pub(crate) fn by_branches() -> [Case; 3] {
    let merge = |cluster_size| Case::of(Method::Merge(MergeOptions { cluster_size }));
    [
        chain(Metric::default()),
        merge(ClusterSize::Paper),
        merge(ClusterSize::Area),
    ]
}

pub(crate) fn chain(branch_metric: Metric) -> Case {
    Case::of(Method::Chain(ChainOptions { branch_metric }))
}

/// The chain by all of its metrics, the paper's own first.
pub(crate) fn by_metrics() -> Vec<Case> {
    let first = chain(Metric::default());
    std::iter::once(first).chain(other_chains()).collect()
}

/// The chain by the metrics that its paper does not prefer.
pub(crate) fn other_chains() -> [Case; 3] {
    [Metric::Children, Metric::Descendants, Metric::LongestPath].map(chain)
}
