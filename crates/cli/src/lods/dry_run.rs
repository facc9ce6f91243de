//! `--dry-run`: everything is checked, nothing is made.

use secateur_gltf::chain::Layout;
use serde_json::json;

use super::super::args;
use super::super::failure::Failure;
use super::super::print::{Printed, Records};
use super::super::record::SCHEMA_VERSION;
use super::super::summary::grouped;
use super::job::Job;
use super::{key_and_known, opened};

/// What would be made of each tree.
pub(super) fn told(args: &args::Lods, jobs: &[Job<'_>]) -> Result<Printed, Failure> {
    let mut pretty = String::new();
    let mut records = Vec::new();
    for job in jobs {
        let (_, known) = key_and_known(args, job)?;
        let is_kept = known.is_some_and(|known| known.is_whole(args));
        let plant = opened(args, job)?;
        let files = match job.layout {
            Layout::Files => job.place.join(format!("{}_LOD0.glb ...", job.name)),
            Layout::Siblings | Layout::Msft | Layout::Usd => job.place.clone(),
        };
        let leaves = plant.leaves().leaves().len() as u64;
        pretty.push_str(&format!(
            "{} -> {}: {} leaves, {} triangles; {}\n",
            job.tree.display(),
            files.display(),
            grouped(leaves),
            grouped(plant.triangle_count()),
            match is_kept {
                true => "is there as it would be made",
                false => "would be made",
            }
        ));
        records.push(json!({
            "schema_version": SCHEMA_VERSION,
            "input": job.tree.display().to_string(),
            "files": files.display().to_string(),
            "leaves": leaves,
            "triangles": plant.triangle_count(),
            "kept": is_kept,
        }));
    }
    Ok(Printed {
        pretty,
        rows: records.clone(),
        records: Records::Lines(records),
        some_failed: false,
    })
}
