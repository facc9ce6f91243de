//! Runs `secateur simplify`: one tree in, one level out, with its report.

use std::path::Path;
use std::time::Instant;

use secateur::{
    Counts, Error, Foliage, Level, LevelOptions, LevelParts, LevelWarning, Lod, MeshoptBorders,
    MeshoptOptions, Method, Objective, Opening, Options, Plant, PreparedLod, Progress, Resolution,
    Simplified, StagedFiles, Stopped, VdsOptions, Views, Warning, WoodMode, WriteOptions, Written,
    read_cameras,
};
use secateur_raster::Scene;

use super::args::{self, Common, MaxCoverage};
use super::failure::Failure;
use super::names::MethodName;
use super::picture::{self, Exhibit};
use super::print::Printed;
use super::progress_bar::RunProgress;
use super::record::{self, Record};
use super::simplify_record::Simplifying;
use super::streams::Outlet;
use super::summary::{columns, grouped, percent, size};
use super::{advice, interrupt, machine, materials_in_words, order, output, streams};

/// Reads, simplifies, writes, reports.
pub(crate) fn run(args: &args::Simplify, common: &Common) -> Result<Printed, Failure> {
    let start = Instant::now();
    let outputs = check_outputs(args)?;
    let outlet = Outlet::of(&args.output)?;
    let options = options(args)?;
    let mut stages = Vec::new();

    let surroundings = timed(&mut stages, "scene", || {
        args.scene.read(args.memory.memory, &outputs)
    })?;
    let opening = Opening {
        foliage: args.foliage.foliage.clone(),
        vertex_alpha: args.vertex_alpha.vertex_alpha,
        wood: match args.wood {
            Some(wood) => wood,
            None if !args.level_of.is_empty() => WoodMode::Auto,
            None => LevelOptions::usual_wood(options.target),
        },
        memory: args.memory.memory,
    };
    let mut plant = timed(&mut stages, "load", || {
        tracing::info!("reading {}", args.tree.display());
        Ok(streams::plant(&args.tree, &opening)?.within(surroundings))
    })?;
    let tree = plant.tree();
    output::check_spares(tree.document(), &outputs)?;
    let mut warnings = advice::sentences(&plant.inspection().warnings);
    warn_all(&warnings);
    interrupt::check()?;

    let level = level(&plant, &options, args, common)?;
    let of_run = level.simplified.seconds.iter();
    stages.extend(of_run.map(|(stage, time)| (stage.name(), *time)));
    stages.extend_from_slice(&level.seconds);
    let (of_look, of_level): (Vec<_>, Vec<_>) =
        (level.warnings.iter()).partition(|warning| warning.is_of_look());
    let [of_look, of_level] = [of_look, of_level]
        .map(|warnings| warnings.into_iter().map(sentence).collect::<Vec<String>>());
    warn_all(&of_level);
    warnings.extend(of_level);
    warnings.extend(of_look.iter().cloned());
    interrupt::writing()?;
    machine::give_back_free_memory();
    // All files are written before the first appears: what fails leaves nothing.
    let prepared = timed(&mut stages, "write", || {
        tracing::info!("writing {}", args.output.display());
        Ok(level.prepare(outlet.path(), write_options(args))?)
    })?;
    let picture = match args.picture {
        Some(_) => Some(timed(&mut stages, "picture", || {
            picture_of(&prepared, args, &plant, &level)
        })?),
        None => None,
    };
    let (written, mut staged) = prepared.into_files();
    let (figures, views_that_judge) = (level.record(), level.views_that_judge());
    let level = level.into_parts();
    let result = &level.simplified;
    if let (Some(path), Some(picture)) = (&args.picture, picture) {
        output::stage(&mut staged, path, &picture)?;
    }
    if let Some(path) = &args.order {
        let order = result.passes.in_one_order();
        order::stage(&mut staged, path, order, &mut plant, write_options(args))?;
    }
    if let Some(folder) = &args.debug_images {
        stage_debug_images(&mut staged, folder, &level.options, &plant, result)?;
    }
    let run = Simplifying {
        input: &args.tree,
        plant: &plant,
        level: &level,
        record: figures,
        views_that_judge,
        written: &written,
        warnings: &warnings,
    };
    let total = start.elapsed().as_secs_f64();
    let record = Record::new("simplify", run.record(args), &stages, total).to_value();
    let record = outlet.renamed(record);
    record::stage(&mut staged, args.report.as_deref(), &record)?;
    staged.commit()?;
    outlet.send()?;
    warn_all(&of_look);
    Ok(Printed::single(pretty(&run, args, total), record))
}

/// The outputs, none of which is known to be in the way of another file.
fn check_outputs(args: &args::Simplify) -> Result<Vec<&Path>, Failure> {
    let mut inputs = vec![args.tree.as_path()];
    inputs.extend(args.views.as_deref().map(Path::new));
    inputs.extend(args.scene.files());
    if !streams::is_stream(&args.output) {
        output::check_tree(&args.output, &inputs, write_options(args))?;
    }
    let mut outputs = vec![args.output.as_path()];
    if let Some(file) = &args.report {
        output::check_file(file, &inputs)?;
        outputs.push(file);
    }
    if let Some(file) = &args.order {
        order::check(file, &inputs, write_options(args))?;
        outputs.push(file);
    }
    if let Some(file) = &args.picture {
        output::check_picture(file, &inputs)?;
        outputs.push(file);
    }
    if let Some(folder) = &args.debug_images {
        output::check_folder(folder)?;
    }
    output::check_distinct(&outputs)?;
    Ok(outputs)
}

fn write_options(args: &args::Simplify) -> WriteOptions {
    WriteOptions::default()
        .overwrite(args.overwrite)
        .compress(args.compress)
}

/// What a run is asked to do.
pub(crate) fn options(args: &args::Simplify) -> Result<Options, Failure> {
    let options = Options::with_preset(args.preset, args.target.target());
    Ok(Options {
        effort: args.effort,
        method: method(args),
        engine: args.engine,
        views: match &args.views {
            Some(name) => views(name)?,
            None => options.views.clone(),
        },
        field_of_view: args.field_of_view.unwrap_or(options.field_of_view),
        resolution: args.resolution.unwrap_or(options.resolution),
        alpha: args.alpha.unwrap_or(options.alpha),
        sides: args.sides.unwrap_or(options.sides),
        leaf_triangles: args.leaf_triangles.unwrap_or(options.leaf_triangles),
        needles: args.needles.unwrap_or(options.needles),
        fit: args.fit,
        audit: args.audit || (options.audit && !args.no_audit),
        ..options
    })
}

fn method(args: &args::Simplify) -> Method {
    match args.method {
        MethodName::Vds => Method::Vds(vds(args)),
        MethodName::VdsReference => Method::VdsReference(vds(args)),
        MethodName::Fsa => Method::Fsa(args.fsa),
        MethodName::Stochastic => Method::Stochastic(args.stochastic),
        MethodName::Meshopt => Method::Meshopt(MeshoptOptions {
            mode: args.meshopt_mode,
            borders: match (args.preserve_area, args.dilate_borders) {
                (true, _) => MeshoptBorders::PreserveArea,
                (false, true) => MeshoptBorders::Dilate,
                (false, false) => MeshoptBorders::Stay,
            },
        }),
        MethodName::Chain => Method::Chain(args.chain),
        MethodName::Merge => Method::Merge(args.merge),
    }
}

fn vds(args: &args::Simplify) -> VdsOptions {
    let preset = args.preset.vds();
    VdsOptions {
        reference: args.reference.unwrap_or(preset.reference),
        resize: args.resize.unwrap_or(preset.resize),
        neighbours: args.neighbours as usize,
        max_coverage: match args.max_coverage {
            Some(MaxCoverage(limit)) => limit,
            None => preset.max_coverage,
        },
        ties: args.ties,
    }
}

/// A set of views by its name, or cameras from a file.
fn views(name: &str) -> Result<Views, Error> {
    if let Some(views) = Views::by_name(name) {
        return Ok(views);
    }
    let path = Path::new(name);
    read_cameras(path).map(Views::Cameras).map_err(|mut error| {
        // A name that was mistyped is no file either.
        if !path.exists() {
            error.reason += "; `--views` takes auto, dodecahedron, turning, icosahedron, 32, 60, 92, 8, \
                             6, vnc or a JSON file";
        }
        Error::Cameras(error)
    })
}

/// A level with the material changes that are asked for.
pub(crate) fn level_options(args: &args::Simplify, simplify: Options) -> LevelOptions {
    LevelOptions {
        simplify,
        cutoffs: args.cutoffs.unwrap_or_default(),
        colors: args.colors.unwrap_or_default(),
        level_of: args.level_of.clone(),
    }
}

fn level(
    plant: &Plant,
    options: &Options,
    args: &args::Simplify,
    common: &Common,
) -> Result<Level, Failure> {
    let progress_bar = RunProgress::new(common, &args.tree.display().to_string());
    let options = level_options(args, options.clone());
    let level = plant.level_watched(&options, &mut |progress| {
        if let Progress::Stage(_) = progress {
            machine::give_back_free_memory();
        }
        progress_bar.show(progress)
    });
    level.map_err(Failure::about(&args.tree))
}

/// Does something and notes how long it took.
pub(crate) fn timed<T>(
    stages: &mut Vec<(&'static str, f64)>,
    name: &'static str,
    work: impl FnOnce() -> Result<T, Failure>,
) -> Result<T, Failure> {
    let start = Instant::now();
    let result = work()?;
    stages.push((name, start.elapsed().as_secs_f64()));
    Ok(result)
}

/// What has to be said of a level, with the option that helps where there is one.
fn sentence(warning: &LevelWarning) -> String {
    match warning {
        LevelWarning::Run(warning) => sentence_of_run(warning),
        LevelWarning::NoOtherColors => "--colors dilate changes no texture: mip maps of leaf textures that are cut out, if there are any, mix in hardly any other colours".to_owned(),
        LevelWarning::CutoffsStay(_)
        | LevelWarning::TexturesStay(_)
        | LevelWarning::AnotherPlant(_)
        | LevelWarning::LookUnknown(_) => warning.to_string(),
    }
}

fn sentence_of_run(warning: &Warning) -> String {
    match warning {
        Warning::FitCostsInformation { .. } => format!("{warning} (`--fit=none`)"),
        _ => warning.to_string(),
    }
}

/// The warnings of a run.
pub(crate) fn sentences(result: &Simplified) -> Vec<String> {
    result.warnings.iter().map(sentence_of_run).collect()
}

pub(crate) fn warn_all(warnings: &[String]) {
    for warning in warnings {
        tracing::warn!("{warning}");
    }
}

/// The bytes of the picture of the original and the result.
fn picture_of(
    prepared: &PreparedLod,
    args: &args::Simplify,
    plant: &Plant,
    level: &LevelParts,
) -> Result<Vec<u8>, Failure> {
    let selectors = &args.foliage.foliage;
    let after = prepared.document()?;
    let leaves = plant.leaves();
    let left = level.simplified.lod.foliage(leaves);
    // Triangles are those that the target counts.
    let counts = |foliage: &Foliage, wood_triangles: u64| {
        let wood = match plant.wood_mode() {
            WoodMode::Ignore => 0,
            _ => wood_triangles as usize,
        };
        [foliage.leaves().len(), foliage.triangles().len() + wood]
    };
    let before = counts(leaves, plant.wood_triangle_count());
    let now = counts(&left, level.wood_triangles);
    let in_words = |counts: [usize; 2]| {
        let [leaves, triangles] = counts.map(|n| grouped(n as u64));
        format!("{leaves} leaves, {triangles} triangles")
    };
    let exhibits = [
        Exhibit {
            title: "original".to_owned(),
            subtitle: in_words(before),
            surfaces: picture::surfaces(plant.tree().document(), selectors)?,
        },
        Exhibit {
            title: match level.simplified.stopped {
                Stopped::AtTriangles => share(now[1], before[1]),
                Stopped::AtLeafCount | Stopped::AtMaxError => share(now[0], before[0]),
            },
            subtitle: in_words(now),
            // No leaf may be left to select.
            surfaces: picture::surfaces(&after, &[])?,
        },
    ];
    picture::sheet(&exhibits)
}

/// "10 %" of the leaves.
pub(crate) fn share(kept: usize, count: usize) -> String {
    let share = 100.0 * kept as f64 / count.max(1) as f64;
    match share {
        s if (s - s.round()).abs() < 0.05 => format!("{s:.0} %"),
        s => format!("{s:.1} %"),
    }
}

fn stage_debug_images(
    staged: &mut StagedFiles,
    folder: &Path,
    options: &Options,
    plant: &Plant,
    result: &Simplified,
) -> Result<(), Failure> {
    let foliage = secateur::as_seen(plant.leaves(), options.alpha, options.sides);
    let original = Lod::original(foliage.leaves().len());
    for (name, lod) in [("before", &original), ("after", &result.lod)] {
        let scene = Scene {
            foliage: &foliage,
            lod,
            views: &result.views,
            resolution: result.resolution,
        };
        picture::stage_leaf_ids(staged, plant.tree().document(), folder, name, &scene)?;
    }
    Ok(())
}

fn fitted_to(objective: Objective) -> String {
    match objective {
        Objective::Information { outline_weight } => {
            format!("fitted to the original at the end, outlines with a weight of {outline_weight}")
        }
        Objective::Coverage => {
            "fitted at the end, so that each part of the crown is as dense as it was".to_owned()
        }
    }
}

/// Whether `measure` looks from elsewhere than what drove the run.
fn who_judges(run: &Simplifying<'_>) -> String {
    match run.views_that_judge {
        0 => "`secateur measure` judges by others".to_owned(),
        count => {
            format!("`secateur measure` judges by {count} of them too, which flatters the result")
        }
    }
}

fn pretty(run: &Simplifying<'_>, args: &args::Simplify, seconds: f64) -> String {
    let (result, written): (&Simplified, &Written) = (&run.level.simplified, run.written);
    let row = |cells: [String; 4]| cells.to_vec();
    let numbers = |name: &str, of: Counts| {
        let share = share(of.left as usize, of.original as usize);
        let [before, after] = [of.original, of.left].map(grouped);
        row([name.to_owned(), before, after, share])
    };
    let (plant, figures) = (run.plant, &run.record);
    let mut rows = vec![
        row([
            String::new(),
            "original".into(),
            "result".into(),
            String::new(),
        ]),
        numbers("leaves", figures.leaves),
        numbers("triangles", figures.triangles),
        numbers("of leaves", figures.foliage_triangles),
        numbers("of wood", figures.wood_triangles),
    ];
    if let Some(before) = record::bytes_of(run.input) {
        let share = share(written.bytes as usize, before as usize);
        rows.push(row([
            "file".into(),
            size(before),
            size(written.bytes),
            share,
        ]));
    }
    let mut text = format!("{} -> {}\n", run.input.display(), args.output.display());
    text += &columns(&rows);
    let mut say = |name: &str, what: String| text += &format!("  {name:<9}  {what}\n");
    say(
        "method",
        format!(
            "{} on the {}",
            run.level.options.method.name(),
            result.adapter.as_deref().unwrap_or("CPU")
        ),
    );
    let has_leaves = !plant.leaves().leaves().is_empty();
    let (views, side) = (result.views.len(), result.resolution);
    if has_leaves {
        say("views", format!("{views} of {side} x {side} pixels"));
    }
    if let (Some(reason), true) = (&result.views_reason, views > 20) {
        say("", reason.clone());
    }
    if has_leaves && run.level.options.resolution == Resolution::Auto {
        say("", result.resolution_reason.clone());
    }
    if let (Some(objective), true) = (run.level.options.objective(), result.passes.sizes.is_some())
    {
        say("sizes", fitted_to(objective));
    }
    if let Some(chosen) = &figures.cutoffs {
        say("cutoffs", materials_in_words::cutoffs(chosen));
    }
    if let Some(chosen) = &figures.colors {
        say("colours", materials_in_words::colors(chosen));
    }
    if has_leaves && let Some(lost) = result.driving_error_percent() {
        say(
            "loss",
            format!(
                "VMI error {} on these views; {}",
                percent(lost),
                who_judges(run)
            ),
        );
    }
    if has_leaves {
        say(
            "growth",
            format!(
                "the largest leaf has {:.1} times its original area",
                result.passes.max_area_scale()
            ),
        );
    }
    let memory = machine::peak_rss_bytes().map(|bytes| format!(", {} of memory", size(bytes)));
    say(
        "cost",
        format!("{seconds:.2} s{}", memory.unwrap_or_default()),
    );
    if let Some(path) = result.audited_by {
        say("audit", format!("the {path} draws the same areas"));
    }
    for note in run.notes() {
        say("note", note);
    }
    text
}
