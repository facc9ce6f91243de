//! What parallel rays see of surfaces: colour and direction without light, as impostors are baked
//! from.

use std::borrow::Borrow;

use glam::{DVec3, Vec2, Vec3};
use rayon::prelude::*;
use secateur_model::Surface;

use crate::camera::ViewAxes;
use crate::lens::Lens;
use crate::shading::Spot;
use crate::surface_references::references;
use crate::visibility::{AlphaFrom, Culling, visibility};

/// A view along parallel rays.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ParallelView {
    /// What is in the middle.
    pub centre: DVec3,
    /// From what is seen to the eye.
    pub toward: DVec3,
    /// A direction that is upward in the picture; need not be square to the view.
    pub up: DVec3,
    /// Length of a texel's side.
    pub texel: f64,
}

impl ParallelView {
    /// Right, up and toward the eye: unit vectors, square to each other.
    pub fn axes(&self) -> [DVec3; 3] {
        let axes = ViewAxes::looking(-self.toward, self.up);
        [axes.right, axes.up, -axes.forward]
    }
}

/// What is seen in a texel.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SeenTexel {
    /// The share of its samples that see something.
    pub coverage: f32,
    /// The mean linear base colour of these.
    pub color: Vec3,
    /// The mean of their shading normals along right, up and toward the eye, not of unit length.
    /// Normals of double-sided materials are turned to the side that is seen, as glTF has it.
    pub normal: Vec3,
}

/// What a view sees, row by row from the top, each texel by `samples` x `samples` rays.
///
/// # Panics
/// If a triangle of finite positions has an index beyond `positions`.
pub fn seen_along<S: Borrow<Surface> + Sync>(
    surfaces: &[S],
    view: &ParallelView,
    [width, height]: [u32; 2],
    samples: u32,
) -> Vec<SeenTexel> {
    let surfaces = &references(surfaces)[..];
    let axes = ViewAxes::looking(-view.toward, view.up);
    let per_unit = f64::from(samples) / view.texel;
    let lens = Lens::parallel_along(
        axes,
        view.centre,
        [width * samples, height * samples],
        per_unit,
    );
    let seen = visibility(surfaces, &lens, Culling::Material, AlphaFrom::default());
    let mut texels = vec![SeenTexel::default(); width as usize * height as usize];
    let rows = texels.par_chunks_mut(width.max(1) as usize).enumerate();
    rows.for_each(|(y, row)| {
        for (x, texel) in row.iter_mut().enumerate() {
            let mut hits = 0;
            for sample in 0..samples * samples {
                let column = x as u32 * samples + sample % samples;
                let line = y as u32 * samples + sample / samples;
                let at = Vec2::new(column as f32 + 0.5, line as f32 + 0.5);
                let index = seen.frontmost[line as usize * seen.width + column as usize];
                let Some(triangle) = seen.triangles.get(index as usize) else {
                    continue;
                };
                let surface = surfaces[triangle.face.surface as usize];
                let Some(spot) = Spot::new(surface, triangle, at) else {
                    continue;
                };
                hits += 1;
                texel.color += spot.base_color(None);
                let normal = spot.normal_of_seen_side(axes.forward).as_dvec3();
                let [right, up, ahead] = axes.parts(normal).to_array();
                texel.normal += Vec3::new(right as f32, up as f32, -ahead as f32);
            }
            if hits > 0 {
                texel.coverage = hits as f32 / (samples * samples) as f32;
                texel.color /= hits as f32;
                texel.normal /= hits as f32;
            }
        }
    });
    texels
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use secateur_model::{AlphaMode, Finish, Material};

    use super::*;

    /// A triangle that fills the lower left half of a square of side 2 about the origin, facing +z.
    fn half(double_sided: bool) -> Surface {
        Surface {
            positions: vec![
                DVec3::new(-1.0, -1.0, 0.0),
                DVec3::new(1.0, -1.0, 0.0),
                DVec3::new(-1.0, 1.0, 0.0),
            ],
            normals: vec![Vec3::Z; 3],
            uvs: Vec::new(),
            colors: Vec::new(),
            holds: Vec::new(),
            triangles: vec![[0, 1, 2]],
            material: Arc::new(Material {
                name: String::new(),
                base_color: [0.5, 0.25, 0.125, 1.0],
                texture: None,
                alpha_mode: AlphaMode::Opaque,
                double_sided,
                finish: Finish::default(),
            }),
        }
    }

    fn seen(toward: DVec3, double_sided: bool) -> Vec<SeenTexel> {
        let view = ParallelView {
            centre: DVec3::ZERO,
            toward,
            up: DVec3::Y,
            texel: 1.0,
        };
        seen_along(&[half(double_sided)], &view, [2, 2], 4)
    }

    #[test]
    fn half_a_square_covers_half_the_texels_on_its_slope() {
        let texels = seen(DVec3::Z, false);
        // Rows from the top; the slope runs through the upper left and the lower right.
        let coverage: Vec<f32> = texels.iter().map(|t| t.coverage).collect();
        assert_eq!(coverage[1], 0.0);
        assert_eq!(coverage[2], 1.0);
        for slope in [coverage[0], coverage[3]] {
            assert!((0.375..=0.625).contains(&slope), "{slope}");
        }
        assert_eq!(texels[2].color, Vec3::new(0.5, 0.25, 0.125));
        assert!(texels[2].normal.distance(Vec3::Z) < 1e-6);
    }

    #[test]
    fn from_behind_left_is_right_and_only_what_is_double_sided_is_seen() {
        let texels = seen(DVec3::NEG_Z, true);
        assert_eq!((texels[0].coverage, texels[3].coverage), (0.0, 1.0));
        assert!(texels[3].normal.distance(Vec3::Z) < 1e-6, "toward the eye");
        let texels = seen(DVec3::NEG_Z, false);
        assert!(texels.iter().all(|texel| texel.coverage == 0.0));
    }
}
