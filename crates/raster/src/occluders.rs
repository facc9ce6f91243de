//! What hides leaves and is none: wood, a wall, a fence before the tree.
//!
//! What hides leaves is drawn and never edited. A leaf has no fragment where something nearer stands, so lists of
//! fragments end there, and a pixel whose list is empty counts as background, whatever shows in it:
//! all that follows (areas, VMI, the greedy loop) stays as it is. At equal depth the leaf shows.

use rayon::prelude::*;
use secateur_model::{Foliage, LeafId, Lod};

use crate::cpu::LeafFragments;
use crate::{
    AreaTable, Fragment, Fragments, RasterError, Rasteriser, Scene, View, ViewFragments, ViewSet,
};

/// A rasteriser, and what stands among the leaves of its scenes.
#[derive(Clone, Copy, Debug)]
pub struct Occluded<'a, R: ?Sized> {
    /// The rasteriser that draws.
    pub rasteriser: &'a R,
    /// What hides leaves; how it is parted into leaves does not matter.
    pub occluders: &'a Foliage,
}

/// The depth from which on each pixel of a view shows no leaf.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Occlusion {
    /// The depth of the nearest occluder, pixel by pixel; `u32::MAX` where there is none.
    pub nearest: Vec<u32>,
}

impl Occlusion {
    /// What occluders hide in a view.
    pub fn of(occluders: &Foliage, view: &View, resolution: u32) -> Self {
        let mut nearest = vec![u32::MAX; resolution as usize * resolution as usize];
        let mut fragments = LeafFragments::new(resolution);
        for index in 0..occluders.leaves().len() {
            let piece = LeafId::from_index(index);
            for &(pixel, depth) in fragments.of(occluders, piece, 1.0, std::slice::from_ref(view)) {
                let nearest = &mut nearest[pixel as usize];
                *nearest = depth.min(*nearest);
            }
        }
        Self { nearest }
    }

    /// The fragments of the view that show.
    pub fn cut(&self, view: &ViewFragments) -> ViewFragments {
        let mut starts = Vec::with_capacity(self.nearest.len() + 1);
        let mut fragments: Vec<Fragment> = Vec::with_capacity(view.as_slice().len());
        starts.push(0);
        for (list, nearest) in view.pixels().zip(&self.nearest) {
            let seen = list.partition_point(|fragment| fragment.depth() <= *nearest);
            fragments.extend_from_slice(&list[..seen]);
            starts.push(fragments.len() as u32);
        }
        ViewFragments::from_lists(starts, fragments)
    }
}

/// What occluders hide in each view.
pub fn occlusions(occluders: &Foliage, views: &ViewSet, resolution: u32) -> Vec<Occlusion> {
    let views = views.views().par_iter();
    let of = |view| Occlusion::of(occluders, view, resolution);
    views.map(of).collect()
}

impl<R: ?Sized> Occluded<'_, R> {
    /// The scene with the occluders as further leaves.
    fn joined(&self, scene: &Scene<'_>) -> Result<(Foliage, Lod), RasterError> {
        let occluders = Lod::original(self.occluders.leaves().len());
        let foliage = scene.foliage.followed_by(self.occluders)?;
        Ok((foliage, scene.lod.followed_by(&occluders)))
    }
}

impl<R: Rasteriser + ?Sized> Rasteriser for Occluded<'_, R> {
    fn fragments(&self, scene: &Scene<'_>) -> Result<Fragments, RasterError> {
        self.fragments_within(scene, u64::from(u32::MAX))
    }

    fn fragments_within(&self, scene: &Scene<'_>, most: u64) -> Result<Fragments, RasterError> {
        let all = self.rasteriser.fragments_within(scene, most)?;
        let occlusions = occlusions(self.occluders, scene.views, scene.resolution);
        let views = all.views().par_iter().zip(occlusions);
        let seen = views.map(|(view, occlusion)| occlusion.cut(view));
        Ok(Fragments::from_views(scene.resolution, seen.collect()))
    }

    fn areas(&self, scene: &Scene<'_>) -> Result<AreaTable, RasterError> {
        let (foliage, lod) = self.joined(scene)?;
        let areas = self.rasteriser.areas(&Scene {
            foliage: &foliage,
            lod: &lod,
            ..*scene
        })?;
        let leaf_count = scene.foliage.leaves().len();
        let mut rows = Vec::with_capacity((leaf_count + 1) * areas.view_count());
        for row in areas.rows() {
            let (leaves, occluders) = row.split_at(leaf_count + 1);
            rows.push(leaves[0] + occluders.iter().sum::<u32>());
            rows.extend_from_slice(&leaves[1..]);
        }
        Ok(AreaTable::from_rows(leaf_count, rows))
    }

    fn may_lists_take(&self, scene: &Scene<'_>, bytes: u64) -> Result<(), RasterError> {
        self.rasteriser.may_lists_take(scene, bytes)
    }

    fn occlusions(&self, views: &ViewSet, resolution: u32) -> Option<Vec<Occlusion>> {
        Some(occlusions(self.occluders, views, resolution))
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;
    use secateur_model::LeafTriangle;

    use super::*;
    use crate::{CpuRasteriser, cpu};

    /// A square of two triangles across the z axis.
    fn square(foliage: &mut Foliage, side: f64, z: f64) {
        let corner = |x: f64, y: f64| DVec3::new(x * side, y * side, z);
        let [a, b, c, d] = [
            corner(-0.5, -0.5),
            corner(0.5, -0.5),
            corner(0.5, 0.5),
            corner(-0.5, 0.5),
        ];
        let square = [[a, b, c], [a, c, d]].map(LeafTriangle::plain);
        foliage.push_leaf(&square, None).unwrap();
    }

    fn foliage(squares: &[(f64, f64)]) -> Foliage {
        let mut foliage = Foliage::default();
        for &(side, z) in squares {
            square(&mut foliage, side, z);
        }
        foliage
    }

    /// From z = 10 and from z = -10.
    fn before_and_behind() -> ViewSet {
        let from = |z: f64| View::look_at(DVec3::Z * z, DVec3::ZERO, DVec3::Y, 0.2, 1e-3).unwrap();
        ViewSet::new(vec![from(10.0), from(-10.0)])
    }

    /// Leaf 1 stands before a wall of half its side, leaf 2 behind it and as large as the wall;
    /// leaf 3 is where the wall is.
    #[test]
    fn leaves_end_where_a_wall_is_nearer() {
        let leaves = foliage(&[(2.0, 1.0), (1.0, -1.0), (0.5, 0.0)]);
        let wall = foliage(&[(1.0, 0.0)]);
        let views = before_and_behind();
        let lod = Lod::original(3);
        let scene = Scene {
            foliage: &leaves,
            lod: &lod,
            views: &views,
            resolution: 64,
        };
        let occluded = Occluded {
            rasteriser: &CpuRasteriser,
            occluders: &wall,
        };
        let fragments = occluded.fragments(&scene).unwrap();
        let bare = cpu::fragments(&scene);
        let lists = |fragments: &Fragments, view: usize| {
            let numbers = |list: &[Fragment]| list.iter().map(|f| f.leaf()).collect::<Vec<_>>();
            fragments.views()[view]
                .pixels()
                .map(numbers)
                .collect::<Vec<_>>()
        };
        let middle = 32 * 64 + 32;
        // At equal depth the leaf shows.
        assert_eq!(lists(&fragments, 0)[middle], [1, 3]);
        assert_eq!(lists(&bare, 0)[middle], [1, 3, 2]);
        assert_eq!(lists(&fragments, 1)[middle], [2, 3]);
        for view in 0..2 {
            for (seen, all) in lists(&fragments, view).iter().zip(lists(&bare, view)) {
                assert!(all.starts_with(seen), "{seen:?} of {all:?}");
            }
        }
        // Leaf 2, as large as the wall and behind it, is nowhere seen round it from the front.
        assert!(lists(&fragments, 0).iter().all(|list| !list.contains(&2)));
        let areas = occluded.areas(&scene).unwrap();
        for view in 0..2 {
            let heads = cpu::histogram(&fragments.leaf_ids(view), 3);
            assert_eq!(areas.row(view), heads);
            let occlusion = Occlusion::of(&wall, &views.views()[view], 64);
            let drawn = cpu::draw_leaf_ids_among(&scene, &views.views()[view], &occlusion);
            assert_eq!(drawn, fragments.leaf_ids(view));
        }
        // What the wall shows of itself counts as background: from behind, round leaf 2 there is
        // leaf 1, and where there is neither, nothing.
        assert_eq!(areas.row(0)[2], 0);
    }

    #[test]
    fn a_leaf_behind_a_wall_is_not_drawn_though_no_leaf_is_nearer() {
        let (leaves, wall) = (foliage(&[(1.0, -1.0)]), foliage(&[(1.0, 0.0)]));
        let views = before_and_behind();
        let scene = Scene {
            foliage: &leaves,
            lod: &Lod::original(1),
            views: &views,
            resolution: 64,
        };
        let drawn = views.views().iter().map(|view| {
            let occlusion = Occlusion::of(&wall, view, 64);
            let image = cpu::draw_leaf_ids_among(&scene, view, &occlusion);
            image.leaf_ids.contains(&1)
        });
        assert!(drawn.eq([false, true]));
    }

    #[test]
    fn a_leaf_that_is_drawn_alone_ends_there_too() {
        let leaves = foliage(&[(2.0, -1.0)]);
        let wall = foliage(&[(1.0, 0.0)]);
        let views = before_and_behind();
        let occlusions = occlusions(&wall, &views, 32);
        let leaf = LeafId::from_index(0);
        let of =
            |mut fragments: LeafFragments| fragments.of(&leaves, leaf, 1.0, views.views()).to_vec();
        let bare = of(LeafFragments::new(32));
        let seen = of(LeafFragments::new(32).among(&occlusions));
        let per_view = 32 * 32;
        let is_first = |(pixel, _): &&(u32, u32)| *pixel < per_view;
        assert!(seen.iter().filter(is_first).count() < bare.iter().filter(is_first).count());
        let of_second = |all: &[(u32, u32)]| {
            all.iter()
                .filter(|f| f.0 >= per_view)
                .copied()
                .collect::<Vec<_>>()
        };
        assert_eq!(of_second(&seen), of_second(&bare));
        assert!(seen.iter().all(|fragment| bare.contains(fragment)));
    }

    #[test]
    fn nothing_hides_nothing() {
        let leaves = foliage(&[(2.0, 1.0), (1.0, -1.0)]);
        let views = before_and_behind();
        let lod = Lod::original(2);
        let scene = Scene {
            foliage: &leaves,
            lod: &lod,
            views: &views,
            resolution: 16,
        };
        let occluded = Occluded {
            rasteriser: &CpuRasteriser,
            occluders: &Foliage::default(),
        };
        assert_eq!(occluded.fragments(&scene).unwrap(), cpu::fragments(&scene));
        assert_eq!(occluded.areas(&scene).unwrap(), cpu::areas(&scene));
    }
}
