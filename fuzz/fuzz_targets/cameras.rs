//! Whatever the text, a file of cameras ends in views that see a leaf, or do not, or
//! in an error.

#![no_main]

use libfuzzer_sys::fuzz_target;
use secateur::glam::DVec3;
use secateur::{Foliage, LeafTriangle, Lod, cameras_from_json};
use secateur_raster::{Scene, cpu};

/// Files of more cameras are read but not looked through: a run stays short.
const MOST_CAMERAS: usize = 64;

fuzz_target!(|text: &str| {
    let Ok(views) = cameras_from_json("fuzz.json", text) else {
        return;
    };
    if views.len() > MOST_CAMERAS {
        return;
    }
    let mut foliage = Foliage::default();
    let leaf = LeafTriangle::plain([DVec3::ZERO, DVec3::X, DVec3::Y]);
    foliage.push_leaf(&[leaf], None).expect("a leaf");
    let areas = cpu::areas(&Scene {
        foliage: &foliage,
        lod: &Lod::original(1),
        views: &views,
        resolution: 8,
    });
    assert_eq!(areas.view_count(), views.len());
});
