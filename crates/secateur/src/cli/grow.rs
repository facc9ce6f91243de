//! `secateur grow`.

use std::time::Instant;

use glam::DVec3;
use secateur::plant::{GrowOptions, Species, UnknownSpecies, grow};
use secateur::{Plant, plant_to_glb};
use serde_json::json;
use sha2::{Digest, Sha256};

use super::args;
use super::failure::Failure;
use super::picture::{self, Exhibit};
use super::print::Printed;
use super::simplify::timed;
use super::summary::{grouped, size};
use super::{interrupt, machine, output, record};

/// Grows, writes, reports.
pub(crate) fn run(args: &args::Grow) -> Result<Printed, Failure> {
    let start = Instant::now();
    check_outputs(args)?;
    let species: Species = args
        .species
        .parse()
        .map_err(|e: UnknownSpecies| Failure(e.to_string()))?;
    let options = GrowOptions {
        leaves: leaves(args, species)?,
        seed: args.seed,
    };
    let mut stages = Vec::new();
    let plant = timed(&mut stages, "grow", || {
        tracing::info!("growing {species}");
        grow(species, &options).map_err(|e| Failure(e.to_string()))
    })?;
    interrupt::writing()?;
    let bytes = timed(&mut stages, "write", || {
        tracing::info!("writing {}", args.output.display());
        let glb = plant_to_glb(&plant);
        output::write_file(&args.output, &glb)?;
        Ok(glb)
    })?;
    if let Some(path) = &args.picture {
        timed(&mut stages, "picture", || {
            output::write_file(path, &picture::sheet(&[exhibit(&plant)])?)
        })?;
    }
    let size_m = extent_m(&plant);
    let total = start.elapsed().as_secs_f64();
    let record = json!({
        "species": species.name(),
        "output": args.output.display().to_string(),
        "bytes": bytes.len(),
        "sha256": sha256(&bytes),
        "leaves": plant.triangles_per_leaf.len(),
        "triangles": {
            "leaves": plant.leaves.triangles.len(),
            "wood": plant.wood.triangles.len(),
        },
        "size_m": { "x": size_m.x, "y": size_m.y, "z": size_m.z },
        "seed": args.seed,
        "seconds": record::seconds(&stages, total),
        "peak_rss_bytes": machine::peak_rss_bytes(),
        "run": record::provenance("grow"),
    });
    record::write(args.report.as_deref(), &record)?;
    let pretty = format!(
        "{} with {} leaves, {:.1} m high, grown in {total:.2} s\n  \
         triangles  {} of leaves, {} of wood\n  \
         file       {}, {}\n",
        plant.name,
        grouped(plant.triangles_per_leaf.len() as u64),
        size_m.y,
        grouped(plant.leaves.triangles.len() as u64),
        grouped(plant.wood.triangles.len() as u64),
        args.output.display(),
        size(bytes.len() as u64),
    );
    Ok(Printed::single(pretty, record))
}

fn check_outputs(args: &args::Grow) -> Result<(), Failure> {
    output::check_glb(&args.output, &[])?;
    let mut outputs = vec![args.output.as_path()];
    for file in [&args.report, &args.picture].into_iter().flatten() {
        output::check_file(file, &[])?;
        outputs.push(file);
    }
    output::check_distinct(&outputs)
}

fn leaves(args: &args::Grow, species: Species) -> Result<u32, Failure> {
    let Some(wanted) = args.leaves else {
        return Ok(GrowOptions::default().leaves);
    };
    u32::try_from(wanted).map_err(|_| {
        let most = secateur::plant::MAX_LEAVES;
        Failure(format!(
            "cannot grow {species} with {wanted} leaves: ask for 1 to {most}"
        ))
    })
}

fn exhibit(plant: &Plant) -> Exhibit {
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
fn extent_m(plant: &Plant) -> DVec3 {
    let mut positions = plant.wood.positions.iter().chain(&plant.leaves.positions);
    let Some(&first) = positions.next() else {
        return DVec3::ZERO;
    };
    let (low, high) = positions.fold((first, first), |(low, high), &p| (low.min(p), high.max(p)));
    high - low
}

fn sha256(bytes: &[u8]) -> String {
    let hash = Sha256::digest(bytes);
    hash.iter().map(|b| format!("{b:02x}")).collect()
}
