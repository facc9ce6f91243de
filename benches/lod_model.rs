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
use secateur_scene::order_file::{read_order, write_order};
use secateur_scene::view_dependent::{InSphere, ViewDependent};
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
        for (name, order) in orders(&foliage) {
            refine(&mut rows, name, order, &foliage);
        }
    }
    if wanted.has("file") {
        let foliage = crown(LEAVES);
        for (name, order) in orders(&foliage) {
            file(&mut rows, name, order, &foliage);
        }
        let options = Options {
            resolution: Resolution::Pixels(256),
            ..Options::with_preset(Preset::Look, Target::leaf_share(0.1))
        };
        let result = simplify(&foliage, &options).expect("a crown can be simplified");
        let order = result.passes.in_one_order();
        file(
            &mut rows,
            "vds to 10 %, sizes fitted",
            order.clone(),
            &foliage,
        );
        refine(&mut rows, "vds to 10 %, sizes fitted", order, &foliage);
    }
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
    let (mut sum, mut most, mut count) = (0.0, 0.0_f64, 0);
    for share in 0..100 {
        let leaves = all - (all - from) * share / 100;
        for to in [leaves, leaves.saturating_sub(change).max(from), leaves] {
            let start = Instant::now();
            level.uniform(to);
            let taken = ms(start);
            if level.changed().len() > change / 2 {
                (sum, most, count) = (sum + taken, most.max(taken), count + 1);
            }
        }
    }
    let case = format!("uniform: {name}, {all} leaves, 1 %");
    let command = "cargo bench --bench lod_model -- uniform";
    rows.note(&case, "mean time", "ms", sum / f64::from(count), command);
    rows.note(&case, "longest time", "ms", most, command);
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
        let (mut sum, mut most, mut active, mut changes) = (0.0, 0.0_f64, 0, 0);
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
                (sum, most) = (sum + taken, most.max(taken));
                active += cut.active_count();
                changes += refined.collapses + refined.splits;
            }
        }
        let case = format!("{case}, sphere of {radius} r");
        let mean = |sum: f64| sum / f64::from(steps);
        rows.note(&case, "mean time", "ms", mean(sum), command);
        rows.note(&case, "longest time", "ms", most, command);
        rows.note(&case, "active nodes", "", mean(active as f64), command);
        rows.note(&case, "changes", "", mean(changes as f64), command);
        points.push((mean(active as f64), mean(sum)));
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
