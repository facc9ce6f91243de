//! What a study needs of the program that runs it.

use std::path::Path;

/// The program around a study.
pub trait Host {
    /// Whether the user has asked for a stop. Finished rows are kept.
    fn is_stop_asked(&self) -> bool;

    /// That many rows are about to be made.
    fn begin(&self, rows: usize);

    /// What is being worked on, in a few words.
    fn working_on(&self, what: &str);

    /// That one more row is there.
    fn row_is_done(&self);

    /// That no more rows will come.
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
