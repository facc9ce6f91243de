//! Whatever the bytes, a skeleton in a glTF ends in the orders of both methods that
//! follow it or in an error. Mutations know JSON and BIN.

#![no_main]

use libfuzzer_sys::{fuzz_mutator, fuzz_target};
use secateur_plant::{ClusterSize, Metric, chain_order, check_depth, merge_order};

fuzz_target!(|bytes: &[u8]| {
    let Some(tree) = secateur_fuzz::tree(bytes) else {
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

fuzz_mutator!(|data: &mut [u8], size: usize, max_size: usize, seed: u32| {
    secateur_fuzz::mutate_gltf(data, size, max_size, seed)
});
