//! Eq. 5: how much the neighbours of a pruned leaf grow.

use secateur_model::{Foliage, Growth, LeafId, Lod};
use secateur_raster::AreaTable;

use super::{Resize, VdsOptions};
use crate::vmi::scaled_to_bits;

/// A leaf never grows past this many times its original area: a speck of a
/// leaf beside a large one would otherwise leave the range of numbers.
const MAX_AREA_SCALE: f64 = 1e6;

/// What decides the share of a pruned leaf's area that is handed on.
#[derive(Clone, Copy)]
pub(crate) struct Pruned {
    /// The leaf that goes.
    pub leaf: LeafId,
    /// Its cost, scaled as VMI is: see [`vmi`](crate::vmi).
    pub cost: i64,
    /// Sum over the views of the VMI without it less that of the original
    /// foliage, scaled.
    pub deviation: i64,
    /// Pixels of the views that show foliage without it.
    pub covered_px: u64,
}

impl VdsOptions {
    /// The share of a pruned leaf's area that is handed on, 0 to 1; of the
    /// original foliage the views show `covered_original_px`. `largest_cost` is
    /// only called where it matters.
    pub(crate) fn share(
        &self,
        pruned: Pruned,
        pixels_per_view: u32,
        covered_original_px: u64,
        largest_cost: impl FnOnce() -> i64,
    ) -> f64 {
        let most_px = |max: f64| max * covered_original_px as f64;
        match self.max_coverage.map(most_px) {
            Some(most) if pruned.covered_px as f64 >= most => 0.0,
            _ => self.resize.share(pruned, pixels_per_view, largest_cost),
        }
    }
}

/// Pixels over all views that show foliage.
pub(crate) fn covered_px(areas: &AreaTable) -> u64 {
    let leaves = areas.rows().flat_map(|row| &row[1..]);
    leaves.map(|area_px| u64::from(*area_px)).sum()
}

impl Resize {
    /// The share, 0 to 1. `largest_cost` is only called where it matters.
    fn share(
        self,
        pruned: Pruned,
        pixels_per_view: u32,
        largest_cost: impl FnOnce() -> i64,
    ) -> f64 {
        match self {
            Resize::None => 0.0,
            Resize::Full => 1.0,
            Resize::Deficit => f64::from(u8::from(pruned.deviation < 0)),
            Resize::Literal => scaled_to_bits(pruned.cost, pixels_per_view).min(1.0),
            // 0 of 0, where no leaf costs anything, is 0 too.
            Resize::Normalised if pruned.cost == 0 => 0.0,
            Resize::Normalised => pruned.cost as f64 / largest_cost() as f64,
        }
    }
}

/// The leaves that grow by equal parts of `share` of the pruned leaf's area.
///
/// `nearest` are the neighbours that are left, nearest first. One without area
/// cannot grow.
pub(crate) fn growths(
    foliage: &Foliage,
    lod: &Lod,
    pruned: LeafId,
    share: f64,
    nearest: &[LeafId],
) -> Vec<Growth> {
    let scale = |leaf| lod.area_scale(leaf).expect("the leaf is still there");
    let area_handed_on = foliage.leaf(pruned).area() * scale(pruned) * share;
    let part = area_handed_on / nearest.len().max(1) as f64;
    if part <= 0.0 {
        return Vec::new();
    }
    let grow = |&leaf: &LeafId| {
        let own_area = foliage.leaf(leaf).area();
        let area_scale = (scale(leaf) + part / own_area).min(MAX_AREA_SCALE);
        (own_area > 0.0 && area_scale > scale(leaf)).then_some(Growth { leaf, area_scale })
    };
    nearest.iter().filter_map(grow).collect()
}

/// Squared distance of the centres of two leaves in squared world units.
#[inline]
pub(crate) fn distance_squared(foliage: &Foliage, a: LeafId, b: LeafId) -> f64 {
    let d = foliage.leaf(a).centre() - foliage.leaf(b).centre();
    d.x * d.x + d.y * d.y + d.z * d.z
}
