//! Runs `secateur lod`: takes any level out of a removal order that was kept.

use std::path::PathBuf;

use schemars::JsonSchema;
use secateur::{Counts, Document, LodModel, WriteOptions};
use serde::Serialize;

use super::advice::warn_all;
use super::args::{self, LevelArgs};
use super::failure::Failure;
use super::output::{self, Outputs};
use super::print::Printed;
use super::record::{Bytes, bytes_of, shown};
use super::summary::{columns, counts_row, grouped};
use super::work::Work;
use super::{advice, interrupt, order};

/// A level along a removal order.
#[derive(Serialize, JsonSchema)]
pub(crate) struct LodRecord {
    /// Path of the plant's file as the call gives it.
    input: String,
    /// The files that were written, the one that was asked for first.
    output: Vec<String>,
    bytes: Bytes,
    leaves: Counts,
    /// Triangles of the whole plant.
    triangles: Counts,
    /// How many of these are leaves.
    foliage_triangles: Counts,
    /// Steps of the order, and how many of them lead to the level.
    steps: Counts,
    /// SHA-256 of the steps that lead to the level.
    order_sha256: String,
    /// The largest area of a leaf as a multiple of its original one.
    max_area_scale: f64,
    /// What of the written file is not as one might expect, a sentence each.
    notes: Vec<String>,
}

/// Reads a tree and an order, writes one level.
pub(crate) fn run(args: &args::Lod) -> Result<Printed, Failure> {
    let mut work = Work::on("lod");
    let write_options = WriteOptions::default().overwrite(args.overwrite);
    let inputs = std::iter::once(&args.tree).chain(&args.order);
    let outputs = Outputs::beside(inputs.map(PathBuf::as_path))
        .and(&args.output, |path, inputs| {
            output::check_tree(path, inputs, write_options)
        })?
        .maybe(args.report.as_ref(), output::check_file)?
        .distinct()?;
    let tree = work.timed("load", |_| {
        let document = interrupt::reading(|| Document::open(&args.tree))?;
        let document = document.with_vertex_alpha(args.vertex_alpha.vertex_alpha);
        let document = document.with_not_plant(&args.not_plant.not_plant)?;
        Ok(document.into_tree(&args.foliage.foliage)?)
    })?;
    output::check_spares(tree.document(), &outputs)?;
    warn_all(&advice::sentences(&tree.inspection().warnings));
    let model = work.timed("order", |_| order::read(args.order.as_deref(), &tree))?;
    let steps = steps(&model, args.level).map_err(|why| {
        let of = args.order.as_ref().unwrap_or(&args.tree);
        Failure::input(format!("{}: {why}", of.display()))
    })?;
    let lod = model.lod_after(steps);
    interrupt::writing()?;
    let written = work.timed("write", |files| {
        let prepared = tree.prepare_lod(&lod, &args.output, write_options)?;
        let (written, own) = prepared.into_files();
        files.append(own);
        Ok(written)
    })?;

    let mut prefix = model.order().clone();
    prefix.truncate(steps);
    let triangles_left = lod.foliage(tree.foliage()).triangles().len();
    let record = LodRecord {
        input: args.tree.display().to_string(),
        output: shown(&written.files),
        bytes: Bytes {
            original: bytes_of(&args.tree),
            written: written.bytes,
        },
        leaves: Counts::of(model.most_leaves(), lod.leaf_count()),
        triangles: Counts::of(tree.triangle_count(), written.triangles),
        foliage_triangles: Counts::of(tree.foliage().triangles().len(), triangles_left),
        steps: Counts::of(model.order().len(), steps),
        order_sha256: prefix.sha256(),
        max_area_scale: lod.max_area_scale(),
        notes: written.notes,
    };
    let pretty = pretty(args, &record);
    let (record, _) = work.record(record);
    work.finish(args.report.as_deref(), &record)?;
    Ok(Printed::single(pretty, record))
}

fn pretty(args: &args::Lod, level: &LodRecord) -> String {
    let table = columns(&[
        ["", "original", "level", ""].map(str::to_owned).to_vec(),
        counts_row("leaves", level.leaves),
        counts_row("triangles", level.triangles),
    ]);
    let [made, all] = [level.steps.left, level.steps.original].map(grouped);
    let mut text = format!(
        "{} -> {}\n{table}  steps      {made} of the order's {all}\n",
        args.tree.display(),
        args.output.display()
    );
    for note in &level.notes {
        text += &format!("  note       {note}\n");
    }
    text
}

/// How many steps lead to the level that is asked for, or why none does.
fn steps(model: &LodModel, level: LevelArgs) -> Result<usize, String> {
    let (all, fewest) = (model.order().len(), model.fewest_leaves());
    if let Some(steps) = level.steps {
        let steps = usize::try_from(steps).unwrap_or(usize::MAX);
        return match steps <= all {
            true => Ok(steps),
            false => Err(format!(
                "the removal order has {all} steps; {steps} are more"
            )),
        };
    }
    let most = model.most_leaves();
    let share = |ratio: f64| (ratio * most as f64).round() as usize;
    let leaves = match level.leaves {
        Some(leaves) => usize::try_from(leaves).unwrap_or(usize::MAX),
        None => share(level.ratio.unwrap_or(1.0)),
    };
    if leaves < fewest {
        let more = "simplify further with `--order`";
        return Err(format!(
            "the removal order ends at {fewest} leaves; {leaves} are fewer: {more}"
        ));
    }
    Ok(model.steps_to(leaves))
}
