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
    for &leaf in &image.leaf_ids {
        area_px[leaf as usize] += 1;
    }
    area_px
}

/// The area table of a scene: draws every view and counts.
///
/// # Panics
/// If the scene's resolution or pixels are out of range.
pub fn areas(scene: &Scene<'_>) -> AreaTable {
    scene.assert_in_range();
    let leaf_count = scene.foliage.leaves().len();
    let rows: Vec<Vec<u32>> = scene
        .views
        .views()
        .par_iter()
        .map(|view| histogram(&draw_leaf_ids(scene, view), leaf_count))
        .collect();
    AreaTable::from_rows(leaf_count, rows.concat())
}
