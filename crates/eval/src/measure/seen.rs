//! What the original and the simplified foliage show to each view.

use rayon::prelude::*;
use secateur_raster::measure::lg::LgTable;
use secateur_raster::measure::vmi::Vmi;
use secateur_raster::{AreaTable, Scene, View, cpu};

/// One view of the original and of the simplified foliage, counted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SeenView {
    /// Foliage pixels of the original.
    pub original_px: u32,
    /// Foliage pixels of the simplified foliage.
    pub simplified_px: u32,
    /// Pixels that are foliage in both.
    pub shared_px: u32,
    /// The original's VMI, as [`Vmi::scaled`].
    pub original_vmi_scaled: i64,
    /// The simplified foliage's VMI, as [`Vmi::scaled`].
    pub simplified_vmi_scaled: i64,
}

/// Draws both scenes, which share views and resolution, once in every view.
pub(super) fn see(original: &Scene<'_>, simplified: &Scene<'_>) -> Vec<SeenView> {
    let views = original.views.views().par_iter();
    let counted: Vec<Counts> = views.map(|v| count(original, simplified, v)).collect();
    let table = LgTable::new();
    let vmi = |scene: &Scene<'_>, row: fn(&Counts) -> &Vec<u32>| {
        let rows: Vec<u32> = counted.iter().flat_map(row).copied().collect();
        Vmi::of(
            &AreaTable::from_rows(scene.foliage.leaves().len(), rows),
            &table,
        )
    };
    let original_vmi = vmi(original, |c| &c.original_area_px);
    let simplified_vmi = vmi(simplified, |c| &c.simplified_area_px);
    let vmis = original_vmi.scaled().iter().zip(simplified_vmi.scaled());
    let seen = counted.iter().zip(vmis);
    seen.map(
        |(counts, (&original_vmi_scaled, &simplified_vmi_scaled))| SeenView {
            original_px: counts.original_area_px[1..].iter().sum(),
            simplified_px: counts.simplified_area_px[1..].iter().sum(),
            shared_px: counts.shared_px,
            original_vmi_scaled,
            simplified_vmi_scaled,
        },
    )
    .collect()
}

/// Rows of the two area tables, and the pixels that are foliage in both.
struct Counts {
    original_area_px: Vec<u32>,
    simplified_area_px: Vec<u32>,
    shared_px: u32,
}

fn count(original: &Scene<'_>, simplified: &Scene<'_>, view: &View) -> Counts {
    let [a, b] = [original, simplified].map(|scene| cpu::draw_leaf_ids(scene, view));
    let pixels = a.leaf_ids.iter().zip(&b.leaf_ids);
    let shared = pixels.filter(|(a, b)| **a != 0 && **b != 0);
    Counts {
        shared_px: shared.count() as u32,
        original_area_px: cpu::histogram(&a, original.foliage.leaves().len()),
        simplified_area_px: cpu::histogram(&b, simplified.foliage.leaves().len()),
    }
}
