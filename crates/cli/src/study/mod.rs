//! `secateur study`: methods x settings x levels x trees, as rows, charts and a report.

mod case;
mod host;

use schemars::JsonSchema;
use secateur::ErrorKind;
use secateur_study::{Case, Error, StudyOptions, redraw, run as run_study};
use serde::Serialize;

use super::args::{self, Common};
use super::failure::Failure;
use super::output;
use super::print::Printed;
use super::record::shown;
use super::summary::grouped;
use super::work::Work;
use host::Program;

/// What a study has drawn.
#[derive(Serialize, JsonSchema)]
pub(crate) struct StudyRecord {
    /// How many rows there are.
    rows: u64,
    /// The folder of rows, charts and report.
    output: String,
    report: String,
    csv: String,
    charts: Vec<String>,
}

/// Runs what is missing, then draws everything from the rows.
pub(crate) fn run(args: &args::Study, common: &Common) -> Result<Printed, Failure> {
    let work = Work::on("study");
    output::check_folder(&args.output)?;
    let host = Program::new(common);
    let drawn = match args.redraw {
        true => redraw(&args.output, &host)?,
        false => run_study(&options(args)?, &host)?,
    };
    let count = drawn.rows as u64;
    let record = StudyRecord {
        rows: count,
        output: args.output.display().to_string(),
        report: drawn.report.display().to_string(),
        csv: drawn.csv.display().to_string(),
        charts: shown(&drawn.charts),
    };
    let (record, total) = work.record(record);
    let pretty = format!(
        "{} rows in {}\n  report   {}\n  rows     {}\n  took     {total:.1} s\n",
        grouped(count),
        args.output.display(),
        drawn.report.display(),
        drawn.csv.display()
    );
    Ok(Printed::single(pretty, record))
}

fn options(args: &args::Study) -> Result<StudyOptions, Failure> {
    let cases: Result<Vec<Case>, Failure> =
        args.case.iter().map(|text| case::parse(text)).collect();
    Ok(StudyOptions {
        trees: args.trees.clone(),
        folder: args.output.clone(),
        selectors: args.foliage.foliage.clone(),
        plans: args.plan.clone(),
        cases: cases?,
        views: args.views,
        levels: args.levels.clone(),
        distances_m: (args.distances.as_ref()).map_or_else(Vec::new, |all| all.0.clone()),
        only: args.only.clone(),
        frames_up_to_px: args.frames_up_to,
        seeds: args.seeds,
        memory: args.memory.memory,
    })
}

impl From<Error> for Failure {
    fn from(error: Error) -> Self {
        match error {
            Error::Gltf(error) => error.into(),
            Error::Stopped(_) => Self::of(ErrorKind::Interrupted, error.to_string()),
            Error::File { .. } => Self::machine(error.to_string()),
            Error::Simplify(error) => error.into(),
            other => Self::input(other.to_string()),
        }
    }
}
