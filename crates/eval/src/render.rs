//! A plain picture of textured triangles, on the CPU.

use std::borrow::Borrow;

use glam::{Vec2, Vec3};
use image::RgbaImage;
use rayon::prelude::*;
use secateur_model::Surface;

use crate::Camera;
use crate::lens::Lens;
use crate::shading::{Lighting, shade};
use crate::texel::srgb_byte;
use crate::visibility::{NOTHING, Visibility, visibility};

/// How a picture is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RenderOptions {
    /// Width in pixels.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
    /// Samples along each side of a pixel, 1 to 8: 2 stands for 2 x 2.
    pub samples: u32,
    /// Whether surfaces shade each other and the ground. Costs two more, smaller
    /// pictures.
    pub shadows: bool,
}

impl RenderOptions {
    /// A panel of a contact sheet: 2 x 2 samples, shadows.
    pub fn panel(width: u32, height: u32) -> Self {
        Self {
            width,
            height,
            samples: 2,
            shadows: true,
        }
    }
}

/// The picture that a camera takes of these surfaces: base colour textures, cut
/// out where their alpha is below the cutoff (blending is taken for a cutoff of
/// 0.5), vertex colours, a sun over the camera's left shoulder and a sky, before
/// a light background. Opaque, sRGB.
///
/// Shading normals are used where there are any, but nothing is culled: both
/// sides of every triangle are drawn. Triangles with positions that are not
/// finite are left out. The same input gives the same picture, whatever the
/// number of threads.
///
/// Takes time in proportion to the triangles and to the samples they cover.
///
/// # Panics
/// If a triangle of finite positions has an index beyond `positions`, or
/// `options.samples` is not in 1 to 8.
pub fn render<S: Borrow<Surface> + Sync>(
    surfaces: &[S],
    camera: &Camera,
    options: &RenderOptions,
) -> RgbaImage {
    let per_side = options.samples;
    assert!(
        (1..=8).contains(&per_side),
        "a pixel has 1 to 8 samples along a side, not {per_side}"
    );
    let lens = Lens::perspective(camera, options.width * per_side, options.height * per_side);
    let seen = visibility(surfaces, &lens);
    let lighting = Lighting::new(surfaces, lens.axes, options.shadows);
    let color_at = |x: u32, y: u32| sample_color(surfaces, &seen, &lens, &lighting, x, y);
    let mut image = RgbaImage::new(options.width, options.height);
    let row_bytes = 4 * options.width.max(1) as usize;
    let rows = image.par_chunks_mut(row_bytes).enumerate();
    rows.for_each(|(y, row)| {
        for (x, pixel) in row.chunks_exact_mut(4).enumerate() {
            let mut sum = Vec3::ZERO;
            for sample in 0..per_side * per_side {
                let (dx, dy) = (sample % per_side, sample / per_side);
                sum += color_at(x as u32 * per_side + dx, y as u32 * per_side + dy);
            }
            let mean = sum / (per_side * per_side) as f32;
            let [r, g, b] = mean.to_array().map(srgb_byte);
            pixel.copy_from_slice(&[r, g, b, 255]);
        }
    });
    image
}

fn sample_color<S: Borrow<Surface>>(
    surfaces: &[S],
    seen: &Visibility,
    lens: &Lens,
    lighting: &Lighting,
    x: u32,
    y: u32,
) -> Vec3 {
    let at = Vec2::new(x as f32 + 0.5, y as f32 + 0.5);
    match seen.frontmost[y as usize * seen.width + x as usize] {
        NOTHING => lighting.background(lens, at),
        index => {
            let triangle = &seen.triangles[index as usize];
            let surface = surfaces[triangle.face.surface as usize].borrow();
            tone(shade(surface, triangle, at, lens, lighting))
        }
    }
}

/// Highlights bend towards white instead of being cut off.
fn tone(linear: Vec3) -> Vec3 {
    linear.map(|value| {
        if value <= 0.6 {
            value
        } else {
            0.6 + 0.4 * (1.0 - (-(value - 0.6) / 0.4).exp())
        }
    })
}
