//! A budget of triangles, shared out over the leaves.

use secateur_model::{Foliage, LeafId};

/// How many triangles each leaf may keep so that all together have `at_most`, as
/// evenly as that goes, none below `least` of it; the last over go to the largest
/// leaves, one each. More than `at_most` only if all have the least.
pub fn shared_out(
    foliage: &Foliage,
    at_most: usize,
    least: impl Fn(LeafId) -> usize,
) -> Vec<usize> {
    let leaves = || (0..foliage.leaves().len()).map(LeafId::from_index);
    let own: Vec<usize> = leaves().map(|l| foliage.triangles_of(l).len()).collect();
    let least: Vec<usize> = leaves().map(|leaf| least(leaf).max(1)).collect();
    let share = |leaf: LeafId, level: usize| own[leaf.index()].min(level.max(least[leaf.index()]));
    let sum = |level: usize| leaves().map(|leaf| share(leaf, level)).sum::<usize>();
    let (mut fits, mut is_too_much) = (0, own.iter().max().map_or(1, |most| most + 1));
    while is_too_much - fits > 1 {
        let level = fits + (is_too_much - fits) / 2;
        match sum(level) <= at_most {
            true => fits = level,
            false => is_too_much = level,
        }
    }
    let mut shares: Vec<usize> = leaves().map(|leaf| share(leaf, fits)).collect();
    let could_have_more = |leaf: &LeafId| share(*leaf, fits + 1) > shares[leaf.index()];
    let mut by_area: Vec<LeafId> = leaves().filter(could_have_more).collect();
    let area = |leaf: &LeafId| foliage.leaf(*leaf).area();
    by_area.sort_by(|a, b| area(b).total_cmp(&area(a)));
    by_area.truncate(at_most.saturating_sub(shares.iter().sum()));
    by_area.iter().for_each(|leaf| shares[leaf.index()] += 1);
    shares
}
