//! `secateur lods`: the chain of levels that an engine loads.

mod dry_run;
mod finished;
mod job;
mod level_options;
mod nameless;
mod table;

use std::path::{Path, PathBuf};
use std::time::Instant;

use schemars::JsonSchema;
use secateur::engines::EngineName;
use secateur::{Effort, ErrorKind, Levels, PlacedLevel, Plant, Preset, Surroundings, WoodMode};
use secateur_gltf::chain::{Layout, WrittenChain};
use secateur_gltf::{Document, StagedFiles, WriteOptions};
use secateur_levels::chain::{ChainOptions, Textures};
use secateur_model::{AlphaMode, Surface};
use serde::Serialize;
use serde_json::{Value, json};

use super::advice::warn_all;
use super::args::{self, Common};
use super::failure::Failure;
use super::measure::warning_of;
use super::print::{Printed, Records};
use super::progress_bar::RunProgress;
use super::record::{self, OfOriginal, Record, shown, shown_if};
use super::streams::Outlet;
use super::surroundings::SurroundingsRecord;
use super::work::Work;
use super::{advice, demo, interrupt, log, output, picture, streams};
use finished::Finished;
pub(crate) use job::Job;
use job::{check_free, check_outputs, jobs, outputs};
pub(crate) use level_options::options;
use table::pretty;
pub(crate) use table::{OF_DEMO, table};

/// The levels of a plant.
#[derive(Serialize, JsonSchema)]
pub(crate) struct LodsRecord {
    /// The plant's file.
    input: String,
    /// What nodes and files of the levels are called after.
    name: String,
    layout: Layout,
    /// The files that were written, those of levels first.
    files: Vec<String>,
    /// Bytes of all files.
    bytes: u64,
    /// The page to look at the levels, if one was asked for.
    preview: Option<String>,
    leaves: OfOriginal,
    /// Triangles of the whole plant.
    triangles: OfOriginal,
    /// Triangles of leaves.
    foliage_triangles: OfOriginal,
    /// Triangles of wood.
    wood_triangles: OfOriginal,
    surroundings: SurroundingsRecord,
    screen: ScreenRecord,
    /// The largest difference that a level may have.
    max_difference: f64,
    /// The largest `block_coverage` that a level may have.
    max_block_coverage: f64,
    plant_height_m: Option<f64>,
    /// The largest difference that a switch may show.
    max_pop: Option<f64>,
    wood: WoodMode,
    textures: Textures,
    /// The largest difference that a switch shows.
    largest_pop: Option<f64>,
    preset: Preset,
    effort: Effort,
    /// Where leaves were drawn: `cpu` or `gpu`.
    engine: &'static str,
    /// The GPU and its driver; none on the CPU.
    adapter: Option<String>,
    /// The levels, finest first.
    levels: Vec<PlacedLevel>,
    /// SHA-256 of all that was done to the leaves of the coarsest level that has any.
    order_sha256: Option<String>,
    /// What was asked for and left out, and the like, a sentence each.
    notes: Vec<String>,
    /// What has to be said of plant and levels, a sentence each.
    warnings: Vec<String>,
    /// Whether the levels are those of an earlier call: neither plant nor options have changed.
    kept: bool,
}

/// A plant that could not be done.
#[derive(Serialize, JsonSchema)]
pub(crate) struct FailureRecord {
    /// The plant's file.
    input: String,
    /// Why, in a sentence.
    error: String,
}

impl FailureRecord {
    /// Why a tree could not be done.
    pub(crate) fn of(tree: &Path, failure: &Failure) -> Self {
        Self {
            input: tree.display().to_string(),
            error: failure.to_string(),
        }
    }
}

/// The screen that levels are for.
#[derive(Serialize, JsonSchema)]
struct ScreenRecord {
    height_px: f64,
    fov_degrees: f64,
}

/// A tree that was done.
struct Done {
    record: Value,
    pretty: String,
}

impl Done {
    /// As an earlier call left it; what it took is this call's.
    fn again(finished: Finished, seconds: f64) -> Self {
        let kept = "  kept       as it was made before: neither the tree nor what was asked for has changed\n";
        let of_call = Record::new("lods", json!({ "kept": true }), &[], seconds).to_value();
        let mut record = finished.record;
        if let (Some(entries), Value::Object(of_call)) = (record.as_object_mut(), of_call) {
            entries.extend(of_call);
        }
        Self {
            record,
            pretty: finished.pretty + kept,
        }
    }
}

/// Makes a chain of each tree, one after the other: what is finished when the program ends stays, and
/// is not done again by the next call. Of several trees those that cannot be done are left out.
pub(crate) fn run(args: &args::Lods, common: &Common) -> Result<Printed, Failure> {
    let outlet = Outlet::of(&args.output)?;
    if !outlet.is_stdout() {
        return run_into_files(args, common, &outlet);
    }
    if matches!(args.layout, Some(Layout::Files | Layout::Usd)) {
        return Err(Failure::usage(
            "standard output takes one file: leave out `--layout`, or name a folder",
        ));
    }
    if args.for_engine.is_some() {
        return Err(Failure::usage(
            "standard output takes one file, and an engine needs more: name a folder",
        ));
    }
    let args = args::Lods {
        output: outlet.path().to_owned(),
        ..args.clone()
    };
    let printed = run_into_files(&args, common, &outlet)?;
    if !args.dry_run {
        outlet.send()?;
    }
    Ok(printed)
}

fn run_into_files(args: &args::Lods, common: &Common, outlet: &Outlet) -> Result<Printed, Failure> {
    let start = Instant::now();
    let jobs = jobs(args)?;
    check_outputs(args, &jobs)?;
    options(args).check().map_err(secateur::Error::from)?;
    let outputs: Vec<PathBuf> = jobs.iter().flat_map(|job| outputs(args, job)).collect();
    let outputs: Vec<&Path> = outputs.iter().map(PathBuf::as_path).collect();
    let surroundings = args.scene.read(args.plant.memory(), &outputs)?;
    if args.dry_run {
        return dry_run::told(args, &jobs);
    }
    let keeps_going = args.keep_going.unwrap_or(jobs.len() > 1);
    if !keeps_going && jobs.len() > 1 {
        // What cannot be done is refused before anything is made of the others.
        for job in &jobs {
            let (_, known) = key_and_known(args, job)?;
            if !known.is_some_and(|known| known.is_whole(args)) {
                opened(args, job)?;
            }
        }
    }
    // What was read for all counts with the first.
    let mut since = start;
    let mut pretty = String::new();
    let mut records = Vec::new();
    let mut failed = Vec::new();
    for job in &jobs {
        match done(args, common, job, &surroundings, since) {
            Ok(done) => {
                pretty.push_str(&done.pretty);
                records.push(outlet.renamed(done.record));
            }
            Err(failure) => {
                if !keeps_going || failure.kind == ErrorKind::Interrupted {
                    return Err(failure);
                }
                log::error(&failure);
                let seconds = since.elapsed().as_secs_f64();
                failed.push((job, failure, seconds));
            }
        }
        since = Instant::now();
    }
    if !failed.is_empty() {
        pretty.push_str(&format!("{} of {} failed\n", failed.len(), jobs.len()));
        for (_, failure, _) in &failed {
            pretty.push_str(&format!("  {failure}\n"));
        }
    }
    let some_failed = !failed.is_empty();
    records.extend(failed.into_iter().map(|(job, failure, seconds)| {
        let failure = FailureRecord::of(job.tree, &failure);
        Record::new("lods", failure, &[], seconds).to_value()
    }));
    let levels = records.iter().map(|record| record["levels"].as_array());
    let rows = levels.flatten().flatten().cloned().collect();
    let records = Records::Lines(records);
    if let Some(report) = &args.report {
        output::write_file(report, records.as_text().as_bytes())?;
    }
    Ok(Printed {
        pretty,
        rows,
        records,
        some_failed,
    })
}

/// What a tree's levels are known by, and those that an earlier call left; nothing else may be in their places.
fn key_and_known(args: &args::Lods, job: &Job<'_>) -> Result<(String, Option<Finished>), Failure> {
    let key = interrupt::reading(|| finished::key(args, job))?;
    let known = Finished::of(args, job, &key).filter(|_| !args.overwrite);
    check_free(args, job, known.as_ref())?;
    Ok((key, known))
}

/// A tree's levels, made or as an earlier call left them.
fn done(
    args: &args::Lods,
    common: &Common,
    job: &Job<'_>,
    surroundings: &Surroundings,
    since: Instant,
) -> Result<Done, Failure> {
    let (key, known) = key_and_known(args, job)?;
    let may_overwrite = args.overwrite || known.is_some();
    match known {
        Some(known) if known.is_whole(args) => {
            Ok(Done::again(known, since.elapsed().as_secs_f64()))
        }
        _ => {
            let (done, files) = make(
                args,
                common,
                (job, may_overwrite),
                surroundings,
                None,
                since,
            )?;
            let noted = (&done.record, &*done.pretty);
            let files = finished::noted(args, job, key, noted, files)?;
            interrupt::writing()?;
            files.commit()?;
            interrupt::written();
            Ok(done)
        }
    }
}

/// What the levels of the first tree depend on, as a SHA-256.
pub(crate) fn key_of_first(args: &args::Lods) -> Result<String, Failure> {
    match jobs(args)?.first() {
        Some(job) => interrupt::reading(|| finished::key(args, job)),
        None => Err(Failure::usage("no tree was named")),
    }
}

/// The record of the levels of the first tree, with a picture of them, and all files but for their names.
pub(crate) fn made_of_first(
    args: &args::Lods,
    common: &Common,
    picture: &Path,
    since: Instant,
) -> Result<(Value, StagedFiles), Failure> {
    let jobs = jobs(args)?;
    check_outputs(args, &jobs)?;
    options(args).check().map_err(secateur::Error::from)?;
    let surroundings = args.scene.read(args.plant.memory(), &[])?;
    let Some(job) = jobs.first() else {
        return Err(Failure::usage("no tree was named"));
    };
    let (done, files) = make(
        args,
        common,
        (job, true),
        &surroundings,
        Some(picture),
        since,
    )?;
    Ok((done.record, files))
}

/// The tree of a job, if a chain can be made of it.
fn opened(args: &args::Lods, job: &Job<'_>) -> Result<Plant, Failure> {
    tracing::info!("reading {}", job.tree.display());
    let opening = args.plant.opening(WoodMode::Auto);
    let plant = streams::plant(job.tree, &opening)?;
    let document = plant.tree().document();
    let outputs = outputs(args, job);
    let outputs: Vec<&Path> = outputs.iter().map(PathBuf::as_path).collect();
    output::check_spares(document, &outputs)?;
    if args.textures == Some(Textures::Fit) && !has_cut_outs(document)? {
        return Err(Failure::input(format!(
            "{}: no texture with alpha cuts out its leaves, so there is no coverage to keep; leave out `--textures fit`",
            job.tree.display()
        )));
    }
    Ok(plant)
}

/// The levels of a tree, and their files but for their names.
fn make(
    args: &args::Lods,
    common: &Common,
    (job, may_overwrite): (&Job<'_>, bool),
    surroundings: &Surroundings,
    picture: Option<&Path>,
    start: Instant,
) -> Result<(Done, StagedFiles), Failure> {
    let mut work = Work::since("lods", start);
    let drawn = args.scene.drawn(surroundings, args.plant.memory())?;
    let plant = opened(args, job)?.within(drawn);
    work.stages.push(("read", start.elapsed().as_secs_f64()));
    let mut warnings = advice::sentences(&plant.inspection().warnings);
    warn_all(&warnings);
    interrupt::check()?;
    let options = options(args);
    let levels = levels_of(&plant, &options, job, common)?;
    work.stages.extend_from_slice(&levels.chain.seconds);
    let differences = levels.chain.levels.iter();
    let differences = differences.map(|level| level.difference.difference);
    let of_levels = warning_of(differences.fold(0.0, f64::max));
    warn_all(&of_levels);
    warnings.extend(of_levels);
    let written = work.timed("write", |files| {
        let how = WriteOptions::default()
            .overwrite(may_overwrite)
            .compress(args.compress);
        stage_all(files, args, job, &levels, how, picture)
    })?;
    let original = plant.report();
    let notes = record::notes(
        &plant,
        advice::sentences(&levels.chain.notes)
            .iter()
            .chain(&written.notes),
    );
    let record = LodsRecord {
        input: job.tree.display().to_string(),
        name: job.name.clone(),
        layout: job.layout,
        files: shown(&written.files),
        bytes: written.bytes,
        preview: shown_if(args.preview.as_deref()),
        leaves: original.leaves.into(),
        triangles: original.triangles.into(),
        foliage_triangles: original.foliage_triangles.into(),
        wood_triangles: original.wood_triangles.into(),
        surroundings: args.scene.record(surroundings),
        screen: ScreenRecord {
            height_px: options.screen.height_px,
            fov_degrees: options.screen.field_of_view_degrees,
        },
        max_difference: options.max_difference,
        max_block_coverage: options.limits().block_coverage,
        plant_height_m: options.plant_height_m,
        max_pop: options.max_pop,
        wood: options.wood.decided(),
        textures: options.textures,
        largest_pop: levels.chain.largest_pop(),
        preset: options.leaves.preset,
        effort: options.leaves.effort,
        engine: levels.engine,
        adapter: levels.adapter.clone(),
        levels: levels.placed(job.layout, &written),
        order_sha256: levels.chain.coarsest_order_sha256(),
        notes: notes.clone(),
        warnings,
        kept: false,
    };
    let (record, seconds) = work.record(record);
    let made = (&levels.chain, &written);
    let pretty = pretty(&original, job, args, made, &notes, seconds);
    Ok((Done { record, pretty }, work.files))
}

fn levels_of(
    plant: &Plant,
    options: &ChainOptions,
    job: &Job<'_>,
    common: &Common,
) -> Result<Levels, Failure> {
    let progress_bar = RunProgress::new(common, &job.tree.display().to_string());
    let levels = plant.levels_watched(options, &mut |progress| progress_bar.show(progress));
    let levels = levels.map_err(|error| Failure::of_plant(job.tree, error))?;
    Ok(levels.named(&job.name))
}

/// Writes levels and all that lies beside them under temporary names.
fn stage_all(
    staged: &mut StagedFiles,
    args: &args::Lods,
    job: &Job<'_>,
    levels: &Levels,
    how: WriteOptions,
    picture: Option<&Path>,
) -> Result<WrittenChain, Failure> {
    if job.place != args.output {
        let made = staged.make_folder(&args.output);
        made.map_err(|e| Failure::of_file(&args.output, "cannot be made", &e))?;
    }
    let (mut written, files) = levels.prepare(&job.place, job.layout, how)?.into_files();
    staged.append(files);
    if let (Some(engine), Some(file)) = (args.for_engine, &job.companion) {
        stage_companion(staged, engine, job, levels, file)?;
        written.files.push(file.clone());
    }
    if let Some(file) = &args.preview {
        let page = levels.preview_html();
        let page = page.map_err(|error| Failure::of_plant(job.tree, error))?;
        output::stage(staged, file, page.as_bytes())?;
    }
    if let Some(file) = picture {
        let strip = picture::strip(&demo::exhibits(levels.tree(), &levels.chain)?)?;
        output::stage(staged, file, &strip)?;
    }
    Ok(written)
}

/// Writes what an engine needs beside the levels.
fn stage_companion(
    staged: &mut StagedFiles,
    engine: EngineName,
    job: &Job<'_>,
    levels: &Levels,
    file: &Path,
) -> Result<(), Failure> {
    if let Some(folder) = file
        .parent()
        .filter(|folder| !folder.as_os_str().is_empty())
    {
        let made = staged.make_folder(folder);
        made.map_err(|e| Failure::of_file(folder, "cannot be made", &e))?;
    }
    let of_levels = job.place.file_name().unwrap_or_default().to_string_lossy();
    match levels.engine_file(engine, &of_levels) {
        Some(text) => output::stage(staged, file, text.as_bytes()),
        None => Ok(()),
    }
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
