//! Whether an order is one of a foliage: what a file says may be anything.

use crate::{Foliage, LeafId, NewCorner, NewLeaf, Place, RemovalOrder};

/// No leaf grows past this many times its area: a hundred thousand leaves whose area one takes
/// over are far below, and sizes stay numbers.
const MAX_AREA_SCALE: f64 = 1e30;

/// No corner that is made lies further from the origin along an axis, in world units; a foliage
/// that can be looked at is far within.
const MAX_COORDINATE: f64 = 1e40;

/// No weight of a corner in the plane of a triangle is larger.
const MAX_WEIGHT: f64 = 1e9;

/// Why steps are no order of a foliage. Steps count from 1.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum OrderError {
    /// The order of a foliage of other size.
    #[error("the order is of {order} leaves, the tree has {leaves}")]
    LeafCount {
        /// How many leaves the order is of.
        order: u32,
        /// How many leaves the foliage has.
        leaves: usize,
    },
    /// A name that no leaf ever has.
    #[error("step {step} of the order names {leaf}, which there never is")]
    NoSuchLeaf {
        /// The number of the step, from 1.
        step: usize,
        /// The leaf ID that the step names.
        leaf: LeafId,
    },
    /// A leaf that goes or grows in the step that makes it or before.
    #[error(
        "step {step} of the order names {leaf}, which no earlier step makes: the order runs in a \
         circle"
    )]
    NotMadeYet {
        /// The number of the step, from 1.
        step: usize,
        /// The leaf that the step names.
        leaf: LeafId,
    },
    /// A leaf that goes or grows after it is gone.
    #[error("step {step} of the order names {leaf}, which is gone")]
    Gone {
        /// The number of the step, from 1.
        step: usize,
        /// The leaf that the step names.
        leaf: LeafId,
    },
    /// A size out of range.
    #[error("step {step} of the order gives {leaf} {area_scale:e} times its area")]
    Size {
        /// The number of the step, from 1.
        step: usize,
        /// The leaf that the step names.
        leaf: LeafId,
        /// The area that the step asks for, as a multiple of the original one.
        area_scale: f64,
    },
    /// A common scale out of range.
    #[error("step {step} of the order scales all areas by {area_scale:e}")]
    CommonSize {
        /// The number of the step, from 1.
        step: usize,
        /// The area that the step asks for, as a multiple of the original one.
        area_scale: f64,
    },
    /// A leaf that is made of what is not there.
    #[error("step {step} of the order makes {leaf} of corners that are not there")]
    Shape {
        /// The number of the step, from 1.
        step: usize,
        /// The leaf that the step names.
        leaf: LeafId,
    },
    /// More leaves than before.
    #[error("step {step} of the order makes more leaves than it removes")]
    More {
        /// The number of the step, from 1.
        step: usize,
    },
}

impl RemovalOrder {
    /// Whether it can be followed over a foliage: each leaf goes once, after it was made, and none
    /// is named when it is gone; sizes and corners are in range; no step leaves more leaves than
    /// there were.
    ///
    /// # Errors
    /// [`OrderError`]: the first thing that is wrong.
    pub fn check(&self, foliage: &Foliage) -> Result<(), OrderError> {
        let leaves = foliage.leaves().len();
        if self.leaf_count() as usize != leaves {
            let order = self.leaf_count();
            return Err(OrderError::LeafCount { order, leaves });
        }
        let mut is_gone = vec![false; self.name_count()];
        let mut named = leaves;
        for (index, content) in self.steps().enumerate() {
            let step = index + 1;
            let find = |leaf: LeafId, is_gone: &[bool]| match is_gone.get(leaf.index()) {
                None => Err(OrderError::NoSuchLeaf { step, leaf }),
                Some(_) if leaf.index() >= named => Err(OrderError::NotMadeYet { step, leaf }),
                Some(true) => Err(OrderError::Gone { step, leaf }),
                Some(false) => Ok(()),
            };
            if content.made.len() > content.removed.len() {
                return Err(OrderError::More { step });
            }
            for &leaf in content.removed {
                find(leaf, &is_gone)?;
                is_gone[leaf.index()] = true;
            }
            for growth in content.grown {
                let (leaf, area_scale) = (growth.leaf, growth.area_scale);
                find(leaf, &is_gone)?;
                if !is_size(area_scale) {
                    return Err(OrderError::Size {
                        step,
                        leaf,
                        area_scale,
                    });
                }
            }
            let area_scale = content.survivors_area_scale;
            if !is_size(area_scale) {
                return Err(OrderError::CommonSize { step, area_scale });
            }
            for (k, made) in content.made.iter().enumerate() {
                if !is_made_of(foliage, made) {
                    let leaf = LeafId::from_index(named + k);
                    return Err(OrderError::Shape { step, leaf });
                }
            }
            named += content.made.len();
        }
        Ok(())
    }
}

fn is_size(area_scale: f64) -> bool {
    area_scale > 0.0 && area_scale <= MAX_AREA_SCALE
}

/// Whether all corners are those of the foliage, or in range.
fn is_made_of(foliage: &Foliage, made: &NewLeaf) -> bool {
    let triangles_of = |leaf: LeafId| match leaf.index() < foliage.leaves().len() {
        true => foliage.triangles_of(leaf).len() as u64,
        false => 0,
    };
    let of_donor = triangles_of(made.donor);
    let is_there = |corner: &NewCorner| {
        let place = match corner.place {
            Place::Of(at) => u64::from(at.corner) < 3 * triangles_of(at.leaf),
            // One by one: the largest element passes over what is no number.
            Place::At(at) => at.to_array().iter().all(|x| x.abs() <= MAX_COORDINATE),
            Place::InPlaneOf { corners, weights } => {
                corners
                    .iter()
                    .all(|corner| u64::from(*corner) < 3 * of_donor)
                    && weights.iter().all(|w| w.abs() <= MAX_WEIGHT)
            }
        };
        place && u64::from(corner.like) < 3 * of_donor
    };
    !made.triangles.is_empty() && made.triangles.iter().flatten().all(is_there)
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;
    use crate::{CornerRef, Growth, LeafTriangle, Step};

    fn leaf(number: u32) -> LeafId {
        LeafId::new(number).unwrap()
    }

    fn foliage() -> Foliage {
        let mut foliage = Foliage::default();
        for x in 0..3 {
            let corners = [DVec3::ZERO, DVec3::X, DVec3::Y].map(|p| p + f64::from(x));
            foliage
                .push_leaf(&[LeafTriangle::plain(corners)], None)
                .unwrap();
        }
        foliage
    }

    fn made(donor: u32, corner: u32) -> NewLeaf {
        let at = CornerRef {
            leaf: leaf(donor),
            corner,
        };
        let corner = NewCorner {
            place: Place::Of(at),
            like: 0,
        };
        NewLeaf {
            donor: leaf(1),
            triangles: vec![[corner; 3]],
        }
    }

    /// What a step removes, grows and makes.
    type Content<'a> = (&'a [u32], &'a [(u32, f64)], &'a [NewLeaf]);

    fn why(steps: &[Content<'_>]) -> String {
        let mut order = RemovalOrder::new(3);
        // What is not there yet may be named only by orders that were read.
        for (removed, grown, made) in steps {
            let removed: Vec<LeafId> = removed.iter().map(|n| leaf(*n)).collect();
            let grown = grown.iter().map(|&(n, area_scale)| Growth {
                leaf: leaf(n),
                area_scale,
            });
            order.push_unchecked(Step {
                removed: &removed,
                grown: &grown.collect::<Vec<_>>(),
                made,
                survivors_area_scale: 1.0,
            });
        }
        match order.check(&foliage()) {
            Ok(()) => String::new(),
            Err(error) => error.to_string(),
        }
    }

    #[test]
    fn an_order_that_can_be_followed_is_one() {
        let steps: [Content<'_>; 3] = [
            (&[1], &[(2, 2.0)], &[]),
            (&[2, 3], &[], &[made(3, 2)]),
            (&[4], &[], &[]),
        ];
        assert_eq!(why(&steps), "");
    }

    #[test]
    fn what_cannot_be_followed_is_named() {
        let twice: [Content<'_>; 2] = [(&[1], &[], &[]), (&[1], &[], &[])];
        assert_eq!(
            why(&twice),
            "step 2 of the order names leaf 1, which is gone"
        );
        let later: [Content<'_>; 2] = [(&[4], &[], &[]), (&[1], &[], &[made(1, 0)])];
        assert!(why(&later).ends_with("the order runs in a circle"));
        let itself: [Content<'_>; 1] = [(&[4], &[], &[made(1, 0)])];
        assert!(why(&itself).ends_with("the order runs in a circle"));
        assert!(why(&[(&[9], &[], &[])]).contains("leaf 9, which there never is"));
        assert!(why(&[(&[1], &[(1, 2.0)], &[])]).contains("is gone"));
        for size in [0.0, -1.0, f64::NAN, f64::INFINITY, 1e31] {
            assert!(why(&[(&[1], &[(2, size)], &[])]).contains("times its area"));
        }
        assert!(why(&[(&[1], &[], &[made(1, 3)])]).contains("corners that are not there"));
        assert!(why(&[(&[1], &[], &[made(1, 0), made(1, 0)])]).contains("more leaves"));
        for (x, y) in [(f64::NAN, 0.0), (0.0, f64::INFINITY), (1e41, 0.0)] {
            let at = Place::At(DVec3::new(x, y, 0.0));
            let mut far = made(1, 0);
            far.triangles[0][1].place = at;
            assert!(why(&[(&[1], &[], &[far])]).contains("corners that are not there"));
            let mut heavy = made(1, 0);
            heavy.triangles[0][2].place = Place::InPlaneOf {
                corners: [0, 1, 2],
                weights: [x, 0.0, y],
            };
            assert!(why(&[(&[1], &[], &[heavy])]).contains("corners that are not there"));
        }
        let none = NewLeaf {
            donor: leaf(1),
            triangles: Vec::new(),
        };
        assert!(why(&[(&[1], &[], &[none])]).contains("corners that are not there"));
    }

    #[test]
    fn an_order_of_another_number_of_leaves_is_refused() {
        let error = RemovalOrder::new(4).check(&foliage()).unwrap_err();
        assert_eq!(
            error.to_string(),
            "the order is of 4 leaves, the tree has 3"
        );
    }
}
