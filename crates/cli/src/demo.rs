//! `secateur demo`: what a newcomer sees first.

use std::path::Path;

use schemars::JsonSchema;
use secateur::{
    Amount, LevelPlace, Levels, Opening, PlacedLevel, Plant, Preset, WriteOptions, plant_to_glb,
};
use secateur_gltf::WholeTree;
use secateur_gltf::chain::{Layout, WrittenChain};
use secateur_levels::chain::{Chain, ChainOptions, CostWeights, Shape, Wanted};
use secateur_levels::impostor::Choice;
use secateur_plant::{GrowOptions, Species, grow};
use serde::Serialize;
use serde_json::json;

use super::args::{self, Common};
use super::failure::Failure;
use super::lods;
use super::picture::{self, Exhibit};
use super::print::Printed;
use super::progress_bar::RunProgress;
use super::summary::grouped;
use super::work::Work;
use super::{advice, interrupt, output};

/// The levels, finest first, in per cent of all triangles.
const LEVELS_PERCENT: [u32; 3] = [50, 25, 10];

/// Grows an oak, makes a chain of it, and shows what became of it: on a sheet and on a page.
pub(crate) fn run(args: &args::Demo, common: &Common) -> Result<Printed, Failure> {
    let mut work = Work::on("demo");
    output::check_folder(&args.output)?;
    let growing = GrowOptions {
        leaves: args.leaves,
        seed: args.seed,
    };
    let plant = work.timed("grow", |_| {
        grow(Species::Oak, &growing).map_err(|e| Failure::input(e.to_string()))
    })?;
    let glb = plant_to_glb(&plant);
    let original = args.output.join("tree.glb");
    let name = original.display().to_string();
    let opening = Opening {
        memory: args.memory.memory,
        ..Opening::default()
    };
    let opened = Plant::from_bytes(&name, glb.clone(), &opening)?;
    interrupt::check()?;

    let options = chain_options(args);
    let progress_bar = RunProgress::new(common, "demo");
    let levels = work.timed("levels", |_| {
        Ok(opened.levels_watched(&options, &mut |p| progress_bar.show(p))?)
    })?;
    drop(progress_bar);
    let (tree, made) = (levels.tree(), &levels.chain);

    interrupt::writing()?;
    output::make_folder(&mut work.files, &args.output)?;
    output::stage_derived(&mut work.files, &original, &glb)?;
    let written = work.timed("write", |files| {
        let how = WriteOptions::default().overwrite(true);
        let prepared = levels.prepare(&args.output, Layout::Files, how)?;
        let (written, own) = prepared.into_files();
        files.append(own);
        Ok(written)
    })?;
    let sheet = args.output.join("contact-sheet.png");
    work.timed("picture", |files| {
        let exhibits = exhibits(tree, made)?;
        output::stage_derived(files, &sheet, &picture::sheet(&exhibits)?)
    })?;
    let page_file = args.output.join("preview.html");
    work.timed("preview", |files| {
        let page = levels.preview_html()?;
        output::stage_derived(files, &page_file, page.as_bytes())
    })?;
    let levels_made = rows(&levels, &written, (&original, glb.len()));
    let rows = levels_made.iter().map(|level| json!(level)).collect();
    let record = DemoRecord {
        species: Species::Oak.name(),
        levels: levels_made,
        picture: sheet.display().to_string(),
        preview: page_file.display().to_string(),
        preset: options.leaves.preset,
        engine: levels.engine,
        adapter: levels.adapter.clone(),
        order_sha256: made.coarsest_order_sha256(),
        seed: args.seed,
        notes: advice::sentences(&made.notes)
            .into_iter()
            .chain(written.notes.clone())
            .collect(),
    };
    let (record, total) = work.record(record);
    let report = args.output.join("report.json");
    work.finish(Some(&report), &record)?;
    let pretty = pretty(&levels, &sheet, total);
    Ok(Printed {
        rows,
        ..Printed::single(pretty, record)
    })
}

/// An oak that was grown, and levels of it.
#[derive(Serialize, JsonSchema)]
pub(crate) struct DemoRecord {
    species: &'static str,
    /// The oak itself, then its levels, finest first.
    levels: Vec<DemoLevel>,
    picture: String,
    preview: String,
    preset: Preset,
    /// Where leaves were drawn: `cpu` or `gpu`.
    engine: &'static str,
    adapter: Option<String>,
    order_sha256: Option<String>,
    seed: u64,
    /// What has to be said of the levels, a sentence each.
    notes: Vec<String>,
}

/// A level of the oak.
#[derive(Serialize, JsonSchema)]
struct DemoLevel {
    /// The share of all triangles that it has; `original` for the oak itself.
    level: String,
    #[serde(flatten)]
    placed: PlacedLevel,
}

fn chain_options(args: &args::Demo) -> ChainOptions {
    let share = |percent: u32| Amount::Share(f64::from(percent) / 100.0);
    let mut options = ChainOptions::default();
    options.leaves.engine = args.engine;
    ChainOptions {
        wanted: Wanted::Triangles(LEVELS_PERCENT.map(share).to_vec()),
        original: false,
        impostor: Some(Choice::None),
        ..options
    }
}

/// What a level is called on the sheet and on the terminal: the share of all triangles it has.
fn title(tree: &WholeTree, triangles: u64) -> String {
    let all = tree.items().foliage().triangles().len() as f64;
    format!("{:.0} %", 100.0 * triangles as f64 / all)
}

/// The plant and its meshes, for pictures.
pub(crate) fn exhibits(tree: &WholeTree, made: &Chain) -> Result<Vec<Exhibit>, Failure> {
    let words = |leaves: u64, triangles: u64| {
        let [leaves, triangles] = [leaves, triangles].map(grouped);
        format!("{leaves} leaves\n{triangles} triangles")
    };
    let items = tree.items();
    let original = items.document();
    let leaves = tree.leaves().leaves().len() as u64;
    let mut exhibits = vec![Exhibit {
        title: "original".to_owned(),
        subtitle: words(leaves, items.foliage().triangles().len() as u64),
        surfaces: picture::surfaces(original, &[])?,
    }];
    for level in &made.levels {
        if let Shape::Mesh(lod) = &level.shape {
            let document = items.lod_document(lod)?;
            exhibits.push(Exhibit {
                title: title(tree, level.triangles),
                subtitle: words(level.leaves, level.triangles),
                surfaces: picture::surfaces(&document, &[])?,
            });
        }
    }
    Ok(exhibits)
}

/// The record of each level, the original first.
fn rows(
    levels: &Levels,
    written: &WrittenChain,
    (original, bytes): (&Path, usize),
) -> Vec<DemoLevel> {
    let tree = levels.tree();
    let plant = levels.plant();
    let file = LevelPlace::File(original.display().to_string());
    let mut cost = plant.tree().document().cost();
    cost.bytes = bytes as u64;
    let first = DemoLevel {
        level: "original".to_owned(),
        placed: PlacedLevel::new(file, cost, plant.report(), CostWeights::default()),
    };
    let placed = levels.placed(Layout::Files, written).into_iter();
    let named = placed.map(|placed| DemoLevel {
        level: title(tree, placed.report.triangles),
        placed,
    });
    std::iter::once(first).chain(named).collect()
}

fn pretty(levels: &Levels, sheet: &Path, seconds: f64) -> String {
    let (tree, made) = (levels.tree(), &levels.chain);
    let rows = made.levels.iter();
    let named = rows.map(|level| (title(tree, level.triangles), &level.report));
    format!(
        "An oak, grown and made into a chain of levels in {seconds:.1} s, judged from views it was not simplified by:\n\n\
         {}\n\
         Triangles are those of leaves and of wood; the difference is what people see at the height on the screen from which a level is seen: up to .18 cannot be told, .28 is good.\n\
         Open preview.html in a browser, or see {}; the tree, its levels (tree_LOD0.glb ...) and report.json are there too.\n",
        lods::table(&lods::OF_DEMO, &levels.plant().report(), named),
        sheet.display(),
    )
}
