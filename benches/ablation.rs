//! What each short cut of the exact engine is worth: seconds of one core without
//! it, beside those with all, in turns; the result must be the same.
//!
//! `cargo bench --bench ablation --features ablation [-- PART]`; PART picks cases,
//! `TREE, JOB` or `TREE, JOB, without MECHANISM`, by name. `TOGETHER` may hold names
//! of mechanisms, joined by ` + `, to be switched off at once instead of one by one.
//! Also writes `ablation.md`.

mod rows;

use std::fmt::Write as _;
use std::ops::ControlFlow;

use rows::{Row, Rows, Wanted, repeats, shared_tree};
use secateur_gltf::{Document, Tree, plant_to_glb};
use secateur_model::Foliage;
use secateur_plant::{EllipsoidCrown, GrowOptions, Species, ellipsoid_crown, grow};
use secateur_raster::{CpuRasteriser, ViewSet};
use secateur_simplify::vds::fast::{self, Mechanism, switch_off};
use secateur_simplify::vds::{Progress, Reference, Resize, VdsOptions, VdsOutcome, VdsRun};

const COMMAND: &str = "cargo bench --bench ablation --features ablation";

/// Image side in pixels: that of the other benches' main job.
const RESOLUTION: u32 = 256;

/// A slowdown in per cent from which on a mechanism is worth its lines.
const WORTH_PERCENT: f64 = 3.0;

/// Some mechanisms and what they are called.
struct Without {
    name: String,
    mechanisms: Vec<Mechanism>,
}

/// A mechanism's slowdown in per cent, by tree and job: the median over the repeats of
/// its seconds over the mean of the runs before and after it.
type Slowdowns = Vec<Option<f64>>;

fn main() {
    let wanted = Wanted::from_command_line();
    let mut rows = Rows::create("ablation");
    let candidates = candidates();
    let mut table: Vec<Slowdowns> = candidates.iter().map(|_| Vec::new()).collect();
    let mut columns = Vec::new();
    // One core: nothing waits for another, and seconds are those of its work.
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build();
    let pool = pool.expect("a thread");
    for (tree, foliage) in trees(&wanted) {
        for job in ["look", "information"] {
            let column = format!("{tree}, {job}");
            let case = |without: &Without| format!("{column}, without {}", without.name);
            let chosen: Vec<usize> = (0..candidates.len())
                .filter(|k| wanted.has(&case(&candidates[*k])))
                .collect();
            if chosen.is_empty() {
                continue;
            }
            let simplify = run_of(job, &foliage);
            let run = |off: &[Mechanism]| pool.install(|| timed(&foliage, &simplify, off));
            let (_, expected) = run(&[]);
            let mut ratios: Vec<Vec<f64>> = vec![Vec::new(); candidates.len()];
            for repeat in 0..repeats() {
                let mut row = |case: &str, value| {
                    rows.add(&Row {
                        case,
                        quantity: "cpu",
                        unit: "s",
                        value,
                        repeat,
                        adapter: "cpu",
                        command: COMMAND,
                    });
                };
                let (mut before, _) = run(&[]);
                row(&column, before);
                for &k in &chosen {
                    let (seconds, outcome) = run(&candidates[k].mechanisms);
                    let case = case(&candidates[k]);
                    assert_eq!(outcome, expected, "{case} finds something else");
                    row(&case, seconds);
                    let (after, _) = run(&[]);
                    row(&column, after);
                    ratios[k].push(2.0 * seconds / (before + after));
                    before = after;
                }
            }
            columns.push(column);
            for (ratios, slowdowns) in ratios.iter_mut().zip(&mut table) {
                slowdowns.push(median(ratios).map(|ratio| 100.0 * (ratio - 1.0)));
            }
        }
    }
    let path = rows.folder().join("ablation.md");
    std::fs::write(&path, markdown(&columns, &candidates, &table)).expect("the table is written");
    println!("{}", path.display());
}

/// What is switched off in turn.
fn candidates() -> Vec<Without> {
    let one = |mechanism: &Mechanism| Without {
        name: mechanism.name().to_owned(),
        mechanisms: vec![*mechanism],
    };
    let Ok(together) = std::env::var("TOGETHER") else {
        return Mechanism::ALL.iter().map(one).collect();
    };
    let named = |name: &str| {
        let found = Mechanism::ALL.iter().find(|m| m.name() == name.trim());
        *found.unwrap_or_else(|| panic!("no mechanism is called '{name}'"))
    };
    vec![Without {
        mechanisms: together.split(" + ").map(named).collect(),
        name: together,
    }]
}

fn trees(wanted: &Wanted) -> Vec<(String, Foliage)> {
    let mut trees = Vec::new();
    if wanted.may_have("ez_oak_20k")
        && let Some(path) = shared_tree("ez_oak_20k.glb")
    {
        let tree = Tree::open(&path, &[]).expect("the tree loads");
        trees.push(("ez_oak_20k".to_owned(), tree.foliage().clone()));
    }
    for species in [Species::Oak, Species::Birch, Species::Carya] {
        let name = format!("grown {species}");
        if wanted.may_have(&name) {
            let leaves = match species {
                Species::Oak => 20_376,
                species => species.default_leaves(),
            };
            let plant = grow(species, &GrowOptions { leaves, seed: 7 }).expect("a species grows");
            let document = Document::from_bytes(&name, plant_to_glb(&plant), None);
            let tree = document.and_then(|document| document.into_tree(&[]));
            trees.push((
                name,
                tree.expect("a grown plant is a tree").foliage().clone(),
            ));
        }
    }
    if wanted.may_have("crown_105688") {
        let crown = ellipsoid_crown(105_688, 1, &EllipsoidCrown::default());
        trees.push(("crown_105688".to_owned(), crown.expect("a crown")));
    }
    trees
}

/// The exact engine's part of a preset, down to a tenth of the leaves.
fn run_of(job: &str, foliage: &Foliage) -> VdsRun {
    let views = ViewSet::dodecahedron(foliage.bounding_sphere().expect("leaves"));
    let plain = VdsRun::to_leaves(views, RESOLUTION, foliage.leaves().len() as u64 / 10);
    match job {
        "look" => VdsRun {
            options: VdsOptions {
                reference: Reference::Previous,
                resize: Resize::Full,
                max_coverage: Some(1.0),
                ..plain.options
            },
            ..plain
        },
        _ => plain,
    }
}

/// Seconds of a run without some mechanisms, and its result.
fn timed(foliage: &Foliage, job: &VdsRun, off: &[Mechanism]) -> (f64, VdsOutcome) {
    switch_off(off);
    let start = thread_seconds();
    let go_on = &mut |_: Progress| ControlFlow::Continue(());
    let outcome = fast::simplify(foliage, job, &CpuRasteriser, go_on).expect("a run");
    (thread_seconds() - start, outcome)
}

/// Seconds for which a core has worked for this thread; others do not count.
#[cfg(target_os = "linux")]
fn thread_seconds() -> f64 {
    let mut time = libc::timespec {
        tv_sec: 0,
        tv_nsec: 0,
    };
    // SAFETY: the time is written to a place of its type.
    let status = unsafe { libc::clock_gettime(libc::CLOCK_THREAD_CPUTIME_ID, &raw mut time) };
    assert_eq!(status, 0, "threads have clocks");
    time.tv_sec as f64 + time.tv_nsec as f64 * 1e-9
}

/// Seconds since the first call; on an idle machine much the same.
#[cfg(not(target_os = "linux"))]
fn thread_seconds() -> f64 {
    static START: std::sync::OnceLock<std::time::Instant> = std::sync::OnceLock::new();
    START
        .get_or_init(std::time::Instant::now)
        .elapsed()
        .as_secs_f64()
}

fn median(numbers: &mut [f64]) -> Option<f64> {
    numbers.sort_by(f64::total_cmp);
    let last = numbers.len().checked_sub(1)?;
    Some((numbers[last / 2] + numbers[last.div_ceil(2)]) / 2.0)
}

/// Slowdowns in per cent, those worth it in bold.
fn markdown(columns: &[String], candidates: &[Without], table: &[Slowdowns]) -> String {
    let mut text = format!("| without | {} |\n|---|", columns.join(" | "));
    text.push_str(&"---|".repeat(columns.len()));
    text.push('\n');
    for (without, slowdowns) in candidates.iter().zip(table) {
        if slowdowns.iter().all(Option::is_none) {
            continue;
        }
        let _ = write!(text, "| {} |", without.name);
        for slowdown in slowdowns {
            let _ = match slowdown {
                Some(percent) if *percent >= WORTH_PERCENT => write!(text, " **{percent:+.0}** |"),
                Some(percent) => write!(text, " {percent:+.1} |"),
                None => write!(text, " |"),
            };
        }
        text.push('\n');
    }
    text
}
