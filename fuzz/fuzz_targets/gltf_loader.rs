//! Whatever the bytes, reading a glTF ends in a tree or in an error:
//! `cargo +nightly fuzz run gltf_loader -- -rss_limit_mb=4096 -timeout=10`.

#![no_main]

use libfuzzer_sys::fuzz_target;
use secateur_gltf::Document;

fuzz_target!(|bytes: &[u8]| {
    let Ok(document) = Document::from_bytes("fuzz.glb", bytes.to_vec(), None) else {
        return;
    };
    let _ = document.inspect(&[]).to_string();
    let _ = document.surfaces(&[]);
    let _ = document.into_tree(&["material:*".parse().expect("a selector")]);
});
