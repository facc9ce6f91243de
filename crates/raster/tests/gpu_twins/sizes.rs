//! Scenes whose sizes lie on both sides of a workgroup, a list's sorting
//! method, a tile.

use glam::DVec3;
use secateur_model::{BoundingSphere, Foliage, LeafTriangle, Lod};
use secateur_raster::{Scene, View, ViewSet, cpu};

use super::{assert_original_twins, assert_twins, device};

/// A camera at the origin looking along -z; at distance 8 an image spans 16
/// units.
fn ahead() -> ViewSet {
    let view = View::look_at(DVec3::ZERO, -DVec3::Z, DVec3::Y, 1.0, 0.5).unwrap();
    ViewSet::new(vec![view])
}

fn quad(centre: [f64; 2], half: f64, distance: f64) -> [LeafTriangle; 2] {
    let [x, y] = centre;
    let at = |dx: f64, dy: f64| DVec3::new(x + dx * half, y + dy * half, -distance);
    let [a, b, c, d] = [at(-1.0, -1.0), at(1.0, -1.0), at(1.0, 1.0), at(-1.0, 1.0)];
    [[a, b, c], [a, c, d]].map(LeafTriangle::plain)
}

/// Leaves on a spiral, small and large, near and far.
fn spiral(leaves: u32) -> Foliage {
    let mut foliage = Foliage::default();
    for k in 0..leaves {
        let angle = f64::from(k) * 2.4;
        let radius = 7.0 * (f64::from(k % 97) / 97.0);
        let centre = [radius * angle.cos(), radius * angle.sin()];
        let leaf = quad(
            centre,
            0.05 + f64::from(k % 11) * 0.1,
            6.0 + f64::from(k % 5),
        );
        foliage.push_leaf(&leaf, None).unwrap();
    }
    foliage
}

#[test]
fn leaf_counts_straddle_the_workgroup() {
    for leaves in [0, 1, 31, 32, 33, 63, 64, 65, 127, 128, 129, 1000] {
        let foliage = spiral(leaves);
        for resolution in [1, 16, 64] {
            assert_original_twins(&foliage, &ahead(), resolution);
        }
    }
}

#[test]
fn resolutions_straddle_blocks_and_tiles() {
    let foliage = spiral(300);
    for resolution in [1, 2, 15, 16, 17, 63, 64, 65, 127, 129, 256, 257] {
        assert_original_twins(&foliage, &ahead(), resolution);
    }
}

#[test]
fn an_empty_scene_is_background() {
    let Some(device) = device() else { return };
    let foliage = Foliage::default();
    let sphere = BoundingSphere {
        centre: DVec3::ZERO,
        radius: 1.0,
    };
    let lod = Lod::original(0);
    for views in [ViewSet::new(Vec::new()), ViewSet::dodecahedron(sphere)] {
        let scene = Scene {
            foliage: &foliage,
            lod: &lod,
            views: &views,
            resolution: 64,
        };
        assert_twins(device, &scene);
    }
}

#[test]
fn a_leaf_that_fills_the_view_is_drawn_in_tiles() {
    let mut foliage = spiral(50);
    foliage
        .push_leaf(&quad([0.0, 0.0], 1e5, 9.0), None)
        .unwrap();
    foliage
        .push_leaf(&quad([0.0, 0.0], 7.9, 5.0), None)
        .unwrap();
    assert_original_twins(&foliage, &ahead(), 1000);
}

/// `leaves` leaves in the pixel above and to the right of the centre, at few
/// depths; every tenth folded, so that it covers the pixel twice.
fn column(leaves: u32) -> Foliage {
    let mut foliage = Foliage::default();
    for k in 0..leaves {
        let shuffled = k.wrapping_mul(0x9E37_79B1) >> 8;
        let distance = 8.0 + f64::from(shuffled % 61) * 0.01;
        let front = quad([0.5, 0.5], 0.3, distance);
        let back = quad([0.5, 0.5], 0.3, distance + 0.005);
        if k % 10 == 0 {
            foliage.push_leaf(&[back, front].concat(), None).unwrap();
        } else {
            foliage.push_leaf(&front, None).unwrap();
        }
    }
    foliage
}

#[test]
fn columns_of_any_length_are_sorted() {
    // Around the bounds of insertion and heap, and a power of two of the
    // network; with the folded leaves lists are a tenth longer.
    for leaves in [2, 29, 30, 31, 929, 930, 931, 932, 1862, 3725, 5000] {
        assert_original_twins(&column(leaves), &ahead(), 16);
    }
}

#[test]
fn a_column_of_a_hundred_thousand_is_sorted() {
    let foliage = column(100_000);
    assert_original_twins(&foliage, &ahead(), 16);
}

#[test]
fn equal_depths_go_by_leaf_number() {
    let mut foliage = Foliage::default();
    for _ in 0..200 {
        foliage
            .push_leaf(&quad([0.0, 0.0], 3.0, 8.0), None)
            .unwrap();
    }
    assert_original_twins(&foliage, &ahead(), 64);
    let views = ahead();
    let lod = Lod::original(200);
    let scene = Scene {
        foliage: &foliage,
        lod: &lod,
        views: &views,
        resolution: 64,
    };
    // The tie is real: all the fragments of the middle pixel are equally deep.
    let fragments = cpu::fragments(&scene);
    let list = fragments.views()[0].at(32 * 64 + 32);
    assert_eq!(list.len(), 200);
    assert!(list.iter().all(|f| f.depth() == list[0].depth()));
}
