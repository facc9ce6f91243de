//! What the original and the simplified foliage show to each view.

use rayon::prelude::*;
use secateur_raster::measure::lg::LgTable;
use secateur_raster::measure::vmi::Vmi;
use secateur_raster::{AreaTable, Scene, cpu};

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

/// A scene as all its views see it, as far as it is judged.
#[derive(Clone, Debug)]
pub(super) struct SeenScene {
    vmi: Vmi,
    views: Vec<DrawnView>,
}

#[derive(Clone, Debug)]
struct DrawnView {
    foliage_px: u32,
    /// A bit a pixel, row by row.
    is_foliage: Vec<u64>,
}

/// Draws a scene once in every view.
pub(super) fn draw(scene: &Scene<'_>) -> SeenScene {
    let leaf_count = scene.foliage.leaves().len();
    let views = scene.views.views().par_iter();
    let drawn: Vec<(Vec<u32>, DrawnView)> = views
        .map(|view| {
            let image = cpu::draw_leaf_ids(scene, view);
            let area_px = cpu::histogram(&image, leaf_count);
            let words = image.leaf_ids.chunks(64).map(|pixels| {
                let bits = pixels.iter().enumerate();
                bits.fold(0, |word, (bit, id)| word | (u64::from(*id != 0) << bit))
            });
            let view = DrawnView {
                foliage_px: area_px[1..].iter().sum(),
                is_foliage: words.collect(),
            };
            (area_px, view)
        })
        .collect();
    let (rows, views): (Vec<Vec<u32>>, Vec<DrawnView>) = drawn.into_iter().unzip();
    let table = AreaTable::from_rows(leaf_count, rows.concat());
    SeenScene {
        vmi: Vmi::of(&table, &LgTable::new()),
        views,
    }
}

/// Holds two scenes of the same views and resolution against each other.
pub(super) fn compare(original: &SeenScene, simplified: &SeenScene) -> Vec<SeenView> {
    let vmis = original.vmi.scaled().iter().zip(simplified.vmi.scaled());
    let views = original.views.iter().zip(&simplified.views);
    let seen = views.zip(vmis).map(|((a, b), vmis)| {
        let both = a.is_foliage.iter().zip(&b.is_foliage);
        SeenView {
            original_px: a.foliage_px,
            simplified_px: b.foliage_px,
            shared_px: both.map(|(a, b)| (a & b).count_ones()).sum(),
            original_vmi_scaled: *vmis.0,
            simplified_vmi_scaled: *vmis.1,
        }
    });
    seen.collect()
}
