//! What can be chosen about a run.

use std::fmt;
use std::sync::Arc;

use glam::DQuat;
use secateur_model::{BoundingSphere, Foliage, PlantSkeleton};
use secateur_plant::ClusterSize;
use secateur_raster::ViewSet;
use secateur_simplify::fit::{DEFAULT_OUTLINE_WEIGHT, Objective};
use secateur_simplify::fsa::FsaOptions;
use secateur_simplify::meshopt::MeshoptOptions;
use secateur_simplify::vds::{Reference, Resize, Ties, ViewPlan};

use crate::{Error, Preset};

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
    /// Others, turned as one about the foliage's centre, and with them those in which sizes
    /// are fitted; of the variable number the first set.
    Turned {
        /// Which.
        views: Box<Self>,
        /// By what.
        turn: DQuat,
    },
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
            Self::Turned { .. } => "turned",
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
            Self::Turned { views, turn } => views.around(sphere).turned(sphere.centre, *turn),
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
    /// At this many triangles of the foliage, or as few below as whole leaves and
    /// collapses of their edges allow; [`Method::Meshopt`] may end above.
    Triangles(u64),
    /// At this share of the foliage's triangles, 0 to 1, rounded to the nearest number.
    TriangleRatio(f64),
}

/// A target as numbers of one foliage.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Goal {
    Leaves(usize),
    Triangles(usize),
    MaxError(f64),
}

impl Target {
    /// Whether its number is in range.
    ///
    /// # Errors
    /// [`Error::Target`] if it is not.
    pub fn check(self) -> Result<(), Error> {
        let refused = |what: String, range| Err(Error::Target(what, range));
        match self {
            Self::Ratio(share) | Self::TriangleRatio(share) if !(0.0..=1.0).contains(&share) => {
                refused(format!("ratio {share}"), "a number from 0 to 1")
            }
            Self::MaxError(percent) if percent.is_nan() || percent < 0.0 => {
                refused(format!("{percent} % error"), "a number from 0 upwards")
            }
            _ => Ok(()),
        }
    }

    pub(crate) fn goal(self, foliage: &Foliage) -> Result<Goal, Error> {
        self.check()?;
        let number = |n: u64| usize::try_from(n).unwrap_or(usize::MAX);
        let share_of = |share: f64, count: usize| (share * count as f64).round() as usize;
        Ok(match self {
            Self::Leaves(n) => Goal::Leaves(number(n)),
            Self::Ratio(share) => Goal::Leaves(share_of(share, foliage.leaves().len())),
            Self::MaxError(percent) => Goal::MaxError(percent),
            Self::Triangles(n) => Goal::Triangles(number(n)),
            Self::TriangleRatio(share) => {
                Goal::Triangles(share_of(share, foliage.triangles().len()))
            }
        })
    }
}

/// How many triangles of its own a leaf keeps at most.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum LeafTriangles {
    /// Where triangles are the target, as many as show the most over all leaves while as few
    /// as possible of them go; but no fewer than show the same, or two, where it has a
    /// cut-out. For other targets, all.
    #[default]
    Auto,
    /// All.
    Keep,
    /// So many, at least 1.
    AtMost(u32),
}

/// As on the command line.
impl fmt::Display for LeafTriangles {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Auto => f.write_str("auto"),
            Self::Keep => f.write_str("keep"),
            Self::AtMost(most) => most.fmt(f),
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

/// Whether the sizes of what is left are fitted to the original at the end, whatever
/// the method made of them: see [`mod@crate::fit`].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub enum Fitting {
    /// As the [`Preset`] has it, for [`Method::Vds`] and [`Method::VdsReference`] where
    /// nothing is said of how leaves grow: it is for the program then to say how what is left
    /// is best used. Never for other methods.
    ///
    /// [`Preset::Look`]: as [`Self::Coverage`], but none where all leaves are left and one triangle
    /// of a card shows all of it. [`Preset::Information`]: to triangles at
    /// [`Resolution::Auto`] as [`Self::Weight`] of
    /// [`DEFAULT_OUTLINE_WEIGHT`], else none; nor where all leaves are left, one
    /// triangle of a card shows all of it, and the driving views say so to a 400th of their
    /// information.
    #[default]
    Auto,
    /// None.
    None,
    /// To the coverage of small blocks of 12 views from which no leaf was chosen, or, with
    /// [`Views::Cameras`], of these.
    Coverage,
    /// To the outline and the information in 78 views from which no leaf was chosen, or, with
    /// [`Views::Cameras`], in these; with this weight of a pixel of outline against a bit of
    /// VMI times a pixel, 0 to [`MAX_OUTLINE_WEIGHT`](crate::fit::MAX_OUTLINE_WEIGHT).
    Weight(f64),
}

/// As on the command line.
impl fmt::Display for Fitting {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Auto => f.write_str("auto"),
            Self::None => f.write_str("none"),
            Self::Coverage => f.write_str("coverage"),
            Self::Weight(weight) => weight.fmt(f),
        }
    }
}

/// The settings of a run; [`Simplify::to`] has the defaults of the command line.
#[derive(Clone, Debug, PartialEq)]
pub struct Simplify {
    /// What the settings began with; it says what [`Fitting::Auto`] is.
    pub preset: Preset,
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
    /// [`Method::Vds`]: leaves of fewer triangles, made before any leaf goes. They are
    /// then what costs and coverage are measured against.
    pub leaf_triangles: LeafTriangles,
    /// Whether the sizes of what is left are fitted to the original at the end.
    pub fit: Fitting,
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
    /// The defaults, with this target: those of [`Preset::Look`]. Audits in debug builds.
    pub fn to(target: Target) -> Self {
        Self::with_preset(Preset::default(), target)
    }

    /// What sizes are fitted to, if they are.
    pub fn objective(&self) -> Option<Objective> {
        let information = |outline_weight| Objective::Information { outline_weight };
        match self.fit {
            Fitting::None => None,
            Fitting::Coverage => Some(Objective::Coverage),
            Fitting::Weight(weight) => Some(information(weight)),
            Fitting::Auto if !self.grows_as_its_preset_has_it() => None,
            Fitting::Auto => match self.preset {
                Preset::Look => Some(Objective::Coverage),
                Preset::Information => {
                    let is_of_triangles =
                        matches!(self.target, Target::Triangles(_) | Target::TriangleRatio(_));
                    (is_of_triangles
                        && self.method == Method::Vds
                        && self.resolution == Resolution::Auto)
                        .then_some(information(DEFAULT_OUTLINE_WEIGHT))
                }
            },
        }
    }

    fn grows_as_its_preset_has_it(&self) -> bool {
        let preset = Self::with_preset(self.preset, self.target);
        matches!(self.method, Method::Vds | Method::VdsReference)
            && self.resize == preset.resize
            && self.max_coverage == preset.max_coverage
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;
    use secateur_model::LeafTriangle;

    #[test]
    fn sizes_are_fitted_unasked_where_all_else_is_left_to_the_program_too() {
        let usual = Some(Objective::Information {
            outline_weight: DEFAULT_OUTLINE_WEIGHT,
        });
        let triangles = Target::TriangleRatio(0.5);
        let information = Simplify::with_preset(Preset::Information, triangles);
        let look = Simplify::to(triangles);
        assert_eq!(information.objective(), usual);
        assert_eq!(look.objective(), Some(Objective::Coverage));
        // Only what one asks to be shown best is fitted to coverage at any target and resolution.
        let pixels = Resolution::Pixels(512);
        for target in [Target::Ratio(0.5), Target::Leaves(3), Target::MaxError(5.0)] {
            assert_eq!(
                Simplify::with_preset(Preset::Information, target).objective(),
                None
            );
            assert_eq!(Simplify::to(target).objective(), Some(Objective::Coverage));
        }
        let at = |settings: &Simplify, resolution| Simplify {
            resolution,
            ..settings.clone()
        };
        assert_eq!(at(&information, pixels).objective(), None);
        assert_eq!(at(&look, pixels).objective(), Some(Objective::Coverage));
        for auto in [information, look] {
            let others = [
                Simplify {
                    method: Method::Fsa,
                    ..auto.clone()
                },
                Simplify {
                    resize: Resize::None,
                    ..auto.clone()
                },
                Simplify {
                    max_coverage: Some(1.5),
                    ..auto.clone()
                },
                Simplify {
                    fit: Fitting::None,
                    ..auto.clone()
                },
            ];
            for other in others {
                assert_eq!(other.objective(), None, "{other:?}");
                let asked = Simplify {
                    fit: Fitting::Weight(3.0),
                    ..other.clone()
                };
                let outline_weight = 3.0;
                assert_eq!(
                    asked.objective(),
                    Some(Objective::Information { outline_weight })
                );
                let asked = Simplify {
                    fit: Fitting::Coverage,
                    ..other
                };
                assert_eq!(asked.objective(), Some(Objective::Coverage));
            }
        }
    }

    /// So many leaves of two triangles.
    fn foliage(leaves: usize) -> Foliage {
        let triangle = LeafTriangle::plain([DVec3::ZERO, DVec3::X, DVec3::Y]);
        let mut foliage = Foliage::default();
        for _ in 0..leaves {
            foliage.push_leaf(&[triangle; 2], None).unwrap();
        }
        foliage
    }

    #[test]
    fn ratios_round_to_the_nearest_count() {
        let foliage = foliage(15);
        let goal = |target: Target| target.goal(&foliage).unwrap();
        // 1.5 and 2.25 leaves; all; none. 7.5 of 30 triangles.
        let leaves = [0.1, 0.15, 1.0, 0.0].map(|ratio| goal(Target::Ratio(ratio)));
        assert_eq!(leaves, [2, 2, 15, 0].map(Goal::Leaves));
        assert_eq!(goal(Target::TriangleRatio(0.25)), Goal::Triangles(8));
        assert_eq!(goal(Target::Triangles(7)), Goal::Triangles(7));
    }

    #[test]
    fn targets_out_of_range_are_refused() {
        for target in [
            Target::Ratio(1.01),
            Target::Ratio(-0.1),
            Target::Ratio(f64::NAN),
            Target::TriangleRatio(1.01),
            Target::MaxError(-1.0),
            Target::MaxError(f64::NAN),
        ] {
            assert!(target.check().is_err(), "{target:?}");
            assert!(target.goal(&foliage(1)).is_err(), "{target:?}");
        }
        let error = Target::Ratio(1.5).check().unwrap_err().to_string();
        assert_eq!(
            error,
            "the target of ratio 1.5 must be a number from 0 to 1"
        );
    }
}
