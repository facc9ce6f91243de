//! Bounds against looking at every leaf, on crowns too large for the literal
//! algorithm: long runs in which all of a step's short cuts are taken.

use std::cell::{Cell, RefCell};

use secateur_model::{OverMemory, Remedy};
use secateur_plant::{EllipsoidCrown, ellipsoid_crown};
use secateur_raster::{CpuRasteriser, Fragments, RasterError};

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
    let mut run = FastRun {
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
        // What is asked where leaves without effect go, one after the other.
        let with_effect = expected.cheapest_with_effect;
        match with_effect.cost == expected.cheapest.cost {
            true => assert_eq!(finds.cheapest_with_effect, with_effect, "step {step}"),
            false => assert!(finds.cheapest_with_effect >= with_effect, "step {step}"),
        }
        if job.options.resize.needs_largest_cost() {
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

/// Passes on what it is asked, and says that it is a GPU.
struct AsGpu<'a> {
    rasteriser: &'a dyn Rasteriser,
    asked: RefCell<Vec<&'static str>>,
}

impl Rasteriser for AsGpu<'_> {
    fn fragments(&self, scene: &Scene<'_>) -> Result<Fragments, RasterError> {
        self.asked.borrow_mut().push("fragments");
        self.rasteriser.fragments(scene)
    }

    fn fragments_and_areas_within(
        &self,
        scene: &Scene<'_>,
        most: u64,
    ) -> Result<(Fragments, AreaTable), RasterError> {
        self.asked.borrow_mut().push("fragments and areas");
        self.rasteriser.fragments_and_areas_within(scene, most)
    }

    fn areas(&self, scene: &Scene<'_>) -> Result<AreaTable, RasterError> {
        self.asked.borrow_mut().push("areas");
        self.rasteriser.areas(scene)
    }

    fn is_gpu(&self) -> bool {
        true
    }
}

/// The areas that costs begin with and those of the result are counted where the leaves
/// are drawn, and are those that the loop on the CPU has kept.
fn assert_areas_come_from(rasteriser: &dyn Rasteriser) {
    let crown = ellipsoid_crown(900, 3, &EllipsoidCrown::default()).unwrap();
    let sphere = crown.bounding_sphere().unwrap();
    for resolution in [48, 100] {
        let job = VdsRun::to_leaves(ViewSet::dodecahedron(sphere), resolution, 300);
        let simplify = |rasteriser: &dyn Rasteriser| {
            let go_on = &mut |_: Progress| ControlFlow::Continue(());
            simplify(&crown, &job, rasteriser, go_on).unwrap()
        };
        let noted = AsGpu {
            rasteriser,
            asked: RefCell::default(),
        };
        assert_eq!(simplify(&noted), simplify(&CpuRasteriser));
        assert_eq!(*noted.asked.borrow(), ["fragments and areas", "areas"]);
    }
}

#[test]
fn a_gpu_is_asked_for_the_first_areas_and_the_last() {
    assert_areas_come_from(&CpuRasteriser);
}

#[cfg(feature = "gpu")]
#[test]
fn the_areas_of_a_gpu_are_those_of_the_cpu() {
    use secateur_raster::gpu::{Device, Preference};
    match Device::find(Preference::Any) {
        Ok(device) => assert_areas_come_from(&device),
        Err(error) => {
            let is_required = std::env::var("SECATEUR_REQUIRE_GPU").is_ok_and(|v| v == "1");
            assert!(!is_required, "SECATEUR_REQUIRE_GPU=1, but: {error}");
            eprintln!("areas of a GPU skipped: {error}");
        }
    }
}

/// Draws on the CPU, and notes or refuses what lists take as leaves grow.
struct Metered {
    most_bytes: u64,
    largest_bytes: Cell<u64>,
}

impl Rasteriser for Metered {
    fn fragments(&self, scene: &Scene<'_>) -> Result<Fragments, RasterError> {
        CpuRasteriser.fragments(scene)
    }

    fn areas(&self, scene: &Scene<'_>) -> Result<AreaTable, RasterError> {
        CpuRasteriser.areas(scene)
    }

    fn may_lists_take(&self, _: &Scene<'_>, bytes: u64) -> Result<(), RasterError> {
        self.largest_bytes.set(self.largest_bytes.get().max(bytes));
        match bytes > self.most_bytes {
            true => Err(Box::new(OverMemory {
                what: "lists".to_owned(),
                bytes,
                left: self.most_bytes,
                remedy: Remedy::LessGrowth,
            })),
            false => Ok(()),
        }
    }
}

/// A crown keeps its area however large its leaves get, so its lists keep their size; places
/// that they left for others are taken back. What is refused ends the run.
#[test]
fn growing_leaves_take_no_more_memory_and_ask_for_it() {
    let crown = ellipsoid_crown(2000, 3, &EllipsoidCrown::default()).unwrap();
    let views = ViewSet::dodecahedron(crown.bounding_sphere().unwrap());
    let mut job = VdsRun::to_leaves(views.clone(), 96, 40);
    job.options.resize = Resize::Full;
    job.options.max_coverage = None;
    let run = |most_bytes| {
        let metered = Metered {
            most_bytes,
            largest_bytes: Cell::new(0),
        };
        let go_on = &mut |_: Progress| ControlFlow::Continue(());
        let ended = simplify(&crown, &job, &metered, go_on).map(|outcome| outcome.order.len());
        (ended, metered.largest_bytes.get())
    };
    let (ended, largest_bytes) = run(u64::MAX);
    assert_eq!(ended.unwrap(), 1960);
    let original = Lod::original(2000);
    let fragments = CpuRasteriser.fragments(&Scene {
        foliage: &crown,
        lod: &original,
        views: &views,
        resolution: 96,
    });
    let at_first = 12 * fragments.unwrap().len() as u64;
    assert!(largest_bytes < 3 * at_first, "{largest_bytes} {at_first}");
    let (ended, _) = run(largest_bytes - 1);
    assert!(matches!(ended, Err(VdsError::Memory(_))), "{ended:?}");
}
