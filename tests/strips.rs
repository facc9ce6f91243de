//! `--strips`: the same plant in triangle strips.

use std::path::Path;

use secateur::{Document, Tree};
use serde_json::Value;

use crate::program::Bench;
use crate::validator::assert_valid;

/// The mode of each primitive of a file.
fn modes(file: &Path) -> Vec<u64> {
    let glb = std::fs::read(file).unwrap();
    let (root, _) = crate::glb::chunks(&glb);
    let root: Value = serde_json::from_slice(root).unwrap();
    let meshes = root["meshes"].as_array().unwrap().iter();
    let primitives = meshes.flat_map(|mesh| mesh["primitives"].as_array().unwrap());
    primitives
        .map(|p| p["mode"].as_u64().unwrap_or(4))
        .collect()
}

/// The triangles of each surface: positions of their corners from the least on, in that direction, sorted.
fn triangles(file: &Path) -> Vec<Vec<[[u64; 3]; 3]>> {
    let surfaces = Document::open(file).unwrap().surfaces(&[]).unwrap();
    let of_surface = |surface: &secateur::Surface| {
        let at = |vertex: u32| {
            surface.positions[vertex as usize]
                .to_array()
                .map(f64::to_bits)
        };
        let mut all: Vec<[[u64; 3]; 3]> = (surface.triangles.iter())
            .map(|triangle| {
                let mut corners = triangle.map(at);
                let least = *corners.iter().min().unwrap();
                while corners[0] != least {
                    corners.rotate_left(1);
                }
                corners
            })
            .collect();
        all.sort_unstable();
        all
    };
    surfaces
        .iter()
        .map(|(surface, _)| of_surface(surface))
        .collect()
}

#[track_caller]
fn assert_same_in_strips(list: &Path, strips: &Path) {
    assert!(modes(list).iter().all(|mode| *mode == 4));
    assert!(modes(strips).iter().all(|mode| *mode == 5));
    assert_eq!(triangles(strips), triangles(list));
}

/// Each triangle is there once, and faces where it did; leaves are found as before.
#[test]
fn a_level_in_strips_has_the_triangles_of_the_list() {
    let bench = Bench::for_small_screen();
    let options = ["--triangles", "0.3", "--no-audit"];
    for (name, more) in [
        ("list", &[][..]),
        ("strips", &["--strips"]),
        ("small", &["--strips", "--compress"]),
    ] {
        let out = format!("{name}.glb");
        bench
            .simplify(&[&["oak.glb", "-o", &out][..], &options, more].concat())
            .succeeded();
    }
    let [list, strips, small] =
        ["list.glb", "strips.glb", "small.glb"].map(|file| bench.path(file));
    assert_same_in_strips(&list, &strips);
    let leaves = |file: &Path| Tree::open(file, &[]).unwrap().foliage().leaves().len();
    assert_eq!(leaves(&strips), leaves(&list));
    assert!(modes(&small).iter().all(|mode| *mode == 5));
    assert_valid(&[strips, small]);
}

/// The plant itself is one of them, and is written in strips too.
#[test]
fn levels_in_strips_are_those_in_lists() {
    let bench = Bench::for_small_screen();
    for (folder, more) in [("lists", &[][..]), ("strips", &["--strips"])] {
        let call = ["lods", "oak.glb", "-o", folder, "--levels", "0.4,0.2"];
        bench.run(&[&call[..], more].concat()).succeeded();
    }
    let mut files = Vec::new();
    for level in 0..3 {
        let name = format!("oak_LOD{level}.glb");
        let [list, strips] = ["lists", "strips"].map(|folder| bench.path(folder).join(&name));
        assert_same_in_strips(&list, &strips);
        files.push(strips);
    }
    assert_valid(&files);
    let refused = bench.run(&["lods", "oak.glb", "-o", "oak.usda", "--strips"]);
    refused.failed_with(2, &["`--strips` is for glTF"]);
}
