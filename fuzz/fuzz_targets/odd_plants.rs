//! Whatever the choices, an odd plant is opened, inspected and made levels of, or refused in a sentence.

#![no_main]

#[path = "../../crates/cli/examples/odd_plants/check.rs"]
mod check;
#[path = "../../crates/cli/examples/odd_plants/plant/mod.rs"]
mod plant;

use libfuzzer_sys::fuzz_target;

fuzz_target!(|choices: &[u8]| {
    check::check(choices);
});
