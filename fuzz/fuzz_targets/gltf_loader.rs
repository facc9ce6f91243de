//! Whatever the bytes, reading a glTF ends in a tree or in an error. Mutations
//! know JSON and BIN.

#![no_main]

use libfuzzer_sys::{fuzz_mutator, fuzz_target};

fuzz_target!(|bytes: &[u8]| {
    let Some(document) = secateur_fuzz::document(bytes) else {
        return;
    };
    let _ = document.inspect(&[]).to_string();
    let _ = document.surfaces(&[]);
    let _ = document.into_tree(&["material:*".parse().expect("a selector")]);
});

fuzz_mutator!(|data: &mut [u8], size: usize, max_size: usize, seed: u32| {
    secateur_fuzz::mutate_gltf(data, size, max_size, seed)
});
