//! Runs `secateur inspect`: says what a file holds and what of it are leaves.

use std::path::Path;

use serde_json::json;

use super::args;
use super::failure::{Failure, to_name};
use super::print::Printed;
use super::work::Work;
use super::{advice, output, streams};

/// Shows what is in a file; that the foliage can't be told is no failure.
pub(crate) fn run(args: &args::Inspect) -> Result<Printed, Failure> {
    let work = Work::on("inspect");
    if let Some(report) = &args.report {
        output::check_file(report, &[&args.tree])?;
    }
    let document = streams::document(&args.tree, args.plant.memory())?;
    let document = document.with_vertex_alpha(args.plant.vertex_alpha());
    let document = document.with_not_plant(args.plant.not_plant())?;
    let outputs: Vec<&Path> = args.report.as_deref().into_iter().collect();
    output::check_spares(&document, &outputs)?;
    let mut inspection = document.inspect(args.plant.selectors());
    inspection.warnings = advice::with_flags(&inspection.warnings);
    let mut pretty = inspection.to_string();
    if !inspection.candidates.is_empty() {
        let options = to_name(&inspection.candidates);
        pretty += &format!("name leaves with {options}\n");
    }
    let rows = inspection.primitives.iter().map(|p| json!(p)).collect();
    let (record, _) = work.record(inspection);
    work.finish(args.report.as_deref(), &record)?;
    Ok(Printed {
        rows,
        ..Printed::single(pretty, record)
    })
}
