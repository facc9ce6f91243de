//! `secateur lods`: the chain of levels that an engine loads.

mod finished;
mod job;
mod page;
mod rows;
mod table;
mod wanted;

use std::path::{Path, PathBuf};
use std::time::Instant;

use secateur::{Opening, Plant};
use secateur_gltf::{Document, StagedFiles, WriteOptions};
use secateur_model::{AlphaMode, Surface};
use secateur_scene::chain::Textures;
use serde_json::{Value, json};

use super::args::{self, Common, TexturesName};
use super::failure::Failure;
use super::measure::warning_of;
use super::print::Printed;
use super::progress_bar::RunProgress;
use super::surroundings::Surroundings;
use super::{interrupt, machine, output, record};
use finished::Finished;
pub(crate) use job::Job;
use job::{about, check_free, check_outputs, jobs, outputs};
pub(crate) use page::preview;
use rows::layout_name;
pub(crate) use rows::rows;
use table::pretty;
use wanted::options;

/// A tree that was done.
struct Done {
    record: Value,
    rows: Vec<Value>,
    pretty: String,
}

impl Done {
    /// As an earlier call left it.
    fn again(finished: Finished) -> Self {
        let kept = "  kept       as it was made before: neither the tree nor what was asked for has changed\n";
        Self {
            record: record::joined(finished.record, json!({ "kept": true })),
            rows: finished.rows,
            pretty: finished.pretty + kept,
        }
    }
}

/// Makes a chain of each tree, one after the other: what is finished when the program ends stays, and
/// is not done again by the next call.
pub(crate) fn run(args: &args::Lods, common: &Common) -> Result<Printed, Failure> {
    let start = Instant::now();
    let jobs = jobs(args)?;
    check_outputs(args, &jobs)?;
    options(args).check().map_err(|e| Failure(e.to_string()))?;
    let outputs: Vec<PathBuf> = jobs.iter().flat_map(|job| outputs(args, job)).collect();
    let outputs: Vec<&Path> = outputs.iter().map(PathBuf::as_path).collect();
    let surroundings = args.scene.read(args.memory.memory, &outputs)?;
    let mut keys = Vec::new();
    let mut finished = Vec::new();
    for job in &jobs {
        let key = finished::key(args, job)?;
        let known = Finished::of(args, job, &key).filter(|_| !args.overwrite);
        check_free(args, job, known.as_ref())?;
        keys.push(key);
        finished.push(known);
    }
    let is_done = |known: &Finished| known.is_whole(args);
    if jobs.len() > 1 {
        // What cannot be read is refused before anything is made of the others.
        for (job, known) in jobs.iter().zip(&finished) {
            if !known.as_ref().is_some_and(is_done) {
                opened(args, job)?;
            }
        }
    }
    let mut trees = Vec::new();
    for ((job, key), known) in jobs.iter().zip(keys).zip(finished) {
        trees.push(match known {
            Some(known) if is_done(&known) => Done::again(known),
            known => {
                let may_overwrite = args.overwrite || known.is_some();
                make(args, common, (job, key, may_overwrite), &surroundings)?
            }
        });
    }
    let total = start.elapsed().as_secs_f64();
    let mut record = match &mut trees[..] {
        [only] => only.record.take(),
        several => json!({
            "trees": several.iter_mut().map(|done| done.record.take()).collect::<Vec<_>>(),
        }),
    };
    record = record::joined(
        record,
        json!({
            "seconds": record::seconds(&[], total),
            "peak_rss_bytes": machine::peak_rss_bytes(),
            "run": record::provenance("lods"),
        }),
    );
    if let Some(report) = &args.report {
        output::write_file(report, format!("{record:#}\n").as_bytes())?;
    }
    Ok(Printed {
        pretty: trees.iter().map(|done| done.pretty.as_str()).collect(),
        rows: trees.into_iter().flat_map(|done| done.rows).collect(),
        record,
    })
}

/// The tree of a job, if a chain can be made of it.
fn opened(args: &args::Lods, job: &Job<'_>) -> Result<Plant, Failure> {
    tracing::info!("reading {}", job.tree.display());
    let opening = Opening {
        foliage: args.foliage.foliage.clone(),
        vertex_alpha: args.vertex_alpha.vertex_alpha,
        memory: args.memory.memory,
        ..Opening::default()
    };
    let plant = Plant::open_with(job.tree, &opening)?;
    let document = plant.tree().document();
    let outputs = outputs(args, job);
    let outputs: Vec<&Path> = outputs.iter().map(PathBuf::as_path).collect();
    output::check_spares(document, &outputs)?;
    if args.textures == Some(TexturesName::Fit) && !has_cut_outs(document)? {
        return Err(Failure(format!(
            "{}: no texture with alpha cuts out its leaves, so there is no coverage to keep; leave out `--textures fit`",
            job.tree.display()
        )));
    }
    Ok(plant)
}

fn make(
    args: &args::Lods,
    common: &Common,
    (job, key, may_overwrite): (&Job<'_>, String, bool),
    surroundings: &Surroundings,
) -> Result<Done, Failure> {
    let start = Instant::now();
    let mut options = options(args);
    surroundings.apply(&mut options.leaves);
    options.scene = surroundings.look(&args.scene, args.memory.memory)?;
    let plant = opened(args, job)?;
    let mut warnings = plant.inspection().warnings.clone();
    super::simplify::warn_all(&warnings);
    interrupt::check()?;
    let progress_bar = RunProgress::new(common);
    let levels = plant
        .levels_watched(&options, &mut |progress| progress_bar.show(progress))
        .map_err(|error| Failure(about(job.tree, &error.to_string())))?
        .named(&job.name);
    drop(progress_bar);
    let (tree, made) = (levels.tree(), &levels.chain);
    let differences = made.levels.iter().map(|level| level.difference.difference);
    let of_levels = warning_of(differences.fold(0.0, f64::max));
    super::simplify::warn_all(&of_levels);
    warnings.extend(of_levels);

    let mut staged = StagedFiles::new();
    if job.place != args.output {
        let made = staged.make_folder(&args.output);
        made.map_err(|e| Failure::of_file(&args.output, "cannot be made", &e))?;
    }
    let how = WriteOptions::default().overwrite(may_overwrite);
    let (written, files) = levels.prepare(&job.place, job.layout, how)?.into_files();
    staged.append(files);
    if let Some(file) = &args.preview {
        let page = preview(tree, job, &options, made)?;
        output::stage(&mut staged, file, page.as_bytes())?;
    }
    let seconds = start.elapsed().as_secs_f64();
    let rows = rows(job, made, &written);
    let record = json!({
        "input": job.tree.display().to_string(),
        "name": job.name,
        "layout": layout_name(job.layout),
        "files": written.files.iter().map(|f| f.display().to_string()).collect::<Vec<_>>(),
        "bytes": written.bytes,
        "preview": args.preview.as_ref().map(|f| f.display().to_string()),
        "leaves": { "original": tree.leaves().leaves().len() },
        "triangles": { "original": tree.items().foliage().triangles().len() },
        "foliage_triangles": { "original": tree.leaves().triangles().len() },
        "wood_triangles": { "original": tree.wood().triangles().len() },
        "surroundings": surroundings.record(&args.scene),
        "screen": { "height_px": options.screen.height_px, "fov_degrees": options.screen.field_of_view_degrees },
        "max_difference": options.max_difference,
        "max_block_coverage": options.limits().block_coverage,
        "plant_height_m": options.plant_height_m,
        "max_pop": options.max_pop,
        "wood": options.wood.decided(),
        "textures": match options.textures {
            Textures::Fit => "fit",
            Textures::Keep => "keep",
        },
        "largest_pop": made.levels.iter().filter_map(|level| level.pop).reduce(f64::max),
        "preset": options.leaves.preset,
        "engine": levels.engine,
        "adapter": levels.adapter,
        "levels": rows,
        "order_sha256": made.levels.iter().rev().find_map(|level| level.order_sha256.clone()),
        "seconds": record::seconds(&[], seconds),
        "notes": made.notes.iter().chain(&written.notes).collect::<Vec<_>>(),
        "warnings": warnings,
        "kept": false,
    });
    let pretty = pretty(tree, job, args, made, &written, seconds);
    let staged = finished::noted(args, job, key, (&record, &rows, &pretty), staged)?;
    interrupt::writing()?;
    staged.commit()?;
    interrupt::written();
    Ok(Done {
        record,
        rows,
        pretty,
    })
}

/// Whether the alpha of a texture cuts anything out of what is drawn.
fn has_cut_outs(document: &Document) -> Result<bool, Failure> {
    let cuts_out = |surface: &Surface| {
        let alpha = surface.material.texture.as_ref();
        let mut alpha = alpha
            .into_iter()
            .flat_map(|texture| texture.rgba.chunks_exact(4));
        let is_mask = matches!(surface.material.alpha_mode, AlphaMode::Mask(_));
        is_mask && alpha.any(|texel| texel[3] < u8::MAX)
    };
    let drawn = document.surfaces(&[])?;
    Ok(drawn.iter().any(|(surface, _)| cuts_out(surface)))
}
