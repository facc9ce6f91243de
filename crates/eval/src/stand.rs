//! Pictures of a stand of plants: many of a few kinds, each somewhere, and how far two such pictures are from each
//! other.
//!
//! A picture has as many pixels as the screen, each the mean of 4 x 4 samples; textures are read without mip maps, and
//! nothing casts a shadow. It is drawn in strips of rows, the nearest plant first; what is hidden whole is passed over.

use std::collections::HashMap;

use glam::{DMat3, DMat4, DVec3, Vec2, Vec3};
use image::RgbaImage;
use rayon::prelude::*;
use secateur_model::Surface;

use crate::camera::ViewAxes;
use crate::cut_mask::CutMasks;
use crate::lens::Lens;
use crate::render::tone;
use crate::shading::{Lighting, Spot};
use crate::srgb_byte;
use crate::visibility::{AlphaFrom, Culling, NOTHING, Visibility, visibility};

mod compare;

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
    /// By pixel, row by row, the place that most of its samples show, and from [`NOTHING`] on nothing.
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
        let lighting = Lighting::new::<Surface>(&[], camera.axes(), false);
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

/// Some rows of samples.
struct Strip<'a> {
    camera: &'a StandCamera,
    height_px: u32,
    /// The first row, in samples of the whole picture.
    first_row: u32,
    /// In samples.
    size: [u32; 2],
    nearness: Vec<f32>,
    shown: Vec<u32>,
    rgb: Vec<Vec3>,
}

/// The pixels of a strip.
struct Pixels {
    rgba: Vec<u8>,
    shown: Vec<u32>,
    coverage: Vec<f32>,
    /// By place, how many samples show it.
    seen: HashMap<u32, u32>,
}

/// Columns and rows of samples, from and to.
type Window = [[u32; 2]; 2];

impl<'a> Strip<'a> {
    fn new(camera: &'a StandCamera, (height_px, first): (u32, u32), size: [u32; 2]) -> Self {
        let size = size.map(|side| side * SAMPLES);
        let samples = size[0] as usize * size[1] as usize;
        Self {
            camera,
            height_px,
            first_row: first * SAMPLES,
            size,
            nearness: vec![f32::NEG_INFINITY; samples],
            shown: vec![NOTHING; samples],
            rgb: vec![Vec3::ZERO; samples],
        }
    }

    fn draw(&mut self, number: u32, place: &StandPlace<'_>, masks: &CutMasks, lighting: &Lighting) {
        let Some((window, nearest)) = self.window_of(place) else {
            return;
        };
        let [[left, right], [top, bottom]] = window;
        let row_of = |row: u32| row as usize * self.size[0] as usize;
        let is_hidden = (top..bottom).all(|row| {
            let samples = row_of(row) + left as usize..row_of(row) + right as usize;
            self.nearness[samples].iter().all(|near| *near >= nearest)
        });
        if is_hidden {
            return;
        }
        let corner = [left, top + self.first_row];
        let size = [right - left, bottom - top];
        let draw = |camera: &StandCamera, surfaces: &[Surface]| {
            let lens = camera.lens(self.height_px, corner, size);
            let alpha = AlphaFrom::masks(masks);
            (visibility(surfaces, &lens, Culling::Material, alpha), lens)
        };
        if let Some(camera) = self.camera.in_space_of(place.world_from_own) {
            let (seen, lens) = draw(&camera, &place.kind.surfaces);
            let lighting = Lighting::new::<Surface>(&[], camera.axes(), false);
            let surfaces = &place.kind.surfaces;
            return self.shade(number, [left, top], surfaces, &seen, (&lens, &lighting));
        }
        let surfaces = place.kind.placed(place.world_from_own);
        let (seen, lens) = draw(self.camera, &surfaces);
        self.shade(number, [left, top], &surfaces, &seen, (&lens, lighting));
    }

    /// Where a place may be seen, and how near its nearest part may be.
    fn window_of(&self, place: &StandPlace<'_>) -> Option<(Window, f32)> {
        if place.kind.surfaces.is_empty() {
            return None;
        }
        let lens = self
            .camera
            .lens(self.height_px, [0, self.first_row], self.size);
        let mut low = Vec2::INFINITY;
        let mut high = Vec2::NEG_INFINITY;
        let mut nearest = f32::NEG_INFINITY;
        let mut in_front = 0;
        for corner in place.kind.corners() {
            let view = lens.to_view(place.world_from_own.transform_point3(corner));
            if lens.in_front(view) > 0.0 {
                let on_raster = lens.project(view);
                low = low.min(on_raster.at);
                high = high.max(on_raster.at);
                nearest = nearest.max(on_raster.nearness);
                in_front += 1;
            }
        }
        let range = |from: f32, to: f32, size: u32| {
            let end = (to.ceil() + 1.0).clamp(0.0, size as f32) as u32;
            [((from - 1.0).clamp(0.0, size as f32) as u32).min(end), end]
        };
        let window = match in_front {
            0 => return None,
            8 => [
                range(low.x, high.x, self.size[0]),
                range(low.y, high.y, self.size[1]),
            ],
            _ => {
                nearest = f32::INFINITY;
                self.size.map(|side| [0, side])
            }
        };
        let is_empty = window.iter().any(|[from, to]| from >= to);
        (!is_empty).then_some((window, nearest))
    }

    fn shade(
        &mut self,
        number: u32,
        [left, top]: [u32; 2],
        surfaces: &[Surface],
        seen: &Visibility,
        (lens, lighting): (&Lens, &Lighting),
    ) {
        let mut lit = (NOTHING, Vec3::ZERO);
        for (k, (index, nearness)) in seen.frontmost.iter().zip(&seen.nearness).enumerate() {
            if *index == NOTHING {
                continue;
            }
            let (x, y) = (k % seen.width, k / seen.width);
            let sample = (y + top as usize) * self.size[0] as usize + x + left as usize;
            if *nearness <= self.nearness[sample] {
                continue;
            }
            let triangle = &seen.triangles[*index as usize];
            let surface = &surfaces[triangle.face.surface as usize];
            let at = Vec2::new(x as f32 + 0.5, y as f32 + 0.5);
            let Some(spot) = Spot::new(surface, triangle, at) else {
                continue;
            };
            if lit.0 != *index {
                lit = (*index, spot.light(lens, lighting, true));
            }
            self.nearness[sample] = *nearness;
            self.shown[sample] = number;
            self.rgb[sample] = tone(spot.base_color(None) * lit.1);
        }
    }

    fn pixels(self, lighting: &Lighting) -> Pixels {
        let [width, rows] = self.size.map(|side| side / SAMPLES);
        let [whole_width, whole_height] =
            self.camera.size(self.height_px).map(|side| side * SAMPLES);
        let whole = self
            .camera
            .lens(self.height_px, [0, 0], [whole_width, whole_height]);
        let mut pixels = Pixels {
            rgba: Vec::with_capacity(4 * width as usize * rows as usize),
            shown: Vec::new(),
            coverage: Vec::new(),
            seen: HashMap::new(),
        };
        for (y, x) in (0..rows).flat_map(|y| (0..width).map(move |x| (y, x))) {
            let (mut sum, mut covered) = (Vec3::ZERO, 0u32);
            let mut most = (NOTHING, 0u32);
            let mut run = (NOTHING, 0u32);
            let mut background = None;
            for sample in 0..SAMPLES * SAMPLES {
                let (column, row) = (
                    x * SAMPLES + sample % SAMPLES,
                    y * SAMPLES + sample / SAMPLES,
                );
                let k = row as usize * self.size[0] as usize + column as usize;
                let shown = self.shown[k];
                if shown == NOTHING {
                    let at = Vec2::new(column as f32 + 0.5, (row + self.first_row) as f32 + 0.5);
                    sum += *background.get_or_insert_with(|| lighting.background(&whole, at));
                    continue;
                }
                sum += self.rgb[k];
                covered += 1;
                *pixels.seen.entry(shown).or_default() += 1;
                run = if run.0 == shown {
                    (shown, run.1 + 1)
                } else {
                    (shown, 1)
                };
                if run.1 > most.1 {
                    most = run;
                }
            }
            let all = (SAMPLES * SAMPLES) as f32;
            let [r, g, b] = (sum / all).to_array().map(srgb_byte);
            pixels.rgba.extend([r, g, b, 255]);
            pixels.shown.push(most.0);
            pixels.coverage.push(covered as f32 / all);
        }
        pixels
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use glam::DQuat;
    use secateur_model::{AlphaMode, Finish, Material};

    use super::*;

    /// A square of side 2 about the origin, across z, seen from both sides.
    fn square() -> StandKind {
        let corners = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
        let material = Material {
            name: String::new(),
            base_color: [0.2, 0.4, 0.1, 1.0],
            texture: None,
            alpha_mode: AlphaMode::Opaque,
            double_sided: true,
            finish: Finish::default(),
        };
        StandKind::new(vec![Surface {
            positions: corners.map(|[x, y]| DVec3::new(x, y, 0.0)).into(),
            normals: vec![Vec3::Z; 4],
            uvs: Vec::new(),
            colors: Vec::new(),
            holds: Vec::new(),
            triangles: vec![[0, 1, 2], [0, 2, 3]],
            material: Arc::new(material),
        }])
    }

    /// From (0, 0, 4), 90 degrees high and twice as wide.
    fn camera() -> StandCamera {
        StandCamera {
            eye: DVec3::Z * 4.0,
            forward: DVec3::NEG_Z,
            up: DVec3::Y,
            tan_half_fov_y: 1.0,
            aspect: 2.0,
            near: 0.01,
        }
    }

    fn at(kind: &StandKind, world_from_own: DMat4) -> StandPlace<'_> {
        StandPlace {
            kind,
            world_from_own,
        }
    }

    /// 400 pixels show 8 m at that distance: a square of 2 m is 100 x 100 of them, one twice as far off a quarter. It
    /// stands behind and to the left; the third is hidden by the first, the fourth stands behind the camera.
    #[test]
    fn what_is_seen_of_each_place_is_counted() {
        let kind = square();
        let at = |x: f64, z: f64| at(&kind, DMat4::from_translation(DVec3::new(x, 0.0, z)));
        let places = [at(0.0, 0.0), at(-5.0, -4.0), at(0.0, -4.0), at(0.0, 9.0)];
        let picture = StandPicture::of(&places, &camera(), 400);
        assert_eq!(picture.image.dimensions(), (800, 400));
        assert_eq!(picture.seen_px, [10_000.0, 2_500.0, 0.0, 0.0]);
        let judge = JudgedStand::new(picture);
        assert_eq!(judge.difference(&judge.picture).flip_mean, 0.0);
        // Without the second its own pixels differ, and those alone.
        let nothing = StandKind::new(Vec::new());
        let second = StandPlace {
            kind: &nothing,
            ..places[1]
        };
        let without = [places[0], second, places[2], places[3]];
        let found = judge.difference(&StandPicture::of(&without, &camera(), 400));
        assert!(
            found.flip_px[1] > 250.0 && found.flip_px[0] < 1.0,
            "{found:?}"
        );
        assert!(found.flip_mean > 0.0 && found.difference > 0.1);
    }

    /// A plant that is turned about y is drawn in its own space, one that leans in the world's: the same picture as that
    /// of its vertices moved there.
    #[test]
    fn a_place_is_drawn_as_its_moved_vertices() {
        let kind = square();
        let lean = DQuat::from_rotation_x(0.5);
        for rotation in [DQuat::from_rotation_y(0.7), lean] {
            let scale = DVec3::splat(1.5);
            let place = DMat4::from_scale_rotation_translation(scale, rotation, DVec3::X);
            let moved = StandKind::new(kind.placed(place));
            let [one, other] = [at(&kind, place), at(&moved, DMat4::IDENTITY)]
                .map(|place| StandPicture::of(&[place], &camera(), 100));
            assert_eq!(one.seen_px, other.seen_px);
            let pairs = one.image.iter().zip(other.image.iter());
            assert!(pairs.into_iter().all(|(a, b)| a.abs_diff(*b) <= 1));
        }
    }

    #[test]
    fn a_dithered_picture_has_a_share_of_the_next() {
        let kind = square();
        let shown = [at(&kind, DMat4::IDENTITY)];
        let [full, empty] = [&shown[..], &[]].map(|places| StandPicture::of(places, &camera(), 64));
        let covered = |picture: &StandPicture| picture.coverage.iter().sum::<f32>();
        assert_eq!(covered(&full.dithered(&empty, 0.25)), 0.75 * covered(&full));
        assert_eq!(full.dithered(&empty, 1.0).image, empty.image);
        assert_eq!(full.dithered(&empty, 0.0).image, full.image);
    }
}
