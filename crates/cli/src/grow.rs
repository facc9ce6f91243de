//! Runs `secateur grow`: grows a plant from a species or a rule file and writes it.

use std::path::Path;

use glam::DVec3;
use schemars::JsonSchema;
use secateur::{GrownPlant, plant_into_glb};
use secateur_plant::{BranchLevel, BranchLevelOptions, BranchMethod, RuleSource, RuleSourceError};
use serde::Serialize;
use sha2::{Digest, Sha256};

use super::args::{self, Common, Format};
use super::failure::Failure;
use super::interrupt;
use super::names::text;
use super::output::{self, Outputs};
use super::picture::{self, Exhibit};
use super::print::Printed;
use super::summary::{grouped, size};
use super::work::Work;

/// A plant that was grown.
#[derive(Serialize, JsonSchema)]
pub(crate) struct GrowRecord {
    /// The species, or the name of the rule file.
    species: String,
    /// The file that was written.
    output: String,
    bytes: usize,
    /// SHA-256 of the file.
    sha256: Option<String>,
    leaves: usize,
    triangles: SurfaceTriangles,
    size_m: Size,
    seed: u64,
    /// The level of detail, if one was asked for.
    lod: Option<GrownLodRecord>,
}

/// A level of detail by the plant's own branches.
#[derive(Serialize, JsonSchema)]
struct GrownLodRecord {
    /// How branches get coarser: `chain` or `merge`, as `--lod-method` has it.
    method: String,
    /// The number of the level, from 1.
    level: usize,
    /// How many there are.
    levels: usize,
    /// merge: sticks above this height over radius (HR) were replaced; null where all were that can
    /// be, or the threshold is a thickness.
    threshold: Option<f64>,
    /// merge: sticks thinner than this were replaced, in metres; null by HR.
    thickness_m: Option<f64>,
    /// merge: sticks that others stand for.
    sticks_replaced: Option<usize>,
    leaves_original: usize,
}

impl From<&BranchLevel> for GrownLodRecord {
    fn from(level: &BranchLevel) -> Self {
        Self {
            method: text(level.method),
            level: level.level,
            levels: level.levels,
            threshold: level.height_over_radius,
            thickness_m: level.thickness_m,
            sticks_replaced: level.sticks_replaced,
            leaves_original: level.leaves_original,
        }
    }
}

/// Triangles of a plant.
#[derive(Serialize, JsonSchema)]
struct SurfaceTriangles {
    leaves: usize,
    wood: usize,
}

/// Width, height and depth in metres.
#[derive(Serialize, JsonSchema)]
struct Size {
    x: f64,
    y: f64,
    z: f64,
}

/// Grows a plant, writes it, and reports what it is.
pub(crate) fn run(args: &args::Grow, common: &Common) -> Result<Printed, Failure> {
    let mut work = Work::on("grow");
    if args.thresholds.is_some() && args.lod_method != BranchMethod::Merge {
        return Err(Failure::usage("--thresholds is for --lod-method merge"));
    }
    let input = Path::new(&args.species);
    Outputs::beside([input])
        .and(&args.output, output::check_glb)?
        .maybe(args.report.as_ref(), output::check_file)?
        .maybe(args.picture.as_ref(), output::check_picture)?
        .distinct()?;
    let source = RuleSource::named(&args.species)?;
    let name = source.name();
    let (plant, lod) = work.timed("grow", |_| {
        tracing::info!("growing {name}");
        grown(&source, args)
    })?;
    let size_m = extent_m(&plant);
    let leaf_count = plant.triangles_per_leaf.len();
    let triangles = [&plant.leaves, &plant.wood].map(|surface| surface.triangles.len());
    let title = plant.name.clone();
    interrupt::writing()?;
    if let Some(path) = &args.picture {
        work.timed("picture", |files| {
            let sheet = picture::sheet(&[exhibit(&plant)])?;
            output::stage(files, path, &sheet)
        })?;
    }
    let bytes = work.timed("write", |files| {
        tracing::info!("writing {}", args.output.display());
        let glb = plant_into_glb(plant);
        output::stage(files, &args.output, &glb)?;
        Ok(glb)
    })?;
    // A second for a large file, so only where someone will see it.
    let is_recorded = args.report.is_some() || common.format != Format::Pretty;
    let record = GrowRecord {
        species: name.to_owned(),
        output: args.output.display().to_string(),
        bytes: bytes.len(),
        sha256: is_recorded.then(|| sha256(&bytes)),
        leaves: leaf_count,
        triangles: SurfaceTriangles {
            leaves: triangles[0],
            wood: triangles[1],
        },
        size_m: Size {
            x: size_m.x,
            y: size_m.y,
            z: size_m.z,
        },
        seed: args.seed,
        lod: lod.as_ref().map(GrownLodRecord::from),
    };
    let (record, _) = work.record(record);
    let growing = work.stages.iter().filter(|(stage, _)| *stage != "picture");
    let seconds: f64 = growing.map(|(_, seconds)| seconds).sum();
    let of_lod = lod.as_ref().map_or_else(String::new, called);
    let pretty = format!(
        "{of_lod}{} with {} leaves, {:.1} m high, grown and written in {seconds:.2} s\n  \
         triangles  {} of leaves, {} of wood\n  \
         file       {}, {}\n",
        title,
        grouped(leaf_count as u64),
        size_m.y,
        grouped(triangles[0] as u64),
        grouped(triangles[1] as u64),
        args.output.display(),
        size(bytes.len() as u64),
    );
    work.finish(args.report.as_deref(), &record)?;
    Ok(Printed::single(pretty, record))
}

fn grown(
    source: &RuleSource,
    args: &args::Grow,
) -> Result<(GrownPlant, Option<BranchLevel>), Failure> {
    let Some(amount) = args.lod else {
        return Ok((source.grow(args.leaves, args.seed)?, None));
    };
    let options = BranchLevelOptions {
        amount,
        method: args.lod_method,
        scheme: args.scheme.clone(),
        thresholds: args.thresholds.clone(),
        cluster_size: args.cluster_size,
    };
    let (plant, level) = source.grow_level(args.leaves, args.seed, &options)?;
    Ok((plant, Some(level)))
}

/// What a level of detail is called.
fn called(level: &BranchLevel) -> String {
    let BranchLevel {
        level,
        levels,
        method,
        ..
    } = level;
    match method {
        BranchMethod::Chain => format!("{level} of {levels} levels of its chain of "),
        BranchMethod::Merge => format!("level {level} of {levels} by merging of "),
    }
}

impl From<RuleSourceError> for Failure {
    fn from(error: RuleSourceError) -> Self {
        match &error {
            RuleSourceError::Read { file, source } => Self::of_file(file, "cannot be read", source),
            _ => Self::input(error.to_string()),
        }
    }
}

fn exhibit(plant: &GrownPlant) -> Exhibit {
    let [leaves, triangles] = [
        plant.triangles_per_leaf.len(),
        plant.leaves.triangles.len() + plant.wood.triangles.len(),
    ]
    .map(|count| grouped(count as u64));
    Exhibit {
        title: plant.name.clone(),
        subtitle: format!("{leaves} leaves\n{triangles} triangles"),
        surfaces: vec![plant.wood.clone(), plant.leaves.clone()],
    }
}

/// Width, height and depth.
fn extent_m(plant: &GrownPlant) -> DVec3 {
    let mut positions = plant.wood.positions.iter().chain(&plant.leaves.positions);
    let Some(&first) = positions.next() else {
        return DVec3::ZERO;
    };
    let (low, high) = positions.fold((first, first), |(low, high), &p| (low.min(p), high.max(p)));
    high - low
}

fn sha256(bytes: &[u8]) -> String {
    secateur_model::hex(&Sha256::digest(bytes))
}
