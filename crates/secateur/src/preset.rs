//! What a result is for: the values that settings begin with.

use secateur_plant::ClusterSize;
use secateur_simplify::fsa::FsaOptions;
use secateur_simplify::meshopt::MeshoptOptions;
use secateur_simplify::vds::{Reference, Resize, Ties};

use crate::{Alpha, Engine, Fitting, LeafTriangles, Method, Resolution, Simplify, Target, Views};

/// What a result is for. Each setting can be changed afterwards.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum Preset {
    /// Pictures that look like the original: costs are measured against the foliage before each
    /// step, a neighbour takes over all of a pruned leaf's area while the views show less
    /// foliage than at first, and at the end sizes are fitted so that each part of the crown is
    /// as dense as it was.
    #[default]
    Look,
    /// The least VMI error, at the price of a crown that gets too dense: costs are measured
    /// against the original, growth is in proportion to cost, and sizes of a budget of triangles
    /// are fitted to outline and information.
    Information,
}

impl Preset {
    /// The name by which it is asked for.
    pub fn name(self) -> &'static str {
        match self {
            Self::Look => "look",
            Self::Information => "information",
        }
    }
}

impl Simplify {
    /// The settings of a preset, with this target. Audits in debug builds.
    pub fn with_preset(preset: Preset, target: Target) -> Self {
        let (reference, resize, max_coverage) = match preset {
            Preset::Look => (Reference::Previous, Resize::Full, Some(1.0)),
            Preset::Information => (Reference::Original, Resize::Normalised, None),
        };
        Self {
            preset,
            target,
            method: Method::default(),
            engine: Engine::default(),
            views: Views::default(),
            resolution: Resolution::default(),
            reference,
            resize,
            neighbours: 1,
            max_coverage,
            ties: Ties::default(),
            alpha: Alpha::default(),
            leaf_triangles: LeafTriangles::default(),
            fit: Fitting::default(),
            seed: 0,
            area_weight: 1.0,
            fsa: FsaOptions::default(),
            meshopt: MeshoptOptions::default(),
            skeleton: None,
            cluster_size: ClusterSize::default(),
            audit: cfg!(debug_assertions),
        }
    }
}
