//! `secateur study`: methods x settings x levels x trees, as rows, charts and a
//! report.

mod draw;
mod judge;
mod kept;
mod lots;
mod paper;
mod perturb;
mod plan;
mod rows;
mod scenes;
mod subjects;

use std::collections::BTreeSet;
use std::io::{IsTerminal, stderr};
use std::ops::ControlFlow;
use std::path::Path;
use std::time::Instant;

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use secateur::{Lod, Progress, Resolution, Stage, Tree};
use secateur_eval::study::{Row, RowKey};
use serde_json::json;

use super::args::{self, Common};
use super::failure::Failure;
use super::print::Printed;
use super::summary::grouped;
use super::{interrupt, machine, output, record, simplify};
use judge::{Judge, Ran, Run};
use plan::Case;
use rows::RowFile;
use subjects::{Subject, subjects};

/// Runs what is missing, then draws everything from the rows.
pub(crate) fn run(args: &args::Study, common: &Common) -> Result<Printed, Failure> {
    let start = Instant::now();
    output::check_folder(&args.output)?;
    if !args.redraw {
        let subjects = subjects(args)?;
        run_all(args, common, &subjects).map_err(|failure| match interrupt::check() {
            Ok(()) => failure,
            Err(_) => Failure(format!(
                "stopped; the finished rows are kept in {}, and the same command goes on from there",
                args.output.display()
            )),
        })?;
    }
    let rows = rows::read(&args.output)?;
    let files = draw::draw(&args.output, &rows)?;
    let total = start.elapsed().as_secs_f64();
    let count = rows.len() as u64;
    let pretty = format!(
        "{} rows in {}\n  report   {}\n  rows     {}\n  took     {total:.1} s\n",
        grouped(count),
        args.output.display(),
        files.report.display(),
        files.csv.display()
    );
    let record = json!({
        "rows": count,
        "output": args.output.display().to_string(),
        "report": files.report.display().to_string(),
        "csv": files.csv.display().to_string(),
        "charts": files.charts.iter().map(|p| p.display().to_string()).collect::<Vec<_>>(),
        "seconds": record::seconds(&[], total),
        "run": record::provenance("study"),
    });
    Ok(Printed::single(pretty, record))
}

/// One method with one seed on one tree: what is still to be done of it.
struct Job<'a> {
    case: &'a Case,
    seed: Option<u64>,
    levels: Vec<f64>,
}

fn run_all(args: &args::Study, common: &Common, subjects: &[Subject]) -> Result<(), Failure> {
    let finished = rows::read(&args.output)?;
    let done: BTreeSet<RowKey> = finished.iter().map(Row::key).collect();
    let todo: Vec<Vec<Job>> = subjects.iter().map(|s| jobs(args, s, &done)).collect();
    for (subject, jobs) in subjects.iter().zip(&todo) {
        if !jobs.is_empty() {
            subject.check(&args.foliage.foliage)?;
        }
    }
    let mut file = RowFile::after(&finished, &args.output)?;
    let rows: usize = todo.iter().flatten().map(|job| job.levels.len()).sum();
    let bar = bar(common, rows);
    for (subject, jobs) in subjects.iter().zip(todo) {
        if jobs.is_empty() {
            continue;
        }
        let (name, path, cases) = (&subject.name, &subject.path, &subject.cases);
        subject.prepare()?;
        let selectors = subject.selectors(&args.foliage.foliage);
        let tree = Tree::open(path, selectors)?;
        let judge = Judge::new(subject, &tree, &args.output)?;
        for job in jobs {
            bar.set_message(format!(
                "{name}: {} {}",
                job.case.method,
                job.case.setting()
            ));
            let of_method = |case: &&Case| case.method == job.case.method;
            let run = Run {
                case: job.case,
                seed: job.seed,
                reference: cases.iter().find(of_method).unwrap_or(job.case),
            };
            for ran in runs(&tree, &job).map_err(|e| about(path, e))? {
                interrupt::check()?;
                file.append(&judge.row(run, &ran)?)?;
                bar.inc(1);
            }
        }
    }
    bar.finish_and_clear();
    Ok(())
}

fn about(path: &Path, failure: Failure) -> Failure {
    match failure.0.starts_with(&path.display().to_string()) {
        true => failure,
        false => Failure(format!("{}: {failure}", path.display())),
    }
}

fn jobs<'a>(args: &args::Study, subject: &'a Subject, done: &BTreeSet<RowKey>) -> Vec<Job<'a>> {
    let mut jobs = Vec::new();
    let tree = &subject.name;
    for case in &subject.cases {
        let draws_lots = case.draws_lots();
        let own_seed = case.words.iter().any(|word| word.starts_with("--seed"));
        let seeds: Vec<Option<u64>> = match draws_lots && !own_seed {
            true => (0..u64::from(args.seeds)).map(Some).collect(),
            false => vec![None],
        };
        for seed in seeds {
            let mut levels = match args.levels.is_empty() {
                true => subject.levels().to_vec(),
                false => args.levels.clone(),
            };
            levels.retain(|level| !done.contains(&rows::key(tree, case, seed, *level)));
            if !levels.is_empty() {
                jobs.push(Job { case, seed, levels });
            }
        }
    }
    jobs
}

fn bar(common: &Common, rows: usize) -> ProgressBar {
    let is_shown = !common.quiet && stderr().is_terminal();
    let target = match is_shown {
        true => ProgressDrawTarget::stderr_with_hz(10),
        false => ProgressDrawTarget::hidden(),
    };
    let bar = ProgressBar::with_draw_target(Some(rows as u64), target);
    let style = ProgressStyle::with_template("{wide_msg} {bar:30} {pos}/{len} rows, {eta} left");
    if let Ok(style) = style {
        bar.set_style(style);
    }
    bar
}

/// One run at a time, so that times are of nothing else: one for all levels
/// where every prefix of an order is a level, else one for each.
fn runs(tree: &Tree, job: &Job<'_>) -> Result<Vec<Ran>, Failure> {
    if !job.case.has_prefixes()? {
        let alone = job.levels.iter().map(|level| timed(tree, job, &[*level]));
        let ran: Result<Vec<Vec<Ran>>, Failure> = alone.collect();
        return Ok(ran?.into_iter().flatten().collect());
    }
    timed(tree, job, &job.levels)
}

fn timed(tree: &Tree, job: &Job<'_>, levels: &[f64]) -> Result<Vec<Ran>, Failure> {
    let coarsest = levels.iter().copied().fold(1.0, f64::min);
    let mut options = job.case.options(coarsest, job.seed)?;
    let sees_pixels = options.method.vds().is_some() || options.objective().is_some();
    if !sees_pixels {
        // A method that sees no pixels does not have to choose how many.
        options.resolution = Resolution::Pixels(1);
    }
    options.skeleton = simplify::skeleton(tree, &options.method)?;
    let changed = job.case.perturbation.apply(tree.foliage(), &options);
    let count = tree.foliage().leaves().len();
    let has_prefixes = job.case.has_prefixes()?;
    let steps: Vec<usize> = levels
        .iter()
        .map(|level| match has_prefixes {
            true => count - (level * count as f64).round() as usize,
            false => usize::MAX,
        })
        .collect();
    let mut reached: Vec<Option<Reached>> = vec![None; levels.len()];
    let mut end = None;
    let mut fitting: Option<(Instant, Instant)> = None;
    let mut begun = Instant::now();
    machine::forget_peak_rss();
    let result = secateur::simplify_with(&changed.foliage, &changed.options, &mut |progress| {
        match progress {
            Progress::Stage(Stage::Select) => begun = Instant::now(),
            // All that comes after is no part of the method.
            Progress::Stage(Stage::Observe) => end = Some(Reached::now(begun)),
            Progress::Stage(Stage::Fit) => {
                end.get_or_insert_with(|| Reached::now(begun));
                fitting = Some((Instant::now(), Instant::now()));
            }
            Progress::Step { .. } if fitting.is_some() => {
                fitting = fitting.map(|(from, _)| (from, Instant::now()));
            }
            Progress::Step { done, .. } => {
                for (at, steps) in reached.iter_mut().zip(&steps) {
                    if done == *steps {
                        *at = Some(Reached::now(begun));
                    }
                }
            }
            _ => {}
        }
        match interrupt::check() {
            Ok(()) => ControlFlow::Continue(()),
            Err(_) => ControlFlow::Break(()),
        }
    })?;
    let order = changed.order_of_tree(&result.passes.in_one_order());
    let of_stage = |name: Stage| {
        let stage = result.seconds.iter().find(|(stage, _)| *stage == name);
        stage.map_or(0.0, |(_, seconds)| *seconds)
    };
    let choosing = if sees_pixels {
        of_stage(Stage::Resolution)
    } else {
        0.0
    };
    let fitted = fitting.map_or(0.0, |(from, to)| (to - from).as_secs_f64());
    let whole = Reached {
        seconds: of_stage(Stage::Select),
        peak_rss_bytes: machine::peak_rss_bytes(),
    };
    let fitting_peak = fitting.and(whole.peak_rss_bytes);
    let ran = |(level, (steps, reached)): (&f64, (&usize, Option<Reached>))| {
        let reached = reached.or(end).unwrap_or(whole);
        Ran {
            level: *level,
            lod: Lod::after(&order, (*steps).min(order.len())),
            seconds: choosing + reached.seconds + fitted,
            peak_rss_bytes: reached.peak_rss_bytes.max(fitting_peak),
            resolution: if sees_pixels { result.resolution } else { 0 },
            engine: result.engine.to_owned(),
            adapter: result.adapter.clone(),
        }
    };
    let levels = levels.iter().zip(steps.iter().zip(reached));
    Ok(levels.map(ran).collect())
}

/// What it took to get to a level.
#[derive(Clone, Copy, Debug)]
struct Reached {
    seconds: f64,
    peak_rss_bytes: Option<u64>,
}

impl Reached {
    fn now(begun: Instant) -> Self {
        Self {
            seconds: begun.elapsed().as_secs_f64(),
            peak_rss_bytes: machine::peak_rss_bytes(),
        }
    }
}
