//! Leaves to fragments: the A-buffer.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use rayon::prelude::*;
use secateur_model::{Cutout, Foliage, Leaf, LeafId, LeafTriangle};

use super::canvas::Canvas;
use super::histogram::table_of;
use crate::occluders::Occlusion;
use crate::snap::Snapper;
use crate::{
    AreaTable, Fragment, Fragments, Scene, SnappedTriangle, TooManyFragments, View, ViewFragments,
};

/// The fragments of all views of a scene.
///
/// Takes time in proportion to triangles times views, with the rows of their
/// boxes, plus fragments, and 8
/// bytes a fragment, plus 16 for those of the views at work.
///
/// # Panics
/// If the scene's resolution, pixels or fragments (over 2^32) are out of range.
pub fn fragments(scene: &Scene<'_>) -> Fragments {
    match fragments_within(scene, u64::from(u32::MAX)) {
        Ok(fragments) => fragments,
        Err(too_many) => panic!("{too_many}"),
    }
}

/// [`fragments`], if there are at most `most`. Takes no more memory than these take, and 16
/// bytes for each; beyond that it only counts.
///
/// # Errors
/// [`TooManyFragments`] if there are more than `most`, or than 2^32 - 1.
///
/// # Panics
/// If the scene's resolution or pixels are out of range.
pub fn fragments_within(scene: &Scene<'_>, most: u64) -> Result<Fragments, TooManyFragments> {
    scene.assert_in_range();
    let most = most.min(u64::from(u32::MAX));
    let count = Count {
        found: AtomicU64::new(0),
        most,
    };
    let views: Vec<ViewFragments> = scene
        .views
        .views()
        .par_iter()
        .map_init(
            || OneView::new(scene),
            |one, view| one.fragments(view, &count),
        )
        .collect();
    // All views are counted, whoever came first: the answer is the same on any number of threads.
    let found = count.found.into_inner();
    if found > most {
        return Err(TooManyFragments { found, most });
    }
    Ok(Fragments::from_views(scene.resolution, views))
}

/// Fragments over all views.
struct Count {
    found: AtomicU64,
    most: u64,
}

impl Count {
    /// Counts more of them; whether there are too many.
    fn add(&self, fragments: u64) -> bool {
        let before = self.found.fetch_add(fragments, Ordering::Relaxed);
        before + fragments > self.most
    }
}

/// Fragments of a view that are counted at a time: that many may be too many in memory.
const COUNTED_AT_ONCE: u64 = 1 << 16;

/// [`fragments`] and, from their heads, the area table.
///
/// # Panics
/// As [`fragments`].
pub fn fragments_and_areas(scene: &Scene<'_>) -> (Fragments, AreaTable) {
    let fragments = fragments(scene);
    let areas = areas_of_heads(&fragments, scene.foliage.leaves().len());
    (fragments, areas)
}

/// The area table that the heads of lists show.
pub fn areas_of_heads(fragments: &Fragments, leaf_count: usize) -> AreaTable {
    let views = fragments.views().len();
    table_of(leaf_count, views, |view| fragments.leaf_ids(view))
}

/// Makes the fragments of one view at a time, reusing its memory.
struct OneView<'a> {
    scene: &'a Scene<'a>,
    leaf_fragments: LeafFragments,
    /// By pixel, leaf by leaf.
    found: Vec<(u32, Fragment)>,
    /// Where the next fragment of each pixel belongs.
    next: Vec<u32>,
}

impl<'a> OneView<'a> {
    fn new(scene: &'a Scene<'a>) -> Self {
        Self {
            scene,
            leaf_fragments: LeafFragments::new(scene.resolution),
            found: Vec::new(),
            next: Vec::new(),
        }
    }

    /// The lists are empty if there are too many.
    fn fragments(&mut self, view: &View, count: &Count) -> ViewFragments {
        let Self {
            scene,
            leaf_fragments,
            found,
            next,
        } = self;
        found.clear();
        let mut uncounted = 0;
        let mut is_beyond = count.add(0);
        for (leaf, area_scale) in scene.lod.leaves() {
            let views = std::slice::from_ref(view);
            let of_leaf = leaf_fragments.of(scene.foliage, leaf, area_scale, views);
            uncounted += of_leaf.len() as u64;
            if uncounted >= COUNTED_AT_ONCE {
                is_beyond |= count.add(std::mem::take(&mut uncounted));
            }
            if !is_beyond {
                let of_leaf = of_leaf.iter();
                found.extend(
                    of_leaf.map(|&(pixel, depth)| (pixel, Fragment::new(depth, leaf.get()))),
                );
            }
        }
        if count.add(uncounted) {
            found.clear();
        }
        // A counting sort by pixel, then each short list by depth and leaf.
        let pixels = scene.pixels_per_view();
        let mut starts = vec![0u32; pixels + 1];
        for (pixel, _) in &*found {
            starts[*pixel as usize + 1] += 1;
        }
        for k in 0..pixels {
            starts[k + 1] += starts[k];
        }
        next.clone_from(&starts);
        let mut sorted = vec![Fragment::new(0, 0); found.len()];
        for &(pixel, fragment) in &*found {
            let slot = &mut next[pixel as usize];
            sorted[*slot as usize] = fragment;
            *slot += 1;
        }
        for k in 0..pixels {
            sorted[starts[k] as usize..starts[k + 1] as usize].sort_unstable();
        }
        ViewFragments::from_lists(starts, sorted)
    }
}

/// Rasterises leaves one at a time, reusing its memory.
#[derive(Clone, Debug)]
pub struct LeafFragments {
    resolution: u32,
    triangles: Vec<SnappedTriangle>,
    canvas: Canvas,
    /// For each pixel over the views the depth beyond which leaves are hidden; empty where
    /// nothing hides them.
    hidden_beyond: Vec<u32>,
    /// Pixels, over the views, and depths.
    found: Vec<(u32, u32)>,
}

impl LeafFragments {
    /// For images of `resolution` x `resolution` pixels.
    pub fn new(resolution: u32) -> Self {
        Self {
            resolution,
            triangles: Vec::new(),
            canvas: Canvas::default(),
            hidden_beyond: Vec::new(),
            found: Vec::new(),
        }
    }

    /// Among what hides leaves in the views that leaves will be drawn in, always the same ones.
    pub fn among(mut self, occlusions: &[Occlusion]) -> Self {
        let nearest = occlusions.iter().map(|of_view| &of_view.nearest[..]);
        self.hidden_beyond = nearest.collect::<Vec<_>>().concat();
        self
    }

    /// The pixels of a leaf in some views in turn, each once, with its nearest
    /// depth there: pairs of pixel, `(view * resolution + row) * resolution +
    /// column`, and depth; in the order of the pixels. There must be fewer than
    /// 2^32 pixels over all these views.
    pub fn of(
        &mut self,
        foliage: &Foliage,
        leaf: LeafId,
        area_scale: f64,
        views: &[View],
    ) -> &[(u32, u32)] {
        let shape = (foliage.leaf(leaf), foliage.triangles_of(leaf));
        self.draw(leaf.get(), shape, area_scale, foliage.cutouts(), views)
    }

    /// As [`Self::of`], of triangles that need not be of a foliage: at their own size, with the
    /// facing and the cut-out of a leaf.
    pub fn of_triangles(
        &mut self,
        triangles: &[LeafTriangle],
        like: &Leaf,
        cutouts: &[Arc<Cutout>],
        views: &[View],
    ) -> &[(u32, u32)] {
        self.draw(1, (like, triangles), 1.0, cutouts, views)
    }

    fn draw(
        &mut self,
        leaf_number: u32,
        (geometry, triangles): (&Leaf, &[LeafTriangle]),
        area_scale: f64,
        cutouts: &[Arc<Cutout>],
        views: &[View],
    ) -> &[(u32, u32)] {
        let Self {
            resolution,
            triangles: snapped,
            canvas,
            hidden_beyond,
            found,
        } = self;
        found.clear();
        let cutout = geometry.cutout().map(|index| &*cutouts[index as usize]);
        let mut first_row = 0;
        for view in views {
            snapped.clear();
            Snapper::new(view, *resolution).snap_leaf(
                leaf_number,
                geometry,
                triangles,
                area_scale,
                cutout,
                |triangle| snapped.push(*triangle),
            );
            canvas.draw(snapped, cutouts, |x, y, depth| {
                found.push(((first_row + y) * *resolution + x, depth));
            });
            first_row += *resolution;
        }
        if !hidden_beyond.is_empty() {
            found.retain(|(pixel, depth)| *depth <= hidden_beyond[*pixel as usize]);
        }
        found
    }
}
