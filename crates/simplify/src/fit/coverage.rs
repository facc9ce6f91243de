//! Sizes fitted to the coverage of small blocks of the views.
//!
//! A person hardly sees which pixels of a crown are leaf and which are sky, but how dense it is
//! from place to place: FLIP, too, compares images after a blur of some pixels. So the views
//! are cut into blocks, and a leaf takes the size at which
//!
//! ```text
//! J = 2 sum_b |E_b| + X + 3 max(0, |sum_b E_b| - C / 64)
//! ```
//!
//! is least, where `E_b` is by how many pixels block b shows more foliage than it did of the
//! original, X the number of pixels that show foliage in only one of the two, and C that of
//! pixels that show foliage of the original, over all blocks and views. X keeps leaves that are
//! right as they are. The last term keeps the coverage of the whole crown: without it a sparse
//! crown gets thinner, since a leaf in a block where none was is wrong by itself, wherever it
//! stands.
//!
//! What a size does to J is counted exactly. All of it is integers, so the sizes are the same
//! on every machine. Which leaf is seen does not matter, only how many cover a pixel.

use rayon::prelude::*;
use secateur_model::{Budget, LeafId, OverMemory};
use secateur_raster::LeafIdImage;
use secateur_raster::abuffer::{ABuffer, FrontTwo};

use super::rounds::{Trial, chance_px};
use super::sized_view::{Change, SizedView};
use super::{DrawnOriginals, Fit};

/// Width and height of a block in pixels.
const BLOCK_PX: u32 = 8;

/// What a pixel too much or too little in a block counts in J; one of outline counts 1.
const BLOCK_WEIGHT: i64 = 2;

/// What a pixel too much or too little in the whole crown counts in J, beyond what is free: as
/// much as the outline and the block of a pixel together.
const WHOLE_WEIGHT: i64 = 3;

/// Of the coverage of the whole crown one part in this number may be missing, or be too much,
/// for nothing: 1.6 %, so that it stays within 3 % in other views.
const FREE: i64 = 64;

/// What a size must gain in J, times the root of the number of pixels that change. With 1
/// sizes fit the pixels of these views: leaves that are right get other sizes, and FLIP of a
/// birch at a quarter of its triangles rises from .0123 to .0135, with 3 to .0127.
const CHANCE_WEIGHT: i64 = 3;

/// Sizes stay where the error of the blocks is at most one pixel in this number of covered
/// ones: that much comes of triangles that are drawn with other borders. A crown may then be up to
/// 2.5 % too thin or too dense.
const SAME: i64 = 40;

/// Whether sizes are to stay, where pictures of what is left show this of the original: as
/// [`Trial::is_there_nothing_to_gain`] says, but found without the lists of what covers each pixel, which take
/// several times as long.
pub(super) fn is_covered_alike<'i>(
    pairs: impl ParallelIterator<Item = (&'i LeafIdImage, LeafIdImage)>,
) -> bool {
    let of_view = |(original, left): (&LeafIdImage, LeafIdImage)| {
        let side = original.resolution.div_ceil(BLOCK_PX);
        let mut excess_px = vec![0_i64; side.pow(2) as usize];
        let mut original_px = 0;
        for (pixel, (was, is)) in (0..).zip(original.leaf_ids.iter().zip(&left.leaf_ids)) {
            let block = block_of(pixel, original.resolution);
            excess_px[block] += i64::from(*is != 0) - i64::from(*was != 0);
            original_px += i64::from(*was != 0);
        }
        [excess_px.into_iter().map(i64::abs).sum(), original_px]
    };
    let plus = |a: [i64; 2], b: [i64; 2]| [a[0] + b[0], a[1] + b[1]];
    let [blocks_px, original_px] = pairs.map(of_view).reduce(|| [0; 2], plus);
    is_same(blocks_px, original_px)
}

fn is_same(blocks_px: i64, original_px: i64) -> bool {
    blocks_px * SAME <= original_px
}

/// The block of a pixel of an image of this side.
fn block_of(pixel: u32, resolution: u32) -> usize {
    let [x, y] = [pixel % resolution, pixel / resolution];
    (y / BLOCK_PX * resolution.div_ceil(BLOCK_PX) + x / BLOCK_PX) as usize
}

/// What is left of a foliage, and how densely it covers the views.
pub(super) struct Coverage<'a> {
    views: Vec<CoveredView<'a>>,
    /// Pixels of the original over all views.
    original_px: i64,
    /// Factors of area, leaf by leaf.
    scales: Vec<f64>,
    errors: Errors,
}

/// Sums over all blocks of all views, or by how much they change.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct Errors {
    /// sum_b E_b, in pixels.
    excess_px: i64,
    /// sum_b |E_b|, in pixels.
    blocks_px: i64,
    /// Pixels that show foliage in only one of the two.
    outline_px: i64,
}

impl Errors {
    fn plus(self, other: Self) -> Self {
        Self {
            excess_px: self.excess_px + other.excess_px,
            blocks_px: self.blocks_px + other.blocks_px,
            outline_px: self.outline_px + other.outline_px,
        }
    }

    /// J, if the original covers this many pixels.
    fn objective(self, original_px: i64) -> i64 {
        let whole_px = (self.excess_px.abs() - original_px / FREE).max(0);
        BLOCK_WEIGHT * self.blocks_px + self.outline_px + WHOLE_WEIGHT * whole_px
    }
}

/// What a leaf of another size does to a view, in pixels.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct Effect {
    errors: Errors,
    /// Pixels that it covers now or at that size, and not both.
    changed_px: u32,
}

impl<'a> Coverage<'a> {
    pub(super) fn new(
        fit: &Fit<'a>,
        budget: &mut Budget,
        originals: Option<&DrawnOriginals>,
    ) -> Result<Self, OverMemory> {
        let of_view = |sized, _, original: &LeafIdImage| CoveredView::new(sized, original);
        let views = fit.of_views(budget, originals, of_view)?;
        let views: Vec<CoveredView<'_>> = views.into_iter().flatten().collect();
        let covered = views.iter().flat_map(|view| &view.blocks.is_original);
        Ok(Self {
            original_px: covered.filter(|is_original| **is_original).count() as i64,
            scales: vec![1.0; fit.left.leaves().len()],
            errors: views
                .iter()
                .map(|view| view.blocks.errors)
                .fold(Errors::default(), Errors::plus),
            views,
        })
    }

    /// Has each view do something, and adds the errors up.
    fn with_views(&mut self, act: impl Fn(&mut CoveredView<'a>) + Sync) {
        let views = self.views.par_iter_mut();
        let errors = views.map(|view| {
            act(view);
            view.blocks.errors
        });
        self.errors = errors.reduce(Errors::default, Errors::plus);
    }
}

impl Trial for Coverage<'_> {
    fn scales(&self) -> &[f64] {
        &self.scales
    }

    fn is_there_nothing_to_gain(&self) -> bool {
        is_same(self.errors.blocks_px, self.original_px)
    }

    fn objective(&self) -> i128 {
        self.errors.objective(self.original_px).into()
    }

    fn try_batch(&mut self, members: &[usize], factor: f64) {
        let scales = &self.scales;
        let sizes_of = |k: usize| [scales[k] * factor, scales[k] / factor];
        let effects = self.views.par_iter_mut().map(|view| {
            let of = |&k: &usize| view.effects(LeafId::from_index(k), sizes_of(k));
            members.iter().map(of).collect::<Vec<_>>()
        });
        let effects: Vec<Vec<[Effect; 2]>> = effects.collect();
        // As they are with what has been chosen of this batch.
        let mut errors = self.errors;
        let mut changes = Vec::new();
        for (member, &k) in members.iter().enumerate() {
            let with = |size: usize| {
                let of_leaf = effects.iter().map(|view| view[member][size]);
                let chance = chance_px(of_leaf.clone().map(|effect| effect.changed_px));
                let with = of_leaf.fold(errors, |sum, effect| sum.plus(effect.errors));
                let gain = errors.objective(self.original_px) - with.objective(self.original_px);
                (gain - CHANCE_WEIGHT * i64::from(chance), size, with)
            };
            // Of equally good sizes the smaller one draws less.
            let [larger, smaller] = [with(0), with(1)];
            let (gain, size, with) = if smaller.0 >= larger.0 {
                smaller
            } else {
                larger
            };
            if gain > 0 {
                errors = with;
                changes.push(Change {
                    leaf: LeafId::from_index(k),
                    to: sizes_of(k)[size],
                });
            }
        }
        if changes.is_empty() {
            return;
        }
        let before = self.objective();
        self.with_views(|view| view.try_out(&changes));
        if self.objective() > before {
            self.with_views(CoveredView::take_back);
            return;
        }
        for change in changes {
            self.scales[change.leaf.index()] = change.to;
        }
    }
}

/// A view, and how densely its blocks are covered.
struct CoveredView<'a> {
    sized: SizedView<'a>,
    blocks: Blocks,
}

impl<'a> CoveredView<'a> {
    fn new(sized: SizedView<'a>, original: &LeafIdImage) -> Self {
        Self {
            blocks: Blocks::new(original, &sized.a_buffer),
            sized,
        }
    }

    /// What a leaf does at two other sizes than it has.
    fn effects(&mut self, leaf: LeafId, sizes: [f64; 2]) -> [Effect; 2] {
        sizes.map(|size| {
            let (a_buffer, then) = self.sized.at_size(leaf, size);
            self.blocks.effect(a_buffer, leaf.get(), then)
        })
    }

    fn try_out(&mut self, changes: &[Change]) {
        let blocks = &mut self.blocks;
        let changed = |pixel, before, after| blocks.change(pixel, before, after);
        self.sized.try_out(changes, changed);
    }

    fn take_back(&mut self) {
        let blocks = &mut self.blocks;
        let changed = |pixel, before, after| blocks.change(pixel, before, after);
        self.sized.take_back(changed);
    }
}

/// By how much the blocks of a view show more foliage than they did of the original.
struct Blocks {
    resolution: u32,
    /// Whether a pixel shows foliage of the original.
    is_original: Vec<bool>,
    /// E, block by block.
    excess_px: Vec<i32>,
    errors: Errors,
    /// By how much E would change; 0 everywhere between two leaves.
    change_px: Vec<i32>,
    /// Blocks whose E would change.
    touched: Vec<usize>,
}

impl Blocks {
    fn new(original: &LeafIdImage, left: &ABuffer) -> Self {
        let blocks = original.resolution.div_ceil(BLOCK_PX).pow(2) as usize;
        let mut new = Self {
            resolution: original.resolution,
            is_original: original.leaf_ids.iter().map(|leaf| *leaf != 0).collect(),
            excess_px: vec![0; blocks],
            errors: Errors::default(),
            change_px: vec![0; blocks],
            touched: Vec::new(),
        };
        for pixel in 0..original.leaf_ids.len() as u32 {
            let is_original = new.is_original[pixel as usize];
            let is_covered = left.cover(pixel) > 0;
            let block = new.block_of(pixel);
            new.excess_px[block] += i32::from(is_covered) - i32::from(is_original);
            new.errors.outline_px += i64::from(is_covered != is_original);
        }
        let excesses = new.excess_px.iter().map(|e| i64::from(*e));
        new.errors.excess_px = excesses.clone().sum();
        new.errors.blocks_px = excesses.map(i64::abs).sum();
        new
    }

    fn block_of(&self, pixel: u32) -> usize {
        block_of(pixel, self.resolution)
    }

    /// Another leaf is in front of a pixel.
    fn change(&mut self, pixel: u32, before: FrontTwo, after: FrontTwo) {
        let by = i32::from(after[0] != 0) - i32::from(before[0] != 0);
        if by != 0 {
            let block = self.block_of(pixel);
            let excess = &mut self.excess_px[block];
            self.errors.blocks_px += i64::from((*excess + by).abs() - excess.abs());
            self.errors.excess_px += i64::from(by);
            self.errors.outline_px += self.outline_px(pixel, by);
            self.excess_px[block] += by;
        }
    }

    /// What it does if a leaf covers other pixels, which are in order.
    fn effect(&mut self, a_buffer: &ABuffer, leaf: u32, then: &[(u32, u32)]) -> Effect {
        let now = a_buffer.pixels_of(leaf);
        let mut outline_px = 0;
        let mut changed_px = (now.len() + then.len()) as u32;
        for &pixel in now {
            if a_buffer.cover(pixel) == 1 {
                outline_px += self.note(pixel, -1);
            }
        }
        let mut own = now.iter().copied().peekable();
        for &(pixel, _) in then {
            while own.next_if(|before| *before < pixel).is_some() {}
            let is_there = u32::from(own.peek() == Some(&pixel));
            changed_px -= 2 * is_there;
            if a_buffer.cover(pixel) == is_there {
                outline_px += self.note(pixel, 1);
            }
        }
        let mut errors = Errors {
            outline_px,
            ..Errors::default()
        };
        for block in self.touched.drain(..) {
            let change = std::mem::take(&mut self.change_px[block]);
            let excess = self.excess_px[block];
            errors.excess_px += i64::from(change);
            errors.blocks_px += i64::from((excess + change).abs() - excess.abs());
        }
        Effect { errors, changed_px }
    }

    /// Notes that a pixel will show a leaf (1) or none (-1); returns what that does to the
    /// outline.
    fn note(&mut self, pixel: u32, change: i32) -> i64 {
        let block = self.block_of(pixel);
        self.change_px[block] += change;
        self.touched.push(block);
        self.outline_px(pixel, change)
    }

    /// What it does to the outline that a pixel shows a leaf (1) or none (-1).
    fn outline_px(&self, pixel: u32, change: i32) -> i64 {
        match self.is_original[pixel as usize] {
            true => -i64::from(change),
            false => i64::from(change),
        }
    }
}

#[cfg(test)]
mod tests;
