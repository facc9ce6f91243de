//! `batch plan`: an item for each plant.

use std::path::{Path, PathBuf};

use clap::parser::ValueSource;
use clap::{ArgAction, ArgMatches, CommandFactory};
use serde_json::json;

use super::super::args::{self, Cli};
use super::super::failure::Failure;
use super::super::print::{Printed, Records};
use super::Item;

/// Options that each item has of its own, that are of all commands, or that belong to `lods` alone.
const NOT_OF_ITEMS: [&str; 10] = [
    "trees",
    "output",
    "format",
    "threads",
    "quiet",
    "verbose",
    "keep_going",
    "report",
    "preview",
    "overwrite",
];

/// Prints an item for each tree.
pub(super) fn run(args: &args::Lods) -> Result<Printed, Failure> {
    let beside = [
        ("--preview", args.preview.is_some()),
        ("--report", args.report.is_some()),
        ("--overwrite", args.overwrite),
        ("--keep-going", args.keep_going.is_some()),
        ("--dry-run", args.dry_run),
    ];
    if let Some((option, _)) = beside.into_iter().find(|(_, is_given)| *is_given) {
        return Err(Failure::usage(format!(
            "`{option}` is not for batches: `batch collect` gathers reports"
        )));
    }
    let options = options_given()?;
    let output = absolute(&args.output)?;
    let mut pretty = String::new();
    let mut records = Vec::new();
    for tree in &args.trees {
        let item = Item::of(absolute(tree)?, output.clone(), options.clone())?;
        let record = json!(item);
        pretty.push_str(&format!("{record}\n"));
        records.push(record);
    }
    Ok(Printed {
        pretty,
        rows: records.clone(),
        records: Records::Lines(records),
        some_failed: false,
    })
}

/// The options of levels on the command line, as words that mean the same from any folder.
fn options_given() -> Result<Vec<String>, Failure> {
    let words = super::super::arguments();
    let words = std::iter::once("secateur".into()).chain(words);
    let mut matches = Cli::command()
        .try_get_matches_from(words)
        .map_err(|error| Failure::of_parser(&error))?;
    let mut command = Cli::command();
    command.build();
    let mut command = &command;
    while let Some((name, of_subcommand)) = matches.remove_subcommand() {
        matches = of_subcommand;
        command = command.find_subcommand(&name).expect("it was parsed");
    }
    let mut options = Vec::new();
    for argument in command.get_arguments() {
        options.extend(words_of(argument, &matches)?);
    }
    Ok(options)
}

fn words_of(argument: &clap::Arg, matches: &ArgMatches) -> Result<Vec<String>, Failure> {
    let id = argument.get_id().as_str();
    let (Some(name), Ok(true)) = (argument.get_long(), matches.try_contains_id(id)) else {
        return Ok(Vec::new());
    };
    let is_given = matches.value_source(id) == Some(ValueSource::CommandLine);
    if !is_given || NOT_OF_ITEMS.contains(&id) {
        return Ok(Vec::new());
    }
    if matches!(argument.get_action(), ArgAction::SetTrue) {
        return Ok(vec![format!("--{name}")]);
    }
    let values = matches.get_raw(id).into_iter().flatten();
    let values = values.map(|value| match argument.get_value_hint() {
        clap::ValueHint::AnyPath => {
            let path = absolute(Path::new(value))?;
            Ok(path.display().to_string())
        }
        _ => Ok(value.to_string_lossy().into_owned()),
    });
    let values = values.collect::<Result<Vec<String>, Failure>>()?;
    Ok(match argument.get_value_delimiter() {
        Some(_) => vec![format!("--{name}={}", values.join(","))],
        None => values
            .iter()
            .map(|value| format!("--{name}={value}"))
            .collect(),
    })
}

fn absolute(path: &Path) -> Result<PathBuf, Failure> {
    std::path::absolute(path).map_err(|e| Failure::of_file(path, "has no place", &e))
}
