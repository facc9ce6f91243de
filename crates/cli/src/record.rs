//! The records behind `--report` and `--format json`: what all have, and how they are written.

use std::path::Path;

use schemars::JsonSchema;
use secateur::Plant;
use serde::Serialize;
use serde_json::{Map, Value, json};

use super::failure::to_name;
use super::machine;

/// Version of the shape of records. It changes where a key goes or gets another meaning.
pub(crate) const SCHEMA_VERSION: u32 = 1;

/// What a command says, and how it came about.
#[derive(Serialize, JsonSchema)]
pub(crate) struct Record<T> {
    /// Version of the shape of this record.
    schema_version: u32,
    #[serde(flatten)]
    facts: T,
    /// How long it took, in seconds.
    seconds: Seconds,
    /// The largest resident set of the process so far, where the system tells.
    peak_rss_bytes: Option<u64>,
    /// What was run, and where.
    run: Run,
}

/// Wall time in seconds: in all, and of the stages by their names.
#[derive(Serialize, JsonSchema)]
struct Seconds {
    total: f64,
    #[serde(flatten)]
    stages: Map<String, Value>,
}

/// What was run, and where.
#[derive(Serialize, JsonSchema)]
struct Run {
    command: &'static str,
    version: &'static str,
    /// The commit that the program was built from, if it is known.
    commit: Option<&'static str>,
    /// All words of the command line after the program.
    arguments: Vec<String>,
    machine: machine::Machine,
}

/// The number of something in an original.
#[derive(Serialize, JsonSchema)]
pub(crate) struct OfOriginal {
    original: u64,
}

impl From<u64> for OfOriginal {
    fn from(original: u64) -> Self {
        Self { original }
    }
}

/// The size of files before and after.
#[derive(Serialize, JsonSchema)]
pub(crate) struct Bytes {
    /// None where it can't be told.
    pub(crate) original: Option<u64>,
    #[serde(rename = "final")]
    pub(crate) written: u64,
}

/// What is to be said of a plant, then these notes, each once.
pub(crate) fn notes<'a>(plant: &Plant, others: impl Iterator<Item = &'a String>) -> Vec<String> {
    let inspection = plant.inspection();
    let mut notes = inspection.notes.clone();
    if !inspection.candidates.is_empty() {
        notes.push(format!(
            "name leaves with {}",
            to_name(&inspection.candidates)
        ));
    }
    for note in others {
        if !notes.contains(note) {
            notes.push(note.clone());
        }
    }
    notes
}

impl<T: Serialize> Record<T> {
    /// The record of a command that took these stages and this long in all.
    pub(crate) fn new(
        command: &'static str,
        facts: T,
        stages: &[(&'static str, f64)],
        total: f64,
    ) -> Self {
        let stages = stages.iter();
        let arguments = super::arguments();
        Self {
            schema_version: SCHEMA_VERSION,
            facts,
            seconds: Seconds {
                total,
                stages: stages
                    .map(|(stage, time)| ((*stage).to_owned(), json!(time)))
                    .collect(),
            },
            peak_rss_bytes: machine::peak_rss_bytes(),
            run: Run {
                command,
                version: env!("CARGO_PKG_VERSION"),
                commit: machine::commit(),
                arguments: arguments
                    .iter()
                    .map(|a| a.to_string_lossy().into_owned())
                    .collect(),
                machine: machine::describe(),
            },
        }
    }

    pub(crate) fn to_value(&self) -> Value {
        serde_json::to_value(self).expect("records have text keys")
    }
}

/// Paths as records have them.
pub(crate) fn shown<P: AsRef<Path>>(paths: impl IntoIterator<Item = P>) -> Vec<String> {
    let paths = paths.into_iter();
    paths.map(|p| p.as_ref().display().to_string()).collect()
}

/// A path that may not be there, likewise.
pub(crate) fn shown_if(path: Option<&Path>) -> Option<String> {
    path.map(|path| path.display().to_string())
}

/// The size of a file, where it can be told.
pub(crate) fn bytes_of(path: &Path) -> Option<u64> {
    std::fs::metadata(path).map(|m| m.len()).ok()
}
