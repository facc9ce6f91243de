//! Which leaves are left, and how large.

use crate::foliage::scaled_about;
use crate::{Foliage, LeafId, NewLeaf, Place, RemovalOrder};

/// A level of detail of a foliage: for each leaf its area as a multiple of the
/// original one, or nothing where the leaf is gone; and the leaves that were
/// made in place of others, with theirs.
#[derive(Clone, Debug, PartialEq)]
pub struct Lod {
    area_scales: Vec<Option<f64>>,
    /// In the order of their names; nothing where one is gone again.
    made: Vec<Option<MadeLeaf>>,
}

/// A leaf that was made, and its area as a multiple of that of its triangles.
#[derive(Clone, Debug, PartialEq)]
struct MadeLeaf {
    leaf: NewLeaf,
    area_scale: f64,
}

impl Lod {
    /// Every one of `leaf_count` leaves at its original size.
    pub fn original(leaf_count: usize) -> Self {
        Self {
            area_scales: vec![Some(1.0); leaf_count],
            made: Vec::new(),
        }
    }

    /// What is left after the first `steps` steps of an order (all of them if
    /// it has fewer).
    pub fn after(order: &RemovalOrder, steps: usize) -> Self {
        let mut lod = Self::original(order.leaf_count() as usize);
        let mut survivors_area_scale = 1.0;
        for step in order.steps().take(steps) {
            step.made.iter().cloned().for_each(|leaf| lod.make(leaf));
            for &leaf in step.removed {
                lod.remove(leaf);
            }
            for growth in step.grown {
                lod.resize(growth.leaf, growth.area_scale);
            }
            survivors_area_scale = step.survivors_area_scale;
        }
        if survivors_area_scale != 1.0 {
            for scale in lod.area_scales.iter_mut().flatten() {
                *scale *= survivors_area_scale;
            }
        }
        lod
    }

    /// A level of these leaves of an order, made ones included, with their area scales; not
    /// necessarily one that any of its prefixes is.
    ///
    /// # Panics
    /// If no leaf ever has such a name.
    pub fn of_leaves(
        order: &RemovalOrder,
        leaves: impl IntoIterator<Item = (LeafId, f64)>,
    ) -> Self {
        let mut scales = vec![0.0; order.name_count()];
        for (leaf, area_scale) in leaves {
            scales[leaf.index()] = area_scale;
        }
        Self::from_own_scales(order.leaf_count() as usize, &scales, order.made(), 1.0)
    }

    /// A level of the leaves that have an own scale, originals and made ones by their names; no
    /// scale is 0.
    pub(crate) fn from_own_scales(
        leaf_count: usize,
        own_scales: &[f64],
        made_leaves: &[NewLeaf],
        survivors_area_scale: f64,
    ) -> Self {
        let (originals, of_made) = own_scales.split_at(leaf_count);
        let is_there = |scale: &&f64| **scale != 0.0;
        let original = |scale: &f64| {
            Some(scale)
                .filter(is_there)
                .map(|s| s * survivors_area_scale)
        };
        let made = |(leaf, scale): (&NewLeaf, &f64)| {
            Some(scale).filter(is_there).map(|&area_scale| MadeLeaf {
                leaf: leaf.clone(),
                area_scale,
            })
        };
        Self {
            area_scales: originals.iter().map(original).collect(),
            made: made_leaves.iter().zip(of_made).map(made).collect(),
        }
    }

    /// Takes a leaf away, an original or a made one.
    ///
    /// # Panics
    /// If there is no such leaf.
    pub fn remove(&mut self, leaf: LeafId) {
        match leaf.index().checked_sub(self.area_scales.len()) {
            None => self.area_scales[leaf.index()] = None,
            Some(made) => self.made[made] = None,
        }
    }

    /// Adds a leaf to those that are left.
    pub fn make(&mut self, leaf: NewLeaf) {
        self.made.push(Some(MadeLeaf {
            leaf,
            area_scale: 1.0,
        }));
    }

    /// Gives a leaf this multiple of its original area, or, if it was made, of that
    /// of its triangles.
    ///
    /// # Panics
    /// If the leaf is gone, or `area_scale` is not a finite positive number.
    pub fn resize(&mut self, leaf: LeafId, area_scale: f64) {
        assert!(
            area_scale.is_finite() && area_scale > 0.0,
            "{leaf} cannot be resized to {area_scale} times its area"
        );
        let scale = match leaf.index().checked_sub(self.area_scales.len()) {
            None => self.area_scales[leaf.index()].as_mut(),
            Some(made) => self.made[made].as_mut().map(|m| &mut m.area_scale),
        };
        *scale.expect("only a leaf that is left can be resized") = area_scale;
    }

    /// The area of an original leaf as a multiple of its original one, or `None` if
    /// it is gone.
    ///
    /// # Panics
    /// If there is no such leaf.
    pub fn area_scale(&self, leaf: LeafId) -> Option<f64> {
        self.area_scales[leaf.index()]
    }

    /// [`area_scale`](Self::area_scale) of every original leaf, leaf 1 first.
    pub fn area_scales(&self) -> &[Option<f64>] {
        &self.area_scales
    }

    /// The leaves that were made and are left, in the order of their making, with
    /// their areas as multiples of those of their triangles.
    pub fn made(&self) -> impl Iterator<Item = (&NewLeaf, f64)> + '_ {
        self.made.iter().flatten().map(|m| (&m.leaf, m.area_scale))
    }

    /// Changes the leaves that were made and are left, in the order of their making.
    pub fn change_made(&mut self, change: impl FnMut(&mut NewLeaf)) {
        let left = self.made.iter_mut().flatten();
        left.map(|made| &mut made.leaf).for_each(change);
    }

    /// The level of two foliages one after the other: this one's leaves, then the other's.
    ///
    /// Leaves that were made keep their shapes; their donors and the corners that they name are
    /// those of the joined foliage.
    #[must_use]
    pub fn followed_by(&self, other: &Self) -> Self {
        let before = self.area_scales.len();
        let mut joined = Self {
            area_scales: [&self.area_scales[..], &other.area_scales].concat(),
            made: self.made.clone(),
        };
        let renamed = |leaf: LeafId| LeafId::from_index(before + leaf.index());
        joined.made.extend(other.made_renamed(renamed));
        joined
    }

    /// The level of a foliage of `leaf_count` leaves of which these are parts: each the level of some of its leaves,
    /// and which those are. Leaves of no part are gone.
    ///
    /// # Panics
    /// If a part has more leaves than are named, or a name is beyond `leaf_count`.
    pub fn of_parts(leaf_count: usize, parts: &[(&Self, &[LeafId])]) -> Self {
        let mut whole = Self {
            area_scales: vec![None; leaf_count],
            made: Vec::new(),
        };
        for (part, names) in parts {
            for (area_scale, name) in part.area_scales.iter().zip(*names) {
                whole.area_scales[name.index()] = *area_scale;
            }
            whole
                .made
                .extend(part.made_renamed(|leaf| names[leaf.index()]));
        }
        whole
    }

    /// The leaves that were made, with other names of the originals that they are like.
    fn made_renamed(
        &self,
        renamed: impl Fn(LeafId) -> LeafId,
    ) -> impl Iterator<Item = Option<MadeLeaf>> {
        self.made.iter().map(move |made| {
            let mut made = made.clone()?;
            made.leaf.donor = renamed(made.leaf.donor);
            for corner in made.leaf.triangles.iter_mut().flatten() {
                if let Place::Of(at) = &mut corner.place {
                    at.leaf = renamed(at.leaf);
                }
            }
            Some(made)
        })
    }

    /// Whether only original leaves are left.
    pub fn is_of_originals(&self) -> bool {
        self.made().next().is_none()
    }

    /// The leaves of this level as a foliage of their own, at the size that
    /// they have now: original ones in leaf order, then made ones.
    ///
    /// # Panics
    /// If the level is one of another foliage, or a size leaves the range of
    /// f64.
    pub fn foliage(&self, original: &Foliage) -> Foliage {
        assert_eq!(self.area_scales.len(), original.leaves().len());
        let mut foliage = Foliage::new(original.cutouts().to_vec());
        let mut push = |triangles: &[crate::LeafTriangle], like: LeafId| {
            let pushed = foliage.push_leaf_like(triangles, original.leaf(like));
            pushed.expect("a leaf of finite corners, with a cut-out of the original");
        };
        for (leaf, area_scale) in self.leaves() {
            let mut triangles = original.triangles_of(leaf).to_vec();
            if area_scale != 1.0 {
                scaled_about(original.leaf(leaf).centre(), area_scale, &mut triangles);
            }
            push(&triangles, leaf);
        }
        for (leaf, area_scale) in self.made() {
            push(&leaf.triangles_in(original, area_scale), leaf.donor);
        }
        foliage
    }

    /// The original leaves that are left with their area scales, in leaf order.
    pub fn leaves(&self) -> impl Iterator<Item = (LeafId, f64)> + '_ {
        let scales = self.area_scales.iter().enumerate();
        scales.filter_map(|(index, scale)| Some((LeafId::from_index(index), (*scale)?)))
    }

    /// All leaves that are left with their area scales, in the order of
    /// [`foliage`](Self::foliage): original ones, then made ones.
    pub fn all_leaves(&self) -> impl Iterator<Item = (LeafId, f64)> + '_ {
        let originals = self.area_scales.len();
        let made = self.made.iter().enumerate();
        let made = made.filter_map(move |(index, made)| {
            let name = LeafId::from_index(originals + index);
            made.as_ref().map(|made| (name, made.area_scale))
        });
        self.leaves().chain(made)
    }

    /// How many leaves are left, made ones included.
    pub fn leaf_count(&self) -> usize {
        self.area_scales.iter().flatten().count() + self.made().count()
    }

    /// The largest area scale of a leaf that is left, 1 where none has grown.
    pub fn max_area_scale(&self) -> f64 {
        let made = self.made().map(|(_, area_scale)| area_scale);
        let originals = self.area_scales.iter().flatten().copied();
        originals.chain(made).fold(1.0, f64::max)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Growth;

    #[test]
    fn a_prefix_of_an_order_is_a_level() {
        let leaf = |n| LeafId::new(n).unwrap();
        let mut order = RemovalOrder::new(3);
        let grown = Growth {
            leaf: leaf(1),
            area_scale: 1.5,
        };
        order.push(leaf(2), &[grown]);
        order.push(leaf(1), &[]);
        assert_eq!(Lod::after(&order, 0), Lod::original(3));
        let one = Lod::after(&order, 1);
        assert_eq!(one.area_scales(), [Some(1.5), None, Some(1.0)]);
        assert_eq!(one.max_area_scale(), 1.5);
        let two = Lod::after(&order, 9);
        assert_eq!(two.leaves().collect::<Vec<_>>(), [(leaf(3), 1.0)]);
        assert_eq!(two.leaf_count(), 1);
    }

    #[test]
    fn two_leaves_become_one_and_that_one_goes() {
        use crate::{CornerRef, LeafTriangle, NewCorner, Place, Step};
        use glam::{DVec2, DVec3};
        let leaf = |n| LeafId::new(n).unwrap();
        let triangle = |x: f64| LeafTriangle {
            corners: [DVec3::X, DVec3::Y, DVec3::Z].map(|p| p + DVec3::X * x),
            uvs: [0.0, 0.25, 0.5].map(|u| DVec2::new(u, x)),
        };
        let mut foliage = Foliage::default();
        for x in [0.0, 5.0] {
            foliage.push_leaf(&[triangle(x)], None).unwrap();
        }
        let of = |n, corner, like| {
            let place = Place::Of(CornerRef {
                leaf: leaf(n),
                corner,
            });
            NewCorner { place, like }
        };
        let made = NewLeaf {
            donor: leaf(2),
            triangles: vec![[of(1, 0, 0), of(1, 2, 1), of(2, 1, 2)]],
        };
        let mut order = RemovalOrder::new(2);
        order.push_step(Step {
            removed: &[leaf(1), leaf(2)],
            grown: &[],
            made: &[made],
            survivors_area_scale: 1.0,
        });
        order.push(leaf(3), &[]);
        assert_eq!([0, 1, 2].map(|k| order.leaves_after(k)), [2, 1, 0]);

        let one = Lod::after(&order, 1);
        assert_eq!((one.leaf_count(), one.is_of_originals()), (1, false));
        let collapsed = one.foliage(&foliage);
        let expected = LeafTriangle {
            corners: [DVec3::X, DVec3::Z, DVec3::Y + DVec3::X * 5.0],
            uvs: triangle(5.0).uvs,
        };
        assert_eq!(collapsed.triangles(), [expected]);
        assert_eq!(Lod::after(&order, 2).leaf_count(), 0);
        order.truncate(1);
        assert_eq!(Lod::after(&order, 9), one);
    }

    #[test]
    fn a_leaf_that_was_made_grows_about_its_own_centre() {
        use crate::{LeafTriangle, NewCorner, Place};
        use glam::DVec3;
        let leaf = |n| LeafId::new(n).unwrap();
        let mut foliage = Foliage::default();
        let corners = [DVec3::ZERO, DVec3::X, DVec3::Y];
        foliage
            .push_leaf(&[LeafTriangle::plain(corners)], None)
            .unwrap();
        // About (6, 1, 0).
        let places = [(3.0, 0.0), (9.0, 0.0), (6.0, 3.0)].map(|(x, y)| DVec3::new(x, y, 0.0));
        let corner = |place| NewCorner {
            place: Place::At(place),
            like: 0,
        };
        let mut lod = Lod::original(1);
        lod.remove(leaf(1));
        lod.make(NewLeaf {
            donor: leaf(1),
            triangles: vec![places.map(corner)],
        });
        lod.resize(leaf(2), 4.0);
        assert_eq!(lod.max_area_scale(), 4.0);
        let grown = lod.foliage(&foliage);
        let expected = [(0.0, -1.0), (12.0, -1.0), (6.0, 5.0)];
        assert_eq!(
            grown.triangles()[0].corners,
            expected.map(|(x, y)| DVec3::new(x, y, 0.0))
        );
    }

    /// Leaves of area 2 and 3 that all keep a common 1.5, and the growth of one.
    #[test]
    fn survivors_share_a_scale() {
        use crate::Step;
        let leaf = |n| LeafId::new(n).unwrap();
        let mut order = RemovalOrder::new(3);
        order.push_step(Step {
            removed: &[leaf(2)],
            grown: &[Growth {
                leaf: leaf(3),
                area_scale: 2.0,
            }],
            made: &[],
            survivors_area_scale: 1.5,
        });
        let lod = Lod::after(&order, 1);
        assert_eq!(lod.area_scales(), [Some(1.5), None, Some(3.0)]);
    }
}
