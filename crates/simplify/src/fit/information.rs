//! Sizes fitted to the outline and the information of the original.
//!
//! A leaf takes the size at which
//!
//! ```text
//! J = w sum_v X_v + sum_v max(0, D_v - P I(v;F) / 400) + 3 max(0, sum_v D_v - L)
//! D_v = P |I(v;F') - I(v;F)|
//! L = max(sum_v P I(v;F) / 10, sum_v D_v before the fit)
//! ```
//!
//! is least, where `X_v` are the pixels of view v that show foliage in only one of the
//! two, F being the original and F' what is left, I the VMI in bits, P the pixels of a
//! view, and w the weight of the outline. A quarter of a hundredth of a view's information
//! is free: other views differ by more. And outlines do not cost information without end: above a
//! tenth of it, or what was missing before, it counts four times. All of it is integers, so
//! the sizes are the same on every machine.
//!
//! What a size would do to the outline is counted exactly; to the information, for the leaf
//! itself exactly, for those from which it takes pixels to the first order, all of it put
//! down to the view where it happens. J itself is counted after each batch.
//!
//! Where the two look the same, to half a hundredth of the outline and of the information,
//! none is tried.

use rayon::prelude::*;
use secateur_model::{Budget, LeafId, OverMemory};
use secateur_raster::measure::incremental::IncrementalVmi;
use secateur_raster::{AreaTable, cpu};
use smallvec::SmallVec;

use super::Fit;
use super::outlined_view::{OutlinedView, Seen};
use super::price::Price;
use super::rounds::{Trial, chance_px};
use super::sized_view::Change;
use crate::lg::{LG_FRACTION_BITS, LgTable};
use crate::vmi::Vmi;

/// Sizes stay where outlines differ by at most one pixel in this number, and the views tell as much:
/// next to nothing could be gained.
const SAME: u64 = 200;

/// A bit of VMI times a pixel, scaled.
const ONE_BIT: i64 = 1 << LG_FRACTION_BITS;

/// The views of a set.
pub(super) struct SeenSet<'a> {
    pub(super) views: Vec<OutlinedView<'a>>,
    /// Measured from that of the original.
    pub(super) vmi: IncrementalVmi<'a>,
}

/// The views and what is counted in them.
pub(super) struct Information<'a> {
    pub(super) sets: Vec<SeenSet<'a>>,
    price: Price,
    /// Factors of area, leaf by leaf.
    pub(super) scales: Vec<f64>,
    /// What a pixel of outline counts, scaled as VMI is.
    pub(super) outline_unit: i64,
}

impl<'a> Information<'a> {
    pub(super) fn new(
        fit: &Fit<'a>,
        outline_weight: f64,
        table: &'a LgTable,
        budget: &mut Budget,
    ) -> Result<Self, OverMemory> {
        let [original_count, count] = [fit.original, fit.left].map(|f| f.leaves().len());
        let sets = fit.of_views(budget, None, |sized, view, image| {
            let view = OutlinedView::new(sized, view, image);
            let areas_px = view.areas_px(count);
            (view, (cpu::histogram(image, original_count), areas_px))
        })?;
        let mut information = Vec::new();
        let of_set = |views: Vec<_>| {
            let (views, areas_px): (Vec<OutlinedView<'_>>, Vec<_>) = views.into_iter().unzip();
            let (original_px, left_px): (Vec<_>, Vec<_>) = areas_px.into_iter().unzip();
            let original = AreaTable::from_rows(original_count, original_px.concat());
            let original = Vmi::of(&original, table);
            let left = AreaTable::from_rows(count, left_px.concat());
            let mut vmi = IncrementalVmi::new(&left, table);
            vmi.measure_from(&original);
            information.extend_from_slice(original.scaled());
            SeenSet { views, vmi }
        };
        let sets: Vec<SeenSet<'_>> = sets.into_iter().map(of_set).collect();
        Ok(Self {
            price: Price::new(&information, deviations(&sets)),
            sets,
            scales: vec![1.0; count],
            outline_unit: (outline_weight * ONE_BIT as f64) as i64,
        })
    }

    pub(super) fn views(&self) -> impl Iterator<Item = &OutlinedView<'a>> {
        self.sets.iter().flat_map(|set| &set.views)
    }

    /// Pixels, over all views, that show foliage in only one of the two.
    fn outline_error_px(&self) -> u64 {
        self.views().map(|v| u64::from(v.outline_error_px())).sum()
    }

    /// J without the outline, scaled.
    fn cost(&self) -> i128 {
        self.price.of(deviations(&self.sets))
    }

    /// What a leaf does at the size that it has and at two others, by view.
    pub(super) fn seen(&mut self, members: &[(LeafId, [f64; 2])]) -> Vec<Vec<[Seen; 3]>> {
        let sets = self.sets.par_iter_mut().flat_map(|SeenSet { views, vmi }| {
            let vmi = &*vmi;
            views.par_iter_mut().enumerate().map(move |(number, view)| {
                let value = |leaf: u32| vmi.pixel_value(leaf, number);
                let seen = |(leaf, others): &(LeafId, [f64; 2])| view.seen(*leaf, *others, value);
                members.iter().map(seen).collect()
            })
        });
        sets.collect()
    }

    /// By how much less J is, scaled, if a leaf takes the size of this number of those
    /// at which the views saw it, of which it has the first.
    pub(super) fn gain(&self, seen: &[&[Seen; 3]], size: usize) -> i128 {
        let outline_px: i64 = seen
            .iter()
            .map(|view| view[size].outline_px - view[0].outline_px)
            .sum();
        let mut of_views = seen;
        let mut then: SmallVec<[i64; 64]> = SmallVec::new();
        for SeenSet { vmi, .. } in &self.sets {
            let (of_set, others) = of_views.split_at(vmi.view_count());
            let lg_total = |size: usize| {
                let total = of_set.iter().map(|view| view[size].area_px).sum();
                vmi.table().lg(total)
            };
            let lg_totals = [lg_total(0), lg_total(size)];
            let value = |seen: &Seen, lg_total: i64| {
                vmi.table().term(seen.area_px, lg_total) - seen.worth_to_others
            };
            let pairs = of_set.iter().zip(vmi.deviations());
            then.extend(pairs.map(|(view, deviation)| {
                deviation + value(&view[size], lg_totals[1]) - value(&view[0], lg_totals[0])
            }));
            of_views = others;
        }
        i128::from(outline_px) * i128::from(self.outline_unit) + self.cost()
            - self.price.of(then.into_iter())
    }

    /// Makes leaves larger or smaller.
    pub(super) fn try_out(&mut self, changes: &[Change]) {
        self.sets.par_iter_mut().for_each(|SeenSet { views, vmi }| {
            vmi.forget_step();
            views.par_iter_mut().for_each(|view| view.try_out(changes));
            let events = views.iter().flat_map(|view| view.events.all());
            events.for_each(|event| vmi.record(event));
            vmi.settle();
        });
    }

    /// Gives the leaves that were last tried out the sizes back that they had.
    pub(super) fn take_back(&mut self) {
        self.sets.par_iter_mut().for_each(|SeenSet { views, vmi }| {
            views.par_iter_mut().for_each(OutlinedView::take_back);
            vmi.undo();
        });
    }
}

/// `P * (I(v;F') - I(v;F))`, scaled, of all views.
fn deviations(sets: &[SeenSet<'_>]) -> impl Iterator<Item = i64> {
    let sets = sets.iter();
    sets.flat_map(|set| set.vmi.deviations().iter().copied())
}

impl Trial for Information<'_> {
    fn scales(&self) -> &[f64] {
        &self.scales
    }

    fn is_there_nothing_to_gain(&self) -> bool {
        let outline_px: u64 = self.views().map(|v| u64::from(v.outline_px())).sum();
        // The views tell as much as of the original, but for twice what is free.
        self.outline_error_px() * SAME <= outline_px && self.cost() <= self.price.free()
    }

    /// J in units of 2^-27 bits times pixels.
    fn objective(&self) -> i128 {
        i128::from(self.outline_error_px()) * i128::from(self.outline_unit) + self.cost()
    }

    fn try_batch(&mut self, members: &[usize], factor: f64) {
        let of = |&k: &usize| {
            let scale = self.scales[k];
            (LeafId::from_index(k), [scale * factor, scale / factor])
        };
        let members: Vec<(LeafId, [f64; 2])> = members.iter().map(of).collect();
        let seen = self.seen(&members);
        let choose = |(member, &(leaf, others)): (usize, &(LeafId, [f64; 2]))| {
            let of_leaf: Vec<&[Seen; 3]> = seen.iter().map(|view| &view[member]).collect();
            let gain = |size: usize| {
                let chance =
                    i128::from(chance_px(of_leaf.iter().map(|view| view[size].changed_px)))
                        * i128::from(self.outline_unit.max(ONE_BIT));
                self.gain(&of_leaf, size) - chance
            };
            let gains = [1, 2].map(|size| (gain(size), size));
            let (_, size) = gains.into_iter().filter(|(gain, _)| *gain > 0).max()?;
            Some(Change {
                leaf,
                to: others[size - 1],
            })
        };
        let changes: Vec<Change> = members.iter().enumerate().filter_map(choose).collect();
        if changes.is_empty() {
            return;
        }
        let before = self.objective();
        self.try_out(&changes);
        if self.objective() > before {
            self.take_back();
            return;
        }
        for change in changes {
            self.scales[change.leaf.index()] = change.to;
        }
    }
}
