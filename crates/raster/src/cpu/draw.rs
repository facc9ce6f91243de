//! Leaves to a leaf-ID image with a depth buffer, as the paper draws them.

use super::rasterise;
use crate::occluders::Occlusion;
use crate::snap::Snapper;
use crate::{Fragment, LeafIdImage, Scene, View};

/// Draws one view of a scene: at each pixel the nearest leaf, at equal depth
/// the lowest number.
///
/// This code shares nothing with [`fragments`](super::fragments) but the snapped
/// triangles, and so serves as its check.
///
/// # Panics
/// If the scene's resolution or pixels are out of range.
pub fn draw_leaf_ids(scene: &Scene<'_>, view: &View) -> LeafIdImage {
    draw(scene, view, None)
}

/// [`draw_leaf_ids`], but none where the nearest leaf is farther than what hides leaves there.
///
/// # Panics
/// As [`draw_leaf_ids`].
pub fn draw_leaf_ids_among(scene: &Scene<'_>, view: &View, occlusion: &Occlusion) -> LeafIdImage {
    draw(scene, view, Some(occlusion))
}

fn draw(scene: &Scene<'_>, view: &View, occlusion: Option<&Occlusion>) -> LeafIdImage {
    scene.assert_in_range();
    let background = Fragment::new(u32::MAX, 0);
    let mut nearest = vec![background; scene.pixels_per_view()];
    let snapper = Snapper::new(view, scene.resolution);
    let cutouts = scene.foliage.cutouts();
    for (leaf, area_scale) in scene.lod.leaves() {
        let geometry = scene.foliage.leaf(leaf);
        snapper.snap_leaf(
            leaf.get(),
            geometry,
            scene.foliage.triangles_of(leaf),
            area_scale,
            geometry.cutout().map(|index| &*cutouts[index as usize]),
            |triangle| {
                rasterise(triangle, cutouts, |x, y, depth| {
                    let pixel = &mut nearest[(y * scene.resolution + x) as usize];
                    *pixel = (*pixel).min(Fragment::new(depth, leaf.get()));
                });
            },
        );
    }
    for (fragment, hidden_beyond) in nearest
        .iter_mut()
        .zip(occlusion.iter().flat_map(|o| &o.nearest))
    {
        if fragment.depth() > *hidden_beyond {
            *fragment = background;
        }
    }
    LeafIdImage {
        resolution: scene.resolution,
        leaf_ids: nearest.into_iter().map(Fragment::leaf).collect(),
    }
}
