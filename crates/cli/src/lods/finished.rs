//! What an earlier call made of a tree, so that it is not done again: a hidden file beside the levels
//! says of what they were made, by which program, and what is in them.

use std::fs;
use std::path::{Path, PathBuf};

use secateur_gltf::StagedFiles;
use secateur_model::hex;
use secateur_study::{file_sha256, tree_sha256};
use serde::{Deserialize, Serialize};
use serde_json::Value;
use sha2::{Digest, Sha256};

use super::super::args;
use super::super::failure::Failure;
use super::super::record::SCHEMA_VERSION;
use super::super::streams::{is_stream, stdin};
use super::super::{machine, output};
use super::job::Job;
use super::level_options::options;
use super::nameless;

/// The levels of a tree as an earlier call left them.
#[derive(Debug, Deserialize, Serialize)]
pub(super) struct Finished {
    schema_version: u32,
    key: String,
    files: Vec<Known>,
    pub(super) record: Value,
    pub(super) pretty: String,
}

/// A file of the levels; in the folder of the levels it goes by its name alone, and the page, where it is not there,
/// without a name.
#[derive(Debug, Deserialize, Serialize)]
struct Known {
    file: Option<PathBuf>,
    sha256: String,
}

/// What the levels of a tree depend on, as a SHA-256: the program, the options, and all files that are
/// read. Trees that cannot be read are refused here.
pub(super) fn key(args: &args::Lods, job: &Job<'_>) -> Result<String, Failure> {
    let memory = args.plant.memory();
    let sha256 = |path: &Path| -> Result<String, Failure> {
        match is_stream(path) {
            true => Ok(hex(&Sha256::digest(stdin(memory)?))),
            false => Ok(tree_sha256(path, memory)?),
        }
    };
    let mut files = vec![sha256(job.tree)?];
    for path in args.scene.files() {
        files.push(sha256(path)?);
    }
    let selectors = args.plant.selectors().iter().map(|s| s.to_string());
    let not_plant: Vec<String> = args
        .plant
        .not_plant()
        .iter()
        .map(|s| s.to_string())
        .collect();
    let about = (
        (env!("CARGO_PKG_VERSION"), machine::commit(), SCHEMA_VERSION),
        (files, args.scene.scene.is_some()),
        (&job.name, job.layout, args.textures.is_some()),
        (selectors.collect::<Vec<_>>(), args.plant.vertex_alpha()),
        not_plant,
        (
            memory,
            args.wind.wind,
            &args.preview,
            args.for_engine,
            args.packing,
        ),
        options(args),
    );
    Ok(hex(&Sha256::digest(format!("{about:?}"))))
}

/// Where it is noted what a tree became; nowhere if its levels go into a file that was named.
fn note(args: &args::Lods, job: &Job<'_>) -> Option<PathBuf> {
    let is_file = job.place == args.output && job.layout != secateur_gltf::chain::Layout::Files;
    let name = format!(".{}_lods.json", job.name);
    (!is_file).then(|| args.output.join(name))
}

impl Finished {
    /// What a call of the same key left of a tree, finished or not; nothing if there was none.
    pub(super) fn of(args: &args::Lods, job: &Job<'_>, key: &str) -> Option<Self> {
        let place = note(args, job)?;
        // A pipe would never end, nor what a link may lead to.
        fs::symlink_metadata(&place)
            .ok()
            .filter(fs::Metadata::is_file)?;
        let text = fs::read(place).ok()?;
        let mut found: Self = serde_json::from_slice(&text).ok()?;
        nameless::named(&mut found.record, &mut found.pretty, args, job);
        (found.key == key).then_some(found)
    }

    /// Whether all files are there as they were written.
    pub(super) fn is_whole(&self, args: &args::Lods) -> bool {
        self.files.iter().all(|known| known.is_there(args))
    }

    /// Whether this is a file that the call wrote, and nobody changed.
    pub(super) fn wrote(&self, args: &args::Lods, file: &Path) -> bool {
        let is_it = |known: &&Known| known.place(args).is_some_and(|place| place == file);
        let known = self.files.iter().find(is_it);
        known.is_some_and(|known| known.is_there(args))
    }
}

impl Known {
    fn is_there(&self, args: &args::Lods) -> bool {
        let sha256 = self.place(args).map(|place| file_sha256(&place));
        sha256.is_some_and(|sha256| sha256.is_ok_and(|sha256| sha256 == self.sha256))
    }

    fn place(&self, args: &args::Lods) -> Option<PathBuf> {
        match &self.file {
            Some(file) => Some(args.output.join(file)),
            None => args.preview.clone(),
        }
    }
}

/// The files of a tree with what is noted of them, which gets its name first: whatever is there
/// of the others if the program is ended then is known to be its own.
pub(super) fn noted(
    args: &args::Lods,
    job: &Job<'_>,
    key: String,
    made: (&Value, &str),
    files: StagedFiles,
) -> Result<StagedFiles, Failure> {
    let Some(place) = note(args, job) else {
        return Ok(files);
    };
    let mut known = Vec::new();
    for (place, temporary) in files.pending() {
        let sha256 = file_sha256(temporary);
        let sha256 = sha256.map_err(|e| Failure::of_file(place, "cannot be read", &e))?;
        let in_folder = place.strip_prefix(&args.output);
        known.push(Known {
            file: in_folder.ok().map(Path::to_owned),
            sha256,
        });
    }
    let (record, pretty) = made;
    let mut finished = Finished {
        schema_version: SCHEMA_VERSION,
        key,
        files: known,
        record: record.clone(),
        pretty: pretty.to_owned(),
    };
    nameless::nameless(&mut finished.record, &mut finished.pretty, args, job);
    let text = serde_json::to_string_pretty(&finished).expect("values of JSON");
    let mut all = StagedFiles::new();
    output::stage_derived(&mut all, &place, format!("{text}\n").as_bytes())?;
    all.append(files);
    Ok(all)
}
