//! `secateur stand`: a scene of many plants, each with the level that the cameras need.

use std::path::{Path, PathBuf};
use std::time::Instant;

use schemars::JsonSchema;
use secateur::stand::{CameraFigures, Stand, StandFigures, StandLevels, StandOptions};
use secateur::{LevelsOptions, StagedFiles};
use secateur_eval::Limits;
use secateur_levels::chain::LevelKind;
use serde::Serialize;

use super::advice;
use super::args::{self, Common};
use super::failure::Failure;
use super::print::Printed;
use super::progress_bar::RunProgress;
use super::record::Record;
use super::summary::{columns, grouped, size};
use super::{interrupt, output, picture};

/// A stand, and the level of each of its plants.
#[derive(Serialize, JsonSchema)]
pub(crate) struct StandRecord {
    /// The file of the scene.
    input: String,
    /// The files that were written.
    files: Vec<String>,
    /// The kinds of plants, and their levels.
    kinds: Vec<KindRecord>,
    /// Each plant of the scene.
    places: Vec<PlaceRecord>,
    /// The scene as it is.
    before: StandFigures,
    /// The scene as it is written, each plant as its level.
    after: StandFigures,
    /// How many times less it costs.
    cost_ratio: f64,
    cameras: Vec<CameraRecord>,
    /// What has to be said, a sentence each.
    notes: Vec<String>,
}

/// A kind of plants.
#[derive(Serialize, JsonSchema)]
struct KindRecord {
    name: String,
    /// How many plants of it there are, and how many of those a camera sees.
    plants: usize,
    seen_plants: usize,
    /// Its levels, finest first; the first is the plant itself.
    levels: Vec<KindLevelRecord>,
}

/// A level of a kind.
#[derive(Serialize, JsonSchema)]
struct KindLevelRecord {
    kind: LevelKind,
    /// How many plants show it.
    plants: usize,
    triangles: u64,
    /// Primitives that are drawn.
    draws: u64,
    gpu_bytes: u64,
    /// The largest height in pixels that it was made for; null for the plant itself.
    pixels_high: Option<f64>,
    /// How far it looks from the plant there.
    difference: f64,
}

/// A plant of a stand.
#[derive(Serialize, JsonSchema)]
struct PlaceRecord {
    /// What its node is called.
    name: String,
    /// The name of its kind.
    plant: String,
    /// The number of its level, from 0; null where no camera sees it.
    level: Option<usize>,
    /// The largest height in pixels at which a camera sees it; null where none does.
    pixels_high: Option<f64>,
    /// How many pixels of all pictures show it.
    seen_px: f64,
}

/// What a camera sees.
#[derive(Serialize, JsonSchema)]
struct CameraRecord {
    /// The pictures before and after.
    before: String,
    after: String,
    /// Mean FLIP between them over the whole picture.
    flip_mean: f64,
    /// The difference between them over the pixels of plants.
    difference: f64,
}

/// Gives each plant its level, and writes the scene.
pub(crate) fn run(args: &args::Stand, common: &Common) -> Result<Printed, Failure> {
    let start = Instant::now();
    output::check_folder(&args.output)?;
    tracing::info!("reading {}", args.scene.display());
    let stand = Stand::open(&args.scene, args.memory.memory)
        .map_err(|error| Failure::of_plant(&args.scene, error))?;
    let files = Files::of(args, stand.cameras.len());
    files.check(args)?;
    let mut stages = vec![("read", start.elapsed().as_secs_f64())];
    interrupt::check()?;
    let working = Instant::now();
    let progress_bar = RunProgress::new(common, &args.scene.display().to_string());
    let levels = stand
        .levels_watched(&options(args), &mut |progress| progress_bar.show(progress))
        .map_err(|error| Failure::of_plant(&args.scene, error))?;
    drop(progress_bar);
    stages.push(("levels", working.elapsed().as_secs_f64()));
    interrupt::writing()?;
    let mut staged = StagedFiles::new();
    let made = staged.make_folder(&args.output);
    made.map_err(|e| Failure::of_file(&args.output, "cannot be made", &e))?;
    output::stage(&mut staged, &files.scene, &levels.glb)?;
    for (camera, places) in levels.cameras.iter().zip(&files.pictures) {
        for (image, place) in [&camera.before.image, &camera.after.image]
            .iter()
            .zip(places)
        {
            output::stage(&mut staged, place, &picture::png_of(image)?)?;
        }
    }
    let record = record(args, &stand, &levels, &files);
    let pretty = pretty(&record);
    let record = Record::new("stand", record, &stages, start.elapsed().as_secs_f64()).to_value();
    output::stage(
        &mut staged,
        &files.record,
        format!("{record:#}\n").as_bytes(),
    )?;
    staged.commit()?;
    interrupt::written();
    Ok(Printed::single(pretty, record))
}

fn options(args: &args::Stand) -> StandOptions {
    let mut levels = LevelsOptions::default();
    levels.screen.height_px = f64::from(args.screen_height);
    levels.cost = args.cost;
    levels.impostor = args.impostor;
    levels.leaves.effort = args.effort;
    levels.leaves.engine = args.engine;
    levels.leaves.memory = args.memory.memory;
    let is_limited =
        args.max_flip.is_some() || args.triangles.is_some() || args.gpu_bytes.is_some();
    let usual = (!is_limited).then_some(Limits::GOOD.difference);
    StandOptions {
        levels,
        max_difference: args.max_difference.or(usual),
        max_flip: args.max_flip,
        triangles: args.triangles,
        gpu_bytes: args.gpu_bytes,
    }
}

/// Paths of all files that a stand is written to.
struct Files {
    scene: PathBuf,
    record: PathBuf,
    /// By camera, before and after.
    pictures: Vec<[PathBuf; 2]>,
}

impl Files {
    fn of(args: &args::Stand, cameras: usize) -> Self {
        let file = |name: String| args.output.join(name);
        let pictures =
            |k: usize| ["before", "after"].map(|when| file(format!("camera{k}_{when}.png")));
        Self {
            scene: file("stand.glb".to_owned()),
            record: file("stand.json".to_owned()),
            pictures: (0..cameras).map(pictures).collect(),
        }
    }

    fn all(&self) -> impl Iterator<Item = &Path> {
        let own = [&self.scene, &self.record].into_iter();
        own.chain(self.pictures.iter().flatten())
            .map(PathBuf::as_path)
    }

    fn check(&self, args: &args::Stand) -> Result<(), Failure> {
        for file in self.all() {
            if args.output.is_dir() {
                output::check_file(file, &[&args.scene])?;
            }
            if std::fs::symlink_metadata(file).is_ok() && !args.overwrite {
                return Err(Failure::input(format!(
                    "{}: is there already; give another folder, or `--overwrite`",
                    file.display()
                )));
            }
        }
        Ok(())
    }
}

fn record(args: &args::Stand, stand: &Stand, levels: &StandLevels, files: &Files) -> StandRecord {
    let shown = |path: &Path| path.display().to_string();
    let places = stand.places.iter().enumerate().map(|(k, place)| {
        let seen = levels.seen[k].iter().filter(|(px, _)| *px > 0.0);
        PlaceRecord {
            name: place.name.clone(),
            plant: stand.kinds[place.kind].name.clone(),
            level: levels.levels[k],
            pixels_high: seen.clone().map(|(_, high)| *high).reduce(f64::max),
            seen_px: seen.map(|(px, _)| px).sum(),
        }
    });
    let camera = |(found, [before, after]): (&CameraFigures, &[PathBuf; 2])| CameraRecord {
        before: shown(before),
        after: shown(after),
        flip_mean: found.difference.flip_mean,
        difference: found.difference.difference,
    };
    let mut notes = levels.notes.clone();
    for (kind, made) in stand.kinds.iter().zip(&levels.kinds) {
        let of_kind = advice::sentences(&made.notes);
        notes.extend(of_kind.iter().map(|note| format!("{}: {note}", kind.name)));
    }
    StandRecord {
        input: shown(&args.scene),
        files: files.all().map(shown).collect(),
        kinds: (0..stand.kinds.len())
            .map(|kind| kind_record(stand, levels, kind))
            .collect(),
        places: places.collect(),
        before: levels.before,
        after: levels.after,
        cost_ratio: levels.before.cost / levels.after.cost,
        cameras: levels
            .cameras
            .iter()
            .zip(&files.pictures)
            .map(camera)
            .collect(),
        notes,
    }
}

fn kind_record(stand: &Stand, levels: &StandLevels, kind: usize) -> KindRecord {
    let of_kind = stand.places.iter().zip(&levels.levels);
    let own: Vec<Option<usize>> = of_kind
        .filter(|(place, _)| place.kind == kind)
        .map(|(_, level)| *level)
        .collect();
    let level = |(number, level): (usize, &secateur::stand::KindLevel)| KindLevelRecord {
        kind: level.report.kind,
        plants: own.iter().filter(|own| **own == Some(number)).count(),
        triangles: level.parts.triangles,
        draws: level.parts.draws,
        gpu_bytes: level.parts.gpu_bytes,
        pixels_high: Some(level.report.pixels_high).filter(|px| px.is_finite()),
        difference: level.report.difference.difference,
    };
    KindRecord {
        name: stand.kinds[kind].name.clone(),
        plants: own.len(),
        seen_plants: own.iter().flatten().count(),
        levels: levels.kinds[kind]
            .levels
            .iter()
            .enumerate()
            .map(level)
            .collect(),
    }
}

fn pretty(record: &StandRecord) -> String {
    let mut rows = vec![["", "before", "after"].map(str::to_owned).to_vec()];
    let (before, after) = (&record.before, &record.after);
    let mut row = |name: &str, of: &dyn Fn(&StandFigures) -> String| {
        rows.push(vec![name.to_owned(), of(before), of(after)]);
    };
    row("plants", &|figures| grouped(figures.plants));
    row("triangles", &|figures| grouped(figures.triangles));
    row("draws", &|figures| grouped(figures.draws));
    row("file", &|figures| size(figures.bytes));
    row("on the GPU", &|figures| size(figures.gpu_bytes));
    row("cost", &|figures| grouped(figures.cost.round() as u64));
    let mut text = format!("{}\n{}", record.files[0], columns(&rows));
    text.push_str(&format!("  {:.1} times less\n", record.cost_ratio));
    let mut rows = vec![
        ["kind", "level", "pixels", "triangles", "plants"]
            .map(str::to_owned)
            .to_vec(),
    ];
    for kind in &record.kinds {
        for (number, level) in kind.levels.iter().enumerate() {
            rows.push(vec![
                kind.name.clone(),
                number.to_string(),
                level
                    .pixels_high
                    .map_or_else(|| "-".to_owned(), |px| format!("{px:.0}")),
                grouped(level.triangles),
                level.plants.to_string(),
            ]);
        }
    }
    text.push_str(&columns(&rows));
    for (k, camera) in record.cameras.iter().enumerate() {
        let (flip, difference) = (camera.flip_mean, camera.difference);
        text.push_str(&format!(
            "  camera {k}: FLIP {flip:.4}, difference {difference:.3}\n"
        ));
    }
    for note in &record.notes {
        text.push_str(&format!("  note: {note}\n"));
    }
    text
}
