//! The fast engine against the literal algorithm, whole runs of 300 leaves to
//! 30 on the same machine: `cargo bench --bench reference`.

mod rows;

use std::ops::ControlFlow;
use std::time::Instant;

use rows::{Row, Rows};
use secateur_plant::{EllipsoidCrown, ellipsoid_crown};
use secateur_raster::{CpuRasteriser, ViewSet};
use secateur_simplify::vds::{Progress, VdsOptions, fast, reference};

fn main() {
    let mut rows = Rows::create("reference");
    let foliage = ellipsoid_crown(300, 1, &EllipsoidCrown::default()).expect("a crown");
    let sphere = foliage.bounding_sphere().expect("the crown has leaves");
    let options = VdsOptions::new(ViewSet::dodecahedron(sphere), 256, 30);
    let go_on = &mut |_: Progress| ControlFlow::Continue(());
    let mut add = |quantity, unit, value, repeat| {
        rows.add(&Row {
            case: "crown_300 to 30 at 256, 20 views",
            quantity,
            unit,
            value,
            repeat,
            adapter: "cpu",
            command: "cargo bench --bench reference",
        });
    };
    let mut least = f64::INFINITY;
    let mut order = None;
    for repeat in 0..rows::repeats() {
        let start = Instant::now();
        let outcome = fast::simplify(&foliage, &options, &CpuRasteriser, go_on).expect("a run");
        let seconds = start.elapsed().as_secs_f64();
        add("fast", "s", seconds, repeat);
        least = least.min(seconds);
        order = Some(outcome);
    }
    let start = Instant::now();
    let literal = reference::simplify(&foliage, &options, go_on).expect("a run");
    let seconds = start.elapsed().as_secs_f64();
    assert_eq!(order.as_ref(), Some(&literal), "the very same result");
    add("literal on all cores", "s", seconds, 0);
    add("literal over least fast", "times", seconds / least, 0);
}
