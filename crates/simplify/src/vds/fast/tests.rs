//! Bounds against looking at every leaf, on crowns too large for the literal
//! algorithm: long runs in which all of a step's short cuts are taken.

use secateur_plant::{EllipsoidCrown, ellipsoid_crown};
use secateur_raster::CpuRasteriser;

use super::super::phases::phases;
use super::super::{Reference, Resize, Ties};
use super::*;
use crate::Target;

fn assert_every_pick_is_the_cheapest(
    leaf_count: u32,
    resolution: u32,
    cores: usize,
    change: fn(&mut VdsRun),
) {
    let crown = ellipsoid_crown(leaf_count, 3, &EllipsoidCrown::default()).unwrap();
    let views = ViewSet::dodecahedron(crown.bounding_sphere().unwrap());
    let mut job = VdsRun::to_leaves(views, resolution, u64::from(leaf_count) / 50);
    change(&mut job);
    let phases = phases(&job, &crown).unwrap();
    let table = LgTable::new();
    let mut run = Run {
        foliage: &crown,
        options: &job.options,
        resolution: job.resolution,
        max_error_percent: job.target.max_error_percent(),
        rasteriser: &CpuRasteriser,
        table: &table,
        lod: Lod::original(leaf_count as usize),
        order: RemovalOrder::new(leaf_count),
        costs_scaled: Vec::new(),
        steps_at_most: 0,
        progress: &mut |_| ControlFlow::Continue(()),
    };
    let mut view_set_loop = ViewSetLoop::new(&run, &phases[0].views, cores).unwrap();
    for step in 0..leaf_count as usize - job.target.fewest_leaves(&crown) {
        let (finds, expected) = view_set_loop.step_and_exhaustively(&mut run);
        assert_eq!(finds.cheapest, expected.cheapest, "step {step}");
        if job.options.resize == Resize::Normalised {
            assert_eq!(finds.largest, expected.largest, "step {step}");
        }
    }
}

#[test]
fn where_leaves_are_specks() {
    assert_every_pick_is_the_cheapest(6000, 64, 2, |_| {});
}

#[test]
fn where_leaves_cover_many_pixels() {
    assert_every_pick_is_the_cheapest(1500, 128, 1, |job| job.options.ties = Ties::Spread);
}

#[test]
fn where_hardly_a_pixel_is_background() {
    for resolution in 1..4 {
        assert_every_pick_is_the_cheapest(800, resolution, 2, |_| {});
    }
}

#[test]
fn where_nothing_grows() {
    assert_every_pick_is_the_cheapest(3000, 64, 4, |job| {
        job.options.resize = Resize::None;
        job.options.reference = Reference::Previous;
    });
}

#[test]
fn where_growth_is_full() {
    assert_every_pick_is_the_cheapest(3000, 96, 2, |job| {
        job.options.resize = Resize::Full;
        job.target = Target::leaves(300);
    });
}
