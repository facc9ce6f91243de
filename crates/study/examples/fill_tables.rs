//! Fills the tables of pages from the rows that they name:
//! `cargo run --package secateur-study --example fill_tables README.md docs/results.md`
//! from the root of the repository.

use std::path::Path;
use std::{env, fs};

use secateur_study::fill_tables;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    for page in env::args().skip(1) {
        let text = fs::read_to_string(&page)?;
        fs::write(&page, fill_tables(&text, Path::new("."))?)?;
    }
    Ok(())
}
