//! `secateur demo`: what a newcomer sees first.

use std::path::{Path, PathBuf};
use std::time::Instant;

use secateur::{
    Document, Measurement, Method, Options, PreparedLod, Preset, Simplified, StagedFiles, Target,
    Tree, WriteOptions, plant_to_glb,
};
use secateur_gltf::Detail;
use secateur_plant::{GrowOptions, Species, grow};
use secateur_scene::Screen;
use secateur_scene::preview::{Facts, Level as Shown, Preview, page};
use serde_json::{Value, json};

use super::args::{self, Common};
use super::failure::Failure;
use super::picture::{self, Exhibit};
use super::print::Printed;
use super::progress_bar::RunProgress;
use super::simplify::{sentences, timed, warn_all};
use super::summary::{columns, grouped, percent, size};
use super::{interrupt, machine, output, record};

/// The LODs, finest first, in per cent of the leaves.
const LEVELS_PERCENT: [u32; 3] = [50, 25, 10];

/// A LOD that is written, but for its name.
struct Level {
    percent: u32,
    leaves: usize,
    prepared: PreparedLod,
    measured: Measurement,
}

/// Grows, simplifies to every level, and writes each. The levels are of one removal order; sizes
/// are fitted at each of them.
pub(crate) fn run(args: &args::Demo, common: &Common) -> Result<Printed, Failure> {
    let start = Instant::now();
    output::check_folder(&args.output)?;
    let mut stages = Vec::new();
    let growing = GrowOptions {
        leaves: args.leaves,
        seed: args.seed,
    };
    let plant = timed(&mut stages, "grow", || {
        grow(Species::Oak, &growing).map_err(|e| Failure(e.to_string()))
    })?;
    let glb = plant_to_glb(&plant);
    let original = args.output.join("tree.glb");
    let name = original.display().to_string();
    let memory = args.memory.memory;
    let tree = Document::from_bytes_within(&name, glb.clone(), None, memory)?.into_tree(&[])?;
    interrupt::check()?;

    let mut results = Vec::new();
    for percent in LEVELS_PERCENT {
        let mut options = Options::to(Target::leaves(leaves_at(&tree, percent) as u64));
        options.engine = args.engine.into();
        options.memory = tree.memory_left();
        let progress_bar = RunProgress::new(common);
        let result =
            secateur::simplify_with(tree.foliage(), &options, &mut |p| progress_bar.show(p))?;
        warn_all(&sentences(&result));
        results.push(result);
    }
    stages.extend(summed(&results));

    interrupt::writing()?;
    // All files are written before the first appears: what fails leaves nothing.
    let mut staged = StagedFiles::new();
    let made = staged.make_folder(&args.output);
    made.map_err(|e| Failure::of_file(&args.output, "cannot be made", &e))?;
    output::stage(&mut staged, &original, &glb)?;
    let levels = prepare_levels(&mut stages, &args.output, &tree, &results)?;
    let sheet = args.output.join("contact-sheet.png");
    timed(&mut stages, "picture", || {
        let exhibits = exhibits(&tree, &levels)?;
        output::stage(&mut staged, &sheet, &picture::sheet(&exhibits)?)
    })?;
    let page_file = args.output.join("preview.html");
    timed(&mut stages, "preview", || {
        output::stage(&mut staged, &page_file, preview(&tree, &levels)?.as_bytes())
    })?;
    let total = start.elapsed().as_secs_f64();
    let rows = rows(&tree, &levels, glb.len() as u64);
    let result = &results[results.len() - 1];
    let record = json!({
        "species": Species::Oak.name(),
        "levels": rows,
        "picture": sheet.display().to_string(),
        "preview": page_file.display().to_string(),
        "method": Method::Vds(Preset::default().vds()).name(),
        "preset": Preset::default().name(),
        "engine": result.engine,
        "adapter": result.adapter,
        "order_sha256": result.passes.in_one_order().sha256(),
        "areas_sha256": result.areas.sha256(),
        "resolution": result.resolution,
        "resolution_reason": result.resolution_reason,
        "seed": args.seed,
        "audit": result.audited_by,
        "seconds": record::seconds(&stages, total),
        "peak_rss_bytes": machine::peak_rss_bytes(),
        "run": record::provenance("demo"),
    });
    let report = args.output.join("report.json");
    record::stage(&mut staged, Some(&report), &record)?;
    let pretty = pretty(&tree, &levels, &sheet, glb.len() as u64, total);
    for level in levels {
        staged.append(level.prepared.into_files().1);
    }
    staged.commit()?;
    Ok(Printed {
        pretty,
        record,
        rows,
    })
}

fn leaves_at(tree: &Tree, percent: u32) -> usize {
    let count = tree.foliage().leaves().len();
    (count as f64 * f64::from(percent) / 100.0).round() as usize
}

/// The stages of all runs, each with its time over all of them.
fn summed(results: &[Simplified]) -> Vec<(&'static str, f64)> {
    let mut stages: Vec<(&'static str, f64)> = Vec::new();
    for (stage, seconds) in results.iter().flat_map(|result| &result.seconds) {
        let name = stage.name();
        match stages.iter_mut().find(|(known, _)| *known == name) {
            Some((_, sum)) => *sum += seconds,
            None => stages.push((name, *seconds)),
        }
    }
    stages
}

fn prepare_levels(
    stages: &mut Vec<(&'static str, f64)>,
    folder: &Path,
    tree: &Tree,
    results: &[Simplified],
) -> Result<Vec<Level>, Failure> {
    let mut levels = Vec::new();
    let mut seconds = [0.0; 2];
    for (percent, result) in LEVELS_PERCENT.into_iter().zip(results) {
        let leaves = result.lod.leaf_count();
        let path: PathBuf = folder.join(format!("tree-{percent:02}.glb"));
        let start = Instant::now();
        let prepared = tree.prepare_lod(&result.lod, &path, WriteOptions::default())?;
        seconds[0] += start.elapsed().as_secs_f64();
        let start = Instant::now();
        let again = prepared.document()?.into_tree(&[])?;
        let measured = secateur::measure(tree.foliage(), again.foliage())?;
        seconds[1] += start.elapsed().as_secs_f64();
        levels.push(Level {
            percent,
            leaves,
            prepared,
            measured,
        });
    }
    stages.extend([("write", seconds[0]), ("measure", seconds[1])]);
    Ok(levels)
}

/// A page to look at the levels. From how far off each is seen was not judged: each is taken to be
/// for half the height on the screen of the one before.
fn preview(tree: &Tree, levels: &[Level]) -> Result<String, Failure> {
    let screen = Screen::default();
    let corners = tree.foliage().triangles().iter().flat_map(|t| t.corners);
    let top = corners.map(|corner| corner.y).fold(0.0, f64::max);
    let mut surfaces = vec![tree.document().surfaces_with(Detail::NormalMaps, &[])?];
    let wood = tree.wood_triangle_count();
    let mut facts = vec![Facts {
        name: "original".to_owned(),
        leaves: Some(tree.foliage().leaves().len() as u64),
        triangles: tree.triangle_count(),
        foliage_triangles: tree.leaf_triangle_count(),
        wood_triangles: wood,
        distance: 0.0,
        pixels_high: None,
        flip_mean: None,
        silhouette_iou: None,
        pop_flip: None,
    }];
    let mut pixels_high = screen.height_px;
    for level in levels {
        let document = level.prepared.document()?;
        surfaces.push(document.surfaces_with(Detail::NormalMaps, &[])?);
        facts.push(Facts {
            name: format!("{} %", level.percent),
            leaves: Some(level.leaves as u64),
            triangles: level.prepared.written().triangles,
            foliage_triangles: level.prepared.written().triangles.saturating_sub(wood),
            wood_triangles: wood,
            distance: screen.distance(top, pixels_high),
            pixels_high: Some(pixels_high),
            flip_mean: None,
            silhouette_iou: Some(level.measured.silhouette_iou()),
            pop_flip: None,
        });
        pixels_high /= 2.0;
    }
    let levels = surfaces.iter().zip(facts);
    let levels: Vec<Shown<'_>> = levels
        .map(|(surfaces, facts)| Shown { surfaces, facts })
        .collect();
    let preview = Preview {
        title: "oak",
        screen,
        levels: &levels,
    };
    page(&preview).map_err(|error| Failure(error.to_string()))
}

fn exhibits(tree: &Tree, levels: &[Level]) -> Result<Vec<Exhibit>, Failure> {
    let words = |leaves: usize, triangles: u64| {
        let [leaves, triangles] = [leaves as u64, triangles].map(grouped);
        format!("{leaves} leaves\n{triangles} triangles")
    };
    let mut exhibits = vec![Exhibit {
        title: "original".to_owned(),
        subtitle: words(tree.foliage().leaves().len(), tree.triangle_count()),
        surfaces: picture::surfaces(tree.document(), &[])?,
    }];
    for level in levels {
        let document = level.prepared.document()?;
        exhibits.push(Exhibit {
            title: format!("{} %", level.percent),
            subtitle: words(level.leaves, level.prepared.written().triangles),
            surfaces: picture::surfaces(&document, &[])?,
        });
    }
    Ok(exhibits)
}

fn rows(tree: &Tree, levels: &[Level], original_bytes: u64) -> Vec<Value> {
    let original = json!({
        "level": "original",
        "leaves": tree.foliage().leaves().len(),
        "triangles": tree.triangle_count(),
        "bytes": original_bytes,
    });
    let rows = levels.iter().map(|level| {
        let about = json!({
            "level": format!("{} %", level.percent),
            "file": level.prepared.written().files[0].display().to_string(),
            "leaves": level.leaves,
            "triangles": level.prepared.written().triangles,
            "bytes": level.prepared.written().bytes,
        });
        record::joined(about, record::overall(&level.measured))
    });
    std::iter::once(original).chain(rows).collect()
}

fn pretty(
    tree: &Tree,
    levels: &[Level],
    sheet: &Path,
    original_bytes: u64,
    seconds: f64,
) -> String {
    let heads = [
        "",
        "leaves",
        "triangles",
        "VMI error",
        "outline IoU",
        "coverage",
        "file",
    ];
    let mut rows = vec![heads.map(str::to_owned).to_vec()];
    let [leaves, triangles] =
        [tree.foliage().leaves().len() as u64, tree.triangle_count()].map(grouped);
    let none = || "-".to_owned();
    rows.push(vec![
        "original".to_owned(),
        leaves,
        triangles,
        none(),
        none(),
        none(),
        size(original_bytes),
    ]);
    for level in levels {
        let measured = &level.measured;
        rows.push(vec![
            format!("{} %", level.percent),
            grouped(level.leaves as u64),
            grouped(level.prepared.written().triangles),
            percent(measured.vmi_error_percent()),
            format!("{:.3}", measured.silhouette_iou()),
            format!("{:.3}", measured.coverage_ratio()),
            size(level.prepared.written().bytes),
        ]);
    }
    format!(
        "An oak, grown and simplified in {seconds:.1} s, judged from views it was not simplified by:\n\n\
         {}\n\
         See {}, and open preview.html beside it in a browser; the trees and report.json are there too.\n",
        columns(&rows),
        sheet.display(),
    )
}
