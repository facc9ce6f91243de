//! A command at work: since when, what its stages took, and the files that it will leave.

use std::path::Path;
use std::time::Instant;

use secateur::StagedFiles;
use serde::Serialize;
use serde_json::Value;

use super::failure::Failure;
use super::output;
use super::record::Record;

/// A command at work. No file has its name before [`finish`](Self::finish): what fails leaves nothing.
pub(crate) struct Work {
    command: &'static str,
    start: Instant,
    /// What stages took, in seconds.
    pub(crate) stages: Vec<(&'static str, f64)>,
    /// Files that are written under temporary names.
    pub(crate) files: StagedFiles,
}

impl Work {
    /// Of a command, from now on.
    pub(crate) fn on(command: &'static str) -> Self {
        Self::since(command, Instant::now())
    }

    /// Of a command that began before.
    pub(crate) fn since(command: &'static str, start: Instant) -> Self {
        Self {
            command,
            start,
            stages: Vec::new(),
            files: StagedFiles::new(),
        }
    }

    /// Does a stage, which may write files, and notes how long it took.
    pub(crate) fn timed<T>(
        &mut self,
        name: &'static str,
        stage: impl FnOnce(&mut StagedFiles) -> Result<T, Failure>,
    ) -> Result<T, Failure> {
        let start = Instant::now();
        let result = stage(&mut self.files)?;
        self.stages.push((name, start.elapsed().as_secs_f64()));
        Ok(result)
    }

    /// The record of what was done, and how many seconds it took.
    pub(crate) fn record(&self, facts: impl Serialize) -> (Value, f64) {
        let seconds = self.start.elapsed().as_secs_f64();
        let record = Record::new(self.command, facts, &self.stages, seconds);
        (record.to_value(), seconds)
    }

    /// Gives all files their names, with the record among them where it is asked for.
    pub(crate) fn finish(mut self, report: Option<&Path>, record: &Value) -> Result<(), Failure> {
        if let Some(path) = report {
            let text = format!("{record:#}\n");
            output::stage(&mut self.files, path, text.as_bytes())?;
        }
        Ok(self.files.commit()?)
    }
}
