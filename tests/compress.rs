//! `--compress`: the same plant in fewer bytes.

use std::path::PathBuf;

use secateur::chain::Wanted;
use secateur::{Amount, Document, ImageFormat, Layout, LevelsOptions, Plant, WriteOptions, judge};

use crate::program::{Bench, shared_tree};
use crate::validator::assert_valid;

/// Levels of a plant in a file each, and the same files compressed.
fn both_ways(bench: &Bench, plant: &Plant) -> [Vec<PathBuf>; 2] {
    let mut options = LevelsOptions {
        wanted: Wanted::Triangles(vec![Amount::Share(0.3), Amount::Share(0.12)]),
        ..LevelsOptions::default()
    };
    options.screen.height_px = 270.0;
    let levels = plant.levels(&options).unwrap().named("plant");
    [None, Some(ImageFormat::WebP)].map(|compress| {
        let folder = bench.path(if compress.is_some() { "small" } else { "plain" });
        let how = WriteOptions::default().compress(compress);
        let prepared = levels.prepare(&folder, Layout::Files, how).unwrap();
        prepared.commit().unwrap().files
    })
}

fn bytes(files: &[PathBuf]) -> u64 {
    let sizes = files.iter().map(|file| file.metadata().unwrap().len());
    sizes.sum()
}

/// Which extensions a reader of the file must know.
fn required(file: &PathBuf) -> Vec<String> {
    let glb = std::fs::read(file).unwrap();
    let (root, _) = crate::glb::chunks(&glb);
    let root: serde_json::Value = serde_json::from_slice(root).unwrap();
    let names = root["extensionsRequired"].as_array();
    let names = names.into_iter().flatten();
    names.map(|n| n.as_str().unwrap().to_owned()).collect()
}

/// Triangles are as many, corners where they were but for a step of the grid, and texels the very same.
#[track_caller]
fn assert_same_looks(plain: &PathBuf, small: &PathBuf) {
    let [plain, small] = [plain, small].map(|file| Document::open(file).unwrap());
    let [plain, small] = [plain, small].map(|file| file.surfaces(&[]).unwrap());
    assert_eq!(plain.len(), small.len());
    for ((a, _), (b, _)) in plain.iter().zip(&small) {
        assert_eq!(a.triangles.len(), b.triangles.len());
        let texels = |of: &secateur::Surface| of.material.texture.as_ref().map(|t| t.rgba.clone());
        assert_eq!(texels(a), texels(b));
        for corner in 0..3 {
            let mean = |of: &secateur::Surface| {
                let all = of.positions.iter().map(|p| p[corner]);
                all.sum::<f64>() / of.positions.len() as f64
            };
            assert!((mean(a) - mean(b)).abs() < 1e-3);
        }
    }
}

#[test]
fn a_real_chain_takes_a_third_and_its_images_are_webp() {
    let Some(tree) = shared_tree("ez_oak_20k.glb") else {
        return;
    };
    let bench = Bench::new();
    let [plain, small] = both_ways(&bench, &Plant::open(tree).unwrap());
    let share = bytes(&small) as f64 / bytes(&plain) as f64;
    assert!(share < 1.0 / 3.0, "{share}");
    for (plain, small) in plain.iter().zip(&small) {
        assert_eq!(required(plain), [""; 0]);
        let required = required(small);
        for name in ["EXT_meshopt_compression", "EXT_texture_webp"] {
            assert!(required.contains(&name.to_owned()), "{required:?}");
        }
        assert_same_looks(plain, small);
    }
    assert_valid(&small);
}

/// Where the plant stands far from the origin, its grid is as fine.
#[test]
fn a_plant_far_off_keeps_its_shape() {
    let bench = Bench::new();
    let (root, bin) = crate::glb::chunks(crate::program::oak());
    let mut root: serde_json::Value = serde_json::from_slice(root).unwrap();
    let far = [700.0, 0.0, -300.0];
    root["nodes"]
        .as_array_mut()
        .unwrap()
        .iter_mut()
        .for_each(|node| {
            if node.get("mesh").is_some() {
                node["translation"] = serde_json::json!(far);
            }
        });
    let glb = crate::glb::joined(&root, bin);
    let plant = Plant::from_bytes("far.glb", glb, &secateur::Opening::default()).unwrap();
    let [plain, small] = both_ways(&bench, &plant);
    for (plain, small) in plain.iter().zip(&small) {
        assert_same_looks(plain, small);
    }
}

/// Images of colours become KTX2, which a reader decodes to nearly the same texels; what else there is becomes WebP.
#[test]
fn colours_become_ktx2() {
    let bench = Bench::new();
    bench.put("oak.glb", crate::program::oak());
    for (file, images) in [("webp.glb", "--compress"), ("ktx2.glb", "--compress=ktx2")] {
        let made = [
            "simplify",
            "oak.glb",
            "--triangles",
            "0.5",
            images,
            "-o",
            file,
        ];
        bench.run(&made).succeeded();
    }
    let other = [
        "simplify",
        "oak.glb",
        "--triangles",
        "0.5",
        "--compress=avif",
        "-o",
        "a.glb",
    ];
    let refused = bench.run(&other);
    assert_eq!(refused.code, Some(2));
    assert!(refused.stderr.contains("images become webp or ktx2"));
    let [webp, ktx2] = ["webp.glb", "ktx2.glb"].map(|name| bench.path(name));
    let names = required(&ktx2);
    assert!(
        names.contains(&"KHR_texture_basisu".to_owned()),
        "{names:?}"
    );
    assert_valid(std::slice::from_ref(&ktx2));
    let seen = judge(&Plant::open(&webp).unwrap(), &Plant::open(&ktx2).unwrap()).unwrap();
    let seen = seen.difference_at(256.0);
    assert!(seen.difference < 0.05, "{seen:?}");
}
