//! The records behind `--report` and `--format json`.

use std::path::{Path, PathBuf};

use secateur::{
    AreaTable, Inspection, Judging, LevelParts, Objective, Options, Plant, StagedFiles, TakenFor,
    Views, Vmi, Written,
};
use serde_json::{Map, Value, json};

use super::args;
use super::machine;
use super::surroundings::Surroundings;
use super::{failure::Failure, output};

/// What was run, on what.
pub(crate) fn provenance(command: &str) -> Value {
    let arguments: Vec<String> = std::env::args_os()
        .skip(1)
        .map(|a| a.to_string_lossy().into_owned())
        .collect();
    json!({
        "command": command,
        "version": env!("CARGO_PKG_VERSION"),
        "commit": machine::commit(),
        "arguments": arguments,
        "machine": machine::describe(),
    })
}

/// Stages as `seconds`, with their total.
pub(crate) fn seconds(stages: &[(&'static str, f64)], total: f64) -> Value {
    let mut seconds = Map::new();
    seconds.insert("total".to_owned(), total.into());
    for (stage, time) in stages {
        seconds.insert((*stage).to_owned(), (*time).into());
    }
    Value::Object(seconds)
}

/// What was taken for foliage, and why.
pub(crate) fn foliage(inspection: &Inspection) -> Value {
    let taken = |p: &&secateur::PrimitiveReport| {
        matches!(p.taken_for, TakenFor::Foliage | TakenFor::FoliageInPart)
    };
    let chosen = inspection.primitives.iter().filter(taken);
    chosen.map(|p| json!(p)).collect()
}

/// A result and all that went into it.
pub(crate) struct RunRecord<'a> {
    pub(crate) input: &'a Path,
    pub(crate) plant: &'a Plant,
    pub(crate) level: &'a LevelParts,
    pub(crate) options: &'a Options,
    pub(crate) written: &'a Written,
    pub(crate) surroundings: &'a Surroundings,
    pub(crate) stages: &'a [(&'static str, f64)],
    pub(crate) total_seconds: f64,
    pub(crate) warnings: &'a [String],
}

/// The record of a `simplify`.
pub(crate) fn of_simplify(run: &RunRecord<'_>, args: &args::Simplify) -> Value {
    let (plant, result) = (run.plant, &run.level.simplified);
    let leaves = plant.leaves();
    json!({
        "input": run.input.display().to_string(),
        "output": files(&run.written.files),
        "bytes": { "original": bytes_of(run.input), "final": run.written.bytes },
        "leaves": {
            "original": result.passes.order.leaf_count(),
            "final": result.lod.leaf_count(),
        },
        "triangles": { "original": plant.triangle_count(), "final": run.written.triangles },
        "foliage_triangles": {
            "original": leaves.triangles().len(),
            "final": result.lod.foliage(leaves).triangles().len(),
        },
        "wood_triangles": {
            "original": plant.wood_triangle_count(),
            "final": run.level.wood_triangles,
        },
        "method": run.options.method.name(),
        "engine": result.engine,
        "adapter": result.adapter,
        "order_sha256": result.passes.in_one_order().sha256(),
        "areas_sha256": result.areas.as_ref().map(AreaTable::sha256),
        "seconds": seconds(run.stages, run.total_seconds),
        "peak_rss_bytes": machine::peak_rss_bytes(),
        "max_area_scale": result.passes.max_area_scale(),
        "vmi_bits": result.vmi_final.as_ref().map(Vmi::bits),
        "vmi_bits_original": result.vmi_original.bits(),
        "driving_vmi_error_percent": result.driving_error_percent(),
        "stopped": result.stopped.name(),
        "cutoffs": super::cutoffs::record(run.level.cutoffs.as_ref()),
        "colors": super::colors::record(&run.level.colors),
        "audit": result.audited_by,
        "settings": settings(run, args),
        "foliage": foliage(plant.inspection()),
        "warnings": run.warnings,
        "notes": run.written.notes,
        "run": provenance("simplify"),
    })
}

/// How it was asked for, and what was decided meanwhile. Options of the method are spelled as the
/// library spells them.
fn settings(run: &RunRecord<'_>, args: &args::Simplify) -> Value {
    let (result, options) = (&run.level.simplified, run.options);
    let selectors = args.foliage.foliage.iter().map(|s| s.to_string());
    let about = json!({
        "views": match options.views {
            Views::Cameras(_) => args.views.clone().unwrap_or_else(|| "scene".to_owned()),
            _ => result.driven_by.name().to_owned(),
        },
        "views_reason": result.views_reason,
        "view_count": result.views.len(),
        "views_that_judge": driving_views_that_judge(run),
        "field_of_view": options.field_of_view(),
        "resolution": result.resolution,
        "resolution_reason": result.resolution_reason,
        "preset": options.preset,
        "target": options.target,
        "wood": run.plant.wood_mode(),
        "leaf_triangles": options.leaf_triangles,
        "needles": options.needles,
        "fit": options.objective().map(fitted_to),
        "alpha": options.alpha,
        "sides": options.sides,
        "engine": options.engine,
        "seed": args.seed,
        "foliage": selectors.collect::<Vec<_>>(),
    });
    let about = joined(about, run.surroundings.record(&args.scene));
    let method = json!(options.method);
    let of_method = method.as_object().and_then(|named| named.values().next());
    joined(about, of_method.cloned().unwrap_or_default())
}

/// How many of the views that leaves were chosen or sized from are held-out views, by which
/// `measure` judges.
pub(crate) fn driving_views_that_judge(run: &RunRecord<'_>) -> usize {
    let options = run.options;
    let is_driven = options.method.vds().is_some() || options.objective().is_some();
    let foliage = run.plant.leaves();
    let about = (foliage.bounding_sphere(), Judging::held_out(foliage));
    let (Some(sphere), Ok(judging)) = about else {
        return 0;
    };
    let sets = run.level.simplified.driving(options, sphere);
    let counts = (sets.iter()).map(|set| judging.views_that_judge(set, sphere.centre));
    if is_driven { counts.sum() } else { 0 }
}

/// `coverage`, or the weight of the outline.
fn fitted_to(objective: Objective) -> Value {
    match objective {
        Objective::Information { outline_weight } => outline_weight.into(),
        Objective::Coverage => "coverage".into(),
    }
}

fn files(paths: &[PathBuf]) -> Vec<String> {
    paths.iter().map(|p| p.display().to_string()).collect()
}

/// The size of a file, where it can be told.
pub(crate) fn bytes_of(path: &Path) -> Option<u64> {
    std::fs::metadata(path).map(|m| m.len()).ok()
}

/// Writes a record, where one is asked for, that appears with the others of `staged`.
pub(crate) fn stage(
    staged: &mut StagedFiles,
    path: Option<&Path>,
    record: &Value,
) -> Result<(), Failure> {
    match path {
        Some(path) => output::stage(staged, path, &bytes(record)),
        None => Ok(()),
    }
}

fn bytes(record: &Value) -> Vec<u8> {
    format!("{record:#}\n").into_bytes()
}

/// Writes a record where one is asked for.
pub(crate) fn write(path: Option<&Path>, record: &Value) -> Result<(), Failure> {
    match path {
        Some(path) => output::write_file(path, &bytes(record)),
        None => Ok(()),
    }
}

/// One record with the values of both, lists of equal length item by item.
pub(crate) fn merged(record: Value, more: Value) -> Value {
    match (record, more) {
        (Value::Object(mut entries), Value::Object(more)) => {
            for (key, value) in more {
                let merged = match entries.get_mut(&key) {
                    Some(there) => merged(there.take(), value),
                    None => value,
                };
                entries.insert(key, merged);
            }
            Value::Object(entries)
        }
        (Value::Array(items), Value::Array(more)) if items.len() == more.len() => {
            let pairs = items.into_iter().zip(more);
            pairs.map(|(item, more)| merged(item, more)).collect()
        }
        (_, more) => more,
    }
}

/// One record with the entries of both.
pub(crate) fn joined(mut record: Value, more: Value) -> Value {
    if let (Value::Object(entries), Value::Object(more)) = (&mut record, more) {
        entries.extend(more);
    }
    record
}
