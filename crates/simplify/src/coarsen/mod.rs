//! Leaves of fewer triangles, so that a budget of triangles shows more leaves.
//!
//! Half of the leaves in full detail leave more holes in a crown than all leaves with half of
//! their triangles. So before any leaf goes, the budget is shared over the leaves that show the
//! most by it (`budget`). What a leaf loses with fewer triangles is measured in views of the
//! crown (`loss_curve`): an arch of three strips is lopsided with three triangles, and better
//! off with two.
//!
//! A leaf becomes coarser in one of four ways: by edge collapses (`leaf_mesh`: meshoptimizer, by
//! quadric error, in f32; the same triangles on every processor), by a triangle around what its
//! texture shows (`enclosing_triangle`), which for bent leaves is put into a plane of three of their corners
//! (`sheets`), or by a triangle of three of its corners in its mean plane
//! (`triangle`). In the first and last way it is then scaled and moved, so that its area and its
//! centre stay. Leaves that are instances of one mesh become coarser together and alike (`instances`).

mod budget;
pub(crate) mod by_position;
mod card_textures;
mod cards;
mod enclosing_triangle;
mod instances;
mod k_dop;
pub(crate) mod leaf_mesh;
mod loss_curve;
mod pass;
mod sheets;
mod triangle;

pub(crate) use budget::share_among;
pub use budget::share_triangles;
pub use loss_curve::{LossCurves, LossPoint};

use cards::Cards;
use glam::DVec3;
use rayon::prelude::*;
use secateur_model::{
    Foliage, Growth, LeafId, LeafTriangle, NewCorner, NewLeaf, Place, RemovalOrder, Step,
};
use sheets::Sheets;

/// Largest factor by which a coarser leaf is scaled to give back its area; with more, a sliver
/// would become a spike.
const MAX_LINEAR_SCALE: f64 = 3.0;

/// Largest factor by which a coarser leaf that lost more area than [`MAX_LINEAR_SCALE`] gives back reaches further from
/// its centre than the leaf did. The largest triangle in an
/// ellipse has the ellipse's area at 1.555 times its size; what would have to grow more is strips of a leaf that lost
/// its width, and would hang in the air beside the plant.
const MAX_REACH: f64 = 1.6;

/// A foliage with coarser leaves.
#[derive(Clone, Debug)]
pub struct Coarse {
    foliage: Foliage,
    /// For each leaf the one that replaces it; none if it stays as it is.
    made: Vec<Option<NewLeaf>>,
    shows_the_same: bool,
}

/// Makes those leaves coarser that have more triangles than they may keep, on the threads of the
/// current rayon pool. Returns none if no leaf becomes coarser.
///
/// A leaf keeps more than it may where edge collapses do not get that far: a leaf with front and
/// back faces keeps a triangle of each. It stays as it is where no edge can collapse, or what
/// would be left has no area.
///
/// # Panics
/// If `triangles_at_most` has not one number for each leaf, or the curves are of other leaves.
pub fn coarsen(
    foliage: &Foliage,
    curves: &LossCurves,
    triangles_at_most: &[usize],
) -> Option<Coarse> {
    assert_eq!(triangles_at_most.len(), foliage.leaves().len());
    let made: Vec<Option<NewLeaf>> = triangles_at_most
        .par_iter()
        .enumerate()
        .map(|(index, at_most)| curves.coarser(foliage, LeafId::from_index(index), *at_most))
        .collect();
    if made.iter().all(Option::is_none) {
        return None;
    }
    let mut coarse = Foliage::new(foliage.cutouts().to_vec());
    for (index, made) in made.iter().enumerate() {
        let leaf = LeafId::from_index(index);
        let triangles = match made {
            Some(made) => made.triangles_in(foliage, 1.0),
            None => foliage.triangles_of(leaf).to_vec(),
        };
        let pushed = coarse.push_leaf_like(&triangles, foliage.leaf(leaf));
        pushed.expect("a leaf that is coarser than one that was there");
    }
    let shows_all = |(index, made): (usize, &Option<NewLeaf>)| {
        let leaf = LeafId::from_index(index);
        made.as_ref()
            .is_none_or(|made| curves.shows_all(leaf, made))
    };
    Some(Coarse {
        foliage: coarse,
        shows_the_same: made.iter().enumerate().all(shows_all),
        made,
    })
}

impl Coarse {
    /// The leaves, by the same names as before.
    pub fn foliage(&self) -> &Foliage {
        &self.foliage
    }

    /// Whether every leaf that became coarser is a card that one triangle shows in full.
    pub fn shows_the_same(&self) -> bool {
        self.shows_the_same
    }

    /// The name of each leaf in [`Self::order`]: a new one where it became coarser.
    pub(crate) fn names(&self) -> Vec<LeafId> {
        let mut next = self.made.len();
        let name = |(index, coarser): (usize, &Option<NewLeaf>)| match coarser {
            Some(_) => {
                next += 1;
                LeafId::from_index(next - 1)
            }
            None => LeafId::from_index(index),
        };
        self.made.iter().enumerate().map(name).collect()
    }

    /// An order over the coarser leaves as one over those before: a first step puts
    /// them in the place of those, the others go by their new names.
    ///
    /// # Panics
    /// If the order is of other leaves, or makes some itself.
    pub fn order(&self, of_coarse: &RemovalOrder) -> RemovalOrder {
        let coarser = self.made.iter().enumerate();
        let coarser = coarser.filter_map(|(index, made)| {
            let made = made.as_ref()?;
            Some((LeafId::from_index(index), made.clone()))
        });
        let (removed, made): (Vec<LeafId>, Vec<NewLeaf>) = coarser.unzip();
        let name_of = self.names();
        let mut order = RemovalOrder::new(of_coarse.leaf_count());
        order.push_step(Step {
            removed: &removed,
            grown: &[],
            made: &made,
            survivors_area_scale: 1.0,
        });
        for step in of_coarse.steps() {
            let name = |leaf: &LeafId| name_of[leaf.index()];
            let grown = step.grown.iter().map(|growth| Growth {
                leaf: name(&growth.leaf),
                ..*growth
            });
            order.push_step(Step {
                removed: &step.removed.iter().map(name).collect::<Vec<_>>(),
                grown: &grown.collect::<Vec<_>>(),
                ..step
            });
        }
        order
    }
}

/// A leaf after edge collapses down to `at_most` triangles.
fn collapsed(foliage: &Foliage, leaf: LeafId, at_most: usize) -> Option<NewLeaf> {
    let triangles = foliage.triangles_of(leaf);
    let kept = leaf_mesh::collapsed(triangles, at_most)?;
    let position = |corner: u32| triangles[corner as usize / 3].corners[corner as usize % 3];
    in_place_of(foliage, leaf, &kept, position)
}

/// A leaf of triangles between corners of an original leaf, with that leaf's area and centre;
/// none if they have no area.
fn in_place_of(
    foliage: &Foliage,
    leaf: LeafId,
    kept: &[[u32; 3]],
    position: impl Fn(u32) -> DVec3,
) -> Option<NewLeaf> {
    let mut left = Foliage::default();
    let plain = |t: &[u32; 3]| LeafTriangle::plain(t.map(&position));
    let plain: Vec<LeafTriangle> = kept.iter().map(plain).collect();
    let left = left
        .push_leaf(&plain, None)
        .ok()
        .map(|id| left.leaf(id).clone())?;
    let (before, after) = (foliage.leaf(leaf), left);
    let linear_scale = (before.area() / after.area()).sqrt();
    if !(linear_scale.is_finite() && linear_scale > 0.0) {
        return None;
    }
    let reach = |triangles: &[LeafTriangle], centre: DVec3| {
        let corners = triangles.iter().flat_map(|t| t.corners);
        corners
            .map(|corner| corner.distance(centre))
            .fold(0.0, f64::max)
    };
    let reaches = [
        reach(foliage.triangles_of(leaf), before.centre()),
        reach(&plain, after.centre()),
    ];
    let within_reach = (MAX_REACH * reaches[0] / reaches[1]).max(1.0);
    // A leaf that can have its area has it.
    let linear_scale = match linear_scale <= MAX_LINEAR_SCALE {
        true => linear_scale,
        false => MAX_LINEAR_SCALE.min(within_reach),
    };
    let placed = |corner: u32| NewCorner {
        place: Place::At(before.centre() + linear_scale * (position(corner) - after.centre())),
        like: corner,
    };
    Some(NewLeaf {
        donor: leaf,
        triangles: kept.iter().map(|t| t.map(placed)).collect(),
    })
}

#[cfg(test)]
mod tests;
