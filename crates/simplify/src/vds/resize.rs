//! Eq. 5: how much the neighbours of a pruned leaf grow.

use secateur_model::{Foliage, Growth, LeafId, Lod};
use secateur_raster::AreaTable;

use super::{Resize, VdsOptions};
use crate::vmi::scaled_to_bits;

/// A leaf never grows past this many times its original area: a speck of a
/// leaf beside a large one would otherwise leave the range of numbers.
const MAX_AREA_SCALE: f64 = 1e6;

/// The number of views with which [`Resize::Steady`] is [`Resize::Normalised`]: the paper's.
const STEADY_VIEWS: f64 = 20.0;

/// What views see, as far as shares depend on it.
#[derive(Clone, Copy)]
pub(crate) struct Sights {
    /// How many views there are.
    pub views: usize,
    /// Width times height of each view's image, in pixels.
    pub pixels_per_view: u32,
    /// Pixels over all views that show foliage of the original.
    pub covered_original_px: u64,
}

/// What decides the share of a pruned leaf's area that is handed on.
#[derive(Clone, Copy)]
pub(crate) struct Pruned {
    /// The leaf that goes.
    pub leaf: LeafId,
    /// Its cost (Eq. 4), scaled as [`vmi`](crate::vmi) says.
    pub cost: i64,
    /// Sum over the views of the VMI without it less that of the original
    /// foliage, scaled.
    pub deviation: i64,
    /// Pixels of the views that show foliage without it.
    pub covered_px: u64,
}

impl VdsOptions {
    /// The share of a pruned leaf's area that is handed on, 0 to 1. `largest_cost` is
    /// only called where it matters.
    pub(crate) fn share(
        &self,
        pruned: Pruned,
        sights: Sights,
        largest_cost: impl FnOnce() -> i64,
    ) -> f64 {
        let most_px = |max: f64| max * sights.covered_original_px as f64;
        match self.max_coverage.map(most_px) {
            Some(most) if pruned.covered_px as f64 >= most => 0.0,
            _ => self.resize.share(pruned, sights, largest_cost),
        }
    }
}

/// Pixels over all views that show foliage.
pub(crate) fn covered_px(areas: &AreaTable) -> u64 {
    let leaves = areas.rows().flat_map(|row| &row[1..]);
    leaves.map(|area_px| u64::from(*area_px)).sum()
}

impl Resize {
    /// Whether the share depends on the largest cost of the step.
    pub(crate) fn needs_largest_cost(self) -> bool {
        matches!(self, Resize::Normalised | Resize::Steady)
    }

    /// The share, 0 to 1. `largest_cost` is only called where it matters.
    fn share(self, pruned: Pruned, sights: Sights, largest_cost: impl FnOnce() -> i64) -> f64 {
        match self {
            Resize::None => 0.0,
            Resize::Full => 1.0,
            Resize::Deficit => f64::from(u8::from(pruned.deviation < 0)),
            Resize::Literal => scaled_to_bits(pruned.cost, sights.pixels_per_view).min(1.0),
            // 0 of 0, where no leaf costs anything, is 0 too.
            Resize::Normalised | Resize::Steady if pruned.cost == 0 => 0.0,
            Resize::Normalised => pruned.cost as f64 / largest_cost() as f64,
            Resize::Steady => {
                let ratio = pruned.cost as f64 / largest_cost() as f64;
                // Costs of fewer than 20 views differ more in proportion: the share has to be larger for the same ratio.
                let slope = (sights.views as f64 / STEADY_VIEWS).sqrt();
                match slope < 1.0 {
                    true => libm::pow(ratio, slope),
                    false => (1.0 - (1.0 - ratio) * slope).max(0.0),
                }
            }
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

#[cfg(test)]
mod tests {
    use super::*;

    fn share(resize: Resize, views: usize, cost: i64) -> f64 {
        let pruned = Pruned {
            leaf: LeafId::new(1).unwrap(),
            cost,
            deviation: 0,
            covered_px: 0,
        };
        let sights = Sights {
            views,
            pixels_per_view: 1,
            covered_original_px: 0,
        };
        resize.share(pruned, sights, || 1000)
    }

    #[test]
    fn steady_growth_is_normalised_growth_with_20_views() {
        for cost in [0, 1, 400, 999, 1000] {
            let [steady, normalised] =
                [Resize::Steady, Resize::Normalised].map(|resize| share(resize, 20, cost));
            assert!((steady - normalised).abs() < 1e-12, "{cost}");
        }
        // Four times as many views bring costs twice as near to each other.
        let [few, many] = [(20, 600), (80, 800)].map(|(n, cost)| share(Resize::Steady, n, cost));
        assert!((few - many).abs() < 1e-12);
        // A leaf that is much cheaper than 80 views make likely hands nothing on.
        assert_eq!(share(Resize::Steady, 80, 400), 0.0);
        // Of a quarter of the views the share is the root of what it is of 20, and falls to nothing with the cost.
        for (cost, of_five) in [(0, 0.0), (1, 0.0316), (250, 0.5), (810, 0.9), (1000, 1.0)] {
            let found = share(Resize::Steady, 5, cost);
            assert!((found - of_five).abs() < 1e-4, "{cost}: {found}");
        }
    }
}
