//! Fills the tables of pages from the rows that they name:
//! `cargo run --package secateur-study --example fill_tables README.md docs/results.md`
//! from the root of the repository.

use std::path::Path;
use std::{env, fs};

use secateur_study::{current_rows, fill_tables, read_rows};

fn main() -> Result<(), String> {
    for page in env::args().skip(1) {
        let text = fs::read_to_string(&page).map_err(|e| format!("{page}: {e}"))?;
        let filled = fill_tables(&text, &mut |folder| {
            let path = Path::new(folder).join("rows.jsonl");
            let rows = fs::read_to_string(&path).map_err(|e| format!("{}: {e}", path.display()))?;
            let rows = read_rows(&rows).map_err(|(line, why)| format!("line {line}: {why}"))?;
            Ok(current_rows(rows))
        });
        let filled = filled.map_err(|e| format!("{page}: {e}"))?;
        fs::write(&page, filled).map_err(|e| format!("{page}: {e}"))?;
    }
    Ok(())
}
