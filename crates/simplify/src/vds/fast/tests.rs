//! Bounds against looking at every leaf, on crowns too large for the literal
//! algorithm: long runs in which all of a step's short cuts are taken.

use secateur_plant::{EllipsoidCrown, ellipsoid_crown};
use secateur_raster::CpuRasteriser;

use super::super::phases::phases;
use super::super::{Stop, Ties};
use super::*;

fn assert_every_pick_is_the_cheapest(
    leaf_count: u32,
    resolution: u32,
    change: fn(&mut VdsOptions),
) {
    let crown = ellipsoid_crown(leaf_count, 3, &EllipsoidCrown::default()).unwrap();
    let views = ViewSet::dodecahedron(crown.bounding_sphere().unwrap());
    let mut options = VdsOptions::new(views, resolution, leaf_count as usize / 50);
    change(&mut options);
    let phases = phases(&options, leaf_count as usize).unwrap();
    let table = LgTable::new();
    let mut run = Run {
        foliage: &crown,
        options: &options,
        rasteriser: &CpuRasteriser,
        table: &table,
        lod: Lod::original(leaf_count as usize),
        order: RemovalOrder::new(leaf_count),
        costs_scaled: Vec::new(),
        steps_at_most: 0,
        progress: &mut |_| ControlFlow::Continue(()),
    };
    let mut stage = Stage::new(&run, &phases[0].views).unwrap();
    for step in 0..leaf_count as usize - options.stop.leaves {
        let cheapest = stage.pick(&run);
        let (least, largest) = stage.candidates.exhaustively(&stage.counts);
        assert_eq!(cheapest, least, "step {step}");
        assert_eq!(
            stage.candidates.largest_cost(&stage.counts),
            largest,
            "step {step}"
        );
        let grown = stage.grow(&run, cheapest);
        stage.apply(&run, cheapest.leaf, &grown);
        run.lod.remove(leaf_id(cheapest.leaf));
        for growth in &grown {
            run.lod.resize(growth.leaf, growth.area_scale);
        }
    }
}

#[test]
fn where_leaves_are_specks() {
    assert_every_pick_is_the_cheapest(6000, 64, |_| {});
}

#[test]
fn where_leaves_cover_many_pixels() {
    assert_every_pick_is_the_cheapest(1500, 128, |options| options.ties = Ties::Spread);
}

#[test]
fn where_nothing_grows() {
    assert_every_pick_is_the_cheapest(3000, 64, |options| {
        options.resize = Resize::None;
        options.reference = Reference::Previous;
    });
}

#[test]
fn where_growth_is_full() {
    assert_every_pick_is_the_cheapest(3000, 96, |options| {
        options.resize = Resize::Full;
        options.stop = Stop {
            leaves: 300,
            max_error_percent: None,
        };
    });
}
