//! The file of rows, which grows by one line at a time.

use std::collections::BTreeSet;
use std::fs::{self, File, OpenOptions};
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};

use crate::{Error, Host, Identity, Row, read_rows, to_line};

/// The name of the file within a study's folder.
const NAME: &str = "rows.jsonl";

/// The rows of a study's folder; none where there is no file.
pub(crate) fn read(folder: &Path) -> Result<Vec<Row>, Error> {
    let path = folder.join(NAME);
    let text = match fs::read_to_string(&path) {
        Ok(text) => text,
        Err(e) if e.kind() == ErrorKind::NotFound => return Ok(Vec::new()),
        Err(e) => return Err(Error::of_file(&path, "cannot be read", e)),
    };
    read_rows(&text).map_err(|(line, reason)| {
        let path = path.display();
        Error::Refused(format!(
            "{path}: line {line} is no row of a study: {reason}"
        ))
    })
}

/// The file of rows, open for appending.
pub(crate) struct RowFile {
    path: PathBuf,
    file: File,
}

impl RowFile {
    /// Opens the file behind the rows that were read from it; a line that was cut off is dropped.
    /// Rows of `studied` are moved to the end, because the last row of a name decides which tree
    /// is drawn: see [`current_rows`](crate::current_rows).
    pub(crate) fn after(
        rows: &[Row],
        studied: &BTreeSet<Identity>,
        folder: &Path,
        host: &dyn Host,
    ) -> Result<Self, Error> {
        let path = folder.join(NAME);
        let is_studied = |row: &&Row| studied.contains(&row.identity());
        let (last, first): (Vec<&Row>, Vec<&Row>) = rows.iter().partition(is_studied);
        let text: String = first.into_iter().chain(last).map(to_line).collect();
        host.write_file(&path, text.as_bytes())
            .map_err(Error::Refused)?;
        let file = OpenOptions::new()
            .append(true)
            .open(&path)
            .map_err(|e| Error::of_file(&path, "cannot be written", e))?;
        Ok(Self { path, file })
    }

    pub(crate) fn append(&mut self, row: &Row) -> Result<(), Error> {
        let line = to_line(row);
        let written = self.file.write_all(line.as_bytes());
        written.map_err(|e| Error::of_file(&self.path, "cannot be written", e))
    }
}
