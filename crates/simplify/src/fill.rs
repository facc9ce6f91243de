//! A budget of triangles is used.
//!
//! Whole leaves, and collapses along textures, may leave much of a budget: a plant in one piece would be gone. So
//! where less than nine tenths are used leaves that went last come back, and what is left gets finer, each leaf
//! with as many triangles as are over.

use std::ops::Range;

use rustc_hash::FxHashMap;
use secateur_model::{
    CornerRef, Foliage, Growth, LeafId, Lod, NewCorner, NewLeaf, Place, RemovalOrder, Step,
};

use crate::coarsen::{Coarse, by_position};
use crate::{Error, LeafTriangles, Options, Passes, Target};

/// A budget is met if at least this share of it is used.
const LEAST_USED: f64 = 0.9;

/// Whether a plant of this many triangles meets a budget.
pub(crate) fn is_met(asked: usize, left: usize) -> bool {
    (1..=asked).contains(&left) && left as f64 >= LEAST_USED * asked as f64
}

/// Whether a plant of `left` of `there` triangles is what was asked for: all of it, or nine tenths of the budget
/// or more, and never more than that.
fn check_met(asked: usize, left: usize, there: usize) -> Result<(), Error> {
    match left == there && asked >= there || is_met(asked, left) {
        true => Ok(()),
        false => Err(Error::BudgetNotMet {
            asked,
            nearest: left.max(1),
            there,
        }),
    }
}

impl Options {
    /// Whether a plant of `left` of `there` triangles, those that the target counts, meets the target if that is
    /// one of triangles. Where leaves may keep no more than a number of triangles any budget above what they come
    /// to is met.
    ///
    /// # Errors
    /// [`Error::BudgetNotMet`] if it does not.
    pub fn check_met(&self, left: usize, there: usize) -> Result<(), Error> {
        let Target::Triangles(amount) = self.target else {
            return Ok(());
        };
        let asked = amount.of(there);
        match self.leaf_triangles {
            LeafTriangles::AtMost(_) if (1..=asked).contains(&left) => Ok(()),
            LeafTriangles::AtMost(_) | LeafTriangles::Auto | LeafTriangles::Keep => {
                check_met(asked, left, there)
            }
        }
    }
}

/// What is left of a leaf.
#[derive(Clone, Copy)]
struct Left {
    triangles: usize,
    area_scale: f64,
}

/// A leaf as it is to be, and what was left of it.
struct Change {
    made: NewLeaf,
    before: Option<Left>,
}

/// What is changed so that a budget is used.
struct Filling<'a> {
    foliage: &'a Foliage,
    at_most: usize,
    /// Triangles of all leaves that are left, changed as they are.
    left: usize,
    changes: Vec<Change>,
}

/// Has the leaves use at least nine tenths of a budget of triangles, if they may become coarser and are not
/// merged. `removals` are the steps of the order that took leaves which may come back: what follows took those
/// that hang in the air, which stay away while anything is left. Whether anything was changed.
pub(crate) fn fill(
    passes: &mut Passes,
    foliage: &Foliage,
    at_most: usize,
    removals: Range<usize>,
) -> bool {
    let at_most = at_most.min(foliage.triangles().len());
    if at_most == 0 || !passes.order.made().is_empty() {
        return false;
    }
    let removed_by = |steps: usize| -> usize {
        let steps = passes.order.steps().take(steps);
        steps.map(|step| step.removed.len()).sum()
    };
    let [first, count] = [removals.start, removals.end].map(removed_by);
    let (back_first, hanging) = passes.order.removed().split_at(count);
    let back_first = &back_first[first.min(count)..];
    let coarse = passes.coarse.as_ref().map_or(foliage, Coarse::foliage);
    let of_hanging = hanging.iter().map(|leaf| coarse.triangles_of(*leaf).len());
    let of_hanging: usize = of_hanging.sum();
    let by_leaf = left_by_leaf(passes, foliage);
    let left: usize = by_leaf.iter().flatten().map(|left| left.triangles).sum();
    let is_used = left + of_hanging >= at_most || is_met(at_most, left + of_hanging);
    if left > 0 && is_used {
        return false;
    }
    let mut filling = Filling {
        foliage,
        at_most,
        left,
        changes: Vec::new(),
    };
    for leaf in back_first.iter().rev() {
        filling.put(*leaf, None);
    }
    let mut there: Vec<(usize, Left)> = by_leaf
        .iter()
        .enumerate()
        .filter_map(|(leaf, left)| Some((leaf, (*left)?)))
        .collect();
    there.sort_by_key(|(leaf, left)| {
        let all = foliage.triangles_of(LeafId::from_index(*leaf)).len();
        (std::cmp::Reverse(all - left.triangles), *leaf)
    });
    for (leaf, left) in there {
        filling.put(LeafId::from_index(leaf), Some(left));
    }
    if filling.left == 0 {
        for leaf in hanging {
            filling.put(*leaf, None);
        }
    }
    let changes = filling.changes;
    if !changes.is_empty() {
        put_into(passes, foliage, &changes);
    }
    !changes.is_empty()
}

/// By original leaf what is left of it.
fn left_by_leaf(passes: &Passes, foliage: &Foliage) -> Vec<Option<Left>> {
    let lod: Lod = passes.lod();
    let originals = lod.leaves().map(|(leaf, _)| {
        let count = foliage.triangles_of(leaf).len();
        (leaf, count)
    });
    let made = lod
        .made()
        .map(|(made, _)| (made.donor, made.triangles.len()));
    let mut by_leaf = vec![None; foliage.leaves().len()];
    for ((_, area_scale), (leaf, triangles)) in lod.all_leaves().zip(originals.chain(made)) {
        by_leaf[leaf.index()] = Some(Left {
            triangles,
            area_scale,
        });
    }
    by_leaf
}

impl Filling<'_> {
    /// Has a leaf, of which this is left, as many triangles more as are over.
    fn put(&mut self, leaf: LeafId, before: Option<Left>) {
        if is_met(self.at_most, self.left) {
            return;
        }
        let now = before.map_or(0, |left| left.triangles);
        let wanted = now + self.at_most - self.left;
        let all = self.foliage.triangles_of(leaf).len();
        if now == all {
            return;
        }
        let made = match wanted >= all {
            true => Some(whole(self.foliage, leaf)),
            false => by_position::within(self.foliage, leaf, wanted),
        };
        if let Some(made) = made.filter(|made| made.triangles.len() > now) {
            self.left += made.triangles.len() - now;
            self.changes.push(Change { made, before });
        }
    }
}

/// A leaf that is made as it was.
fn whole(foliage: &Foliage, leaf: LeafId) -> NewLeaf {
    let corner = |corner: usize| NewCorner {
        place: Place::Of(CornerRef {
            leaf,
            corner: corner as u32,
        }),
        like: corner as u32,
    };
    let triangles = 0..foliage.triangles_of(leaf).len();
    NewLeaf {
        donor: leaf,
        triangles: triangles
            .map(|t| [3 * t, 3 * t + 1, 3 * t + 2].map(corner))
            .collect(),
    }
}

/// All that was done as one step, with these changes: leaves that are gone cannot come back later.
fn put_into(passes: &mut Passes, foliage: &Foliage, changes: &[Change]) {
    let lod = passes.lod();
    let mut made_of: FxHashMap<LeafId, (NewLeaf, f64)> = FxHashMap::default();
    for (made, area_scale) in lod.made() {
        made_of.insert(made.donor, (made.clone(), area_scale));
    }
    for Change { made, before } in changes {
        let area_scale = before.map_or(1.0, |left| left.area_scale);
        made_of.insert(made.donor, (made.clone(), area_scale));
    }
    let mut order = RemovalOrder::new(foliage.leaves().len() as u32);
    let (mut removed, mut made, mut grown) = (Vec::new(), Vec::new(), Vec::new());
    for (index, area_scale) in lod.area_scales().iter().enumerate() {
        let leaf = LeafId::from_index(index);
        let (name, area_scale) = match (made_of.remove(&leaf), area_scale) {
            (Some((form, area_scale)), _) => {
                removed.push(leaf);
                made.push(form);
                let name = LeafId::from_index(foliage.leaves().len() + made.len() - 1);
                (name, area_scale)
            }
            (None, Some(area_scale)) => (leaf, *area_scale),
            (None, None) => {
                removed.push(leaf);
                continue;
            }
        };
        if area_scale != 1.0 {
            grown.push(Growth {
                leaf: name,
                area_scale,
            });
        }
    }
    order.push_step(Step {
        removed: &removed,
        grown: &grown,
        made: &made,
        survivors_area_scale: 1.0,
    });
    *passes = Passes {
        coarse: None,
        order,
        needles: Vec::new(),
        sizes: None,
    };
}

#[cfg(test)]
mod tests {
    use glam::DVec3;
    use secateur_model::LeafTriangle;

    use super::*;

    /// Leaves of these numbers of triangles, which do not meet.
    fn leaves(counts: &[usize]) -> Foliage {
        let mut foliage = Foliage::default();
        for (leaf, count) in counts.iter().enumerate() {
            let triangle = |k: usize| {
                let at = DVec3::new(2.0 * k as f64, 2.0 * leaf as f64, 0.0);
                LeafTriangle::plain([at, at + DVec3::X, at + DVec3::Y])
            };
            let triangles: Vec<LeafTriangle> = (0..*count).map(triangle).collect();
            foliage.push_leaf(&triangles, None).unwrap();
        }
        foliage
    }

    /// Triangles of each leaf, after leaves went in this order and the rest of a budget was used.
    fn filled(counts: &[usize], gone: &[usize], removals: usize, at_most: usize) -> Vec<usize> {
        let foliage = leaves(counts);
        let mut order = RemovalOrder::new(counts.len() as u32);
        for leaf in gone {
            order.push(LeafId::from_index(*leaf), &[]);
        }
        let mut passes = Passes {
            coarse: None,
            order,
            needles: Vec::new(),
            sizes: None,
        };
        let before = passes.clone();
        let is_changed = fill(&mut passes, &foliage, at_most, 0..removals);
        assert_eq!(is_changed, passes.lod() != before.lod());
        passes.in_one_order().check(&foliage).unwrap();
        let left = left_by_leaf(&passes, &foliage);
        let count = |left: &Option<Left>| left.map_or(0, |left| left.triangles);
        left.iter().map(count).collect()
    }

    #[test]
    fn what_went_last_comes_back_as_coarse_as_the_budget_asks_for() {
        // A plant in one piece is not dropped.
        assert_eq!(filled(&[450], &[0], 1, 225), [225]);
        assert_eq!(filled(&[450], &[0], 1, 1), [1]);
        // The last one as it was, and of the one before what fits.
        assert_eq!(filled(&[9, 40, 1, 200], &[0, 3, 1], 3, 100), [0, 40, 1, 59]);
        // Nine tenths are enough.
        assert_eq!(filled(&[9, 91], &[0], 1, 100), [0, 91]);
        assert_eq!(filled(&[450], &[0], 1, 0), [0]);
    }

    /// The second leaf hangs in the air.
    #[test]
    fn what_hangs_in_the_air_stays_away_while_anything_is_left() {
        assert_eq!(filled(&[10, 50, 40], &[0, 1], 1, 90), [0, 0, 40]);
        assert_eq!(filled(&[10, 50], &[1, 0], 0, 60), [10, 50]);
    }

    #[test]
    fn a_budget_is_met_or_refused() {
        for (asked, left, is_met) in [
            (100, 100, true),
            (100, 90, true),
            (100, 89, false),
            (100, 101, false),
            (200, 100, true),
            (0, 0, false),
            (1, 1, true),
        ] {
            assert_eq!(
                check_met(asked, left, 100).is_ok(),
                is_met,
                "{left} of {asked}"
            );
        }
        let said = |asked, left| check_met(asked, left, 450).unwrap_err().to_string();
        assert!(said(225, 4).ends_with("4 is the most that is possible: ask for 4"));
        assert!(said(0, 0).ends_with("1 is the least that is possible: ask for 1"));
    }
}
