//! The command line: arguments in, an exit code out.

mod args;
mod colors;
mod contradiction;
mod cutoffs;
mod demo;
mod escape;
mod failure;
mod grow;
mod grow_lod;
mod inspect;
mod interrupt;
mod left_out_of_stream;
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
mod progress_share;
mod record;
mod schema;
mod simplify;
mod simplify_record;
mod stream;
mod study;
mod summary;
mod surroundings;

use std::process::ExitCode;

use clap::{CommandFactory, Parser};

use args::{Cli, Command, Common};
use failure::Failure;
use print::Printed;

/// The exit code where some of several inputs failed.
const SOME_FAILED: u8 = 3;

/// Runs the command that the process was called with.
pub(crate) fn main() -> ExitCode {
    let cli = match Cli::try_parse().and_then(without_contradiction) {
        Ok(cli) => cli,
        Err(usage) => {
            // Help and version come this way too, with code 0.
            let _ = usage.print();
            return ExitCode::from(usage.exit_code() as u8);
        }
    };
    log::start(&cli.common);
    match run(&cli) {
        Ok(false) => ExitCode::SUCCESS,
        Ok(true) => ExitCode::from(SOME_FAILED),
        Err(failure) => {
            log::error(&failure);
            ExitCode::from(1)
        }
    }
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
