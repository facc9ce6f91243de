//! A plain picture of textured triangles, on the CPU.

mod cut_out;

use std::borrow::Borrow;

use glam::{Vec2, Vec3};
use image::RgbaImage;
use rayon::prelude::*;
use secateur_model::Surface;

pub(crate) use cut_out::{CutOut, CutOutRoles, draw_cut_out};

use crate::Camera;
use crate::lens::Lens;
use crate::mips::{MipChains, MipSampler};
use crate::screen_triangle::ScreenTriangle;
use crate::shading::{Lighting, Spot};
use crate::srgb_byte;
use crate::surface_references::references;
use crate::visibility::{AlphaFrom, Culling, NOTHING, SeenRows, outline, visibility};

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
    /// Whether the normals of double-sided materials are turned around where the back is seen, as
    /// glTF asks clients to.
    pub turns_normals: bool,
}

impl RenderOptions {
    /// A panel of a contact sheet: 2 x 2 samples, shadows.
    pub fn panel(width: u32, height: u32) -> Self {
        Self {
            width,
            height,
            samples: 2,
            shadows: true,
            turns_normals: false,
        }
    }
}

/// The picture that a camera takes of these surfaces: base colour textures, cut
/// out where their alpha is below the cutoff (blending is taken for a cutoff of
/// 0.5), vertex colours, a sun over the camera's left shoulder and a sky, before
/// a light background. Opaque, sRGB.
///
/// Shading normals are used where there are any. Back faces of materials that are not
/// double-sided are left out, but cast shadows. Triangles with positions that are not
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
    let surfaces = &references(surfaces)[..];
    draw(surfaces, camera, options, AlphaFrom::default()).image
}

/// A picture, and what of it shows the plant.
pub(crate) struct DrawnPicture {
    pub(crate) image: RgbaImage,
    /// By sample, row by row, whether anything is in front of the background.
    pub(crate) is_covered: Vec<bool>,
}

/// As [`render`], with textures read from mip maps if there are any.
pub(crate) fn draw(
    surfaces: &[&Surface],
    camera: &Camera,
    options: &RenderOptions,
    alpha: AlphaFrom<'_>,
) -> DrawnPicture {
    let per_side = options.samples;
    assert!(
        (1..=8).contains(&per_side),
        "a pixel has 1 to 8 samples along a side, not {per_side}"
    );
    let lens = Lens::perspective(camera, options.width * per_side, options.height * per_side);
    let seen = visibility(surfaces, &lens, Culling::Material, alpha);
    let scene = SeenFrom {
        surfaces,
        triangles: &seen.triangles,
        mips: alpha.mips,
        lighting: Lighting::new(surfaces, lens.axes, options.shadows),
        turns_normals: options.turns_normals,
        lens,
    };
    let mut image = RgbaImage::new(options.width, options.height);
    let row_bytes = 4 * options.width.max(1) as usize;
    let rows = image.par_chunks_mut(row_bytes).enumerate();
    rows.for_each(|(y, row)| {
        for (x, pixel) in row.chunks_exact_mut(4).enumerate() {
            let mean = scene.pixel_color(x as u32, y as u32, per_side, seen.rows());
            let [r, g, b] = mean.to_array().map(srgb_byte);
            pixel.copy_from_slice(&[r, g, b, 255]);
        }
    });
    let is_covered = seen.frontmost.iter().map(|index| *index != NOTHING);
    DrawnPicture {
        image,
        is_covered: is_covered.collect(),
    }
}

/// By pixel, row by row, whether a camera sees anything but the background at its middle, in a
/// square picture of `side` pixels.
pub(crate) fn is_covered(
    surfaces: &[&Surface],
    camera: &Camera,
    side: u32,
    alpha: AlphaFrom<'_>,
) -> Vec<bool> {
    let lens = Lens::perspective(camera, side, side);
    outline(surfaces, &lens, alpha)
}

/// A scene and what is seen of it.
struct SeenFrom<'a> {
    surfaces: &'a [&'a Surface],
    triangles: &'a [ScreenTriangle],
    mips: Option<&'a MipChains>,
    lighting: Lighting,
    turns_normals: bool,
    lens: Lens,
}

impl SeenFrom<'_> {
    /// The mean linear colour of a pixel's samples. Light changes little within
    /// a pixel and costs most: it is found once for samples of one triangle, and
    /// once for the background.
    fn pixel_color(&self, x: u32, y: u32, per_side: u32, seen: SeenRows<'_>) -> Vec3 {
        let mut sum = Vec3::ZERO;
        let mut lit = (NOTHING, Vec3::ZERO);
        let mut background = None;
        for sample in 0..per_side * per_side {
            let column = x * per_side + sample % per_side;
            let row = y * per_side + sample / per_side;
            let at = Vec2::new(column as f32 + 0.5, row as f32 + 0.5);
            let index = seen.at(column, row);
            sum += match self.spot(index, at) {
                None => *background.get_or_insert_with(|| self.lighting.background(&self.lens, at)),
                Some(spot) => {
                    if lit.0 != index {
                        lit = (
                            index,
                            spot.light(&self.lens, &self.lighting, self.turns_normals),
                        );
                    }
                    tone(spot.base_color(self.mips_at(index)) * lit.1)
                }
            };
        }
        sum / (per_side * per_side) as f32
    }

    /// The mip chain of what a sample sees.
    fn mips_at(&self, index: u32) -> Option<MipSampler<'_>> {
        let triangle = self.triangles.get(index as usize)?;
        self.mips?.of_surface(triangle.face.surface)
    }

    fn spot(&self, index: u32, at: Vec2) -> Option<Spot<'_>> {
        let triangle = self.triangles.get(index as usize)?;
        let surface = self.surfaces[triangle.face.surface as usize];
        Spot::new(surface, triangle, at)
    }
}

/// Highlights bend towards white instead of being cut off.
pub(crate) fn tone(linear: Vec3) -> Vec3 {
    linear.map(|value| {
        if value <= 0.6 {
            value
        } else {
            0.6 + 0.4 * (1.0 - (-(value - 0.6) / 0.4).exp())
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;
    use secateur_model::{AlphaMode, Material, Texture, Wrap};
    use std::sync::Arc;

    const RED: [f32; 4] = [0.8, 0.0, 0.0, 1.0];
    const BLUE: [f32; 4] = [0.0, 0.0, 0.8, 1.0];

    /// A square of side 2 about (0, 0, z) that faces +z.
    fn quad(z: f64, base_color: [f32; 4]) -> Surface {
        let corners = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
        let material = Material {
            name: String::new(),
            base_color,
            texture: None,
            alpha_mode: AlphaMode::Opaque,
            double_sided: false,
            finish: secateur_model::Finish::default(),
        };
        Surface {
            positions: corners.map(|[x, y]| DVec3::new(x, y, z)).into(),
            normals: vec![Vec3::Z; 4],
            uvs: corners
                .map(|[x, y]| Vec2::new(x as f32, -y as f32) * 0.5 + 0.5)
                .into(),
            colors: Vec::new(),
            holds: Vec::new(),
            triangles: vec![[0, 1, 2], [0, 2, 3]],
            material: Arc::new(material),
        }
    }

    /// Opaque on the left, clear on the right.
    fn half_cut(mut surface: Surface, alpha_mode: AlphaMode) -> Surface {
        let texture = Texture {
            width: 2,
            height: 1,
            rgba: vec![255, 255, 255, 255, 255, 255, 255, 0],
            wrap: [Wrap::ClampToEdge; 2],
            filters: secateur_model::Filters::default(),
        };
        let material = Arc::make_mut(&mut surface.material);
        material.texture = Some(Arc::new(texture));
        material.alpha_mode = alpha_mode;
        surface
    }

    /// From (0, 0, 2): a square at z = 0 fills a view of 2 atan(1 / 2).
    fn camera() -> Camera {
        Camera {
            eye: DVec3::Z * 2.0,
            target: DVec3::ZERO,
            up: DVec3::Y,
            fov_y_rad: 2.0 * 0.5f64.atan(),
        }
    }

    fn picture(surfaces: &[Surface]) -> RgbaImage {
        let options = RenderOptions {
            width: 8,
            height: 8,
            samples: 2,
            shadows: false,
            turns_normals: false,
        };
        render(surfaces, &camera(), &options)
    }

    fn is_red(pixel: &image::Rgba<u8>) -> bool {
        pixel[0] > 100 && pixel[2] == 0
    }

    fn is_blue(pixel: &image::Rgba<u8>) -> bool {
        pixel[2] > 100 && pixel[0] == 0
    }

    #[test]
    fn a_quad_that_fills_the_view_has_its_colour_in_the_sun() {
        // The sun stands at (-0.6, 0.95, 0.55) / 1.2510: facing 0.4397, wrapped
        // (0.4397 + 0.35) / 1.35 = 0.5849. A level normal sees half of sky and
        // ground, (0.51, 0.545, 0.57). Base times sun and sky is linear
        // (0.3535, 0.1715, 0.0782), in sRGB 160, 115 and 79.
        let image = picture(&[quad(0.0, [0.2, 0.1, 0.05, 1.0])]);
        for pixel in image.pixels() {
            for (found, expected) in pixel.0.into_iter().zip([160u8, 115, 79, 255]) {
                assert!(found.abs_diff(expected) <= 1, "{pixel:?}");
            }
        }
    }

    #[test]
    fn the_nearer_quad_hides_the_farther_in_either_order() {
        let (near, far) = (quad(0.5, RED), quad(0.0, BLUE));
        for surfaces in [[near.clone(), far.clone()], [far, near]] {
            assert!(picture(&surfaces).pixels().all(is_red));
        }
    }

    #[test]
    fn a_back_face_shows_what_is_behind_it_unless_it_is_double_sided() {
        let mut turned = quad(0.5, RED);
        turned.triangles = vec![[0, 2, 1], [0, 3, 2]];
        let behind = quad(0.0, BLUE);
        let image = picture(&[turned.clone(), behind.clone()]);
        assert!(image.pixels().all(is_blue));
        Arc::make_mut(&mut turned.material).double_sided = true;
        assert!(picture(&[turned, behind]).pixels().all(is_red));
    }

    #[test]
    fn cut_out_texels_show_what_is_behind() {
        for mode in [AlphaMode::Mask(0.5), AlphaMode::Blend] {
            let image = picture(&[half_cut(quad(0.0, RED), mode), quad(-0.1, BLUE)]);
            for (x, _, pixel) in image.enumerate_pixels() {
                // Alpha falls through 0.5 at u = 0.5, the middle of the picture.
                let seen = if x < 4 { is_red(pixel) } else { is_blue(pixel) };
                assert!(seen, "column {x}: {pixel:?}");
            }
        }
        let opaque = half_cut(quad(0.0, RED), AlphaMode::Opaque);
        assert!(picture(&[opaque]).pixels().all(is_red));
    }

    #[test]
    fn vertex_colours_multiply() {
        let mut surface = quad(0.0, [0.8, 0.8, 0.8, 1.0]);
        surface.colors = vec![glam::Vec4::new(1.0, 0.0, 0.0, 1.0); 4];
        assert!(picture(&[surface]).pixels().all(is_red));
    }

    #[test]
    fn a_floor_that_runs_past_the_eye_is_clipped_not_lost() {
        // From far ahead to far behind, half a unit below the eye: the lower half
        // of the picture.
        let mut floor = quad(0.0, RED);
        Arc::make_mut(&mut floor.material).double_sided = true;
        floor.normals.clear();
        for p in &mut floor.positions {
            *p = DVec3::new(100.0 * p.x, -0.5, 100.0 * p.y);
        }
        let image = picture(&[floor]);
        assert!(
            image
                .enumerate_pixels()
                .all(|(_, y, pixel)| is_red(pixel) == (y >= 4))
        );
    }

    #[test]
    fn triangles_that_are_not_finite_are_left_out() {
        let mut broken = quad(0.5, BLUE);
        broken.positions[0].x = f64::NAN;
        broken.triangles[1] = [1, 1, 1];
        assert!(picture(&[broken, quad(0.0, RED)]).pixels().all(is_red));
        assert_eq!(picture(&[]).dimensions(), (8, 8));
    }

    #[test]
    fn shade_darkens_what_lies_beneath() {
        let options = RenderOptions {
            width: 8,
            height: 8,
            samples: 1,
            shadows: true,
            turns_normals: false,
        };
        let lid = |y: f64| {
            let mut surface = quad(0.0, RED);
            for p in &mut surface.positions {
                *p = DVec3::new(3.0 * p.x, y, 3.0 * p.y);
            }
            surface.normals = vec![Vec3::Y; 4];
            surface
        };
        let brightness = |surfaces: &[Surface]| {
            let image = render(surfaces, &camera(), &options);
            image.get_pixel(4, 4)[0]
        };
        let open = brightness(&[quad(0.0, RED), lid(-1.5)]);
        let covered = brightness(&[quad(0.0, RED), lid(1.5)]);
        assert!(covered + 20 < open, "{covered} under a lid, {open} without");
    }

    #[test]
    fn the_number_of_threads_changes_nothing() {
        let surfaces = [half_cut(quad(0.5, RED), AlphaMode::Blend), quad(0.0, BLUE)];
        let with = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
            pool.unwrap().install(|| {
                let options = RenderOptions::panel(40, 70);
                render(&surfaces, &camera(), &options)
            })
        };
        assert_eq!(with(1), with(3));
    }
}
