//! Whatever the bytes, a chain is drawn as far as it goes, or ends in an error.

#![no_main]

use libfuzzer_sys::fuzz_target;
use secateur_plant::read_chain;

fuzz_target!(|bytes: &[u8]| {
    let mut records = 0usize;
    let _ = read_chain(&mut &*bytes, &mut |_| {
        records += 1;
        true
    });
    // Each record is a byte at least.
    assert!(records <= bytes.len());
});
