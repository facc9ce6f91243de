//! Runs `secateur grow`: grows a plant from a species or a rule file and writes it.

use std::borrow::Cow;
use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};
use std::time::Instant;

use glam::DVec3;
use schemars::JsonSchema;
use secateur::{GrownPlant, StagedFiles, plant_into_glb};
use secateur_plant::{
    GrowError, Rules, Species, UnknownSpecies, grow_rules, plant_of, rules_skeleton,
};
use serde::Serialize;
use sha2::{Digest, Sha256};

use super::args::{self, Common, Format};
use super::failure::Failure;
use super::grow_lod::GrownLodRecord;
use super::picture::{self, Exhibit};
use super::print::Printed;
use super::record::Record;
use super::simplify::timed;
use super::summary::{grouped, size};
use super::{grow_lod, interrupt, output, record};

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
    let start = Instant::now();
    check_outputs(args)?;
    let mut stages = Vec::new();
    let source = RuleSource::of(args)?;
    let name = &source.name;
    let (plant, lod) = timed(&mut stages, "grow", || {
        tracing::info!("growing {name}");
        grown(&source, args)
    })?;
    let size_m = extent_m(&plant);
    let leaf_count = plant.triangles_per_leaf.len();
    let triangles = [&plant.leaves, &plant.wood].map(|surface| surface.triangles.len());
    let title = plant.name.clone();
    interrupt::writing()?;
    // All files are written before the first appears: what fails leaves nothing.
    let mut staged = StagedFiles::new();
    if let Some(path) = &args.picture {
        timed(&mut stages, "picture", || {
            let sheet = picture::sheet(&[exhibit(&plant)])?;
            output::stage(&mut staged, path, &sheet)
        })?;
    }
    let bytes = timed(&mut stages, "write", || {
        tracing::info!("writing {}", args.output.display());
        let glb = plant_into_glb(plant);
        output::stage(&mut staged, &args.output, &glb)?;
        Ok(glb)
    })?;
    // A second for a large file, so only where someone will see it.
    let is_recorded = args.report.is_some() || common.format != Format::Pretty;
    let total = start.elapsed().as_secs_f64();
    let record = GrowRecord {
        species: name.clone(),
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
        lod: lod.as_ref().map(|(_, record)| record.clone()),
    };
    let record = Record::new("grow", record, &stages, total).to_value();
    record::stage(&mut staged, args.report.as_deref(), &record)?;
    staged.commit()?;
    let growing = stages.iter().filter(|(stage, _)| *stage != "picture");
    let seconds: f64 = growing.map(|(_, seconds)| seconds).sum();
    let of_lod = lod.map_or_else(String::new, |(name, _)| format!("{name} of "));
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
    Ok(Printed::single(pretty, record))
}

/// What a level of detail is called, and its record.
type Lod = (String, GrownLodRecord);

fn grown(source: &RuleSource, args: &args::Grow) -> Result<(GrownPlant, Option<Lod>), Failure> {
    let (rules, name) = (&*source.rules, &*source.name);
    let (leaves, seed) = (args.leaves, args.seed);
    let Some(amount) = args.lod else {
        let plant = grow_rules(rules, name, leaves, seed);
        return Ok((plant.map_err(|e| source.failure(e))?, None));
    };
    let skeleton = rules_skeleton(rules, name, leaves, seed).map_err(|e| source.failure(e))?;
    let level = grow_lod::level(name, &skeleton, amount, args)?;
    let plant = plant_of(level.skeleton, rules, name, seed).map_err(|e| source.failure(e))?;
    Ok((plant, Some((level.name, level.record))))
}

fn check_outputs(args: &args::Grow) -> Result<(), Failure> {
    let inputs = [Path::new(&args.species)];
    output::check_glb(&args.output, &inputs)?;
    let mut outputs = vec![args.output.as_path()];
    if let Some(file) = &args.report {
        output::check_file(file, &inputs)?;
        outputs.push(file);
    }
    if let Some(file) = &args.picture {
        output::check_picture(file, &inputs)?;
        outputs.push(file);
    }
    output::check_distinct(&outputs)
}

/// Rules and what they are called.
struct RuleSource {
    name: String,
    rules: Cow<'static, Rules>,
    /// The user's own file.
    file: Option<PathBuf>,
}

impl RuleSource {
    /// A species, or else a file: what ends in .lsys or has a folder in its name.
    fn of(args: &args::Grow) -> Result<Self, Failure> {
        let path = Path::new(&args.species);
        let is_file =
            path.extension().is_some_and(|e| e == "lsys") || path.components().count() > 1;
        if !is_file {
            let species: Species = args.species.parse().map_err(|e: UnknownSpecies| {
                Failure::input(format!("{e}; a rule file of your own ends in .lsys"))
            })?;
            return Ok(Self {
                name: species.name().to_owned(),
                rules: Cow::Borrowed(species.rules()),
                file: None,
            });
        }
        let text = read_text(path)?;
        let rules = Rules::parse(&text)
            .map_err(|error| Failure::input(format!("{}: {error}", path.display())))?;
        let name = path.file_stem().unwrap_or_default().to_string_lossy();
        Ok(Self {
            name: name.into_owned(),
            rules: Cow::Owned(rules),
            file: Some(path.to_owned()),
        })
    }

    fn failure(&self, error: GrowError) -> Failure {
        match (&self.file, error) {
            (Some(path), GrowError::Rules { source, .. }) => {
                Failure::input(format!("{}: {source}", path.display()))
            }
            (_, error) => Failure::input(error.to_string()),
        }
    }
}

/// The text of a rule file, of which no more is read than can be one.
fn read_text(path: &Path) -> Result<String, Failure> {
    let read = || {
        let mut bytes = Vec::new();
        let file = File::open(path)?;
        file.take(Rules::MAX_BYTES as u64 + 1)
            .read_to_end(&mut bytes)?;
        Ok(bytes)
    };
    let bytes = read().map_err(|e: std::io::Error| Failure::of_file(path, "cannot be read", &e))?;
    if bytes.len() > Rules::MAX_BYTES {
        let most = Rules::MAX_BYTES;
        return Err(Failure::input(format!(
            "{}: a rule file has at most {most} bytes",
            path.display()
        )));
    }
    String::from_utf8(bytes)
        .map_err(|_| Failure::input(format!("{}: the rules are not UTF-8 text", path.display())))
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
