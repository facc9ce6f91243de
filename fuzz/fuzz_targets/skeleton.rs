//! Whatever the bytes, a skeleton in a glTF ends in the orders of both methods that
//! follow it or in an error:
//! `cargo +nightly fuzz run skeleton -- -rss_limit_mb=4096 -timeout=10`.

#![no_main]

use libfuzzer_sys::fuzz_target;
use secateur_gltf::Document;
use secateur_plant::{ClusterSize, Metric, chain_order, check_depth, merge_order};

fuzz_target!(|bytes: &[u8]| {
    let Ok(document) = Document::from_bytes("fuzz.glb", bytes.to_vec(), None) else {
        return;
    };
    let Ok(tree) = document.into_tree(&["material:*".parse().expect("a selector")]) else {
        return;
    };
    let Ok(Some(skeleton)) = tree.skeleton() else {
        return;
    };
    if check_depth(&skeleton.segments).is_ok() {
        let foliage = tree.foliage();
        let _ = chain_order(foliage, &skeleton, Metric::BranchingLength, 0);
        let _ = merge_order(foliage, &skeleton, ClusterSize::Area, 0);
    }
});
