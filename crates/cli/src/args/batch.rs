//! The options of `secateur batch`, and of `secateur completions`.

use std::path::PathBuf;

use clap::{Args, Subcommand};

use super::super::completions::CompletionsFor;
use super::Lods;

#[derive(Debug, Subcommand)]
pub(crate) enum Batch {
    /// Print an item for each tree, a line of JSON: what `batch run` is given.
    Plan(Box<Lods>),
    /// Make the levels of one item, unless they are there.
    Run(BatchRun),
    /// Gather what became of a batch into one file of lines and one page.
    Collect(BatchCollect),
}

#[derive(Args, Debug)]
pub(crate) struct BatchRun {
    /// The item: a line of `batch plan`, a file that has it, or - for standard input.
    #[arg(value_name = "ITEM|-")]
    pub(crate) item: PathBuf,
}

#[derive(Args, Debug)]
pub(crate) struct BatchCollect {
    /// The folder of the batch.
    #[arg(value_name = "DIR")]
    pub(crate) folder: PathBuf,
    /// The report: NAME.jsonl and NAME.html.
    #[arg(short, long, value_name = "NAME")]
    pub(crate) output: PathBuf,
    /// The items of the batch, to tell which of them are missing.
    #[arg(long, value_name = "ITEMS.jsonl")]
    pub(crate) plan: Option<PathBuf>,
}

#[derive(Args, Debug)]
pub(crate) struct Completions {
    /// For what.
    #[arg(value_enum, value_name = "SHELL")]
    pub(crate) of: CompletionsFor,
    /// The folder for man pages; made if it is not there.
    #[arg(short, long, value_name = "DIR")]
    pub(crate) output: Option<PathBuf>,
}
