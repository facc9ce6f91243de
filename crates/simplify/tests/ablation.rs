//! What the ablation bench measures is the same work: without any of the exact
//! engine's short cuts, and without all of them, it finds the same.
//!
//! The switches hold for the whole process, so this test has one of its own.

use std::ops::ControlFlow;

use secateur_plant::{EllipsoidCrown, ellipsoid_crown};
use secateur_raster::{CpuRasteriser, ViewSet};
use secateur_simplify::vds::fast::{self, Mechanism, switch_off};
use secateur_simplify::vds::{Progress, Reference, Resize, VdsOptions, VdsRun};

#[test]
fn the_result_is_the_same_without_any_short_cut() {
    // Small leaves, of which many cover the same few pixels, so that each short
    // cut is taken.
    let crown = ellipsoid_crown(700, 5, &EllipsoidCrown::default()).unwrap();
    let views = ViewSet::dodecahedron(crown.bounding_sphere().unwrap());
    let information = VdsRun::to_leaves(views, 40, 70);
    let look = VdsRun {
        options: VdsOptions {
            reference: Reference::Previous,
            resize: Resize::Full,
            max_coverage: Some(1.0),
            ..information.options
        },
        ..information.clone()
    };
    for job in [information, look] {
        let run = |off: &[Mechanism]| {
            switch_off(off);
            let go_on = &mut |_: Progress| ControlFlow::Continue(());
            fast::simplify(&crown, &job, &CpuRasteriser, go_on).unwrap()
        };
        let expected = run(&[]);
        for mechanism in Mechanism::ALL {
            let found = run(&[*mechanism]);
            assert_eq!(found, expected, "without {}", mechanism.name());
        }
        assert_eq!(run(Mechanism::ALL), expected, "without any");
    }
}
