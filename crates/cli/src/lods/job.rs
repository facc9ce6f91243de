//! Where the levels of each tree go.

use std::collections::HashSet;
use std::ffi::OsStr;
use std::fs;
use std::path::{Path, PathBuf};

use secateur::engines::EngineName;
use secateur_gltf::chain::{Layout, MAX_LEVELS, check_name};
use secateur_gltf::{has_extension, is_gltf_name};

use super::super::args;
use super::super::failure::Failure;
use super::super::output;
use super::super::streams::is_stream;
use super::finished::Finished;

/// A tree to be done, and where its levels go.
pub(crate) struct Job<'a> {
    pub(crate) tree: &'a Path,
    pub(crate) name: String,
    pub(crate) layout: Layout,
    /// The file, or for the layout of files the folder.
    pub(crate) place: PathBuf,
    /// What an engine needs beside the levels, where it does.
    pub(crate) companion: Option<PathBuf>,
}

/// Where each tree's levels go.
pub(super) fn jobs(args: &args::Lods) -> Result<Vec<Job<'_>>, Failure> {
    let is_usda = has_extension(&args.output, &["usda"]);
    let is_file = is_usda || is_gltf_name(&args.output);
    if is_file && args.trees.len() > 1 {
        return Err(Failure::usage(format!(
            "{}: one file holds the levels of one tree; name a folder for {} trees",
            args.output.display(),
            args.trees.len()
        )));
    }
    let layout = layout(args, is_file.then_some(is_usda))?;
    let mut names: Vec<String> = Vec::new();
    for tree in &args.trees {
        let stem = tree.file_stem().and_then(OsStr::to_str);
        let name = match is_stream(tree) {
            true => "plant".to_owned(),
            false => stem.unwrap_or("tree").to_owned(),
        };
        if names.contains(&name) {
            return Err(Failure::usage(format!(
                "{}: another tree of this call has the same name; its levels would overwrite this one's",
                tree.display()
            )));
        }
        let wrong = |error| Failure::input(format!("{}: {error}", tree.display()));
        check_name(&name).map_err(wrong)?;
        if tree.exists() && !tree.is_file() && !tree.is_dir() {
            return Err(Failure::input(format!(
                "{}: is a pipe or a device, and `lods` reads a plant more than once: name a file",
                tree.display()
            )));
        }
        names.push(name);
    }
    let mut jobs = Vec::new();
    for (tree, name) in args.trees.iter().zip(names) {
        let place = match is_file || layout == Layout::Files {
            true => args.output.clone(),
            false => args.output.join(match layout {
                Layout::Usd => format!("{name}.usda"),
                Layout::Files | Layout::Siblings | Layout::Msft => format!("{name}.glb"),
            }),
        };
        let folder = match is_file {
            true => args
                .output
                .parent()
                .map_or_else(PathBuf::new, Path::to_owned),
            false => args.output.clone(),
        };
        let companion = args
            .for_engine
            .and_then(|engine| Some(folder.join(engine.companion(&name)?)));
        jobs.push(Job {
            tree,
            layout,
            place,
            companion,
            name,
        });
    }
    Ok(jobs)
}

/// How levels lie in files; `is_usda` says of an output that is a file whether it is one of USD.
fn layout(args: &args::Lods, is_usda: Option<bool>) -> Result<Layout, Failure> {
    let wrong = |what: &str| Failure::usage(format!("{}: {what}", args.output.display()));
    let of_engine = args.for_engine.map(EngineName::layout);
    let layout = match (args.layout.or(of_engine), is_usda) {
        (Some(layout), _) => layout,
        (None, Some(true)) => Layout::Usd,
        (None, Some(false)) => Layout::Siblings,
        (None, None) => Layout::Files,
    };
    match (layout, is_usda) {
        (Layout::Files, Some(_)) if args.for_engine.is_some() => Err(wrong(
            "that engine needs a file for each level: name a folder",
        )),
        (Layout::Files, Some(_)) => Err(wrong("the layout of files needs a folder as its output")),
        (Layout::Usd, Some(false)) => Err(wrong("levels as USD need a name that ends in .usda")),
        (Layout::Siblings | Layout::Msft, Some(true)) => {
            Err(wrong("this layout needs a name that ends in .glb or .gltf"))
        }
        (Layout::Usd, _) if args.packing.compress.is_some() => Err(Failure::usage(
            "`--compress` is for glTF: leave it out with the layout usd",
        )),
        (Layout::Usd, _) if args.packing.strips => Err(Failure::usage(
            "`--strips` is for glTF: leave it out with the layout usd",
        )),
        (layout, _) => Ok(layout),
    }
}

pub(super) fn check_outputs(args: &args::Lods, jobs: &[Job<'_>]) -> Result<(), Failure> {
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
        return Err(Failure::usage(
            "a preview shows one tree: give one at a time, or leave out `--preview`".to_owned(),
        ));
    }
    let places: Vec<PathBuf> = jobs.iter().flat_map(places).collect();
    if args.output.is_dir() {
        places
            .iter()
            .try_for_each(|place| output::check_name(place))?;
    }
    let found = inputs
        .iter()
        .filter_map(|input| fs::canonicalize(input).ok());
    let found: HashSet<PathBuf> = found.collect();
    let is_input = |place: &&PathBuf| {
        let place = fs::canonicalize(place);
        place.is_ok_and(|place| found.contains(&place))
    };
    if let Some(place) = places.iter().find(is_input) {
        return Err(Failure::input(format!(
            "{}: is an input of this call, and a level would take its place; give another folder",
            place.display()
        )));
    }
    let beside = [&args.report, &args.preview].into_iter().flatten();
    let outputs: Vec<&Path> = places.iter().chain(beside).map(PathBuf::as_path).collect();
    output::check_distinct(&outputs)
}

/// Refuses files in the places of a tree's levels, but for those that a call like this one wrote.
pub(super) fn check_free(
    args: &args::Lods,
    job: &Job<'_>,
    finished: Option<&Finished>,
) -> Result<(), Failure> {
    let is_in_the_way = |file: &&PathBuf| {
        let is_there = std::fs::symlink_metadata(file).is_ok();
        is_there && !finished.is_some_and(|finished| finished.wrote(args, file))
    };
    match places(job).iter().find(is_in_the_way) {
        Some(file) if !args.overwrite => Err(Failure::input(format!(
            "{}: is there already; give another folder, or `--overwrite`",
            file.display()
        ))),
        _ => Ok(()),
    }
}

/// The files that a tree's levels may become.
fn places(job: &Job<'_>) -> Vec<PathBuf> {
    let level = |k| job.place.join(format!("{}_LOD{k}.glb", job.name));
    let mut places: Vec<PathBuf> = match job.layout {
        Layout::Files => (0..MAX_LEVELS).map(level).collect(),
        Layout::Siblings | Layout::Msft | Layout::Usd => vec![job.place.clone()],
    };
    places.extend(job.companion.clone());
    places
}

/// All files that may come of a tree.
pub(super) fn outputs(args: &args::Lods, job: &Job<'_>) -> Vec<PathBuf> {
    let mut outputs = places(job);
    outputs.extend([&args.report, &args.preview].into_iter().flatten().cloned());
    outputs
}
