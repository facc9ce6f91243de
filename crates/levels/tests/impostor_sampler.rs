//! The sampler in `docs/impostors.md` is valid, and its numbers are those of the atlas.

use naga::valid::{Capabilities, ValidationFlags, Validator};
use secateur_levels::impostor::octahedral::{BORDER, CELLS, CUTOFF, FRAMES};

const PAGE: &str = include_str!("../../../docs/impostors.md");

/// The text between the marks of a block of code.
fn block(language: &str) -> &'static str {
    let (_, rest) = PAGE
        .split_once(&format!("```{language}\n"))
        .expect("the block");
    rest.split_once("\n```").expect("its end").0
}

#[test]
fn the_wgsl_sampler_is_valid() {
    let text = block("wgsl");
    let module = naga::front::wgsl::parse_str(text);
    let module = module.unwrap_or_else(|e| panic!("{}", e.emit_to_string(text)));
    Validator::new(ValidationFlags::all(), Capabilities::empty())
        .validate(&module)
        .unwrap_or_else(|e| panic!("{e:?}"));
}

#[test]
fn both_samplers_know_the_grid() {
    for text in [block("wgsl"), block("glsl")] {
        for (name, value) in [
            ("FRAMES", f64::from(FRAMES)),
            ("CELLS", f64::from(CELLS)),
            ("BORDER", BORDER),
            ("CUTOFF", f64::from(CUTOFF)),
        ] {
            let line = text
                .lines()
                .find(|line| line.starts_with("const") && line.contains(name));
            let line = line.unwrap_or_else(|| panic!("{name} is there"));
            let found = line
                .rsplit('=')
                .next()
                .and_then(|v| v.trim().trim_end_matches(';').parse().ok());
            assert_eq!(found, Some(value), "{name}");
        }
    }
}
