//! A plant alone: what it shows of each pixel, whatever is behind it.

use glam::{Vec2, Vec3};
use rayon::prelude::*;
use secateur_model::Surface;

use super::{SeenFrom, tone};
use crate::lens::Lens;
use crate::shading::Lighting;
use crate::visibility::{AlphaFrom, BandSamples, Bands, NOTHING, SeenRows};

/// A plant alone, before no background.
pub(crate) struct CutOut {
    /// Pixels in width and height.
    pub(crate) size: [u32; 2],
    /// By pixel, row by row: linear RGB times coverage.
    pub(crate) rgb: Vec<[f32; 3]>,
    /// By pixel, the share of its samples that show the plant.
    pub(crate) coverage: Vec<f32>,
    /// By pixel, the share of its samples that show the first `core` surfaces.
    pub(crate) core: Vec<f32>,
}

/// Which surfaces are which, by their places in a list.
#[derive(Clone, Copy, Debug)]
pub(crate) struct CutOutRoles {
    /// The surfaces before this one are counted by themselves.
    pub(crate) core: usize,
    /// The surfaces from this one on hide the plant, and are background themselves.
    pub(crate) occluders: usize,
}

/// Draws a plant alone through a lens of `samples` x `samples` samples a pixel, lit as [`render`] does without
/// shadows, textures read without mip maps.
pub(crate) fn draw_cut_out(
    surfaces: &[&Surface],
    roles: CutOutRoles,
    lens: Lens,
    (samples, turns_normals): (u32, bool),
    alpha: AlphaFrom<'_>,
) -> CutOut {
    let per_side = samples as usize;
    let bands = Bands::of_pixels(surfaces, &lens, alpha, per_side);
    let scene = SeenFrom {
        surfaces,
        triangles: &bands.triangles,
        mips: None,
        lighting: Lighting::new(surfaces, lens.axes, false),
        turns_normals,
        lens,
    };
    let size = [lens.width / samples, lens.height / samples];
    let count = size[0] as usize * size[1] as usize;
    let mut drawn = CutOut {
        size,
        rgb: vec![[0.0; 3]; count],
        coverage: vec![0.0; count],
        core: vec![0.0; count],
    };
    let width = size[0].max(1) as usize;
    let band_rows = bands.rows() / per_side;
    let of_bands = drawn.rgb.par_chunks_mut(band_rows * width);
    let of_bands = of_bands.zip(drawn.coverage.par_chunks_mut(band_rows * width));
    let of_bands = of_bands.zip(drawn.core.par_chunks_mut(band_rows * width));
    // A band is shaded while its samples are at hand.
    let shade = |memory: &mut BandSamples, (band, ((rgb, coverage), core)): (usize, Pixels<'_>)| {
        let Some(seen) = bands.seen(band, memory) else {
            return;
        };
        for k in 0..coverage.len() {
            let [x, y] = [k % width, band * band_rows + k / width];
            let pixel = scene.cut_out_pixel(x as u32, y as u32, samples, roles, seen);
            (rgb[k], coverage[k], core[k]) = (pixel.rgb.to_array(), pixel.coverage, pixel.core);
        }
    };
    of_bands
        .enumerate()
        .for_each_init(BandSamples::default, shade);
    drawn
}

/// Colours, coverage and core of some pixels.
type Pixels<'a> = ((&'a mut [[f32; 3]], &'a mut [f32]), &'a mut [f32]);

/// A pixel of a [`CutOut`].
#[derive(Clone, Copy, Debug, Default)]
struct CutOutPixel {
    rgb: Vec3,
    coverage: f32,
    core: f32,
}

impl SeenFrom<'_> {
    /// The plant's share of a pixel. Of 2 x 2 samples that see one triangle the colour is found once, in their
    /// middle.
    fn cut_out_pixel(
        &self,
        x: u32,
        y: u32,
        per_side: u32,
        roles: CutOutRoles,
        seen: SeenRows<'_>,
    ) -> CutOutPixel {
        let mut pixel = CutOutPixel::default();
        let mut lit = (NOTHING, Vec3::ZERO);
        let step = if per_side.is_multiple_of(2) { 2 } else { 1 };
        for (row, column) in (0..per_side)
            .step_by(step)
            .flat_map(|row| (0..per_side).step_by(step).map(move |column| (row, column)))
        {
            let (column, row) = (x * per_side + column, y * per_side + row);
            let index = |dx: u32, dy: u32| seen.at(column + dx, row + dy);
            let corner = Vec2::new(column as f32, row as f32);
            if step == 1 {
                self.add_samples(
                    &mut pixel,
                    &mut lit,
                    (index(0, 0), corner + 0.5, 1.0),
                    roles,
                );
                continue;
            }
            let four = [(0, 0), (1, 0), (0, 1), (1, 1)];
            if four.iter().all(|(dx, dy)| index(*dx, *dy) == index(0, 0)) {
                self.add_samples(
                    &mut pixel,
                    &mut lit,
                    (index(0, 0), corner + 1.0, 4.0),
                    roles,
                );
                continue;
            }
            for (dx, dy) in four {
                let at = corner + Vec2::new(dx as f32, dy as f32) + 0.5;
                self.add_samples(&mut pixel, &mut lit, (index(dx, dy), at, 1.0), roles);
            }
        }
        let all = (per_side * per_side) as f32;
        CutOutPixel {
            rgb: pixel.rgb / all,
            coverage: pixel.coverage / all,
            core: pixel.core / all,
        }
    }

    /// Adds `count` samples about a place, which see this triangle, to the sums of a pixel. `lit` is the triangle whose
    /// light was found last, and that light.
    fn add_samples(
        &self,
        pixel: &mut CutOutPixel,
        lit: &mut (u32, Vec3),
        (index, at, count): (u32, Vec2, f32),
        roles: CutOutRoles,
    ) {
        let Some(triangle) = self.triangles.get(index as usize) else {
            return;
        };
        let surface = triangle.face.surface as usize;
        if surface >= roles.occluders {
            return;
        }
        let Some(spot) = self.spot(index, at) else {
            return;
        };
        pixel.coverage += count;
        if surface < roles.core {
            pixel.core += count;
        }
        if lit.0 != index {
            *lit = (
                index,
                spot.light(&self.lens, &self.lighting, self.turns_normals),
            );
        }
        pixel.rgb += tone(spot.base_color(None) * lit.1) * count;
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use glam::DVec3;
    use secateur_model::{AlphaMode, Finish, Material};

    use super::*;
    use crate::Camera;
    use crate::visibility::{Culling, visibility};

    /// Triangles all over a view, of which the upper left has none.
    fn scattered() -> Surface {
        let at = |k: u32| {
            let angle = 2.4 * f64::from(k);
            let reach = 0.1 * f64::from(k).sqrt();
            DVec3::new(
                reach * angle.cos(),
                reach * angle.sin(),
                0.01 * f64::from(k),
            )
        };
        let near = |middle: &DVec3| middle.x > -0.2 || middle.y < 0.2;
        let middles: Vec<DVec3> = (0..60).map(at).filter(near).collect();
        let corners = [
            DVec3::ZERO,
            DVec3::new(0.13, 0.02, 0.0),
            DVec3::new(0.03, 0.17, 0.0),
        ];
        Surface {
            positions: middles
                .iter()
                .flat_map(|m| corners.map(|c| *m + c))
                .collect(),
            normals: Vec::new(),
            uvs: Vec::new(),
            colors: Vec::new(),
            holds: Vec::new(),
            triangles: (0..middles.len() as u32)
                .map(|k| [3 * k, 3 * k + 1, 3 * k + 2])
                .collect(),
            material: Arc::new(Material {
                name: String::new(),
                base_color: [0.5, 0.5, 0.5, 1.0],
                texture: None,
                alpha_mode: AlphaMode::Opaque,
                double_sided: true,
                finish: Finish::default(),
            }),
        }
    }

    /// Whatever the samples of a pixel, and where a band is empty or ends early, each pixel is covered as the samples of one
    /// z-buffer for all say.
    #[test]
    fn bands_cover_what_one_buffer_does() {
        let surfaces = [scattered()];
        let camera = Camera {
            eye: DVec3::Z * 3.0,
            target: DVec3::ZERO,
            up: DVec3::Y,
            fov_y_rad: 0.6,
        };
        for samples in [1, 2, 3, 4] {
            let [width, height] = [53, 47];
            let lens = Lens::perspective(&camera, width * samples, height * samples);
            let whole = visibility(
                &surfaces.each_ref(),
                &lens,
                Culling::Material,
                AlphaFrom::default(),
            );
            let roles = CutOutRoles {
                core: 0,
                occluders: 1,
            };
            let how = (samples, false);
            let drawn = draw_cut_out(&surfaces.each_ref(), roles, lens, how, AlphaFrom::default());
            let is_seen = |x: u32, y: u32| whole.rows().at(x, y) != NOTHING;
            let mut covered = 0;
            for (k, share) in drawn.coverage.iter().enumerate() {
                let (x, y) = (k as u32 % width, k as u32 / width);
                let all = (0..samples * samples).map(|s| (s % samples, s / samples));
                let seen = all.filter(|(dx, dy)| is_seen(x * samples + dx, y * samples + dy));
                let expected = seen.count() as f32 / (samples * samples) as f32;
                assert_eq!(*share, expected, "{samples} {x} {y}");
                covered += usize::from(expected > 0.0);
            }
            assert!((300..2000).contains(&covered), "{covered}");
        }
    }
}
