//! A budget of triangles is used.
//!
//! Whole leaves, and collapses along textures, may leave much of a budget: a plant in one piece would be gone. So
//! where less than nine tenths are used leaves that went last come back, and what is left gets finer, each leaf
//! with as many triangles as are over.

use secateur_model::{CornerRef, Foliage, Growth, LeafId, Lod, NewCorner, NewLeaf, Place, Step};

use crate::coarsen::by_position;
use crate::{Error, Passes};

/// A budget is met if at least this share of it is used.
const LEAST_USED: f64 = 0.9;

/// Whether a plant of this many triangles meets a budget.
pub(crate) fn is_met(asked: usize, left: usize) -> bool {
    (1..=asked).contains(&left) && left as f64 >= LEAST_USED * asked as f64
}

/// Whether a plant of `left` of `there` triangles is what was asked for: all of it, or nine tenths of the budget
/// or more, and never more than that.
///
/// # Errors
/// [`Error::BudgetNotMet`] if it is not.
pub fn check_met(asked: usize, left: usize, there: usize) -> Result<(), Error> {
    match left == there && asked >= there || is_met(asked, left) {
        true => Ok(()),
        false => Err(Error::BudgetNotMet {
            asked,
            nearest: left.max(1),
            there,
        }),
    }
}

/// A leaf of a level.
#[derive(Clone, Copy)]
struct Left {
    /// Its name in the order.
    name: LeafId,
    triangles: usize,
    area_scale: f64,
}

/// A leaf as it is to be: what takes its place, and what goes for that.
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
/// merged. `removals` is how many steps of the order took leaves that may come back first: what
/// follows took those that hang in the air. Whether anything was changed.
pub(crate) fn fill(
    passes: &mut Passes,
    foliage: &Foliage,
    at_most: usize,
    removals: usize,
) -> bool {
    let at_most = at_most.min(foliage.triangles().len());
    if at_most == 0 || !passes.order.made().is_empty() {
        return false;
    }
    let by_leaf = left_by_leaf(passes, foliage);
    let left: usize = by_leaf.iter().flatten().map(|left| left.triangles).sum();
    if is_met(at_most, left) || left > at_most {
        return false;
    }
    let mut filling = Filling {
        foliage,
        at_most,
        left,
        changes: Vec::new(),
    };
    let count = |steps: usize| -> usize {
        let steps = passes.order.steps().take(steps);
        steps.map(|step| step.removed.len()).sum()
    };
    let (back_first, hanging) = passes.order.removed().split_at(count(removals));
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
    for leaf in hanging {
        filling.put(*leaf, None);
    }
    let changes = filling.changes;
    if !changes.is_empty() {
        put_into(passes, &changes);
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
    for ((name, area_scale), (leaf, triangles)) in lod.all_leaves().zip(originals.chain(made)) {
        by_leaf[leaf.index()] = Some(Left {
            name,
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

/// A step more, in which leaves take the place of others or come back.
fn put_into(passes: &mut Passes, changes: &[Change]) {
    let mut order = passes.in_one_order();
    let first = order.name_count();
    let grown = changes.iter().enumerate().filter_map(|(k, change)| {
        let area_scale = change.before?.area_scale;
        (area_scale != 1.0).then_some(Growth {
            leaf: LeafId::from_index(first + k),
            area_scale,
        })
    });
    let grown: Vec<Growth> = grown.collect();
    let removed = changes
        .iter()
        .filter_map(|change| Some(change.before?.name));
    let made: Vec<NewLeaf> = changes.iter().map(|change| change.made.clone()).collect();
    let survivors_area_scale = order.survivors_area_scale_after(order.len());
    order.push_step(Step {
        removed: &removed.collect::<Vec<_>>(),
        grown: &grown,
        made: &made,
        survivors_area_scale,
    });
    *passes = Passes {
        coarse: None,
        order,
        needles: Vec::new(),
        sizes: None,
    };
}
