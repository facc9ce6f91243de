//! Levels of detail by a plant's own branches: whether they keep what they
//! promise, beside VDS on the same tree; and how long a level of a chain takes.
//!
//! `cargo bench --bench procedural [-- PART]`; PART is `goals`, `methods` or
//! `chain`.

mod rows;

use std::time::Instant;

use rows::{Rows, Wanted, exponent, repeats};
use secateur::{
    ChainOptions, Document, Judging, MergeOptions, Method, Options, Preset, Resolution, Stage,
    StochasticOptions, Target, Tree, plant_to_glb, simplify,
};
use secateur_plant::{
    Chain, ClusterSize, GrowOptions, Metric, Scheme, Skeleton, Species, grow_skeleton,
    merge_levels, plant_of,
};
use std::sync::Arc;

const SEED: u64 = 7;

fn main() {
    let wanted = Wanted::from_command_line();
    let mut rows = Rows::create("procedural");
    if wanted.has("goals") {
        for species in [Species::Oak, Species::Birch, Species::Palmetto] {
            goals(&mut rows, species, 5000);
        }
    }
    if wanted.has("methods") {
        for species in [Species::Oak, Species::Birch] {
            methods(&mut rows, species, 5000);
        }
    }
    if wanted.has("chain") {
        extraction(&mut rows);
    }
}

const COMMAND: &str = "cargo bench --bench procedural";

fn skeleton(species: Species, leaves: u32) -> Skeleton {
    let options = GrowOptions { leaves, seed: SEED };
    grow_skeleton(species, &options).expect("a species grows")
}

/// As a file would be read, with its wood triangles and its height in metres,
/// leaves included.
fn read_back(skeleton: Skeleton, species: Species) -> (Tree, f64) {
    let plant = plant_of(skeleton, species.rules(), species.name(), SEED);
    let plant = plant.expect("a plant of a species");
    let positions = plant.wood.positions.iter().chain(&plant.leaves.positions);
    let top_m = positions.map(|p| p.y).fold(0.0, f64::max);
    let document = Document::from_bytes(species.name(), plant_to_glb(&plant), None);
    let leaves = format!("material:{} leaf", species.name());
    let leaves = leaves.parse().expect("a selector");
    let tree = document.and_then(|document| document.into_tree(&[leaves]));
    (tree.expect("a grown plant is a tree"), top_m)
}

fn wood_top_m(skeleton: &Skeleton) -> f64 {
    skeleton
        .segments
        .iter()
        .map(|s| s.end.y)
        .fold(0.0, f64::max)
}

/// L-plants, section IV: polygons fall, the height and the coverage are kept.
fn goals(rows: &mut Rows, species: Species, leaves: u32) {
    let whole = skeleton(species, leaves);
    let wood_m = wood_top_m(&whole);
    let (original, top_m) = read_back(whole.clone(), species);
    for (name, scheme) in [
        ("50-25-12.5-12.5", Scheme::halving()),
        ("25-25-25-25", Scheme::even()),
    ] {
        for (k, level) in merge_levels(&whole, &scheme, ClusterSize::Paper)
            .into_iter()
            .enumerate()
        {
            let case = format!("{species} {leaves}, merge {name}, level {}", k + 1);
            let wood_kept = wood_top_m(&level.skeleton) / wood_m;
            judged(rows, &case, level.skeleton, species, &original, top_m);
            rows.note(&case, "wood height kept", "", wood_kept, COMMAND);
        }
    }
    let chain = Chain::of(&whole, Metric::BranchingLength);
    for share in [0.5, 0.25, 0.125, 0.02] {
        let levels = (share * chain.levels() as f64).ceil() as usize;
        let case = format!(
            "{species} {leaves}, chain, {} % of its levels",
            100.0 * share
        );
        let level = chain.skeleton(levels);
        let wood_kept = wood_top_m(&level) / wood_m;
        judged(rows, &case, level, species, &original, top_m);
        rows.note(&case, "wood height kept", "", wood_kept, COMMAND);
    }
}

fn judged(
    rows: &mut Rows,
    case: &str,
    level: Skeleton,
    species: Species,
    original: &Tree,
    top_m: f64,
) {
    let (tree, now_m) = read_back(level, species);
    let triangles = tree.triangle_count() as f64 / original.triangle_count() as f64;
    rows.note(case, "triangles kept", "", triangles, COMMAND);
    rows.note(
        case,
        "leaves",
        "",
        tree.foliage().leaves().len() as f64,
        COMMAND,
    );
    rows.note(case, "height kept", "", now_m / top_m, COMMAND);
    scores(rows, case, original, &tree);
}

fn scores(rows: &mut Rows, case: &str, original: &Tree, simplified: &Tree) {
    let judging = Judging::held_out(original.foliage()).expect("a crown with leaves");
    let measured = secateur_eval::measure(original.foliage(), simplified.foliage(), &judging);
    let measured = measured.expect("a crown in range");
    for (metric, value) in measured.overall.iter() {
        if ["vmi_error_percent", "silhouette_iou", "coverage_ratio"].contains(&metric.key) {
            rows.note(case, metric.key, metric.unit, value, COMMAND);
        }
    }
}

/// Leaves taken away by rules, and as many by what the views show.
fn methods(rows: &mut Rows, species: Species, leaves: u32) {
    let (tree, _) = read_back(skeleton(species, leaves), species);
    let skeleton = tree.skeleton().expect("a sound skeleton").map(Arc::new);
    for ratio in [0.5, 0.25, 0.1] {
        for method in [
            Method::Chain(ChainOptions::default()),
            Method::Merge(MergeOptions::default()),
            Method::Vds(Preset::Information.vds()),
            Method::Stochastic(StochasticOptions::default()),
        ] {
            let case = format!(
                "{species} {leaves} to {} %, {}",
                100.0 * ratio,
                method.name()
            );
            let target = Target::leaf_share(ratio);
            let mut options = Options::with_preset(Preset::Information, target);
            options.method = method;
            options.skeleton = skeleton.clone();
            options.resolution = Resolution::Pixels(256);
            options.audit = false;
            let run = simplify(tree.foliage(), &options);
            let run = run.expect("a crown that can be simplified");
            let seconds = run
                .seconds
                .iter()
                .find(|(stage, _)| *stage == Stage::Select);
            rows.note(
                &case,
                "seconds",
                "s",
                seconds.map_or(f64::NAN, |s| s.1),
                COMMAND,
            );
            let bytes = tree.lod_to_bytes(&run.lod).expect("a level can be written");
            let document = Document::from_bytes("level", bytes, None);
            let selector = format!("material:{} leaf", species.name());
            let level = document
                .and_then(|d| d.into_tree(&[selector.parse().expect("a selector")]))
                .expect("and read");
            scores(rows, &case, &tree, &level);
        }
    }
}

/// Hybrid, section 4.1: level K in time proportional to K. Drawing alone: the chain
/// is there, and a level is given back after the clock has stopped.
fn extraction(rows: &mut Rows) {
    const POINTS: i32 = 13;
    let oak = skeleton(Species::Oak, 105_688);
    let chain = Chain::of(&oak, Metric::BranchingLength);
    let all = chain.levels();
    // From a sixty-fourth of the levels to all, each the root of two times the last.
    let share = |k: i32| 0.5f64.powf(0.5 * f64::from(POINTS - 1 - k));
    let levels: Vec<usize> = (0..POINTS)
        .map(|k| (all as f64 * share(k)).round() as usize)
        .collect();
    let mut least = vec![f64::INFINITY; levels.len()];
    // Round after round over all points, so that a slow moment is no one's alone.
    for _ in 0..repeats().max(40) {
        for (levels, least) in levels.iter().zip(&mut least) {
            let start = Instant::now();
            let level = chain.skeleton(*levels);
            *least = least.min(start.elapsed().as_secs_f64());
            drop(level);
        }
    }
    let mut points = Vec::new();
    for (levels, least) in levels.into_iter().zip(least) {
        let case = format!("chain of oak 105688, level {levels}");
        let records = chain.prefix(levels).len() as f64;
        rows.note(&case, "records", "", records, COMMAND);
        rows.note(&case, "extraction", "s", least, COMMAND);
        rows.note(&case, "per record", "ns", 1e9 * least / records, COMMAND);
        points.push((records, least, levels as f64));
    }
    let case = "chain of oak 105688, extraction";
    let by_records = exponent(points.iter().map(|p| (p.0, p.1)));
    let by_levels = exponent(points.iter().map(|p| (p.2, p.1)));
    rows.note(case, "exponent over records", "", by_records, COMMAND);
    rows.note(case, "exponent over levels", "", by_levels, COMMAND);
}
