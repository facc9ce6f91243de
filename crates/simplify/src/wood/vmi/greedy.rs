//! The order of collapses: always the cheapest that is known.
//!
//! Each place has one entry in a queue, with the cheapest of its collapses when it was last looked
//! at. The first entry is looked at again: where its triangles changed since, all collapses of its
//! place, else the one. If it is then still no dearer than the next entry, it is made; else it goes
//! back. What got cheaper meanwhile is found when its turn comes (a lazy queue), but for the place
//! that others have just moved onto, which is looked at anew at once.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use super::mesh::{Effect, Mesh};
use super::seen::Cost;

/// A collapse with what it costs, the cheapest least. Of equal costs the one that moves the surface
/// least comes first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Candidate {
    pub(super) cost: i64,
    /// The bits of a distance that is not negative, which are in its order.
    distance_bits: u64,
    pub(super) from: u32,
    pub(super) to: u32,
}

/// The cheapest collapse of a place as it is.
pub(super) fn cheapest(mesh: &Mesh<'_>, from: u32, cost: &mut impl Cost) -> Option<Candidate> {
    let neighbours = mesh.neighbours(from).into_iter();
    let all = neighbours.filter_map(|to| Some(candidate(mesh, from, to, cost)?.0));
    all.min()
}

fn candidate(
    mesh: &Mesh<'_>,
    from: u32,
    to: u32,
    cost: &mut impl Cost,
) -> Option<(Candidate, Effect)> {
    let effect = mesh.effect(from, to)?;
    let candidate = Candidate {
        cost: cost.of(mesh, &effect),
        distance_bits: effect.distance.to_bits(),
        from,
        to,
    };
    Some((candidate, effect))
}

/// Collapses until nothing can collapse. `firsts` are the first entries, place by place; `made` is
/// told of each collapse when the mesh is what it makes of it.
pub(super) fn collapse_all<C: Cost>(
    mesh: &mut Mesh<'_>,
    cost: &mut C,
    firsts: Vec<Option<Candidate>>,
    mut made: impl FnMut(&Mesh<'_>, Candidate, &Effect),
) {
    let mut is_queued: Vec<bool> = firsts.iter().map(Option::is_some).collect();
    let mut is_touched = vec![false; firsts.len()];
    let mut queue: BinaryHeap<Reverse<Candidate>> =
        firsts.into_iter().flatten().map(Reverse).collect();
    while let Some(Reverse(known)) = queue.pop() {
        let from = known.from;
        let now = match std::mem::take(&mut is_touched[from as usize]) {
            true => cheapest(mesh, from, cost),
            false => candidate(mesh, from, known.to, cost).map(|(candidate, _)| candidate),
        };
        let Some(now) = now else {
            is_queued[from as usize] = false;
            continue;
        };
        if queue.peek().is_some_and(|Reverse(next)| *next < now) {
            queue.push(Reverse(now));
            continue;
        }
        let effect = mesh.effect(from, now.to).expect("what was just looked at");
        let neighbours = mesh.neighbours(from);
        cost.commit(mesh, &effect);
        mesh.commit(from, &effect);
        is_queued[from as usize] = false;
        made(mesh, now, &effect);
        for place in neighbours.into_iter().chain(mesh.neighbours(now.to)) {
            is_touched[place as usize] = true;
            // What could not collapse before may do so now.
            if !is_queued[place as usize]
                && let Some(first) = cheapest(mesh, place, cost)
            {
                is_queued[place as usize] = true;
                is_touched[place as usize] = false;
                queue.push(Reverse(first));
            }
        }
    }
}
