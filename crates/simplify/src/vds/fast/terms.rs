//! The terms of reveal edges: what pixels handed to a leaf do to P times VMI, view by
//! view, in integers.

use secateur_raster::measure::incremental::LeafAreas;

use super::reveals::Reveals;
use crate::lg::LgTable;

/// Adds `f(a + r, S + s) - f(a, S)` to each view.
#[inline]
pub(super) fn add_term(
    table: &LgTable,
    deltas: &mut [i64],
    target: LeafAreas,
    s: u32,
    reveals: &Reveals,
) {
    let lg_after = table.lg(target.total + s);
    let rise = target.rise(lg_after);
    for (delta, &a) in deltas.iter_mut().zip(target.areas) {
        *delta -= (u64::from(a) * rise) as i64;
    }
    add_revealed(table, deltas, target, lg_after, reveals);
}

/// What [`add_term`] adds in the views in which the target is revealed.
#[inline]
fn add_revealed(
    table: &LgTable,
    deltas: &mut [i64],
    target: LeafAreas,
    lg_after: i64,
    reveals: &Reveals,
) {
    for (view, r) in reveals.iter() {
        let a = target.areas[view as usize];
        deltas[view as usize] += table.n_lg_n(a + r) - table.n_lg_n(a) - i64::from(r) * lg_after;
    }
}

/// Brings the term of an edge, which did not change itself, from what its target
/// was to what it is; the sum over the views of the changes without signs, or
/// more.
#[inline]
pub(super) fn move_term(
    table: &LgTable,
    deltas: &mut [i64],
    before: LeafAreas,
    after: LeafAreas,
    s: u32,
    reveals: &Reveals,
) -> u64 {
    let lg_before = table.lg(before.total + s);
    let lg_after = table.lg(after.total + s);
    let (rise_before, rise_after) = (before.rise(lg_before), after.rise(lg_after));
    let mut moved = 0;
    for ((delta, &b), &a) in deltas.iter_mut().zip(before.areas).zip(after.areas) {
        let change = (u64::from(b) * rise_before) as i64 - (u64::from(a) * rise_after) as i64;
        *delta += change;
        moved += change.unsigned_abs();
    }
    for (view, r) in reveals.iter() {
        let (b, a) = (before.areas[view as usize], after.areas[view as usize]);
        let was = table.n_lg_n(b + r) - table.n_lg_n(b) - i64::from(r) * lg_before;
        let is = table.n_lg_n(a + r) - table.n_lg_n(a) - i64::from(r) * lg_after;
        deltas[view as usize] += is - was;
        moved += (is - was).unsigned_abs();
    }
    moved
}

/// Takes an edge's term away as it was and adds it as it is.
#[inline]
pub(super) fn replace_term(
    table: &LgTable,
    deltas: &mut [i64],
    (before, s_before, reveals_before): (LeafAreas, u32, &Reveals),
    (after, s_after, reveals_after): (LeafAreas, u32, &Reveals),
) {
    let lg_before = table.lg(before.total + s_before);
    let lg_after = table.lg(after.total + s_after);
    let rise_before = before.rise(lg_before);
    let rise_after = after.rise(lg_after);
    for ((delta, &b), &a) in deltas.iter_mut().zip(before.areas).zip(after.areas) {
        let (b, a) = (u64::from(b) * rise_before, u64::from(a) * rise_after);
        *delta += b as i64 - a as i64;
    }
    for (view, r) in reveals_before.iter() {
        let a = before.areas[view as usize];
        deltas[view as usize] -= table.n_lg_n(a + r) - table.n_lg_n(a) - i64::from(r) * lg_before;
    }
    for (view, r) in reveals_after.iter() {
        let a = after.areas[view as usize];
        deltas[view as usize] += table.n_lg_n(a + r) - table.n_lg_n(a) - i64::from(r) * lg_after;
    }
}
