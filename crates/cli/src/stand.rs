//! `secateur stand`: a scene of many plants, each with the level that the cameras need.

use std::path::{Path, PathBuf};

use schemars::JsonSchema;
use secateur::LevelsOptions;
use secateur::stand::{CameraFigures, Stand, StandFigures, StandLevels, StandOptions, StandReport};
use secateur_eval::Limits;
use serde::Serialize;

use super::advice;
use super::args::{self, Common};
use super::failure::Failure;
use super::print::Printed;
use super::progress_bar::RunProgress;
use super::record::shown;
use super::summary::{columns, grouped, size};
use super::work::Work;
use super::{interrupt, output, picture};

/// A stand, and the level of each of its plants.
#[derive(Serialize, JsonSchema)]
pub(crate) struct StandRecord {
    /// The file of the scene.
    input: String,
    /// The files that were written.
    files: Vec<String>,
    #[serde(flatten)]
    report: StandReport,
    cameras: Vec<CameraRecord>,
    /// What has to be said, a sentence each.
    notes: Vec<String>,
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
    let mut work = Work::on("stand");
    output::check_folder(&args.output)?;
    tracing::info!("reading {}", args.scene.display());
    let of_scene = |error| Failure::of_plant(&args.scene, error);
    let stand = work.timed("read", |_| {
        Stand::open(&args.scene, args.memory.memory).map_err(of_scene)
    })?;
    let files = Files::of(args, stand.cameras.len());
    files.check(args)?;
    interrupt::check()?;
    let progress_bar = RunProgress::new(common, &args.scene.display().to_string());
    let levels = work.timed("levels", |_| {
        let levels =
            stand.levels_watched(&options(args), &mut |progress| progress_bar.show(progress));
        levels.map_err(of_scene)
    })?;
    drop(progress_bar);
    interrupt::writing()?;
    output::make_folder(&mut work.files, &args.output)?;
    output::stage(&mut work.files, &files.scene, &levels.glb)?;
    for (camera, places) in levels.cameras.iter().zip(&files.pictures) {
        for (shown, place) in [&camera.before, &camera.after].iter().zip(places) {
            output::stage(&mut work.files, place, &picture::png_of(&shown.image)?)?;
        }
    }
    let record = record(args, &stand, &levels, &files);
    let pretty = pretty(&record);
    let (record, _) = work.record(record);
    work.finish(Some(&files.record), &record)?;
    Ok(Printed::single(pretty, record))
}

fn options(args: &args::Stand) -> StandOptions {
    let mut levels = LevelsOptions::default();
    levels.screen.height_px = f64::from(args.screen_height);
    levels.cost = args.cost;
    levels.impostor = Some(args.impostor);
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
    let camera = |(found, [before, after]): (&CameraFigures, &[PathBuf; 2])| CameraRecord {
        before: before.display().to_string(),
        after: after.display().to_string(),
        flip_mean: found.difference.flip_mean,
        difference: found.difference.difference,
    };
    let mut notes = levels.notes.clone();
    for (kind, made) in stand.kinds.iter().zip(&levels.kinds) {
        let of_kind = advice::sentences(&made.notes);
        notes.extend(of_kind.iter().map(|note| format!("{}: {note}", kind.name)));
    }
    let cameras = levels.cameras.iter().zip(&files.pictures);
    StandRecord {
        input: args.scene.display().to_string(),
        files: shown(files.all()),
        report: levels.report(stand),
        cameras: cameras.map(camera).collect(),
        notes,
    }
}

fn pretty(record: &StandRecord) -> String {
    let mut rows = vec![["", "before", "after"].map(str::to_owned).to_vec()];
    let report = &record.report;
    let (before, after) = (&report.before, &report.after);
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
    text.push_str(&format!("  {:.1} times less\n", report.cost_ratio));
    let mut rows = vec![
        ["kind", "level", "pixels", "triangles", "plants"]
            .map(str::to_owned)
            .to_vec(),
    ];
    for kind in &report.kinds {
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
