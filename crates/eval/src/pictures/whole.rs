//! Whole plants beside each other: what they look like, and how far their outlines agree.

use std::borrow::Borrow;

use rayon::prelude::*;
use secateur_model::Surface;
use secateur_raster::{View, ViewSet};

use super::{PictureMeasurement, Pictures, camera_of};
use crate::cut_mask::CutMasks;
use crate::render::{DrawnPicture, draw};
use crate::surface_references::references;
use crate::visibility::AlphaFrom;

/// The pictures of one plant from the views that judge, with its outlines: wood and leaves, whoever
/// made them, since nothing has to be told apart.
#[derive(Clone, Debug)]
pub struct WholePictures {
    pictures: Pictures,
    /// Set by set and view by view, whether each sample shows the plant.
    outlines: Vec<Vec<Vec<bool>>>,
}

/// How far a whole plant looks from its original.
#[derive(Clone, Debug, PartialEq)]
pub struct WholeMeasurement {
    /// By the metrics of pictures.
    pub pictures: PictureMeasurement,
    /// Overlap (shared by both / in one of them) of the plants' outlines, 0 to 1: for each set of
    /// views the mean over its views.
    pub outline_iou: Vec<f64>,
}

impl WholePictures {
    /// Draws everything from every view of every set, as [`Pictures::of`].
    pub fn of<S: Borrow<Surface> + Sync>(surfaces: &[S], rigs: &[ViewSet]) -> Self {
        let surfaces = &references(surfaces)[..];
        let options = Pictures::options(Pictures::RESOLUTION);
        let masks = CutMasks::default();
        let alpha = AlphaFrom::masks(&masks);
        let drawn = |view: &View| draw(surfaces, &camera_of(view), &options, alpha);
        let (mut pictures, mut outlines) = (Vec::new(), Vec::new());
        for rig in rigs {
            let of_rig: Vec<DrawnPicture> = rig.views().par_iter().map(drawn).collect();
            let (images, covered) = of_rig.into_iter().map(|d| (d.image, d.is_covered)).unzip();
            pictures.push(images);
            outlines.push(covered);
        }
        Self {
            pictures: Pictures::of_sets(pictures),
            outlines,
        }
    }

    /// Measures pictures of another plant against these of its original.
    ///
    /// # Panics
    /// If the views differ in number or a set has none.
    pub fn measure(&self, other: &Self) -> WholeMeasurement {
        let pictures = self.pictures.measure(&other.pictures);
        let of_rig = |(a, b): (&Vec<Vec<bool>>, &Vec<Vec<bool>>)| {
            let ious = a.iter().zip(b).map(|(a, b)| iou(a, b));
            ious.sum::<f64>() / a.len() as f64
        };
        let sets = self.outlines.iter().zip(&other.outlines);
        WholeMeasurement {
            pictures,
            outline_iou: sets.map(of_rig).collect(),
        }
    }
}

/// 1 where neither shows anything.
fn iou(a: &[bool], b: &[bool]) -> f64 {
    let count = |is: fn(bool, bool) -> bool| a.iter().zip(b).filter(|(a, b)| is(**a, **b)).count();
    match count(|a, b| a || b) {
        0 => 1.0,
        either => count(|a, b| a && b) as f64 / either as f64,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::{DVec3, Vec3};
    use secateur_model::{AlphaMode, BoundingSphere, Finish, Material};
    use std::sync::Arc;

    /// A square as wide as said, in the plane through the centre, seen from both sides.
    fn square(width: f32) -> Surface {
        let half = 0.5 * width;
        let at = |x: f32, y: f32| Vec3::new(half * x, half * y, 0.0).as_dvec3();
        Surface {
            positions: vec![at(-1.0, -1.0), at(1.0, -1.0), at(1.0, 1.0), at(-1.0, 1.0)],
            normals: Vec::new(),
            uvs: Vec::new(),
            colors: Vec::new(),
            holds: Vec::new(),
            triangles: vec![[0, 1, 2], [0, 2, 3]],
            material: Arc::new(Material {
                name: String::new(),
                base_color: [0.1, 0.5, 0.1, 1.0],
                texture: None,
                alpha_mode: AlphaMode::Opaque,
                double_sided: true,
                finish: Finish::default(),
            }),
        }
    }

    /// A square half as wide lies within the other and is a quarter of it, but for 4 of 20 views that
    /// look along both and see nothing of either.
    #[test]
    fn outlines_of_whole_plants_overlap_as_their_areas() {
        let rigs = [ViewSet::dodecahedron(BoundingSphere {
            centre: DVec3::ZERO,
            radius: 1.0,
        })];
        let [large, small] = [1.0, 0.5].map(|width| WholePictures::of(&[square(width)], &rigs));
        let same = large.measure(&large);
        assert_eq!(same.outline_iou, [1.0]);
        assert_eq!(same.pictures.overall.get("flip_mean"), Some(0.0));
        let found = large.measure(&small);
        let iou = found.outline_iou[0];
        assert!((iou - 0.4).abs() < 0.01, "{iou}");
        assert_eq!(found, {
            let pictures = Pictures::of(&[square(1.0)], &rigs);
            WholeMeasurement {
                pictures: pictures.measure(&Pictures::of(&[square(0.5)], &rigs)),
                outline_iou: found.outline_iou.clone(),
            }
        });
        let nothing = WholePictures::of(&[] as &[Surface], &rigs);
        assert_eq!(large.measure(&nothing).outline_iou, [0.2]);
        assert_eq!(nothing.measure(&nothing).outline_iou, [1.0]);
    }
}
