//! What a run takes of its memory, reckoned from counts before it is taken.

use secateur_model::{Budget, Foliage, OverMemory, Remedy};
use secateur_raster::{
    AreaTable, Fragments, MAX_TOTAL_PIXELS, OpenEngine, RasterError, Rasteriser, Scene,
    TooManyFragments, ViewSet,
};

use crate::resolution::least_resolution;
use crate::{Method, Options, sphere_of};

/// What a fragment takes where it takes most: 8 bytes in its list, and 16 while the list of its
/// view is made; later 8 in the A-buffer, half as many for lists that grow, and 4 to find it by its
/// leaf.
pub(crate) const BYTES_A_FRAGMENT: u64 = 24;

/// What a pixel takes: its place in the lists and in the A-buffer, and its first two leaves.
pub(crate) const BYTES_A_PIXEL: u64 = 28;

/// Bytes that a leaf takes for each view: areas, and what depends on them on each core of the
/// exact engine's loop.
const BYTES_A_LEAF_AND_VIEW: u64 = 4 * (4 + crate::vds::fast::MAX_CORES as u64);

/// What a leaf takes besides: its neighbours, its edges, its cost, its place in orders.
const BYTES_A_LEAF: u64 = 600;

/// What a leaf takes where leaves are collapsed: it and what it becomes, with places and shapes.
const BYTES_A_COLLAPSED_LEAF: u64 = 2000;

/// What a triangle of a whole plant's wood takes: in the forms that it may have, and where it hides leaves. As
/// measured of an oak of 2,000 to 30,000 leaves (`tests/peak_memory`), as is what a leaf takes.
const BYTES_A_WOOD_TRIANGLE: u64 = 600;

/// What a leaf of a whole plant takes beside the run over all leaves: in what levels share, and as it is drawn.
const BYTES_A_LEAF_OF_PLANT: u64 = 3200;

/// Takes what levels of a whole plant need beside the runs over its leaves.
///
/// # Errors
/// [`OverMemory`] if that is not left.
pub fn take_plant(budget: &mut Budget, leaves: &Foliage, wood: &Foliage) -> Result<(), OverMemory> {
    let [leaves, wood] = [leaves.leaves().len(), wood.triangles().len()].map(|n| n as u64);
    let bytes = BYTES_A_LEAF_OF_PLANT * leaves + BYTES_A_WOOD_TRIANGLE * wood;
    let what = || format!("a plant of {leaves} leaves and {wood} triangles of wood");
    budget.take(bytes, what, ALLOW_MORE)
}

/// What to do where views take too much memory.
pub(crate) const LOOK_LESS: Remedy = Remedy::FewerPixels;

/// What to do where leaves have grown so large that their lists take too much memory.
const GROW_LESS: Remedy = Remedy::LessGrowth;

/// What to do where the foliage alone takes too much.
const ALLOW_MORE: Remedy = Remedy::LessFoliage;

/// Takes what a run needs for its leaves and for the pixels of its views, and leaves the rest for
/// what the views show.
pub(crate) fn take_run(
    budget: &mut Budget,
    foliage: &Foliage,
    options: &Options,
    views: &ViewSet,
    resolution: u32,
) -> Result<(), OverMemory> {
    let of_foliage = size_of_val(foliage.leaves()) + size_of_val(foliage.triangles());
    let a_leaf = match options.method {
        Method::Fsa(_) => BYTES_A_COLLAPSED_LEAF,
        _ => BYTES_A_LEAF,
    };
    let [leaves, views] = [foliage.leaves().len() as u64, views.len() as u64];
    let bytes = 2 * of_foliage as u64 + leaves * (a_leaf + views * BYTES_A_LEAF_AND_VIEW);
    let what = || format!("{leaves} leaves in {views} views");
    budget.take(bytes, what, ALLOW_MORE)?;
    // Now, and not after an hour of other passes.
    after_pixels(budget, views, resolution, LOOK_LESS)?;
    Ok(())
}

/// Whether a run over these leaves may fit in what is left of a budget, as far as counts tell before anything is drawn.
///
/// # Errors
/// [`OverMemory`] if it does not.
pub fn check_run(budget: &Budget, leaves: &Foliage, options: &Options) -> Result<(), OverMemory> {
    // What is out of range is refused later, in words that no memory helps.
    let Ok(sphere) = sphere_of(leaves) else {
        return Ok(());
    };
    let views = options.first_views(sphere);
    let resolution = least_resolution(options);
    if u64::from(resolution).pow(2) * views.len() as u64 > MAX_TOTAL_PIXELS {
        return Ok(());
    }
    take_run(&mut { *budget }, leaves, options, &views, resolution)
}

/// What the pixels of views leave of a budget.
fn after_pixels(
    budget: &Budget,
    views: u64,
    resolution: u32,
    remedy: Remedy,
) -> Result<Budget, OverMemory> {
    let mut left = *budget;
    let bytes = BYTES_A_PIXEL * views * u64::from(resolution).pow(2);
    let what = || format!("{views} views of {resolution} x {resolution} pixels");
    left.take(bytes, what, remedy)?;
    Ok(left)
}

/// A rasteriser whose lists of fragments keep to what is left of a budget.
pub(crate) struct Within<'a> {
    pub(crate) engine: &'a OpenEngine,
    pub(crate) budget: Budget,
}

impl Rasteriser for Within<'_> {
    fn fragments(&self, scene: &Scene<'_>) -> Result<Fragments, RasterError> {
        let room = Room::for_lists(&self.budget, scene, LOOK_LESS)?;
        let fragments = self.engine.fragments_within(scene, room.most());
        fragments.map_err(|error| room.explain(error, scene))
    }

    fn fragments_and_areas_within(
        &self,
        scene: &Scene<'_>,
        most: u64,
    ) -> Result<(Fragments, AreaTable), RasterError> {
        let room = Room::for_lists(&self.budget, scene, LOOK_LESS)?;
        let most = most.min(room.most());
        let both = self.engine.fragments_and_areas_within(scene, most);
        both.map_err(|error| room.explain(error, scene))
    }

    fn areas(&self, scene: &Scene<'_>) -> Result<AreaTable, RasterError> {
        self.engine.areas(scene)
    }

    fn may_lists_take(&self, scene: &Scene<'_>, bytes: u64) -> Result<(), RasterError> {
        let mut room = Room::for_lists(&self.budget, scene, GROW_LESS)?;
        let what = || room_of_grown(scene);
        Ok(room.left.take(bytes, what, GROW_LESS)?)
    }

    fn is_gpu(&self) -> bool {
        self.engine.is_gpu()
    }
}

/// What is left for the lists of fragments of a scene.
pub(crate) struct Room {
    left: Budget,
    remedy: Remedy,
}

impl Room {
    /// What the scene's pixels leave of a budget.
    ///
    /// # Errors
    /// [`OverMemory`] if these alone take more.
    pub(crate) fn for_lists(
        budget: &Budget,
        scene: &Scene<'_>,
        remedy: Remedy,
    ) -> Result<Self, OverMemory> {
        let views = scene.views.len() as u64;
        let left = after_pixels(budget, views, scene.resolution, remedy)?;
        Ok(Self { left, remedy })
    }

    /// How many fragments fit.
    pub(crate) fn most(&self) -> u64 {
        self.left.left() / BYTES_A_FRAGMENT
    }

    /// What is left after this number of fragments, which must fit.
    pub(crate) fn after(mut self, fragments: u64) -> Result<Budget, OverMemory> {
        self.left
            .take(BYTES_A_FRAGMENT * fragments, String::new, self.remedy)?;
        Ok(self.left)
    }

    /// The error, in words of memory where there are too many fragments.
    fn explain(&self, error: RasterError, scene: &Scene<'_>) -> RasterError {
        match error.downcast::<TooManyFragments>() {
            Ok(too_many) => self.lacks(&too_many, scene).into(),
            Err(other) => other,
        }
    }

    /// What is wrong with too many fragments.
    pub(crate) fn lacks(&self, found: &TooManyFragments, scene: &Scene<'_>) -> OverMemory {
        let [leaves, views] = [scene.lod.leaf_count(), scene.views.len()];
        let side = scene.resolution;
        OverMemory {
            what: format!(
                "{leaves} leaves behind each other in {views} views of {side} x {side} pixels"
            ),
            bytes: BYTES_A_FRAGMENT.saturating_mul(found.found),
            left: self.left.left(),
            remedy: self.remedy,
        }
    }
}

fn room_of_grown(scene: &Scene<'_>) -> String {
    let [leaves, views] = [scene.lod.leaf_count(), scene.views.len()];
    let side = scene.resolution;
    format!("{leaves} leaves, grown, in {views} views of {side} x {side} pixels")
}

#[cfg(test)]
mod tests {
    use std::ops::ControlFlow;

    use glam::DVec3;
    use secateur_model::{LeafTriangle, Memory};
    use secateur_raster::OpenEngine;

    use super::*;
    use crate::{Error, Fitting, Resolution, Target, simplify, simplify_on};

    /// `leaves` unit squares at one place.
    fn pile(leaves: usize) -> Foliage {
        let corners = [DVec3::ZERO, DVec3::X, DVec3::X + DVec3::Y, DVec3::Y];
        let square =
            [[0, 1, 2], [0, 2, 3]].map(|t| LeafTriangle::plain(t.map(|k: usize| corners[k])));
        let mut foliage = Foliage::default();
        for _ in 0..leaves {
            foliage.push_leaf(&square, None).unwrap();
        }
        foliage
    }

    fn options(bytes: u64, fit: Fitting) -> Options {
        Options {
            resolution: Resolution::Pixels(64),
            memory: Memory::Bytes(bytes),
            fit,
            audit: false,
            ..Options::to(Target::leaf_share(0.5))
        }
    }

    fn refusal(foliage: &Foliage, options: &Options) -> OverMemory {
        match simplify(foliage, options) {
            Err(Error::Memory(over)) => over,
            other => panic!("{:?}", other.map(|result| result.lod.leaf_count())),
        }
    }

    /// What is refused says what it would take, and with that it is not refused; more threads
    /// need no more.
    #[test]
    fn what_a_run_says_it_takes_is_enough() {
        let foliage = pile(400);
        let of_pixels = refusal(&foliage, &options(2 << 20, Fitting::None));
        assert!(
            of_pixels.what.contains("20 views of 64 x 64"),
            "{of_pixels}"
        );
        // So much is known before anything is drawn.
        let check = |bytes: u64| {
            let budget = Budget::new(Memory::Bytes(bytes));
            check_run(&budget, &foliage, &options(bytes, Fitting::None))
        };
        assert_eq!(check(2 << 20), Err(of_pixels));
        assert_eq!(check(8 << 20), Ok(()));
        let of_lists = refusal(&foliage, &options(8 << 20, Fitting::None));
        assert!(of_lists.what.contains("400 leaves behind"), "{of_lists}");
        let enough = (8 << 20) + of_lists.bytes - of_lists.left;
        for threads in [1, 3] {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
            pool.build().unwrap().install(|| {
                assert_eq!(
                    refusal(&foliage, &options(8 << 20, Fitting::None)),
                    of_lists
                );
                refusal(&foliage, &options(enough - BYTES_A_FRAGMENT, Fitting::None));
                simplify(&foliage, &options(enough, Fitting::None)).unwrap();
            });
        }
    }

    #[test]
    fn sizes_are_fitted_within_the_memory_too() {
        let foliage = pile(40);
        for fit in [Fitting::Coverage, Fitting::Weight(1.0)] {
            let over = refusal(&foliage, &options(24 << 20, fit));
            assert!(over.remedy == Remedy::NoFit, "{over}");
        }
        let mut stages = Vec::new();
        let watch = &mut |progress| {
            if let crate::Progress::Stage(stage) = progress {
                stages.push(stage);
            }
            ControlFlow::Continue(())
        };
        simplify_on(
            &OpenEngine::cpu(),
            &foliage,
            &options(1 << 30, Fitting::Coverage),
            watch,
        )
        .unwrap();
        assert!(stages.contains(&crate::Stage::Fit));
    }
}
