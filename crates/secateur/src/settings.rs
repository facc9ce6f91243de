//! What can be chosen about a run.

use std::sync::Arc;

use secateur_model::{BoundingSphere, Foliage, PlantSkeleton};
use secateur_plant::ClusterSize;
use secateur_raster::ViewSet;
use secateur_simplify::fsa::FsaOptions;
use secateur_simplify::meshopt::MeshoptOptions;
use secateur_simplify::vds::{Reference, Resize, Ties, ViewPlan};

use crate::Error;

/// How leaves are chosen.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum Method {
    /// Viewpoint-driven simplification by the exact, fast engine.
    #[default]
    Vds,
    /// The same as the paper's Algorithm 1 is written: every view drawn anew for
    /// every candidate of every step. For checking, on a few hundred leaves.
    VdsReference,
    /// Leaf collapse: the two leaves that are nearest and most in one plane
    /// become one ([`fsa`](crate::fsa)).
    Fsa,
    /// Stochastic pruning: a random order, survivors grow alike
    /// ([`stochastic`](crate::stochastic)).
    Stochastic,
    /// The mesh simplifier of meshoptimizer on the mesh of all leaves
    /// ([`meshopt`](crate::meshopt)).
    Meshopt,
    /// The multiresolution chain: branches go, the least branching length first.
    /// For plants with a skeleton ([`chain_order`](crate::plant::chain_order)).
    Chain,
    /// Sticks and leaf clusters merge, the thinnest and highest first. For plants
    /// with a skeleton ([`merge_order`](crate::plant::merge_order)).
    Merge,
}

impl Method {
    /// The name by which it is asked for.
    pub fn name(self) -> &'static str {
        match self {
            Self::Vds => "vds",
            Self::VdsReference => "vds-reference",
            Self::Fsa => "fsa",
            Self::Stochastic => "stochastic",
            Self::Meshopt => "meshopt",
            Self::Chain => "chain",
            Self::Merge => "merge",
        }
    }

    /// Whether it follows branches, and so needs [`Simplify::skeleton`].
    pub fn needs_skeleton(self) -> bool {
        matches!(self, Self::Chain | Self::Merge)
    }
}

/// Where leaves are rasterised; the results are the same, bit for bit.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Engine {
    /// A hardware GPU if there is one and the foliage is large enough to gain
    /// by it, else the CPU. Never a software driver.
    #[default]
    Auto,
    /// A GPU, or an error; software drivers are allowed.
    Gpu,
    /// The CPU.
    Cpu,
}

/// Where the foliage is looked at from while it is simplified.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum Views {
    /// The 20 vertices of a dodecahedron, at 3 radii from the foliage's centre.
    #[default]
    Dodecahedron,
    /// The 12 vertices of an icosahedron: also the set that
    /// [`measure`](crate::measure) judges by.
    Icosahedron,
    /// 92 views all around, those of the dodecahedron among them.
    Geodesic,
    /// The 8 corners of a cube.
    Cube,
    /// The 6 corners of an octahedron.
    Octahedron,
    /// The paper's variable number: 20 views up to 10 % simplification, 12 to
    /// 30 %, 8 to 50 %, then 6.
    Variable,
    /// One's own cameras.
    Cameras(ViewSet),
}

impl Views {
    /// The name in reports.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Dodecahedron => "dodecahedron",
            Self::Icosahedron => "icosahedron",
            Self::Geodesic => "92",
            Self::Cube => "8",
            Self::Octahedron => "6",
            Self::Variable => "vnc",
            Self::Cameras(_) => "cameras",
        }
    }

    /// The cameras about a foliage with this bounding sphere; the first set of
    /// the variable number.
    pub fn around(&self, sphere: BoundingSphere) -> ViewSet {
        match self {
            Self::Dodecahedron | Self::Variable => ViewSet::dodecahedron(sphere),
            Self::Icosahedron => ViewSet::icosahedron(sphere),
            Self::Geodesic => ViewSet::geodesic(sphere),
            Self::Cube => ViewSet::cube(sphere),
            Self::Octahedron => ViewSet::octahedron(sphere),
            Self::Cameras(views) => views.clone(),
        }
    }

    pub(crate) fn plan(&self, sphere: BoundingSphere) -> ViewPlan {
        match self {
            Self::Variable => ViewPlan::Variable(sphere),
            fixed => ViewPlan::Fixed(fixed.around(sphere)),
        }
    }
}

/// Width and height of the images that areas are counted in.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Resolution {
    /// 256, or more where the leaves need it.
    #[default]
    Auto,
    /// So many pixels, 1 to [`MAX_RESOLUTION`](crate::raster::MAX_RESOLUTION).
    Pixels(u32),
}

/// When to stop.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Target {
    /// At this many leaves. More than there are: nothing is removed, and a
    /// warning says so.
    Leaves(u64),
    /// At this share of the leaves, 0 to 1, rounded to the nearest number.
    Ratio(f64),
    /// Before the first step after which the VMI error on the driving views
    /// would exceed this many per cent.
    MaxError(f64),
}

impl Target {
    /// The number of leaves to stop at and the error to stop before.
    ///
    /// # Errors
    /// [`Error::Target`] if the number is out of range.
    pub fn resolve(self, leaf_count: usize) -> Result<(usize, Option<f64>), Error> {
        match self {
            Self::Leaves(n) => Ok((usize::try_from(n).unwrap_or(usize::MAX), None)),
            Self::Ratio(ratio) if (0.0..=1.0).contains(&ratio) => {
                Ok(((ratio * leaf_count as f64).round() as usize, None))
            }
            Self::MaxError(percent) if percent >= 0.0 => Ok((0, Some(percent))),
            Self::Ratio(r) => Err(Error::Target(format!("ratio {r}"), "a number from 0 to 1")),
            Self::MaxError(e) => Err(Error::Target(
                format!("{e} % error"),
                "a number from 0 upwards",
            )),
        }
    }
}

/// Whether holes of leaf textures count.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Alpha {
    /// What an alpha mask cuts out is not there.
    #[default]
    Mask,
    /// Leaves are solid polygons.
    Ignore,
}

impl Alpha {
    /// The foliage as it is to be looked at.
    pub fn apply(self, foliage: &Foliage) -> std::borrow::Cow<'_, Foliage> {
        match self {
            Self::Mask => std::borrow::Cow::Borrowed(foliage),
            Self::Ignore => std::borrow::Cow::Owned(foliage.without_cutouts()),
        }
    }
}

/// The settings of a run; [`Simplify::to`] has the defaults of the command line.
#[derive(Clone, Debug, PartialEq)]
pub struct Simplify {
    /// When to stop.
    pub target: Target,
    /// How leaves are chosen.
    pub method: Method,
    /// Where they are rasterised.
    pub engine: Engine,
    /// From where.
    pub views: Views,
    /// How finely.
    pub resolution: Resolution,
    /// F of Eq. 4: the foliage that costs are measured against.
    pub reference: Reference,
    /// Eq. 5: the share of a pruned leaf's area that its neighbours gain.
    pub resize: Resize,
    /// How many nearest neighbours share that, at least 1.
    pub neighbours: usize,
    /// Nothing grows while the driving views show this many times as much
    /// foliage as at first, in pixels, or more; at least 0, no limit if `None`.
    pub max_coverage: Option<f64>,
    /// Which of equally cheap leaves goes first.
    pub ties: Ties,
    /// Whether holes of leaf textures count.
    pub alpha: Alpha,
    /// For methods that draw lots; others only record it.
    pub seed: u64,
    /// [`Method::Stochastic`]: the share of the lost area that the survivors
    /// regain, 0 to 1.
    pub area_weight: f64,
    /// [`Method::Fsa`]: what counts.
    pub fsa: FsaOptions,
    /// [`Method::Meshopt`]: which simplifier, and whether area is given back.
    pub meshopt: MeshoptOptions,
    /// [`Method::Chain`] and [`Method::Merge`]: what the foliage has grown on, as
    /// [`Tree::skeleton`](crate::Tree::skeleton) reads it.
    pub skeleton: Option<Arc<PlantSkeleton>>,
    /// [`Method::Merge`]: how large clusters of leaves are.
    pub cluster_size: ClusterSize,
    /// Whether the final foliage is rasterised from scratch another way and
    /// compared.
    pub audit: bool,
}

impl Simplify {
    /// The defaults, with this target. Audits in debug builds.
    pub fn to(target: Target) -> Self {
        Self {
            target,
            method: Method::default(),
            engine: Engine::default(),
            views: Views::default(),
            resolution: Resolution::default(),
            reference: Reference::default(),
            resize: Resize::default(),
            neighbours: 1,
            max_coverage: None,
            ties: Ties::default(),
            alpha: Alpha::default(),
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ratios_round_to_the_nearest_count() {
        let leaves = |ratio| Target::Ratio(ratio).resolve(15).unwrap().0;
        // 1.5 and 2.25 leaves; all; none.
        assert_eq!([0.1, 0.15, 1.0, 0.0].map(leaves), [2, 2, 15, 0]);
    }

    #[test]
    fn targets_out_of_range_are_refused() {
        for target in [
            Target::Ratio(1.01),
            Target::Ratio(-0.1),
            Target::Ratio(f64::NAN),
            Target::MaxError(-1.0),
            Target::MaxError(f64::NAN),
        ] {
            assert!(target.resolve(10).is_err(), "{target:?}");
        }
        let error = Target::Ratio(1.5).resolve(10).unwrap_err().to_string();
        assert_eq!(
            error,
            "the target of ratio 1.5 must be a number from 0 to 1"
        );
    }
}
