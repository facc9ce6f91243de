//! `secateur lods`: the chain of levels that an engine loads.

use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::time::Instant;

use secateur::{Amount, Options, Target};
use secateur_gltf::chain::{Layout, Level, LevelTexture, PreparedChain, WrittenChain};
use secateur_gltf::{Detail, Document, GltfError, StagedFiles, WholeTree, WriteOptions};
use secateur_model::Surface;
use secateur_raster::OpenEngine;
use secateur_scene::Screen;
use secateur_scene::chain::{Chain, ChainLevel, ChainOptions, HEIGHTS_PX, Shape, Textures};
use secateur_scene::chain::{Wanted, chain, show};
use secateur_scene::impostor::Choice;
use secateur_scene::preview::{Facts, Level as Shown, Preview, page};
use serde_json::{Map, Value, json};

use super::args::{self, Common, LayoutName};
use super::failure::Failure;
use super::print::Printed;
use super::progress_bar::RunProgress;
use super::summary::{columns, grouped, size};
use super::surroundings::Surroundings;
use super::{interrupt, machine, output, record};

/// A tree to be done, and where its levels go.
struct Job<'a> {
    tree: &'a Path,
    name: String,
    layout: Layout,
    /// The file, or for the layout of files the folder.
    place: PathBuf,
}

/// A tree that was done.
struct Done {
    record: Value,
    rows: Vec<Value>,
    pretty: String,
}

/// Makes a chain of each tree.
pub(crate) fn run(args: &args::Lods, common: &Common) -> Result<Printed, Failure> {
    let start = Instant::now();
    let jobs = jobs(args)?;
    check_outputs(args, &jobs)?;
    options(args).check().map_err(|e| Failure(e.to_string()))?;
    let outputs: Vec<PathBuf> = jobs.iter().flat_map(|job| outputs(args, job)).collect();
    let outputs: Vec<&Path> = outputs.iter().map(PathBuf::as_path).collect();
    let surroundings = args.scene.read(args.memory.memory, &outputs)?;
    let mut trees = Vec::new();
    // All files are written before the first appears: what fails leaves nothing.
    let mut staged = StagedFiles::new();
    for job in &jobs {
        trees.push(make(args, common, job, &surroundings, &mut staged)?);
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
        output::stage(&mut staged, report, format!("{record:#}\n").as_bytes())?;
    }
    staged.commit()?;
    Ok(Printed {
        pretty: trees.iter().map(|done| done.pretty.as_str()).collect(),
        rows: trees.into_iter().flat_map(|done| done.rows).collect(),
        record,
    })
}

/// Where each tree's levels go.
fn jobs(args: &args::Lods) -> Result<Vec<Job<'_>>, Failure> {
    let extension = args.output.extension().and_then(OsStr::to_str);
    let is_file =
        extension.is_some_and(|e| ["glb", "gltf"].contains(&e.to_ascii_lowercase().as_str()));
    if is_file && args.trees.len() > 1 {
        return Err(Failure(format!(
            "{}: one file holds the levels of one tree; name a folder for {} trees",
            args.output.display(),
            args.trees.len()
        )));
    }
    if is_file && args.layout == Some(LayoutName::Files) {
        return Err(Failure(format!(
            "{}: the layout of files needs a folder as its output",
            args.output.display()
        )));
    }
    let layout = match (args.layout, is_file) {
        (Some(LayoutName::Siblings), _) | (None, true) => Layout::Siblings,
        (Some(LayoutName::Msft), _) => Layout::Msft,
        (Some(LayoutName::Files) | None, _) => Layout::Files,
    };
    let mut names: Vec<String> = Vec::new();
    for tree in &args.trees {
        let name = tree
            .file_stem()
            .and_then(OsStr::to_str)
            .unwrap_or("tree")
            .to_owned();
        if names.contains(&name) {
            return Err(Failure(format!(
                "{}: another tree of this call has the same name; its levels would overwrite this one's",
                tree.display()
            )));
        }
        names.push(name);
    }
    let mut jobs = Vec::new();
    for (tree, name) in args.trees.iter().zip(names) {
        jobs.push(Job {
            tree,
            layout,
            place: match is_file || layout == Layout::Files {
                true => args.output.clone(),
                false => args.output.join(format!("{name}.glb")),
            },
            name,
        });
    }
    Ok(jobs)
}

fn check_outputs(args: &args::Lods, jobs: &[Job<'_>]) -> Result<(), Failure> {
    let trees = args.trees.iter().map(PathBuf::as_path);
    let inputs: Vec<&Path> = trees.chain(args.scene.files()).collect();
    let is_folder = jobs
        .iter()
        .all(|job| job.place != args.output || job.layout == Layout::Files);
    if is_folder {
        output::check_folder(&args.output)?;
    }
    for file in [&args.report, &args.preview].into_iter().flatten() {
        output::check_file(file, &inputs)?;
    }
    if args.preview.is_some() && jobs.len() > 1 {
        return Err(Failure(
            "a preview shows one tree: give one at a time, or leave out `--preview`".to_owned(),
        ));
    }
    let places: Vec<PathBuf> = jobs.iter().flat_map(places).collect();
    let beside = [&args.report, &args.preview].into_iter().flatten();
    let outputs: Vec<&Path> = places.iter().chain(beside).map(PathBuf::as_path).collect();
    output::check_distinct(&outputs)?;
    if !args.overwrite {
        let there = |file: &&PathBuf| std::fs::symlink_metadata(file).is_ok();
        if let Some(file) = places.iter().find(there) {
            return Err(Failure(format!(
                "{}: is there already; give another folder, or `--overwrite`",
                file.display()
            )));
        }
    }
    Ok(())
}

/// The files that a tree's levels may become.
fn places(job: &Job<'_>) -> Vec<PathBuf> {
    let level = |k| job.place.join(format!("{}_LOD{k}.glb", job.name));
    match job.layout {
        Layout::Files => (0..secateur_scene::chain::MAX_LEVELS).map(level).collect(),
        _ => vec![job.place.clone()],
    }
}

/// All files that may come of a tree.
fn outputs(args: &args::Lods, job: &Job<'_>) -> Vec<PathBuf> {
    let mut outputs = places(job);
    outputs.extend([&args.report, &args.preview].into_iter().flatten().cloned());
    outputs
}

fn options(args: &args::Lods) -> ChainOptions {
    let wanted = match (&args.levels[..], &args.triangles[..], &args.distances) {
        (.., Some(distances)) => Wanted::Distances(distances.0.clone()),
        ([], [], None) => {
            let screen = args.screen_height / HEIGHTS_PX[0];
            Wanted::Heights(HEIGHTS_PX.map(|height| height * screen).to_vec())
        }
        ([], counts, _) => Wanted::Triangles(counts.iter().map(|n| Amount::Count(*n)).collect()),
        (shares, ..) => Wanted::Triangles(shares.iter().map(|r| Amount::Share(*r)).collect()),
    };
    let mut leaves = Options::with_preset(args.preset.into(), Target::triangle_share(1.0));
    leaves.alpha = args.alpha.into();
    leaves.sides = args.sides.into();
    leaves.engine = args.engine.into();
    leaves.audit = false;
    let impostor = match (args.impostor, &wanted) {
        (Some(name), _) => name.into(),
        (None, Wanted::Triangles(_)) => Choice::None,
        (None, _) => Choice::Auto,
    };
    ChainOptions {
        wanted,
        impostor,
        shadow_steps: usize::from(args.shadow_steps),
        max_pop: args.max_pop,
        textures: args.textures.into(),
        screen: Screen {
            height_px: args.screen_height,
            field_of_view_degrees: args.fov,
        },
        max_flip: args.max_flip,
        leaves,
    }
}

fn make(
    args: &args::Lods,
    common: &Common,
    job: &Job<'_>,
    surroundings: &Surroundings,
    staged: &mut StagedFiles,
) -> Result<Done, Failure> {
    let start = Instant::now();
    let mut options = options(args);
    surroundings.apply(&mut options.leaves);
    tracing::info!("reading {}", job.tree.display());
    let tree = WholeTree::open_within(job.tree, &args.foliage.foliage, args.memory.memory)?;
    let outputs = outputs(args, job);
    let outputs: Vec<&Path> = outputs.iter().map(PathBuf::as_path).collect();
    output::check_spares(tree.items().document(), &outputs)?;
    let warnings = tree.items().inspection().warnings.clone();
    super::simplify::warn_all(&warnings);
    interrupt::check()?;
    let triangle_views = tree.items().foliage().triangles().len() as u64 * 20;
    let engine = OpenEngine::open(options.leaves.engine, triangle_views)
        .map_err(|reason| Failure(reason.to_string()))?;
    let progress_bar = RunProgress::new(common);
    let made = chain(&tree, &options, &engine, &mut |progress| {
        progress_bar.show(progress)
    })
    .map_err(|error| Failure(about(job.tree, &error.to_string())))?;
    drop(progress_bar);

    interrupt::writing()?;
    if job.place != args.output {
        let made = staged.make_folder(&args.output);
        made.map_err(|e| Failure::of_file(&args.output, "cannot be made", &e))?;
    }
    let (written, files) = write(args, &tree, job, &made)?.into_files();
    staged.append(files);
    if let Some(file) = &args.preview {
        let page = preview(&tree, job, &options, &made)?;
        output::stage(staged, file, page.as_bytes())?;
    }
    let seconds = start.elapsed().as_secs_f64();
    let rows = rows(job, &made, &written);
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
        "max_flip": options.max_flip,
        "max_pop": options.max_pop,
        "textures": match options.textures {
            Textures::Fit => "fit",
            Textures::Keep => "keep",
        },
        "largest_pop": made.levels.iter().filter_map(|level| level.pop_flip).reduce(f64::max),
        "preset": options.leaves.preset,
        "engine": engine.name(),
        "adapter": engine.adapter(),
        "levels": rows,
        "order_sha256": made.levels.iter().rev().find_map(|level| level.order_sha256.clone()),
        "seconds": record::seconds(&[], seconds),
        "notes": made.notes.iter().chain(&written.notes).collect::<Vec<_>>(),
        "warnings": warnings,
    });
    let pretty = pretty(&tree, job, args, &made, &written, seconds);
    Ok(Done {
        record,
        rows,
        pretty,
    })
}

fn about(path: &Path, error: &str) -> String {
    let path = path.display().to_string();
    match error.starts_with(&path) {
        true => error.to_owned(),
        false => format!("{path}: {error}"),
    }
}

fn write(
    args: &args::Lods,
    tree: &WholeTree,
    job: &Job<'_>,
    made: &Chain,
) -> Result<PreparedChain, Failure> {
    let levels = made.levels.iter().enumerate();
    let levels: Vec<Level<'_>> = levels
        .map(|(k, level)| {
            let facts = facts(job, level);
            match &level.shape {
                Shape::Mesh(lod) => {
                    Level::new(&job.name, k, lod, facts).with_textures(&level.textures)
                }
                Shape::Impostor(made) => {
                    Level::of_surface(&job.name, k, &made.impostor.surface, facts)
                }
            }
        })
        .collect();
    let options = WriteOptions::default().overwrite(args.overwrite);
    Ok(tree
        .items()
        .prepare_chain(&job.name, &levels, job.layout, &job.place, options)?)
}

/// What the node of a level says in its extras.
fn facts(job: &Job<'_>, level: &ChainLevel) -> Map<String, Value> {
    let mut facts = Map::new();
    let mut say = |name: &str, value: Value| facts.insert(name.to_owned(), value);
    say("kind", kind(level).into());
    say("distance", level.distance.into());
    say("pixels_high", level.pixels_high.into());
    say("screen_coverage", level.screen_coverage.into());
    say("triangles", level.triangles().into());
    say("flip", level.flip_mean.into());
    say("shadow", format!("{}_LOD{}", job.name, level.shadow).into());
    if let Some(pop) = level.pop_flip {
        say("pop_flip", pop.into());
    }
    if let Some(sha256) = &level.order_sha256 {
        say("order_sha256", sha256.clone().into());
    }
    if let Shape::Impostor(made) = &level.shape {
        say("impostor", made.impostor.facts());
    }
    facts
}

fn kind(level: &ChainLevel) -> &'static str {
    match level.shape {
        Shape::Mesh(_) => "mesh",
        Shape::Impostor(_) => "impostor",
    }
}

fn layout_name(layout: Layout) -> &'static str {
    match layout {
        Layout::Siblings => "siblings",
        Layout::Msft => "msft",
        _ => "files",
    }
}

fn rows(job: &Job<'_>, made: &Chain, written: &WrittenChain) -> Vec<Value> {
    let levels = made.levels.iter().enumerate();
    let row = |(k, level): (usize, &ChainLevel)| {
        let place = |k: usize| match job.layout {
            Layout::Files => json!({ "file": written.files[k].display().to_string() }),
            _ => json!({ "node": format!("{}_LOD{k}", job.name) }),
        };
        let mut figures = json!({
            "kind": kind(level),
            "shadow": place(level.shadow),
            "pop_flip": level.pop_flip,
            "leaves": level.leaves,
            "triangles": level.triangles(),
            "foliage_triangles": level.foliage_triangles,
            "wood_triangles": level.wood_triangles,
            "distance": level.distance,
            "pixels_high": level.pixels_high,
            "screen_coverage": level.screen_coverage,
            "flip_mean": level.flip_mean,
            "silhouette_iou": level.silhouette_iou,
            "vmi_error_percent": level.vmi_error_percent,
            "order_sha256": level.order_sha256,
            "textures": match level.textures.is_empty() {
                true => "keep",
                false => "fit",
            },
            "texture_bytes": level.texture_bytes,
            "coverage_as_drawn": level.as_drawn.map(|seen| seen.begin.coverage_over_truth),
            "coverage_as_drawn_at_end": level.as_drawn.map(|seen| seen.end.coverage_over_truth),
            "specks_as_drawn": level.as_drawn.map(|seen| seen.begin.specks_per_view),
        });
        if let Shape::Impostor(made) = &level.shape {
            let against = json!({
                "mesh_triangles": made.mesh_triangles,
                "mesh_flip_mean": made.mesh_flip_mean,
            });
            figures["impostor"] = record::joined(made.impostor.facts(), against);
        }
        record::joined(place(k), figures)
    };
    levels.map(row).collect()
}

/// The page, from the levels as a client would draw them.
fn preview(
    tree: &WholeTree,
    job: &Job<'_>,
    options: &ChainOptions,
    made: &Chain,
) -> Result<String, Failure> {
    let items = tree.items();
    let draw = |document: &Document, textures: &[LevelTexture]| {
        let drawn = document.drawn(Detail::NormalMaps, &[])?;
        let surfaces = drawn.into_iter().map(|mut drawn| {
            show(&mut drawn.surface, drawn.material, textures);
            (drawn.surface, drawn.is_foliage)
        });
        Ok::<_, GltfError>(surfaces.collect())
    };
    let original = items.document();
    let memory = original.memory();
    let mut surfaces: Vec<Vec<(Surface, bool)>> = vec![draw(original, &[])?];
    for level in &made.levels {
        let lod = match &level.shape {
            Shape::Mesh(lod) => lod,
            Shape::Impostor(made) => {
                surfaces.push(vec![(made.impostor.surface.clone(), true)]);
                continue;
            }
        };
        let bytes = items.lod_to_bytes(lod)?;
        let document =
            Document::from_bytes_within(original.name(), bytes, original.folder(), memory)?;
        surfaces.push(draw(&document, &level.textures)?);
    }
    let first = Facts {
        name: "original".to_owned(),
        leaves: Some(tree.leaves().leaves().len() as u64),
        triangles: items.foliage().triangles().len() as u64,
        foliage_triangles: tree.leaves().triangles().len() as u64,
        wood_triangles: tree.wood().triangles().len() as u64,
        distance: 0.0,
        pixels_high: None,
        flip_mean: None,
        silhouette_iou: None,
        pop_flip: None,
    };
    let rest = made.levels.iter().enumerate().map(|(k, level)| Facts {
        name: format!("LOD{k}"),
        leaves: matches!(level.shape, Shape::Mesh(_)).then_some(level.leaves),
        triangles: level.triangles(),
        foliage_triangles: level.foliage_triangles,
        wood_triangles: level.wood_triangles,
        distance: level.distance,
        pixels_high: Some(level.pixels_high),
        flip_mean: Some(level.flip_mean),
        silhouette_iou: level.silhouette_iou,
        pop_flip: level.pop_flip,
    });
    let facts: Vec<Facts> = std::iter::once(first).chain(rest).collect();
    let levels: Vec<Shown<'_>> = surfaces
        .iter()
        .zip(facts)
        .map(|(surfaces, facts)| Shown { surfaces, facts })
        .collect();
    let preview = Preview {
        title: &job.name,
        screen: options.screen,
        levels: &levels,
    };
    page(&preview).map_err(|error| Failure(about(job.tree, &error.to_string())))
}

fn pretty(
    tree: &WholeTree,
    job: &Job<'_>,
    args: &args::Lods,
    made: &Chain,
    written: &WrittenChain,
    seconds: f64,
) -> String {
    let heads = [
        "",
        "triangles",
        "leaves",
        "wood",
        "from",
        "pixels high",
        "FLIP",
        "covers",
        "textures",
    ];
    let mut rows = vec![heads.map(str::to_owned).to_vec()];
    rows.push(vec![
        "original".to_owned(),
        grouped(tree.items().foliage().triangles().len() as u64),
        grouped(tree.leaves().triangles().len() as u64),
        grouped(tree.wood().triangles().len() as u64),
        String::new(),
        String::new(),
        String::new(),
        String::new(),
        String::new(),
    ]);
    for (k, level) in made.levels.iter().enumerate() {
        rows.push(vec![
            format!("LOD{k}"),
            grouped(level.triangles()),
            grouped(level.foliage_triangles),
            grouped(level.wood_triangles),
            format!("{:.1} m", level.distance),
            format!("{:.0}", level.pixels_high),
            format!("{:.3}", level.flip_mean),
            level.as_drawn.map_or_else(String::new, |seen| {
                let [begin, end] = [seen.begin, seen.end].map(|shown| shown.coverage_over_truth);
                format!("{begin:.2} to {end:.2}")
            }),
            size(level.texture_bytes),
        ]);
    }
    let mut text = format!("{} -> {}\n", job.tree.display(), args.output.display());
    text += &columns(&rows);
    let mut say = |name: &str, what: String| text += &format!("  {name:<9}  {what}\n");
    for file in &written.files {
        say("wrote", file.display().to_string());
    }
    if let Some(file) = &args.preview {
        say("look", format!("open {} in a browser", file.display()));
    }
    say(
        "cost",
        format!("{seconds:.2} s, {} in all", size(written.bytes)),
    );
    for note in made.notes.iter().chain(&written.notes) {
        say("note", note.clone());
    }
    text
}
