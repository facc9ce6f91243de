//! Runs `secateur inspect`: says what a file holds and what of it are leaves.

use std::path::Path;

use secateur::Document;
use serde_json::json;

use super::args;
use super::failure::Failure;
use super::print::Printed;
use super::{output, record};

/// Shows what is in a file; that the foliage can't be told is no failure.
pub(crate) fn run(args: &args::Inspect) -> Result<Printed, Failure> {
    if let Some(report) = &args.report {
        output::check_file(report, &[&args.tree])?;
    }
    let document = Document::open_within(&args.tree, args.memory.memory)?;
    let document = document.with_vertex_alpha(args.vertex_alpha.vertex_alpha);
    let outputs: Vec<&Path> = args.report.as_deref().into_iter().collect();
    output::check_spares(&document, &outputs)?;
    let inspection = document.inspect(&args.foliage.foliage);
    let record = json!(inspection);
    record::write(args.report.as_deref(), &record)?;
    Ok(Printed {
        pretty: inspection.to_string(),
        rows: inspection.primitives.iter().map(|p| json!(p)).collect(),
        record,
    })
}
