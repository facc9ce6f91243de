//! Which original leaves survive a run, and how many of them two runs share.

use std::fs;
use std::path::Path;

use secateur_model::{Lod, NewLeaf, Place};

use crate::{Error, Host};

/// A bit for each original leaf, leaf 1 first: whether it is left, as it was or of
/// another shape.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct SurvivorBits(Vec<u8>);

impl SurvivorBits {
    pub(crate) fn of(lod: &Lod) -> Self {
        let mut bits = vec![0; lod.area_scales().len().div_ceil(8)];
        let originals = lod.leaves().map(|(leaf, _)| leaf);
        let changed = lod.made().filter(|(leaf, _)| is_of_one(leaf));
        for leaf in originals.chain(changed.map(|(leaf, _)| leaf.donor)) {
            bits[leaf.index() / 8] |= 1 << (leaf.index() % 8);
        }
        Self(bits)
    }

    /// Jaccard's index: leaves that both keep / leaves that one of them keeps,
    /// 0 to 1; nothing where neither keeps any, or they are of different trees.
    pub(crate) fn overlap(&self, other: &Self) -> Option<f64> {
        let count = |of: fn(u8, u8) -> u8| -> u32 {
            let pairs = self.0.iter().zip(&other.0);
            pairs.map(|(a, b)| of(*a, *b).count_ones()).sum()
        };
        let (both, either) = (count(|a, b| a & b), count(|a, b| a | b));
        (self.0.len() == other.0.len() && either > 0).then(|| f64::from(both) / f64::from(either))
    }

    pub(crate) fn write(&self, host: &dyn Host, path: &Path) -> Result<(), Error> {
        host.write_file(path, &self.0).map_err(Error::Refused)
    }

    /// What [`Self::write`] wrote; nothing if there is no such file.
    pub(crate) fn read(path: &Path) -> Option<Self> {
        fs::read(path).ok().map(Self)
    }
}

/// Whether all corners of a new leaf are its donor's own, so that it stands for that leaf alone.
fn is_of_one(leaf: &NewLeaf) -> bool {
    let corners = leaf.triangles.iter().flatten();
    let mut own = corners.map(|corner| match corner.place {
        Place::Of(at) => at.leaf == leaf.donor,
        Place::At(_) | Place::InPlaneOf { .. } => true,
    });
    own.all(|is_own| is_own)
}

#[cfg(test)]
mod tests {
    use super::*;
    use secateur_model::{CornerRef, LeafId, Lod, NewCorner};

    /// Of two leaves that were made, one of leaf 1 alone, one of leaves 1 and 2, the
    /// first counts for leaf 1.
    #[test]
    fn a_leaf_of_another_shape_is_left() {
        let corner = |leaf| NewCorner {
            place: Place::Of(CornerRef {
                leaf: LeafId::from_index(leaf),
                corner: 0,
            }),
            like: 0,
        };
        let with = |other| {
            let mut lod = Lod::original(3);
            (0..3).for_each(|leaf| lod.remove(LeafId::from_index(leaf)));
            lod.make(NewLeaf {
                donor: LeafId::from_index(0),
                triangles: vec![[corner(0), corner(0), corner(other)]],
            });
            SurvivorBits::of(&lod)
        };
        assert_eq!(
            (with(0), with(1)),
            (SurvivorBits(vec![1]), SurvivorBits(vec![0]))
        );
    }

    /// Of ten leaves one run keeps 1 to 4, the other 3 to 8: two of eight.
    #[test]
    fn overlaps_are_shared_leaves_of_all_that_are_kept() {
        let keeping = |left: std::ops::RangeInclusive<u32>| {
            let mut lod = Lod::original(10);
            for leaf in (1..=10).filter(|leaf| !left.contains(leaf)) {
                lod.remove(LeafId::from_index(leaf as usize - 1));
            }
            SurvivorBits::of(&lod)
        };
        assert_eq!(keeping(1..=4).overlap(&keeping(3..=8)), Some(0.25));
        assert_eq!(keeping(9..=10).overlap(&keeping(9..=10)), Some(1.0));
        assert_eq!(keeping(1..=2).overlap(&keeping(9..=10)), Some(0.0));
        let none = keeping(11..=11);
        assert_eq!(none.overlap(&none), None);
        let of_other = SurvivorBits::of(&Lod::original(20));
        assert_eq!(none.overlap(&of_other), None);
    }
}
