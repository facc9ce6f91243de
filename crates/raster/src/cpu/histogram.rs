//! Leaf-ID images to areas.

use rayon::prelude::*;

use super::draw_leaf_ids;
use crate::{AreaTable, LeafIdImage, Scene};

/// Counts each leaf's pixels in an image: `leaf_count + 1` areas, the
/// background first. The twin is `histogram.wgsl`.
///
/// # Panics
/// If the image holds a leaf number above `leaf_count`.
pub fn histogram(image: &LeafIdImage, leaf_count: usize) -> Vec<u32> {
    let mut area_px = vec![0u32; leaf_count + 1];
    count(image, &mut area_px);
    area_px
}

fn count(image: &LeafIdImage, area_px: &mut [u32]) {
    for &leaf in &image.leaf_ids {
        area_px[leaf as usize] += 1;
    }
}

/// The area table of the images of some views, in which rows are counted where they lie: with many
/// leaves it is large, and is not there twice.
pub(super) fn table_of(
    leaf_count: usize,
    views: usize,
    image: impl Fn(usize) -> LeafIdImage + Sync,
) -> AreaTable {
    let mut area_px = vec![0; views * (leaf_count + 1)];
    let rows = area_px.par_chunks_mut(leaf_count + 1).enumerate();
    rows.for_each(|(view, row)| count(&image(view), row));
    AreaTable::from_rows(leaf_count, area_px)
}

/// The area table of a scene: draws every view and counts.
///
/// # Panics
/// If the scene's resolution or pixels are out of range.
pub fn areas(scene: &Scene<'_>) -> AreaTable {
    scene.assert_in_range();
    let leaf_count = scene.foliage.leaves().len();
    let views = scene.views.views();
    table_of(leaf_count, views.len(), |view| {
        draw_leaf_ids(scene, &views[view])
    })
}
