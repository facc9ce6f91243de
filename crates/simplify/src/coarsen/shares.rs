//! A budget of triangles, shared out over the leaves.

use secateur_model::{Foliage, LeafId};

use super::Shapes;

/// How many triangles each leaf may keep so that all together have `at_most`, or a few
/// less that are of no use: those that show the most each, by what leaves lose without them
/// and how large they are. More than `at_most` only if all have the least.
pub fn shared_out(foliage: &Foliage, at_most: usize, shapes: &Shapes) -> Vec<usize> {
    let leaves = || (0..foliage.leaves().len()).map(LeafId::from_index);
    let mut shares: Vec<usize> = leaves()
        .map(|leaf| shapes.kept(leaf)[0].triangles)
        .collect();
    struct More {
        leaf: LeafId,
        from: usize,
        to: usize,
        worth: f64,
    }
    let mut more: Vec<More> = Vec::new();
    for leaf in leaves() {
        for pair in shapes.kept(leaf).windows(2) {
            let (from, to) = (pair[0].triangles, pair[1].triangles);
            let lost = pair[0].loss - pair[1].loss;
            let worth = foliage.leaf(leaf).area() * lost / (to - from) as f64;
            more.push(More {
                leaf,
                from,
                to,
                worth,
            });
        }
    }
    more.sort_by(|a, b| b.worth.total_cmp(&a.worth));
    let mut over = at_most.saturating_sub(shares.iter().sum());
    for More { leaf, from, to, .. } in more {
        if shares[leaf.index()] == from && to - from <= over {
            shares[leaf.index()] = to;
            over -= to - from;
        }
    }
    // A number that a leaf takes less well, where none that it takes well is near enough.
    let mut by_area: Vec<LeafId> = leaves().collect();
    by_area.sort_by(|a, b| {
        let area = |leaf: &LeafId| foliage.leaf(*leaf).area();
        area(b).total_cmp(&area(a))
    });
    for leaf in by_area {
        if over == 0 {
            break;
        }
        let share = &mut shares[leaf.index()];
        let all = shapes.all(leaf);
        let now = all.partition_point(|kept| kept.triangles < *share);
        let near = all[now..].iter();
        let near = near.take_while(|kept| kept.triangles - *share <= over);
        let best = near.min_by(|a, b| a.loss.total_cmp(&b.loss));
        if let Some(best) = best {
            over -= best.triangles - *share;
            *share = best.triangles;
        }
    }
    shares
}
