//! Small changes that should not matter: how much a method's result depends on
//! accidents of its input.

use std::sync::Arc;

use glam::{DQuat, DVec3};
use secateur_model::{
    CornerRef, Foliage, LeafId, LeafTriangle, NewLeaf, Place, PlantSkeleton, RemovalOrder, Step,
};
use secateur_plant::Random;
use secateur_simplify::{Options, Views};

use crate::random::{in_cube, signed, stream};

/// A small change of a tree or of the driving views.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Perturbation {
    /// The tree and the views as they are.
    None,
    /// The driving and the fitting views turned as one about the foliage's centre, to a place
    /// drawn with this seed.
    Rotated(u64),
    /// Every corner moved at random within a cube of this half side, in radii of
    /// the foliage.
    Jittered(f64),
    /// The leaves in another order, drawn with this seed.
    Shuffled(u64),
}

impl Perturbation {
    /// No change, and some of each kind.
    pub const ALL: [Self; 8] = [
        Self::None,
        Self::Rotated(1),
        Self::Rotated(2),
        Self::Jittered(1e-5),
        Self::Jittered(1e-4),
        Self::Jittered(1e-3),
        Self::Shuffled(1),
        Self::Shuffled(2),
    ];

    /// What rows call it; empty for no change.
    pub fn name(self) -> String {
        match self {
            Self::None => String::new(),
            Self::Rotated(k) => format!("views turned {k}"),
            Self::Jittered(size) => format!("jitter {size:e}"),
            Self::Shuffled(k) => format!("leaves shuffled {k}"),
        }
    }

    /// Makes the foliage and the options that a method gets in place of the tree's.
    pub(crate) fn apply(self, foliage: &Foliage, options: &Options) -> Changed {
        let mut options = options.clone();
        let mut names: Vec<LeafId> = (0..foliage.leaves().len())
            .map(LeafId::from_index)
            .collect();
        let mut random = stream(0);
        match self {
            Self::None => {}
            Self::Rotated(seed) => {
                random = stream(seed);
                options.views = Views::Turned {
                    views: Box::new(options.views),
                    turn: any_turn(&mut random),
                };
            }
            Self::Jittered(_) => {}
            Self::Shuffled(seed) => {
                random = stream(seed);
                let mut keyed: Vec<(u64, LeafId)> =
                    names.iter().map(|leaf| (random.bits(), *leaf)).collect();
                keyed.sort_unstable();
                names = keyed.into_iter().map(|(_, leaf)| leaf).collect();
                let skeleton = options.skeleton.take();
                options.skeleton = skeleton.map(|s| Arc::new(with_leaves_in(&s, &names)));
            }
        }
        let radius = foliage.bounding_sphere().map_or(0.0, |s| s.radius);
        let reach = match self {
            Self::Jittered(size) => size * radius,
            _ => 0.0,
        };
        let mut changed = Foliage::new(foliage.cutouts().to_vec());
        for &leaf in &names {
            let moved = jittered(foliage.triangles_of(leaf), reach, &mut random);
            let pushed = changed.push_leaf_like(&moved, foliage.leaf(leaf));
            pushed.expect("a leaf that was there before");
        }
        Changed {
            foliage: changed,
            options,
            names,
        }
    }
}

/// A tree that was perturbed, with the options to run it with.
pub(crate) struct Changed {
    pub(crate) foliage: Foliage,
    pub(crate) options: Options,
    /// For each leaf of the changed foliage, that leaf of the tree.
    names: Vec<LeafId>,
}

impl Changed {
    /// An order of the changed foliage as one of the tree.
    pub(crate) fn order_of_tree(&self, order: &RemovalOrder) -> RemovalOrder {
        let name = |leaf: LeafId| self.names.get(leaf.index()).copied().unwrap_or(leaf);
        let mut own = RemovalOrder::new(order.leaf_count());
        for step in order.steps() {
            let removed: Vec<LeafId> = step.removed.iter().map(|leaf| name(*leaf)).collect();
            let mut grown = step.grown.to_vec();
            grown.iter_mut().for_each(|g| g.leaf = name(g.leaf));
            let made: Vec<NewLeaf> = step.made.iter().map(|m| renamed(m, &name)).collect();
            own.push_step(Step {
                removed: &removed,
                grown: &grown,
                made: &made,
                survivors_area_scale: step.survivors_area_scale,
            });
        }
        own
    }
}

fn renamed(leaf: &NewLeaf, name: &impl Fn(LeafId) -> LeafId) -> NewLeaf {
    let mut own = leaf.clone();
    own.donor = name(leaf.donor);
    for corner in own.triangles.iter_mut().flatten() {
        if let Place::Of(at) = corner.place {
            corner.place = Place::Of(CornerRef {
                leaf: name(at.leaf),
                ..at
            });
        }
    }
    own
}

/// The skeleton of a foliage with its leaves in this order.
///
/// A skeleton of another number of leaves stays as it is, for the method to refuse.
fn with_leaves_in(skeleton: &PlantSkeleton, names: &[LeafId]) -> PlantSkeleton {
    let mut own = skeleton.clone();
    if own.leaf_segments.len() == names.len() {
        let segment_of = |leaf: &LeafId| skeleton.leaf_segments[leaf.index()];
        own.leaf_segments = names.iter().map(segment_of).collect();
    }
    own
}

/// A rotation about a random axis by a random angle.
fn any_turn(random: &mut Random) -> DQuat {
    let axis = in_cube(random).normalize_or(DVec3::Y);
    DQuat::from_axis_angle(axis, std::f64::consts::PI * signed(random))
}

/// The triangles with corners moved at random; corners that were at one place stay together.
fn jittered(triangles: &[LeafTriangle], reach: f64, random: &mut Random) -> Vec<LeafTriangle> {
    let mut moved = triangles.to_vec();
    if reach > 0.0 {
        let mut known: Vec<(DVec3, DVec3)> = Vec::new();
        for corner in moved.iter_mut().flat_map(|t| &mut t.corners) {
            let there = known.iter().find(|(from, _)| from == corner).map(|k| k.1);
            let to = there.unwrap_or_else(|| *corner + reach * in_cube(random));
            known.push((*corner, to));
            *corner = to;
        }
    }
    moved
}

#[cfg(test)]
mod tests {
    use super::*;
    use secateur_model::{Lod, Segment, SegmentIndex};
    use secateur_plant::{EllipsoidCrown, ellipsoid_crown};
    use secateur_simplify::by_branches::{ChainOptions, MergeOptions};
    use secateur_simplify::stochastic::{StochasticOptions, simplify};
    use secateur_simplify::{Method, Resolution, Target};

    fn options() -> Options {
        Options::to(Target::leaf_share(0.5))
    }

    #[test]
    fn a_shuffled_order_comes_back_to_the_leaves_it_meant() {
        let foliage = ellipsoid_crown(50, 1, &EllipsoidCrown::default()).unwrap();
        let changed = Perturbation::Shuffled(1).apply(&foliage, &options());
        let order = simplify(&changed.foliage, 20, &StochasticOptions::default());
        let own = changed.order_of_tree(&order);
        assert_ne!(own.removed(), order.removed());
        let left = |order, foliage| {
            let lod = Lod::after(order, 30);
            let mut centres: Vec<[u64; 3]> = (lod.foliage(foliage).leaves().iter())
                .map(|leaf| leaf.centre().to_array().map(f64::to_bits))
                .collect();
            centres.sort_unstable();
            centres
        };
        assert_eq!(left(&own, &foliage), left(&order, &changed.foliage));
    }

    /// Leaf k grows k m up the stem, on a segment of its own.
    fn by_the_stem(leaves: usize) -> (Foliage, PlantSkeleton) {
        let mut foliage = Foliage::default();
        let mut skeleton = PlantSkeleton::default();
        for leaf in 0..leaves {
            let at = DVec3::Y * leaf as f64;
            let corners = [DVec3::ZERO, DVec3::X, DVec3::Z].map(|p| at + p);
            foliage
                .push_leaf(&[LeafTriangle::plain(corners)], None)
                .unwrap();
            skeleton.segments.push(Segment {
                parent: leaf.checked_sub(1).map(SegmentIndex::from_index),
                continues_parent: leaf > 0,
                start: at - DVec3::Y,
                end: at,
                start_radius_m: 0.1,
                end_radius_m: 0.1,
                sides: 3,
            });
            let segment = SegmentIndex::from_index(leaf);
            skeleton.leaf_segments.push(Some(segment));
        }
        (foliage, skeleton)
    }

    /// The chain takes the stem from its tip, however its leaves are numbered; and
    /// merging joins the same neighbours.
    #[test]
    fn shuffled_leaves_keep_their_segments() {
        let (foliage, skeleton) = by_the_stem(40);
        for method in [
            Method::Chain(ChainOptions::default()),
            Method::Merge(MergeOptions::default()),
        ] {
            let plain = Options {
                method,
                resolution: Resolution::Pixels(1),
                skeleton: Some(Arc::new(skeleton.clone())),
                ..options()
            };
            let run = |change: Perturbation| {
                let changed = change.apply(&foliage, &plain);
                let result = secateur_simplify::simplify(&changed.foliage, &changed.options);
                let order = changed.order_of_tree(&result.unwrap().passes.in_one_order());
                assert_eq!(order.len(), 20);
                let left = Lod::after(&order, 20).foliage(&foliage);
                let mut centres: Vec<[u64; 3]> = (left.leaves().iter())
                    .map(|leaf| leaf.centre().to_array().map(f64::to_bits))
                    .collect();
                centres.sort_unstable();
                centres
            };
            let original = run(Perturbation::None);
            for seed in [1, 2] {
                assert_eq!(run(Perturbation::Shuffled(seed)), original, "{method:?}");
            }
        }
    }

    #[test]
    fn jitter_moves_every_leaf_a_little_and_keeps_it_whole() {
        let foliage = ellipsoid_crown(50, 1, &EllipsoidCrown::default()).unwrap();
        let radius = foliage.bounding_sphere().unwrap().radius;
        let changed = Perturbation::Jittered(1e-3)
            .apply(&foliage, &options())
            .foliage;
        for (before, after) in foliage.triangles().iter().zip(changed.triangles()) {
            for (a, b) in before.corners.iter().zip(after.corners) {
                let moved = a.distance(b);
                assert!(0.0 < moved && moved <= 1.8e-3 * radius);
            }
        }
        assert_eq!(
            changed.triangles()[0].corners[0],
            changed.triangles()[1].corners[0]
        );
    }

    #[test]
    fn turned_views_keep_their_distance() {
        let foliage = ellipsoid_crown(50, 1, &EllipsoidCrown::default()).unwrap();
        let sphere = foliage.bounding_sphere().unwrap();
        let changed = Perturbation::Rotated(1).apply(&foliage, &options());
        let views = changed.options.first_views(sphere);
        let original = secateur_raster::ViewSet::dodecahedron(sphere);
        assert_eq!(views.len(), original.len());
        for (a, b) in original.views().iter().zip(views.views()) {
            let [near, far] = [a, b].map(|v| v.eye().distance(sphere.centre));
            assert!((near - far).abs() < 1e-9 * near);
            assert!(a.eye().distance(b.eye()) > 1e-3 * near);
        }
    }
}
