//! The program `secateur`: a command line in, an exit code out. Python's package runs it too.

mod advice;
mod args;
mod batch;
mod completions;
mod demo;
mod escape;
mod failure;
mod grow;
mod in_words;
mod inspect;
mod interrupt;
mod lod;
mod lods;
mod log;
mod machine;
mod measure;
mod names;
mod order;
mod output;
mod picture;
mod print;
mod progress_bar;
mod record;
mod schema;
mod simplify;
mod stand;
mod stream;
mod streams;
mod study;
mod summary;
mod surroundings;
mod work;

use std::ffi::OsString;
use std::process::ExitCode;
use std::sync::{Mutex, PoisonError};

pub use in_words::{LevelRequest, RequestError, levels_options};

use args::{Cli, Command, Common};
use failure::Failure;
use print::Printed;

/// The exit code where some of several inputs failed.
const SOME_FAILED: u8 = 3;

/// The words of the command line after the program's name, as reports have them.
static ARGUMENTS: Mutex<Vec<OsString>> = Mutex::new(Vec::new());

/// Runs the command of these words, the first of which is the program's name. It prints to standard output and standard
/// error, and from then on listens to Ctrl-C.
pub fn main(words: impl IntoIterator<Item = OsString>) -> ExitCode {
    ExitCode::from(run_words(words.into_iter().collect()))
}

/// As [`main`], for processes that are not this program: gives the exit code as a number.
pub fn run_words(words: Vec<OsString>) -> u8 {
    *ARGUMENTS.lock().unwrap_or_else(PoisonError::into_inner) =
        words.iter().skip(1).cloned().collect();
    let cli = match Cli::of(words).and_then(without_contradiction) {
        Ok(cli) => cli,
        Err(usage) => {
            // Help and version come this way too, with code 0.
            match usage.use_stderr() && asks_for_json() {
                true => {
                    log::tell_json();
                    log::error(&Failure::of_parser(&usage));
                }
                false => drop(usage.print()),
            }
            return usage.exit_code() as u8;
        }
    };
    log::start(&cli.common);
    match run(&cli) {
        Ok(false) => 0,
        Ok(true) => SOME_FAILED,
        Err(failure) => {
            log::error(&failure);
            failure.exit_code()
        }
    }
}

/// Whether words that could not be parsed ask for JSON.
fn asks_for_json() -> bool {
    let words = arguments();
    let is_pair = |pair: &[OsString]| pair[0] == "--format" && pair[1] == "json";
    words.windows(2).any(is_pair) || words.iter().any(|word| word == "--format=json")
}

/// The words of the command line after the program's name.
fn arguments() -> Vec<OsString> {
    let arguments = ARGUMENTS.lock().unwrap_or_else(PoisonError::into_inner);
    arguments.clone()
}

/// What the parser can't see: options that are right alone, and wrong beside each other.
fn without_contradiction(cli: Cli) -> Result<Cli, clap::Error> {
    let sentence = match &cli.command {
        Command::Simplify(args) => simplify::contradiction(args),
        _ => None,
    };
    match sentence {
        Some(sentence) => {
            Err(args::command().error(clap::error::ErrorKind::ArgumentConflict, sentence))
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
        Command::Stand(args) => stand::run(args, &cli.common)?,
        Command::Measure(args) => measure::run(args)?,
        Command::Study(args) => study::run(args, &cli.common)?,
        Command::Stream(args) => stream::run(args, &cli.common)?,
        Command::Grow(args) => grow::run(args, &cli.common)?,
        Command::Batch(args) => batch::run(args, &cli.common)?,
        Command::Schema(args) => schema::run(args)?,
        Command::Completions(args) => completions::run(args)?,
    };
    if !cli.common.quiet && !streams::is_stdout_taken() {
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
        .map_err(|e| Failure::machine(format!("{threads} threads cannot be started: {e}")))
}
