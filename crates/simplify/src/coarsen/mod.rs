//! Leaves of fewer triangles, so that a budget of triangles shows more leaves.
//!
//! Half of the leaves in all their detail leave more holes in a crown than all of
//! them with half of their triangles. So triangles are shared out before leaves
//! go: to those that show the most by them. What leaves lose by fewer is looked at in
//! views of the crown, since some numbers suit a leaf and others don't: an arch of three
//! strips is lopsided with three triangles, and better off with two.
//!
//! A leaf becomes coarser by collapses of its edges (meshoptimizer, by quadric error, in
//! f32: the same triangles on every processor if its C++ is compiled with
//! `-ffp-contract=off`, as this workspace does), by a triangle around what its texture
//! shows, or by one of some of its corners in its mean plane; but for what is on a card it
//! is then grown and moved so that its area and its centre stay.

mod around;
mod cards;
pub(crate) mod leaf_mesh;
mod pass;
mod shapes;
mod shares;
mod sides;
mod triangle;

pub use shapes::{Kept, Shapes};
pub use shares::shared_out;

use cards::Cards;
use glam::DVec3;
use rayon::prelude::*;
use secateur_model::{
    Foliage, Growth, LeafId, LeafTriangle, NewCorner, NewLeaf, Place, RemovalOrder, Step,
};

/// What is left of a leaf grows at most by this to give back its area: a sliver
/// would become a spike.
const MOST_LINEAR_SCALE: f64 = 3.0;

/// A foliage with coarser leaves.
#[derive(Clone, Debug)]
pub struct Coarse {
    foliage: Foliage,
    /// For each leaf what takes its place; nothing where it stays as it is.
    made: Vec<Option<NewLeaf>>,
    shows_the_same: bool,
}

/// Makes the leaves coarser that have more triangles than they may keep, on the
/// threads of the current rayon pool; nothing if none becomes coarser.
///
/// A leaf keeps more than it may where collapses of edges do not get that far: of a
/// leaf of front and back faces a triangle of each is left. It stays as it is where
/// no edge can collapse, or what would be left has no area.
///
/// # Panics
/// If `triangles_at_most` is not of one number for each leaf, or the shapes are of other
/// leaves.
pub fn coarsen(foliage: &Foliage, shapes: &Shapes, triangles_at_most: &[usize]) -> Option<Coarse> {
    assert_eq!(triangles_at_most.len(), foliage.leaves().len());
    let made: Vec<Option<NewLeaf>> = triangles_at_most
        .par_iter()
        .enumerate()
        .map(|(index, at_most)| shapes.coarser(foliage, LeafId::from_index(index), *at_most))
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
        let pushed = coarse.push_leaf(&triangles, foliage.leaf(leaf).cutout());
        pushed.expect("a leaf that is coarser than one that was there");
    }
    let shows_all = |(index, made): (usize, &Option<NewLeaf>)| {
        let leaf = LeafId::from_index(index);
        made.as_ref()
            .is_none_or(|made| shapes.shows_all(leaf, made))
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

    /// Whether all that became coarser are cards, of which one triangle shows all.
    pub fn shows_the_same(&self) -> bool {
        self.shows_the_same
    }

    /// An order over the coarser leaves as one over those before: a first step puts
    /// them in the place of those, the others go by their new names.
    ///
    /// # Panics
    /// If the order is of other leaves, or makes some itself.
    pub fn order(&self, of_coarse: &RemovalOrder) -> RemovalOrder {
        let mut removed: Vec<LeafId> = Vec::new();
        let mut made: Vec<NewLeaf> = Vec::new();
        let mut name_of: Vec<LeafId> = Vec::with_capacity(self.made.len());
        for (index, coarser) in self.made.iter().enumerate() {
            let leaf = LeafId::from_index(index);
            name_of.push(match coarser {
                Some(_) => LeafId::from_index(self.made.len() + made.len()),
                None => leaf,
            });
            removed.extend(coarser.as_ref().map(|_| leaf));
            made.extend(coarser.clone());
        }
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

/// What collapses of its edges leave of a leaf.
fn collapsed(foliage: &Foliage, leaf: LeafId, at_most: usize) -> Option<NewLeaf> {
    let triangles = foliage.triangles_of(leaf);
    let kept = leaf_mesh::collapsed(triangles, at_most)?;
    let position = |corner: u32| triangles[corner as usize / 3].corners[corner as usize % 3];
    in_place_of(foliage, leaf, &kept, position)
}

/// Triangles by corners of a leaf, with its area about its centre; nothing if they have
/// no area.
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
    let linear_scale = linear_scale.min(MOST_LINEAR_SCALE);
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
