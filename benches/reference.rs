//! The fast engine against the literal algorithm, whole runs of 300 leaves to
//! 30 on the same machine: `cargo bench --bench reference`.

mod rows;

use std::ops::ControlFlow;
use std::time::Instant;

use rows::{Row, Rows};
use secateur_plant::{EllipsoidCrown, ellipsoid_crown};
use secateur_raster::{CpuRasteriser, ViewSet};
use secateur_simplify::vds::{Progress, VdsRun, fast, reference};

fn main() {
    let mut rows = Rows::create("reference");
    let foliage = ellipsoid_crown(300, 1, &EllipsoidCrown::default()).expect("a crown");
    let sphere = foliage.bounding_sphere().expect("the crown has leaves");
    let job = VdsRun::to_leaves(ViewSet::dodecahedron(sphere), 256, 30);
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
    let repeats = 2 * rows::repeats().max(5);
    let (mut fast_s, mut outcomes) = (Vec::new(), Vec::new());
    let mut run_fast = || {
        let start = Instant::now();
        let outcome = fast::simplify(&foliage, &job, &CpuRasteriser, go_on);
        fast_s.push(start.elapsed().as_secs_f64());
        outcomes.push(outcome.expect("a run"));
    };
    // The literal run takes minutes, in which a shared machine may become another
    // and back: fast runs are spread over its steps, and their time is not its.
    let mut between_s = 0.0;
    let start = Instant::now();
    let literal = reference::simplify(&foliage, &job, &mut |progress: Progress| {
        let every = progress.steps_at_most.div_ceil(repeats);
        if progress.steps.is_multiple_of(every) {
            let start = Instant::now();
            run_fast();
            between_s += start.elapsed().as_secs_f64();
        }
        ControlFlow::Continue(())
    });
    let literal_s = start.elapsed().as_secs_f64() - between_s;
    let literal = literal.expect("a run");
    assert!(
        outcomes.iter().all(|o| *o == literal),
        "the very same result"
    );
    for (repeat, seconds) in (0..).zip(&fast_s) {
        add("fast", "s", *seconds, repeat);
    }
    add("literal on all cores", "s", literal_s, 0);
    fast_s.sort_by(f64::total_cmp);
    let median = fast_s[fast_s.len() / 2];
    add("literal over median fast", "times", literal_s / median, 0);
}
