//! `secateur lods`: the chain of levels that an engine loads.

mod dry_run;
mod finished;
mod job;
mod level_options;
mod make;
mod nameless;
mod record;
mod table;

use std::path::{Path, PathBuf};
use std::time::Instant;

use secateur::{ErrorKind, Surroundings};
use secateur_gltf::StagedFiles;
use secateur_gltf::chain::Layout;
use serde_json::Value;

use super::args::{self, Common};
use super::failure::Failure;
use super::print::{Printed, Records};
use super::record::Record;
use super::streams::Outlet;
use super::{interrupt, log, output};
use finished::Finished;
pub(crate) use job::Job;
use job::{check_free, check_outputs, jobs, outputs};
pub(crate) use level_options::options;
use make::{Done, make, opened};
pub(crate) use record::{FailureRecord, LodsRecord};
pub(crate) use table::{OF_DEMO, table};

/// Makes a chain of each tree, one after the other: what is finished when the program ends stays, and
/// is not done again by the next call. Of several trees those that cannot be done are left out.
pub(crate) fn run(args: &args::Lods, common: &Common) -> Result<Printed, Failure> {
    let outlet = Outlet::of(&args.output)?;
    if !outlet.is_stdout() {
        return run_into_files(args, common, &outlet);
    }
    if matches!(args.layout, Some(Layout::Files | Layout::Usd)) {
        return Err(Failure::usage(
            "standard output takes one file: leave out `--layout`, or name a folder",
        ));
    }
    if args.for_engine.is_some() {
        return Err(Failure::usage(
            "standard output takes one file, and an engine needs more: name a folder",
        ));
    }
    let args = args::Lods {
        output: outlet.path().to_owned(),
        ..args.clone()
    };
    let printed = run_into_files(&args, common, &outlet)?;
    if !args.dry_run {
        outlet.send()?;
    }
    Ok(printed)
}

fn run_into_files(args: &args::Lods, common: &Common, outlet: &Outlet) -> Result<Printed, Failure> {
    let start = Instant::now();
    let jobs = jobs(args)?;
    check_outputs(args, &jobs)?;
    options(args).check().map_err(secateur::Error::from)?;
    let outputs: Vec<PathBuf> = jobs.iter().flat_map(|job| outputs(args, job)).collect();
    let outputs: Vec<&Path> = outputs.iter().map(PathBuf::as_path).collect();
    let surroundings = args.scene.read(args.plant.memory(), &outputs)?;
    if args.dry_run {
        return dry_run::told(args, &jobs);
    }
    let keeps_going = args.keep_going.unwrap_or(jobs.len() > 1);
    if !keeps_going && jobs.len() > 1 {
        // What cannot be done is refused before anything is made of the others.
        for job in &jobs {
            let (_, known) = key_and_known(args, job)?;
            if !known.is_some_and(|known| known.is_whole(args)) {
                opened(args, job)?;
            }
        }
    }
    // What was read for all counts with the first.
    let mut since = start;
    let mut pretty = String::new();
    let mut records = Vec::new();
    let mut failed = Vec::new();
    for job in &jobs {
        match done(args, common, job, &surroundings, since) {
            Ok(done) => {
                pretty.push_str(&done.pretty);
                records.push(outlet.renamed(done.record));
            }
            Err(failure) => {
                if !keeps_going || failure.kind == ErrorKind::Interrupted {
                    return Err(failure);
                }
                log::error(&failure);
                let seconds = since.elapsed().as_secs_f64();
                failed.push((job, failure, seconds));
            }
        }
        since = Instant::now();
    }
    if !failed.is_empty() {
        pretty.push_str(&format!("{} of {} failed\n", failed.len(), jobs.len()));
        for (_, failure, _) in &failed {
            pretty.push_str(&format!("  {failure}\n"));
        }
    }
    let some_failed = !failed.is_empty();
    records.extend(failed.into_iter().map(|(job, failure, seconds)| {
        let failure = FailureRecord::of(job.tree, &failure);
        Record::new("lods", failure, &[], seconds).to_value()
    }));
    let levels = records.iter().map(|record| record["levels"].as_array());
    let rows = levels.flatten().flatten().cloned().collect();
    let records = Records::Lines(records);
    if let Some(report) = &args.report {
        output::write_file(report, records.as_text().as_bytes())?;
    }
    Ok(Printed {
        pretty,
        rows,
        records,
        some_failed,
    })
}

/// What a tree's levels are known by, and those that an earlier call left; nothing else may be in their places.
fn key_and_known(args: &args::Lods, job: &Job<'_>) -> Result<(String, Option<Finished>), Failure> {
    let key = interrupt::reading(|| finished::key(args, job))?;
    let known = Finished::of(args, job, &key).filter(|_| !args.overwrite);
    check_free(args, job, known.as_ref())?;
    Ok((key, known))
}

/// A tree's levels, made or as an earlier call left them.
fn done(
    args: &args::Lods,
    common: &Common,
    job: &Job<'_>,
    surroundings: &Surroundings,
    since: Instant,
) -> Result<Done, Failure> {
    let (key, known) = key_and_known(args, job)?;
    let may_overwrite = args.overwrite || known.is_some();
    match known {
        Some(known) if known.is_whole(args) => {
            Ok(Done::again(known, since.elapsed().as_secs_f64()))
        }
        _ => {
            let (done, files) = make(
                args,
                common,
                (job, may_overwrite),
                surroundings,
                None,
                since,
            )?;
            let noted = (&done.record, &*done.pretty);
            let files = finished::noted(args, job, key, noted, files)?;
            interrupt::writing()?;
            files.commit()?;
            interrupt::written();
            Ok(done)
        }
    }
}

/// What the levels of the first tree depend on, as a SHA-256.
pub(crate) fn key_of_first(args: &args::Lods) -> Result<String, Failure> {
    match jobs(args)?.first() {
        Some(job) => interrupt::reading(|| finished::key(args, job)),
        None => Err(Failure::usage("no tree was named")),
    }
}

/// The record of the levels of the first tree, with a picture of them, and all files but for their names.
pub(crate) fn made_of_first(
    args: &args::Lods,
    common: &Common,
    picture: &Path,
    since: Instant,
) -> Result<(Value, StagedFiles), Failure> {
    let jobs = jobs(args)?;
    check_outputs(args, &jobs)?;
    options(args).check().map_err(secateur::Error::from)?;
    let surroundings = args.scene.read(args.plant.memory(), &[])?;
    let Some(job) = jobs.first() else {
        return Err(Failure::usage("no tree was named"));
    };
    let (done, files) = make(
        args,
        common,
        (job, true),
        &surroundings,
        Some(picture),
        since,
    )?;
    Ok((done.record, files))
}
