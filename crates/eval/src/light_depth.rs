//! How deep in the crown a point lies, seen from a light.

use std::borrow::Borrow;

use glam::DVec3;
use secateur_model::{BoundingSphere, Surface};

use crate::lens::Lens;
use crate::visibility::visibility;

/// Depths are compared at this many places around a point.
const TAPS: i32 = 5;

/// A depth map from a light.
pub(crate) struct LightDepth {
    lens: Lens,
    nearness: Vec<f32>,
    /// Depth within which a surface does not shade itself.
    bias: f32,
    /// Depth at which light has fallen to 1/e.
    reach: f32,
    /// Samples between taps.
    spread: f32,
}

impl LightDepth {
    /// The depths of surfaces within a sphere, from a light that shines along
    /// `direction`. `reach` and `blur` are shares of the sphere's radius.
    pub(crate) fn new<S: Borrow<Surface> + Sync>(
        surfaces: &[S],
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
            nearness: visibility(surfaces, &lens).nearness,
            bias: (0.012 * radius) as f32,
            reach: (reach * radius) as f32,
            spread: (0.5 * f64::from(size) * blur / f64::from(TAPS / 2)) as f32,
        }
    }

    /// The share of the light that comes to a world-space point, 0 to 1: it
    /// fades with the depth of foliage above it.
    pub(crate) fn light_at(&self, world: DVec3) -> f32 {
        let projected = self.lens.project(self.lens.to_view(world));
        let mut light = 0.0;
        for dy in -(TAPS / 2)..=TAPS / 2 {
            for dx in -(TAPS / 2)..=TAPS / 2 {
                let x = projected.at.x + dx as f32 * self.spread;
                let y = projected.at.y + dy as f32 * self.spread;
                let depth = self.nearness_at(x, y) - projected.nearness - self.bias;
                light += (-depth.max(0.0) / self.reach).exp();
            }
        }
        light / (TAPS * TAPS) as f32
    }

    fn nearness_at(&self, x: f32, y: f32) -> f32 {
        let size = self.lens.width as i64;
        let (x, y) = (x.floor() as i64, y.floor() as i64);
        if x < 0 || y < 0 || x >= size || y >= size {
            return f32::NEG_INFINITY;
        }
        self.nearness[(y * size + x) as usize]
    }
}
