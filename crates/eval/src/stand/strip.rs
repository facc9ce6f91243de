//! Strips of a picture: what is held of samples at a time.

use std::collections::HashMap;

use glam::{Vec2, Vec3};
use secateur_model::Surface;

use super::{SAMPLES, StandCamera, StandPlace};
use crate::cut_mask::CutMasks;
use crate::lens::Lens;
use crate::render::tone;
use crate::shading::{Lighting, Spot};
use crate::srgb_byte;
use crate::surface_references::references;
use crate::visibility::{AlphaFrom, Culling, NOTHING, Visibility, visibility};

/// Some rows of samples.
pub(super) struct Strip<'a> {
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
pub(super) struct Pixels {
    pub(super) rgba: Vec<u8>,
    pub(super) shown: Vec<u32>,
    pub(super) coverage: Vec<f32>,
    /// By place, how many samples show it.
    pub(super) seen: HashMap<u32, u32>,
}

/// Columns and rows of samples, from and to.
type Window = [[u32; 2]; 2];

impl<'a> Strip<'a> {
    pub(super) fn new(
        camera: &'a StandCamera,
        (height_px, first): (u32, u32),
        size: [u32; 2],
    ) -> Self {
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

    pub(super) fn draw(
        &mut self,
        number: u32,
        place: &StandPlace<'_>,
        masks: &CutMasks,
        lighting: &Lighting,
    ) {
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
            let surfaces = references(surfaces);
            (visibility(&surfaces, &lens, Culling::Material, alpha), lens)
        };
        if let Some(camera) = self.camera.in_space_of(place.world_from_own) {
            let (seen, lens) = draw(&camera, &place.kind.surfaces);
            let lighting = Lighting::new(&[], camera.axes(), false);
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

    pub(super) fn pixels(self, lighting: &Lighting) -> Pixels {
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
