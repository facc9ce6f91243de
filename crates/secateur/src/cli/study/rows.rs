//! The file of rows, which grows by one line at a time.

use std::fs::{self, File, OpenOptions};
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};

use secateur_eval::study::{Row, RowKey, read_rows, to_line};

use super::super::failure::Failure;
use super::super::output;
use super::plan::Case;

/// The name of the file within a study's folder.
const NAME: &str = "rows.jsonl";

/// The rows of a study's folder; none where there is no file.
pub(super) fn read(folder: &Path) -> Result<Vec<Row>, Failure> {
    let path = folder.join(NAME);
    let text = match fs::read_to_string(&path) {
        Ok(text) => text,
        Err(e) if e.kind() == ErrorKind::NotFound => return Ok(Vec::new()),
        Err(e) => return Err(Failure::of_file(&path, "cannot be read", &e)),
    };
    read_rows(&text).map_err(|(line, reason)| {
        let path = path.display();
        Failure(format!(
            "{path}: line {line} is no row of a study: {reason}"
        ))
    })
}

/// The key of a row that is yet to be made.
pub(super) fn key(tree: &str, case: &Case, seed: Option<u64>, level: f64) -> RowKey {
    let level = (1e6 * level).round() as u64;
    let (setting, change) = (case.setting(), case.perturbation.name());
    let names = [tree.to_owned(), case.method.clone(), setting, change];
    (names, seed.unwrap_or(0), level)
}

/// The file, open at its end.
pub(super) struct RowFile {
    path: PathBuf,
    file: File,
}

impl RowFile {
    /// Goes on behind the rows that were read; half a last line is dropped.
    pub(super) fn after(rows: &[Row], folder: &Path) -> Result<Self, Failure> {
        output::make_folder(folder)?;
        let path = folder.join(NAME);
        let whole: String = rows.iter().map(to_line).collect();
        output::write_file(&path, whole.as_bytes())?;
        let file = OpenOptions::new()
            .append(true)
            .open(&path)
            .map_err(|e| Failure::of_file(&path, "cannot be written", &e))?;
        Ok(Self { path, file })
    }

    pub(super) fn append(&mut self, row: &Row) -> Result<(), Failure> {
        let line = to_line(row);
        let written = self.file.write_all(line.as_bytes());
        written.map_err(|e| Failure::of_file(&self.path, "cannot be written", &e))
    }
}
