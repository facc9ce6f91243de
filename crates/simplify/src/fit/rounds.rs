//! The rounds in which leaves are tried in other sizes, whatever the sizes are fitted to.

use std::ops::ControlFlow;

/// By what areas are multiplied and divided in the rounds, each about the root of the one
/// before. The first is repeated while it pays, with those leaves that took another size.
const FACTORS: [f64; 3] = [2.0, 1.4, 1.2];

/// The first factor is tried again if it took one part in ten of the objective away.
const PAYS: i128 = 10;

/// The first factor is tried in at most this number of rounds: all together make no leaf
/// more than 431 times as large.
const MOST_ROUNDS: usize = 8;

/// Leaves that are tried at a time.
const BATCH: usize = 64;

/// A round has at least this number of batches, smaller ones where there are few leaves:
/// leaves of one batch do not see each other's changes.
const BATCHES_AT_LEAST: usize = 16;

/// Leaves with sizes, and an objective that says how good they are.
pub(super) trait Trial {
    /// Factors of area, leaf by leaf.
    fn scales(&self) -> &[f64];

    /// Whether no size is to be sought.
    fn is_there_nothing_to_gain(&self) -> bool;

    /// What should become least.
    fn objective(&self) -> i128;

    /// Tries these leaves larger and smaller by a factor of area, each against what the
    /// others were, and keeps what makes the objective less.
    fn try_batch(&mut self, members: &[usize], factor: f64);
}

/// Tries all leaves in all rounds. `progress` gets, after every batch, the number of leaves
/// tried and that of those to be tried at most.
pub(super) fn fit_in_rounds(
    trial: &mut impl Trial,
    progress: &mut dyn FnMut(usize, usize) -> ControlFlow<()>,
) -> ControlFlow<()> {
    if trial.is_there_nothing_to_gain() {
        return ControlFlow::Continue(());
    }
    let all: Vec<usize> = (0..trial.scales().len()).collect();
    let mut done = 0;
    for (k, factor) in FACTORS.into_iter().enumerate() {
        let later = (FACTORS.len() - 1 - k) * all.len();
        let rounds = if k == 0 { MOST_ROUNDS } else { 1 };
        let mut tried = all.clone();
        for left in (0..rounds).rev() {
            let before = trial.objective();
            let scales = trial.scales().to_vec();
            let at_most = done + (left + 1) * tried.len() + later;
            round(trial, &tried, factor, &mut |leaves| {
                done += leaves;
                progress(done, at_most)
            })?;
            if (before - trial.objective()) * PAYS <= before {
                break;
            }
            tried.retain(|&leaf| trial.scales()[leaf] != scales[leaf]);
        }
    }
    ControlFlow::Continue(())
}

/// Tries each of these leaves once, those of a batch far from each other in the order of
/// the leaves.
fn round(
    trial: &mut impl Trial,
    leaves: &[usize],
    factor: f64,
    progress: &mut dyn FnMut(usize) -> ControlFlow<()>,
) -> ControlFlow<()> {
    let count = leaves.len();
    let size = (count / BATCHES_AT_LEAST).clamp(1, BATCH);
    let stride = count.div_ceil(size);
    for first in 0..stride {
        let members: Vec<usize> = leaves.iter().copied().skip(first).step_by(stride).collect();
        trial.try_batch(&members, factor);
        progress(members.len())?;
    }
    ControlFlow::Continue(())
}

/// What chance alone may gain, in pixels: the root of the number of pixels that a size changes over
/// all views, rounded down. Each objective weighs it.
pub(super) fn chance_px(changed_px: impl Iterator<Item = u32>) -> u32 {
    changed_px.sum::<u32>().isqrt()
}
