//! The levels of one tree, and their files but for their names.

use std::path::{Path, PathBuf};
use std::time::Instant;

use secateur::engines::EngineName;
use secateur::{Levels, Opening, Plant, Surroundings, WoodMode};
use secateur_gltf::chain::WrittenChain;
use secateur_gltf::{Document, StagedFiles, WriteOptions};
use secateur_levels::chain::{ChainOptions, Textures};
use secateur_model::{AlphaMode, Surface};
use serde_json::{Value, json};

use super::super::advice::{self, warn_all};
use super::super::args::{self, Common};
use super::super::failure::Failure;
use super::super::progress_bar::RunProgress;
use super::super::record::{self, Record, shown, shown_if};
use super::super::work::Work;
use super::super::{demo, interrupt, output, picture, streams};
use super::finished::Finished;
use super::job::{Job, outputs};
use super::level_options::options;
use super::record::{LodsRecord, ScreenRecord};
use super::table::pretty;

/// A tree that was done.
pub(super) struct Done {
    pub(super) record: Value,
    pub(super) pretty: String,
}

impl Done {
    /// As an earlier call left it; what it took is this call's.
    pub(super) fn again(finished: Finished, seconds: f64) -> Self {
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

/// The tree of a job, if a chain can be made of it.
pub(super) fn opened(args: &args::Lods, job: &Job<'_>) -> Result<Plant, Failure> {
    tracing::info!("reading {}", job.tree.display());
    let opening = Opening {
        wind: args.wind.wind,
        ..args.plant.opening(WoodMode::Auto)
    };
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
pub(super) fn make(
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
    let of_levels = levels.warning().map(|warning| warning.to_string());
    warn_all(of_levels.as_slice());
    warnings.extend(of_levels);
    let written = work.timed("write", |files| {
        let how = args.packing.write_options(may_overwrite);
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
        output::make_folder(staged, &args.output)?;
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
        output::make_folder(staged, folder)?;
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
