//! What it costs to hold all levels of a foliage and to change between them: bytes a leaf, and time
//! a change, uniform and view-dependent. One core.
//!
//! `cargo bench --bench lod_model [-- PART]`; PART picks cases by name.

mod rows;

use std::ops::ControlFlow;
use std::time::Instant;

use glam::DVec3;
use rows::{Rows, Wanted, exponent};
use secateur_model::{Foliage, Growth, LodModel, RemovalOrder};
use secateur_plant::{EllipsoidCrown, Random, ellipsoid_crown};
use secateur_runtime::order_file::{read_order, write_order};
use secateur_runtime::view_dependent::{InSphere, ViewDependent};
use secateur_simplify::fsa::{self, FsaOptions};
use secateur_simplify::stochastic::{self, StochasticOptions};
use secateur_simplify::{Options, Preset, Resolution, Target, simplify};

/// Of the uniform model's target, and of the paper's tree.
const MANY_LEAVES: u32 = 100_000;
const LEAVES: u32 = 20_376;

fn main() {
    let wanted = Wanted::from_command_line();
    let mut rows = Rows::create("lod_model");
    if wanted.has("uniform") {
        let foliage = crown(MANY_LEAVES);
        for (name, order) in orders(&foliage) {
            uniform(&mut rows, name, order, &foliage);
        }
    }
    if wanted.has("refine") {
        let foliage = crown(LEAVES);
        // Neighbours by lot are no neighbours: what they stand for is all of the crown.
        let [collapsed, pruned, _] = orders(&foliage);
        for (name, order) in [collapsed, pruned, viewpoint_driven(&foliage)] {
            refine(&mut rows, name, order, &foliage);
        }
    }
    if wanted.has("file") {
        let foliage = crown(LEAVES);
        let orders = orders(&foliage).into_iter();
        for (name, order) in orders.chain([viewpoint_driven(&foliage)]) {
            file(&mut rows, name, order, &foliage);
        }
    }
}

/// To a tenth, with the defaults of `simplify`.
fn viewpoint_driven(foliage: &Foliage) -> (&'static str, RemovalOrder) {
    let options = Options {
        resolution: Resolution::Pixels(256),
        ..Options::with_preset(Preset::Look, Target::leaf_share(0.1))
    };
    let result = simplify(foliage, &options).expect("a crown can be simplified");
    ("vds to 10 %, sizes fitted", result.passes.in_one_order())
}

fn crown(leaves: u32) -> Foliage {
    ellipsoid_crown(leaves, 1, &EllipsoidCrown::default()).expect("a crown")
}

/// Orders down to a leaf or two. In that by lot each leaf that goes lets another grow, wherever that
/// is: no memory is touched twice in a row.
fn orders(foliage: &Foliage) -> [(&'static str, RemovalOrder); 3] {
    let go_on = &mut |_| ControlFlow::Continue(());
    let collapsed = fsa::simplify(foliage, 1, &FsaOptions::default(), go_on);
    let pruned = stochastic::simplify(foliage, 1, &StochasticOptions::default());
    let mut by_lot = RemovalOrder::new(foliage.leaves().len() as u32);
    let removed = pruned.removed();
    let mut random = Random::new(1);
    for (index, leaf) in removed.iter().enumerate().take(removed.len() - 1) {
        let others = &removed[index + 1..];
        let grown = others[(random.bits() % others.len() as u64) as usize];
        let area_scale = 1.0 + index as f64 / 3.0;
        by_lot.push(
            *leaf,
            &[Growth {
                leaf: grown,
                area_scale,
            }],
        );
    }
    [
        ("fsa", collapsed.expect("not broken off")),
        ("stochastic", pruned),
        ("one goes, one grows, by lot", by_lot),
    ]
}

fn ms(start: Instant) -> f64 {
    start.elapsed().as_secs_f64() * 1e3
}

/// A change of 1 % of the leaves, down and up, from levels all over the range.
fn uniform(rows: &mut Rows, name: &str, order: RemovalOrder, foliage: &Foliage) {
    let model = LodModel::new(order, foliage).expect("an order of the crown");
    let all = foliage.leaves().len();
    let (from, change) = (model.fewest_leaves().max(1), all / 100);
    let mut level = model.finest();
    let mut times = Vec::new();
    for share in 0..100 {
        let leaves = all - (all - from) * share / 100;
        for to in [leaves, leaves.saturating_sub(change).max(from), leaves] {
            let start = Instant::now();
            level.uniform(to);
            let taken = ms(start);
            if level.changed().len() > change / 2 {
                times.push(taken);
            }
        }
    }
    let case = format!("uniform: {name}, {all} leaves, 1 %");
    let command = "cargo bench --bench lod_model -- uniform";
    note_times(rows, &case, &mut times, command);
}

/// The median, which other programs on the machine hardly change, and the ninth of ten. Returns the
/// median.
fn note_times(rows: &mut Rows, case: &str, times: &mut [f64], command: &str) -> f64 {
    times.sort_by(f64::total_cmp);
    let [median, ninth] = [5, 9].map(|tenths| times[times.len() * tenths / 10]);
    rows.note(case, "median time", "ms", median, command);
    rows.note(case, "nine of ten times", "ms", ninth, command);
    median
}

/// A sphere of full detail that goes through the crown in 200 steps, for several sizes.
fn refine(rows: &mut Rows, name: &str, order: RemovalOrder, foliage: &Foliage) {
    let model = LodModel::new(order, foliage).expect("an order of the crown");
    let sphere = foliage.bounding_sphere().expect("leaves");
    let command = "cargo bench --bench lod_model -- refine";
    let case = format!("refine: {name}, {} leaves", foliage.leaves().len());
    let start = Instant::now();
    let mut cut = ViewDependent::new(&model, foliage);
    rows.note(&case, "forest", "ms", ms(start), command);
    let mut points = Vec::new();
    for radius in [0.1, 0.2, 0.4, 0.8, 1.6] {
        let (mut times, mut active, mut changes) = (Vec::new(), 0, 0);
        let steps = 200;
        for step in 0..=steps {
            let along = 2.0 * f64::from(step) / f64::from(steps) - 1.0;
            let mut criterion = InSphere {
                centre: sphere.centre + along * sphere.radius * DVec3::X,
                radius: radius * sphere.radius,
            };
            let start = Instant::now();
            let refined = cut.refine(&mut criterion);
            let taken = ms(start);
            // The first step comes from another sphere.
            if step > 0 {
                times.push(taken);
                active += cut.active_count();
                changes += refined.collapses + refined.splits;
            }
        }
        let case = format!("{case}, sphere of {radius} r");
        let mean = |sum: usize| sum as f64 / f64::from(steps);
        let median = note_times(rows, &case, &mut times, command);
        rows.note(&case, "active nodes", "", mean(active), command);
        rows.note(&case, "changes", "", mean(changes), command);
        points.push((mean(active), median));
    }
    let exponent = exponent(points.into_iter());
    rows.note(&case, "exponent of time over nodes", "", exponent, command);
}

fn file(rows: &mut Rows, name: &str, order: RemovalOrder, foliage: &Foliage) {
    let leaves = foliage.leaves().len();
    let model = LodModel::new(order, foliage).expect("an order of the crown");
    let command = "cargo bench --bench lod_model -- file";
    let case = format!("file: {name}, {leaves} leaves");
    let start = Instant::now();
    let bytes = write_order(&model, foliage);
    rows.note(&case, "write", "ms", ms(start), command);
    let start = Instant::now();
    let read = read_order(&bytes, foliage).expect("what was written");
    rows.note(&case, "read", "ms", ms(start), command);
    assert_eq!(read, model);
    rows.note(
        &case,
        "bytes a leaf",
        "",
        bytes.len() as f64 / leaves as f64,
        command,
    );
}
