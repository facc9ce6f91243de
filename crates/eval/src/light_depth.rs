//! How deep in the crown a point lies, seen from a light.

use glam::DVec3;
use secateur_model::{BoundingSphere, Surface};

use crate::lens::Lens;
use crate::texel::floor;
use crate::visibility::{AlphaFrom, Culling, visibility};

/// A depth map from a light.
pub(crate) struct LightDepth {
    lens: Lens,
    nearness: Vec<f32>,
    /// Depth within which a surface does not shade itself.
    bias: f32,
    /// Depth at which light has fallen to a quarter.
    reach: f32,
    /// Samples from the middle to the outermost place that is looked up.
    blur: f32,
}

impl LightDepth {
    /// The depths of surfaces within a sphere, from a light that shines along
    /// `direction`. `reach` and `blur` are shares of the sphere's radius.
    pub(crate) fn new(
        surfaces: &[&Surface],
        bounds: BoundingSphere,
        direction: DVec3,
        size: u32,
        reach: f64,
        blur: f64,
    ) -> Self {
        let radius = bounds.radius.max(f64::MIN_POSITIVE.sqrt());
        let lens = Lens::parallel(bounds.centre, radius, direction, size);
        Self {
            lens,
            nearness: visibility(surfaces, &lens, Culling::None, AlphaFrom::default()).nearness,
            bias: (0.015 * radius) as f32,
            reach: (reach * radius) as f32,
            blur: (0.5 * f64::from(size) * blur) as f32,
        }
    }

    /// The share of the light that comes to a world-space point, 0 to 1: it
    /// fades with the depth of foliage above it. A mean over
    /// (2 `rings` + 1)^2 places around the point.
    pub(crate) fn light_at(&self, world: DVec3, rings: i32) -> f32 {
        let projected = self.lens.project(self.lens.to_view(world));
        let spread = self.blur / rings as f32;
        let mut light = 0.0;
        for dy in -rings..=rings {
            for dx in -rings..=rings {
                let x = projected.at.x + dx as f32 * spread;
                let y = projected.at.y + dy as f32 * spread;
                let depth = self.nearness_at(x, y) - projected.nearness - self.bias;
                let fade = 1.0 + depth.max(0.0) / self.reach;
                light += 1.0 / (fade * fade);
            }
        }
        light / ((2 * rings + 1) * (2 * rings + 1)) as f32
    }

    fn nearness_at(&self, x: f32, y: f32) -> f32 {
        let size = self.lens.width as i64;
        let (x, y) = (floor(x), floor(y));
        if x < 0 || y < 0 || x >= size || y >= size {
            return f32::NEG_INFINITY;
        }
        self.nearness[(y * size + x) as usize]
    }
}
