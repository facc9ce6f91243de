//! What a study needs of the program that runs it.

use std::path::Path;

/// The program that runs a study.
pub trait Host {
    /// Whether the user has asked for a stop. Finished rows are kept.
    fn is_stop_asked(&self) -> bool;

    /// Called once before the first row, with the number of rows to come.
    fn begin(&self, rows: usize);

    /// Called before each run, with its tree, method and setting.
    fn working_on(&self, what: &str);

    /// Called after each row.
    fn row_is_done(&self);

    /// Called after the last row; not if the study fails.
    fn end(&self);

    /// Writes a file whole or not at all.
    ///
    /// # Errors
    /// One sentence that names the file and says why not.
    fn write_file(&self, path: &Path, bytes: &[u8]) -> Result<(), String>;

    /// The largest resident set of the process in bytes since [`Self::forget_peak_rss`], where
    /// the system tells.
    fn peak_rss_bytes(&self) -> Option<u64>;

    /// Lets [`Self::peak_rss_bytes`] count anew from now.
    fn forget_peak_rss(&self);

    /// What rows say about the program and the machine.
    fn provenance(&self) -> Provenance;
}

/// Which program made a row, and where.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Provenance {
    /// Version of the program.
    pub version: String,
    /// The commit that it was built from, or `unknown`.
    pub commit: String,
    /// Processor, threads and system.
    pub machine: String,
}
