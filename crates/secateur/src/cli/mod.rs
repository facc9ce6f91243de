//! The program `secateur`: a command line in, an exit code out. Python's package runs it too.

mod args;
mod colors;
mod contradiction;
mod cutoffs;
mod demo;
mod escape;
mod failure;
mod grow;
mod grow_lod;
mod in_words;
mod inspect;
mod interrupt;
mod lod;
mod lods;
mod log;
mod machine;
mod measure;
mod names;
mod not_sent;
mod order;
mod output;
mod picture;
mod print;
mod progress_bar;
mod record;
mod schema;
mod simplify;
mod simplify_record;
mod stream;
mod study;
mod summary;
mod surroundings;

use std::ffi::OsString;
use std::process::ExitCode;
use std::sync::OnceLock;

use clap::{CommandFactory, Parser};

pub use in_words::{LevelRequest, RequestError, levels_options};

use args::{Cli, Command, Common};
use failure::Failure;
use print::Printed;

/// The exit code where some of several inputs failed.
const SOME_FAILED: u8 = 3;

/// The words of the command line after the program's name, as reports have them.
static ARGUMENTS: OnceLock<Vec<OsString>> = OnceLock::new();

/// Runs the command of these words, the first of which is the program's name. It prints to standard output and standard
/// error, and from then on listens to Ctrl-C.
pub fn main(words: impl IntoIterator<Item = OsString>) -> ExitCode {
    ExitCode::from(run_words(words.into_iter().collect()))
}

/// As [`main`], for processes that are not this program: gives the exit code as a number.
pub fn run_words(words: Vec<OsString>) -> u8 {
    let _ = ARGUMENTS.set(words.iter().skip(1).cloned().collect());
    let cli = match Cli::try_parse_from(words).and_then(without_contradiction) {
        Ok(cli) => cli,
        Err(usage) => {
            // Help and version come this way too, with code 0.
            let _ = usage.print();
            return usage.exit_code() as u8;
        }
    };
    log::start(&cli.common);
    match run(&cli) {
        Ok(false) => 0,
        Ok(true) => SOME_FAILED,
        Err(failure) => {
            log::error(&failure);
            1
        }
    }
}

/// The words of the command line after the program's name.
fn arguments() -> &'static [OsString] {
    ARGUMENTS.get().map_or(&[], Vec::as_slice)
}

/// What the parser can't see: options that are right alone, and wrong beside each other.
fn without_contradiction(cli: Cli) -> Result<Cli, clap::Error> {
    let sentence = match &cli.command {
        Command::Simplify(args) => contradiction::contradiction(args),
        _ => None,
    };
    match sentence {
        Some(sentence) => {
            Err(Cli::command().error(clap::error::ErrorKind::ArgumentConflict, sentence))
        }
        None => Ok(cli),
    }
}

/// Runs a command; whether some of its inputs failed.
fn run(cli: &Cli) -> Result<bool, Failure> {
    interrupt::listen();
    use_threads(&cli.common)?;
    let printed: Printed = match &cli.command {
        Command::Demo(args) => demo::run(args, &cli.common)?,
        Command::Inspect(args) => inspect::run(args)?,
        Command::Simplify(args) => simplify::run(args, &cli.common)?,
        Command::Lod(args) => lod::run(args)?,
        Command::Lods(args) => lods::run(args, &cli.common)?,
        Command::Measure(args) => measure::run(args)?,
        Command::Study(args) => study::run(args, &cli.common)?,
        Command::Stream(args) => stream::run(args, &cli.common)?,
        Command::Grow(args) => grow::run(args, &cli.common)?,
        Command::Schema(args) => schema::run(args)?,
    };
    if !cli.common.quiet {
        print::to_stdout(&printed.as_text(cli.common.format))?;
    }
    Ok(printed.some_failed)
}

fn use_threads(common: &Common) -> Result<(), Failure> {
    let Some(threads) = common.threads else {
        return Ok(());
    };
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads as usize);
    pool.build_global()
        .map_err(|e| Failure(format!("{threads} threads cannot be started: {e}")))
}
