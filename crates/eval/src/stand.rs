//! Pictures of a stand of plants: many of a few kinds, each somewhere, and how far two such pictures are from each
//! other.
//!
//! A picture has as many pixels as the screen, each the mean of 4 x 4 samples; textures are read without mip maps, and
//! nothing casts a shadow. It is drawn in strips of rows, the nearest plant first; what is hidden whole is passed over.

use glam::{DMat3, DMat4, DVec3};
use image::RgbaImage;
use rayon::prelude::*;
use secateur_model::Surface;

use crate::camera::ViewAxes;
use crate::cut_mask::CutMasks;
use crate::lens::Lens;
use crate::shading::Lighting;
use crate::srgb::{LINEAR_FROM_SRGB, srgb_byte};
use strip::{Pixels, Strip};

mod compare;
mod strip;

pub use compare::{JudgedStand, StandDifference};

/// Samples along a side of a pixel.
const SAMPLES: u32 = 4;

/// Rows of pixels in a strip: what is held of samples at a time.
const STRIP_ROWS: u32 = 192;

/// A camera whose picture may be wider than high.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StandCamera {
    /// Its place in world space.
    pub eye: DVec3,
    /// The direction in which it looks.
    pub forward: DVec3,
    /// A direction that is upward in the picture.
    pub up: DVec3,
    /// The tangent of half its vertical field of view.
    pub tan_half_fov_y: f64,
    /// The width of its picture over the height.
    pub aspect: f64,
    /// Nothing nearer than this is seen, in world units along the view.
    pub near: f64,
}

/// A kind of plants as it is drawn: in its own space.
#[derive(Clone, Debug)]
pub struct StandKind {
    surfaces: Vec<Surface>,
    /// The least and the largest of its coordinates.
    bounds: [DVec3; 2],
}

/// One of them, somewhere.
#[derive(Clone, Copy, Debug)]
pub struct StandPlace<'a> {
    /// What stands there.
    pub kind: &'a StandKind,
    /// From its own space to the world's.
    pub world_from_own: DMat4,
}

/// What a camera sees of a stand.
#[derive(Clone, Debug)]
pub struct StandPicture {
    /// Opaque, sRGB.
    pub image: RgbaImage,
    /// By place, how many pixels show it, parts of pixels counted.
    pub seen_px: Vec<f64>,
    /// By pixel, row by row, the place that most of its samples show, and `u32::MAX` nothing.
    shown: Vec<u32>,
    /// By pixel, row by row, the share of it that shows any place.
    coverage: Vec<f32>,
}

impl StandKind {
    /// Of these surfaces.
    pub fn new(surfaces: Vec<Surface>) -> Self {
        let corners = surfaces.iter().flat_map(|s| {
            let corners = s.triangles.iter().flatten();
            corners.filter_map(|c| s.positions.get(*c as usize))
        });
        let corners = corners.filter(|p| p.is_finite());
        let bounds = corners.fold([DVec3::INFINITY, DVec3::NEG_INFINITY], |[low, high], p| {
            [low.min(*p), high.max(*p)]
        });
        Self { surfaces, bounds }
    }

    /// The largest of its extents along an axis, in its own units; 0 where nothing is drawn.
    pub fn size(&self) -> f64 {
        (self.bounds[1] - self.bounds[0]).max_element().max(0.0)
    }

    /// The middle of its box.
    pub fn middle(&self) -> DVec3 {
        0.5 * (self.bounds[0] + self.bounds[1])
    }

    fn corners(&self) -> impl Iterator<Item = DVec3> + '_ {
        (0..8).map(|k| {
            DVec3::from_array(std::array::from_fn(|axis| self.bounds[k >> axis & 1][axis]))
        })
    }

    /// Its surfaces in world space.
    fn placed(&self, matrix: DMat4) -> Vec<Surface> {
        let of_normals = DMat3::from_mat4(matrix).inverse().transpose().as_mat3();
        let mirrors = matrix.determinant() < 0.0;
        let placed = |surface: &Surface| {
            let mut surface = surface.clone();
            for p in &mut surface.positions {
                *p = matrix.transform_point3(*p);
            }
            for n in &mut surface.normals {
                *n = (of_normals * *n).normalize_or_zero();
            }
            if mirrors {
                surface
                    .triangles
                    .iter_mut()
                    .for_each(|corners| corners.swap(1, 2));
            }
            surface
        };
        self.surfaces.iter().map(placed).collect()
    }
}

impl StandCamera {
    fn axes(&self) -> ViewAxes {
        ViewAxes::looking(self.forward, self.up)
    }

    /// This camera in a plant's own space, where that is turned about the y axis alone: it sees the same there, the sun
    /// too, and no vertex has to be moved.
    fn in_space_of(&self, world_from_own: DMat4) -> Option<Self> {
        let (scale, rotation, _) = world_from_own.to_scale_rotation_translation();
        let is_even = scale.x > 0.0 && scale.abs_diff_eq(DVec3::splat(scale.x), 1e-9 * scale.x);
        let stands = (rotation * DVec3::Y).abs_diff_eq(DVec3::Y, 1e-9);
        let again = DMat4::from_scale_rotation_translation(scale, rotation, DVec3::ZERO);
        let is_plain =
            DMat3::from_mat4(again).abs_diff_eq(DMat3::from_mat4(world_from_own), 1e-9 * scale.x);
        (is_even && stands && is_plain).then(|| Self {
            eye: world_from_own.inverse().transform_point3(self.eye),
            forward: rotation.inverse() * self.forward,
            up: rotation.inverse() * self.up,
            near: self.near / scale.x,
            ..*self
        })
    }

    /// Width and height of its picture in pixels.
    pub fn size(&self, height_px: u32) -> [u32; 2] {
        let width = (f64::from(height_px) * self.aspect)
            .round()
            .clamp(1.0, 32_768.0);
        [width as u32, height_px]
    }

    /// How many pixels high its picture shows what is as large as this at a point; infinite behind it.
    pub fn pixels_high(&self, size: f64, at: DVec3, height_px: u32) -> f64 {
        let distance = (at - self.eye).length();
        let shown = f64::from(height_px) * size / (2.0 * distance * self.tan_half_fov_y);
        if shown.is_nan() { f64::INFINITY } else { shown }
    }

    /// A part of the picture in samples: from this column and row on, of this size.
    fn lens(&self, height_px: u32, [column, row]: [u32; 2], size: [u32; 2]) -> Lens {
        let whole = self.size(height_px).map(|side| f64::from(side * SAMPLES));
        let per_tangent = 0.5 * whole[1] / self.tan_half_fov_y;
        let corner = [
            (f64::from(column) - 0.5 * whole[0]) / per_tangent,
            (0.5 * whole[1] - f64::from(row)) / per_tangent,
        ];
        Lens::window(
            self.axes(),
            self.eye,
            self.near,
            (corner, size, per_tangent),
        )
    }
}

impl StandPicture {
    /// What a camera sees of these places in a picture of `height_px` rows.
    pub fn of(places: &[StandPlace<'_>], camera: &StandCamera, height_px: u32) -> Self {
        let size = camera.size(height_px);
        let order = nearest_first(places, camera);
        let masks = CutMasks::default();
        let lighting = Lighting::new(&[], camera.axes(), false);
        let first_rows: Vec<u32> = (0..height_px).step_by(STRIP_ROWS as usize).collect();
        let strips = first_rows.into_par_iter().map(|first| {
            let rows = STRIP_ROWS.min(height_px - first);
            let mut strip = Strip::new(camera, (height_px, first), [size[0], rows]);
            for place in &order {
                strip.draw(*place, &places[*place as usize], &masks, &lighting);
            }
            strip.pixels(&lighting)
        });
        let strips: Vec<Pixels> = strips.collect();
        let mut picture = Self {
            image: RgbaImage::new(size[0], size[1]),
            seen_px: vec![0.0; places.len()],
            shown: Vec::new(),
            coverage: Vec::new(),
        };
        let mut bytes = Vec::new();
        for strip in strips {
            bytes.extend(strip.rgba);
            picture.shown.extend(strip.shown);
            picture.coverage.extend(strip.coverage);
            for (place, samples) in strip.seen {
                picture.seen_px[place as usize] +=
                    f64::from(samples) / f64::from(SAMPLES * SAMPLES);
            }
        }
        picture.image = RgbaImage::from_raw(size[0], size[1], bytes).unwrap_or(picture.image);
        picture
    }
}

/// The order in which pixels of a square of 4 x 4 go over to the next level.
const DITHER: [[u32; 4]; 4] = [[0, 8, 2, 10], [12, 4, 14, 6], [3, 11, 1, 9], [15, 7, 13, 5]];

impl StandPicture {
    /// This picture with a share, 0 to 1, of its pixels those of another by the same camera: a dithered cross-fade, as
    /// clients have it.
    ///
    /// # Panics
    /// If the pictures are of other sizes.
    pub fn dithered(&self, next: &Self, share: f64) -> Self {
        assert_eq!(
            self.image.dimensions(),
            next.image.dimensions(),
            "one camera"
        );
        let mut mixed = self.clone();
        let width = self.image.width();
        for (x, y, pixel) in mixed.image.enumerate_pixels_mut() {
            let rank = DITHER[(y % 4) as usize][(x % 4) as usize];
            if (f64::from(rank) + 0.5) / 16.0 < share {
                let k = (y * width + x) as usize;
                *pixel = *next.image.get_pixel(x, y);
                mixed.shown[k] = next.shown[k];
                mixed.coverage[k] = next.coverage[k];
            }
        }
        mixed
    }

    /// This picture with another behind its plants; `plain` is what the same camera sees where nothing stands.
    ///
    /// # Panics
    /// If the pictures are of other sizes.
    pub fn before(&self, behind: &RgbaImage, plain: &RgbaImage) -> Self {
        let size = self.image.dimensions();
        assert_eq!(
            [size; 2],
            [behind.dimensions(), plain.dimensions()],
            "one camera"
        );
        let mut mixed = self.clone();
        let pixels = mixed.image.pixels_mut().zip(&self.coverage);
        for ((pixel, coverage), (behind, plain)) in pixels.zip(behind.pixels().zip(plain.pixels()))
        {
            for k in 0..3 {
                let bytes = [pixel[k], behind[k], plain[k]];
                let [own, behind, plain] = bytes.map(|byte| LINEAR_FROM_SRGB[usize::from(byte)]);
                pixel[k] = srgb_byte(own + (1.0 - coverage) * (behind - plain));
            }
        }
        mixed
    }
}

/// Places by the distance of their middles: of what is hidden little is then drawn.
fn nearest_first(places: &[StandPlace<'_>], camera: &StandCamera) -> Vec<u32> {
    let distance = |place: &StandPlace<'_>| {
        let middle = place.world_from_own.transform_point3(place.kind.middle());
        camera.eye.distance_squared(middle)
    };
    let mut order: Vec<(f64, u32)> = places.iter().map(distance).zip(0..).collect();
    order.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    order.into_iter().map(|(_, place)| place).collect()
}

#[cfg(test)]
mod tests;
