//! Runs `secateur lod`: takes any level out of a removal order that was kept.

use std::path::Path;
use std::time::Instant;

use schemars::JsonSchema;
use secateur::{Counts, Document, LodModel, WriteOptions};
use serde::Serialize;

use super::args::{self, LevelArgs};
use super::failure::Failure;
use super::print::Printed;
use super::record::{Bytes, Record, bytes_of, shown};
use super::simplify::{share, timed, warn_all};
use super::summary::{columns, grouped};
use super::{advice, interrupt, order, output, record};

/// A level along a removal order.
#[derive(Serialize, JsonSchema)]
pub(crate) struct LodRecord {
    /// The plant's file.
    input: String,
    /// The files that were written, the one that was asked for first.
    output: Vec<String>,
    bytes: Bytes,
    leaves: Counts,
    /// Triangles of the whole plant.
    triangles: Counts,
    /// Triangles of leaves.
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
    let start = Instant::now();
    let write_options = WriteOptions::default().overwrite(args.overwrite);
    let mut inputs = vec![args.tree.as_path()];
    inputs.extend(args.order.as_deref());
    output::check_tree(&args.output, &inputs, write_options)?;
    let mut outputs: Vec<&Path> = vec![&args.output];
    if let Some(file) = &args.report {
        output::check_file(file, &inputs)?;
        outputs.push(file);
    }
    output::check_distinct(&outputs)?;

    let mut stages = Vec::new();
    let tree = timed(&mut stages, "load", || {
        let document = interrupt::reading(|| Document::open(&args.tree))?;
        let document = document.with_vertex_alpha(args.vertex_alpha.vertex_alpha);
        Ok::<_, Failure>(document.into_tree(&args.foliage.foliage)?)
    })?;
    output::check_spares(tree.document(), &outputs)?;
    warn_all(&advice::sentences(&tree.inspection().warnings));
    let model = timed(&mut stages, "order", || {
        order::read(args.order.as_deref(), &tree)
    })?;
    let steps = steps(&model, args.level).map_err(|why| {
        let of = args.order.as_ref().unwrap_or(&args.tree);
        Failure::input(format!("{}: {why}", of.display()))
    })?;
    let lod = model.lod_after(steps);
    interrupt::writing()?;
    let prepared = timed(&mut stages, "write", || {
        tree.prepare_lod(&lod, &args.output, write_options)
            .map_err(Failure::from)
    })?;
    let (written, mut staged) = prepared.into_files();

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
        notes: written.notes.clone(),
    };
    let total = start.elapsed().as_secs_f64();
    let record = Record::new("lod", record, &stages, total).to_value();
    record::stage(&mut staged, args.report.as_deref(), &record)?;
    staged.commit()?;

    let mut text = format!("{} -> {}\n", args.tree.display(), args.output.display());
    let row = |name: &str, before: u64, after: u64| {
        let share = share(after as usize, before as usize);
        vec![name.to_owned(), grouped(before), grouped(after), share]
    };
    text += &columns(&[
        ["", "original", "level", ""].map(str::to_owned).to_vec(),
        row(
            "leaves",
            model.most_leaves() as u64,
            lod.leaf_count() as u64,
        ),
        row("triangles", tree.triangle_count(), written.triangles),
    ]);
    let (made, all) = (grouped(steps as u64), grouped(model.order().len() as u64));
    text += &format!("  steps      {made} of the order's {all}\n");
    for note in &written.notes {
        text += &format!("  note       {note}\n");
    }
    Ok(Printed::single(text, record))
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
