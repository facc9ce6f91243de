//! `secateur simplify`.

use std::path::Path;
use std::sync::Arc;
use std::time::Instant;

use secateur::fit::Objective;
use secateur::raster::ViewSet;
use secateur::{
    Error, Foliage, Lod, PlantSkeleton, PreparedLod, Resolution, Simplified, Simplify, StagedFiles,
    Stopped, Tree, Views, WriteOptions, Written, read_cameras,
};

use super::args::{self, Common, MaxCoverage};
use super::failure::Failure;
use super::picture::{self, Exhibit};
use super::print::Printed;
use super::record::{self, Run};
use super::summary::{columns, grouped, percent, size};
use super::watch::Watch;
use super::{interrupt, machine, names, output};

/// Reads, simplifies, writes, reports.
pub(crate) fn run(args: &args::Simplify, common: &Common) -> Result<Printed, Failure> {
    let start = Instant::now();
    let outputs = check_outputs(args)?;
    let mut settings = settings(args)?;
    let mut stages = Vec::new();

    let tree = timed(&mut stages, "load", || {
        tracing::info!("reading {}", args.tree.display());
        Tree::open(&args.tree, &args.foliage.foliage).map_err(Failure::from)
    })?;
    output::check_spares(tree.document(), &outputs)?;
    let mut warnings = tree.inspection().warnings.clone();
    warn_all(&warnings);
    interrupt::check()?;

    settings.skeleton = skeleton(&tree, &settings)?;
    let result = simplified(&tree, &settings, args, common)?;
    warn_all(&result.warnings);
    warnings.extend(result.warnings.iter().cloned());
    stages.extend(result.seconds.iter().copied());

    interrupt::writing()?;
    // All files are written before the first appears: what fails leaves nothing.
    let prepared = timed(&mut stages, "write", || {
        tracing::info!("writing {}", args.output.display());
        tree.prepare_lod(&result.lod, &args.output, write_options(args))
            .map_err(Failure::from)
    })?;
    let picture = match args.picture {
        Some(_) => Some(timed(&mut stages, "picture", || {
            picture_of(&prepared, args, &tree, &result)
        })?),
        None => None,
    };
    let (written, mut staged) = prepared.into_files();
    if let (Some(path), Some(picture)) = (&args.picture, picture) {
        output::stage(&mut staged, path, &picture)?;
    }
    if let Some(folder) = &args.debug_images {
        stage_debug_images(&mut staged, folder, &settings, &tree, &result)?;
    }
    let run = Run {
        input: &args.tree,
        tree: &tree,
        result: &result,
        settings: &settings,
        written: &written,
        stages: &stages,
        total_seconds: start.elapsed().as_secs_f64(),
        warnings: &warnings,
    };
    let record = record::of_simplify(&run, args);
    record::stage(&mut staged, args.report.as_deref(), &record)?;
    staged.commit()?;
    Ok(Printed::single(pretty(&run, args), record))
}

/// The outputs, none of which is known to be in the way of another file.
fn check_outputs(args: &args::Simplify) -> Result<Vec<&Path>, Failure> {
    let mut inputs = vec![args.tree.as_path()];
    let cameras = Path::new(&args.views);
    inputs.push(cameras);
    output::check_tree(&args.output, &inputs, write_options(args))?;
    let mut outputs = vec![args.output.as_path()];
    if let Some(file) = &args.report {
        output::check_file(file, &inputs)?;
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
    WriteOptions::default().overwrite(args.overwrite)
}

/// What a run is asked to do.
pub(crate) fn settings(args: &args::Simplify) -> Result<Simplify, Failure> {
    let mut settings = Simplify::with_preset(args.preset.into(), args.target.target());
    settings.method = args.method.into();
    settings.engine = args.engine.into();
    settings.views = views(&args.views)?;
    settings.resolution = args.resolution;
    if let Some(reference) = args.reference {
        settings.reference = reference.into();
    }
    if let Some(resize) = args.resize {
        settings.resize = resize.into();
    }
    settings.neighbours = args.neighbours as usize;
    if let Some(MaxCoverage(limit)) = args.max_coverage {
        settings.max_coverage = limit;
    }
    settings.ties = args.ties.into();
    settings.alpha = args.alpha.into();
    settings.leaf_triangles = args.leaf_triangles;
    settings.fit = args.fit;
    settings.seed = args.seed;
    settings.area_weight = args.area_weight;
    settings.fsa.distance_weight = args.distance_weight;
    settings.fsa.planarity_weight = args.planarity_weight;
    settings.meshopt.mode = args.meshopt_mode.into();
    settings.meshopt.preserve_area = args.preserve_area;
    settings.cluster_size = args.cluster_size.into();
    settings.audit = args.audit || (settings.audit && !args.no_audit);
    Ok(settings)
}

/// The skeleton of a tree, where the method needs one.
pub(crate) fn skeleton(
    tree: &Tree,
    settings: &Simplify,
) -> Result<Option<Arc<PlantSkeleton>>, Failure> {
    if !settings.method.needs_skeleton() {
        return Ok(None);
    }
    Ok(tree.skeleton()?.map(Arc::new))
}

fn views(name: &str) -> Result<Views, Error> {
    Ok(match name {
        "dodecahedron" | "20" => Views::Dodecahedron,
        "icosahedron" | "12" => Views::Icosahedron,
        "92" => Views::Geodesic,
        "cube" | "8" => Views::Cube,
        "octahedron" | "6" => Views::Octahedron,
        "vnc" => Views::Variable,
        file => Views::Cameras(read_cameras(Path::new(file)).map_err(or_a_name(file))?),
    })
}

/// A name that was mistyped is no file either.
fn or_a_name(name: &str) -> impl Fn(Error) -> Error {
    let is_there = Path::new(name).exists();
    move |error| match error {
        Error::Cameras { file, reason } if !is_there => Error::Cameras {
            file,
            reason: format!(
                "{reason}; `--views` takes dodecahedron, icosahedron, 92, 8, 6, vnc or a JSON file"
            ),
        },
        other => other,
    }
}

fn simplified(
    tree: &Tree,
    settings: &Simplify,
    args: &args::Simplify,
    common: &Common,
) -> Result<Simplified, Failure> {
    let watch = Watch::new(common);
    secateur::simplify(tree.foliage(), settings, &mut |progress| {
        watch.see(progress)
    })
    .map_err(Failure::about(&args.tree))
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

pub(crate) fn warn_all(warnings: &[String]) {
    for warning in warnings {
        tracing::warn!("{warning}");
    }
}

/// The bytes of the picture of the original and the result.
fn picture_of(
    prepared: &PreparedLod,
    args: &args::Simplify,
    tree: &Tree,
    result: &Simplified,
) -> Result<Vec<u8>, Failure> {
    let selectors = &args.foliage.foliage;
    let after = prepared.document()?;
    let left = result.lod.foliage(tree.foliage());
    let in_words = |foliage: &Foliage| {
        let [leaves, triangles] = counts(foliage).map(|n| grouped(n as u64));
        format!("{leaves} leaves, {triangles} triangles")
    };
    let [[leaves_before, triangles_before], [leaves, triangles]] =
        [tree.foliage(), &left].map(counts);
    let exhibits = [
        Exhibit {
            title: "original".to_owned(),
            subtitle: in_words(tree.foliage()),
            surfaces: picture::surfaces(tree.document(), selectors)?,
        },
        Exhibit {
            title: match result.stopped {
                Stopped::AtTriangles => share(triangles, triangles_before),
                Stopped::AtLeafCount | Stopped::AtMaxError => share(leaves, leaves_before),
            },
            subtitle: in_words(&left),
            // No leaf may be left to select.
            surfaces: picture::surfaces(&after, &[])?,
        },
    ];
    picture::sheet(&exhibits)
}

/// Leaves and triangles.
fn counts(foliage: &Foliage) -> [usize; 2] {
    [foliage.leaves().len(), foliage.triangles().len()]
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
    settings: &Simplify,
    tree: &Tree,
    result: &Simplified,
) -> Result<(), Failure> {
    let foliage = settings.alpha.apply(tree.foliage());
    let original = Lod::original(foliage.leaves().len());
    let views: &ViewSet = &result.views;
    for (name, lod) in [("before", &original), ("after", &result.lod)] {
        picture::stage_leaf_ids(
            staged,
            folder,
            name,
            &foliage,
            lod,
            views,
            result.resolution,
        )?;
    }
    Ok(())
}

fn fitted_to(objective: Objective) -> String {
    match objective {
        Objective::Information { outline_weight } => {
            format!("fitted to the original at the end, outlines with a weight of {outline_weight}")
        }
        _ => "fitted at the end, so that each part of the crown is as dense as it was".to_owned(),
    }
}

fn pretty(run: &Run<'_>, args: &args::Simplify) -> String {
    let (result, written): (&Simplified, &Written) = (run.result, run.written);
    let row = |cells: [String; 4]| cells.to_vec();
    let numbers = |name: &str, before: u64, after: u64| {
        let share = share(after as usize, before as usize);
        row([name.to_owned(), grouped(before), grouped(after), share])
    };
    let left = result.lod.foliage(run.tree.foliage());
    let [before, after] = [run.tree.foliage(), &left].map(|f| f.triangles().len());
    let mut rows = vec![
        row([
            String::new(),
            "original".into(),
            "result".into(),
            String::new(),
        ]),
        numbers(
            "leaves",
            result.order.leaf_count().into(),
            result.lod.leaf_count() as u64,
        ),
        numbers("triangles", run.tree.triangle_count(), written.triangles),
        numbers("of leaves", before as u64, after as u64),
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
            names::text(args.method),
            result.adapter.as_deref().unwrap_or("CPU")
        ),
    );
    let (views, side) = (result.views.len(), result.resolution);
    say("views", format!("{views} of {side} x {side} pixels"));
    if args.resolution == Resolution::Auto {
        say("", result.resolution_reason.clone());
    }
    if let (Some(objective), true) = (run.settings.objective(), result.is_fitted) {
        say("sizes", fitted_to(objective));
    }
    say(
        "loss",
        format!(
            "VMI error {} on these views; `secateur measure` judges by others",
            percent(result.driving_error_percent())
        ),
    );
    say(
        "growth",
        format!(
            "the largest leaf has {:.1} times its original area",
            result.lod.max_area_scale()
        ),
    );
    let memory = machine::peak_rss_bytes().map(|bytes| format!(", {} of memory", size(bytes)));
    say(
        "cost",
        format!("{:.2} s{}", run.total_seconds, memory.unwrap_or_default()),
    );
    if let Some(path) = result.audited_by {
        say("audit", format!("the {path} draws the same areas"));
    }
    for note in &written.notes {
        say("note", note.clone());
    }
    text
}
