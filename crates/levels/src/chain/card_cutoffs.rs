//! Alpha cutoffs with which a client shows as much of cards as there is of the plant.
//!
//! Cards that are seen from aside show less of thin leaves than the plant does; a lower cutoff makes up for it. What
//! mip maps make of alpha is seen too: where no cutoff keeps the coverage with them, they are not read.
//! Crossed planes are too few for that: what some views show of them is not what others do.

use std::cell::Cell;
use std::slice::from_ref;

use secateur_eval::MipMaps;
use secateur_model::Mips;

use super::level_as_drawn::LevelAsDrawn;
use super::textures::{Client, mips_to_try};
use crate::impostor::Impostor;

/// The range of cutoffs.
const CUTOFFS: [f32; 2] = [0.1, 0.6];

/// Halvings of that range.
const HALVINGS: usize = 5;

/// A cutoff with which coverage is off by no more is near enough.
const NEAR: f64 = 0.02;

/// With a cutoff that is known already, coverage may be off by this much.
const NEAR_OF_KNOWN: f64 = 0.05;

/// How alpha is tested.
#[derive(Clone, Copy, Debug)]
struct AlphaTest {
    mips: Mips,
    cutoff: f32,
}

/// Finds how the alpha of cards of one plant is tested, from one height on the screen to another.
pub(super) struct Covering<'a> {
    client: &'a Client<'a>,
    range: [f64; 2],
    /// Which mips are tried, the first first.
    mips: [Mips; 2],
    /// What was best for the last one: it mostly does for others, too.
    last: Cell<Option<AlphaTest>>,
}

impl<'a> Covering<'a> {
    pub(super) fn new(client: &'a Client<'a>, range: [f64; 2]) -> Self {
        Self {
            client,
            range,
            mips: mips_to_try(range[0]),
            last: Cell::new(None),
        }
    }

    /// Cards that cover what they should.
    pub(super) fn of(&self, cards: Impostor) -> Impostor {
        if let Some(AlphaTest { mips, cutoff }) = self.last.get() {
            let tried = cards.with_mips(mips).with_cutoff(cutoff);
            let seen = self.client.as_drawn(from_ref(&tried.surface), self.range);
            if is_enough(&seen, NEAR_OF_KNOWN) {
                return tried;
            }
        }
        let mut best: Option<(f64, AlphaTest)> = None;
        for mips in self.mips {
            let read = cards.with_mips(mips);
            let known = MipMaps::of_cut_outs(from_ref(&read.surface));
            let [mut low, mut high] = CUTOFFS;
            let mut is_within = false;
            for _ in 0..HALVINGS {
                let cutoff = (low + high) / 2.0;
                let tried = read.with_cutoff(cutoff);
                let surfaces = from_ref(&tried.surface);
                let seen = self.client.as_drawn_with(surfaces, &known, self.range);
                match seen.wanted_gain() > 1.0 {
                    true => high = cutoff,
                    false => low = cutoff,
                }
                if best.is_none_or(|(error, _)| seen.error() < error) {
                    best = Some((seen.error(), AlphaTest { mips, cutoff }));
                }
                is_within |= seen.is_within();
                if is_enough(&seen, NEAR) {
                    break;
                }
            }
            if is_within {
                break;
            }
        }
        let Some((_, AlphaTest { mips, cutoff })) = best else {
            return cards;
        };
        self.last.set(Some(AlphaTest { mips, cutoff }));
        cards.with_mips(mips).with_cutoff(cutoff)
    }
}

fn is_enough(seen: &LevelAsDrawn, near: f64) -> bool {
    seen.is_within() && seen.coverage_error() <= near
}
