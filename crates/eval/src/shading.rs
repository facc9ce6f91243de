//! The colour of what a sample sees.

use glam::{DVec3, Vec2, Vec3, Vec4};
use secateur_model::{BoundingSphere, NormalMap, Surface};

use crate::camera::ViewAxes;
use crate::lens::Lens;
use crate::light_depth::LightDepth;
use crate::mips::MipSampler;
use crate::point_in_triangle::{PointInTriangle, face_weights, uv_steps};
use crate::screen_triangle::ScreenTriangle;
use crate::texel::{sample, sample_plain};

const SUN: Vec3 = Vec3::new(2.15, 2.0, 1.7);
const SKY: Vec3 = Vec3::new(0.66, 0.74, 0.86);
const GROUND: Vec3 = Vec3::new(0.36, 0.35, 0.28);
/// The light that reaches even the middle of a crown.
const LEAST_SUN: f32 = 0.06;
const LEAST_SKY: f32 = 0.30;
/// How far the light wraps around a surface.
const WRAP: f32 = 0.35;
const BACKGROUND_TOP: Vec3 = Vec3::new(0.86, 0.90, 0.95);
const BACKGROUND_BOTTOM: Vec3 = Vec3::new(0.72, 0.74, 0.73);
/// How far off its surface a point is lit, as a share of the scene's radius: so
/// that round wood does not shade itself.
const SELF_SHADE: f64 = 0.02;
const MAP_SIZE: u32 = 512;

/// The lights of a scene and the plane that the plant stands on.
pub(crate) struct Lighting {
    /// Unit, from the scene to the sun.
    to_sun: DVec3,
    shade: Option<Shade>,
}

struct Shade {
    sun: LightDepth,
    sky: LightDepth,
    bounds: BoundingSphere,
    ground_y: f64,
}

impl Lighting {
    /// A sun over the camera's left shoulder and a sky above. With `shadows`,
    /// surfaces take light from each other.
    pub(crate) fn new(surfaces: &[&Surface], axes: ViewAxes, shadows: bool) -> Self {
        let level = DVec3::new(-axes.forward.x, 0.0, -axes.forward.z).normalize_or(-axes.forward);
        let to_sun = (level * 0.55 - axes.right * 0.6 + DVec3::Y * 0.95).normalize();
        let shade = shadows.then(|| bounds_of(surfaces)).flatten();
        let shade = shade.map(|(bounds, ground_y)| Shade {
            sun: LightDepth::new(surfaces, bounds, -to_sun, MAP_SIZE, 0.16, 0.025),
            sky: LightDepth::new(surfaces, bounds, DVec3::NEG_Y, MAP_SIZE, 0.55, 0.10),
            bounds,
            ground_y,
        });
        Self { to_sun, shade }
    }

    fn sun_and_sky_at(&self, world: DVec3, normal: Vec3) -> (f32, f32) {
        let Some(shade) = &self.shade else {
            return (1.0, 1.0);
        };
        let fade = |least: f32, light: f32| least + (1.0 - least) * light;
        let world = world + normal.as_dvec3() * (SELF_SHADE * shade.bounds.radius);
        (
            fade(LEAST_SUN, shade.sun.light_at(world, 1)),
            fade(LEAST_SKY, shade.sky.light_at(world, 1)),
        )
    }

    /// The linear colour where nothing is in front: a gradient that darkens
    /// downwards, and under the plant its shadow on the ground.
    pub(crate) fn background(&self, lens: &Lens, at: Vec2) -> Vec3 {
        let down = (at.y / lens.height as f32).clamp(0.0, 1.0);
        let plain = BACKGROUND_TOP.lerp(BACKGROUND_BOTTOM, down * down * (3.0 - 2.0 * down));
        plain * self.ground_shadow(lens.origin, lens.ray(at.x.into(), at.y.into()))
    }

    fn ground_shadow(&self, eye: DVec3, ray: DVec3) -> f32 {
        let Some(shade) = &self.shade else {
            return 1.0;
        };
        let distance = (shade.ground_y - eye.y) / ray.y;
        if !(distance > 0.0 && ray.y < 0.0) {
            return 1.0;
        }
        let world = eye + ray * distance;
        let aside = (world - shade.bounds.centre).with_y(0.0).length() / shade.bounds.radius;
        let fade = ((1.0 - aside) / 0.6).clamp(0.0, 1.0) as f32;
        if fade == 0.0 {
            return 1.0;
        }
        let light = 0.5 * (shade.sun.light_at(world, 2) + shade.sky.light_at(world, 2));
        1.0 - 0.45 * fade * (1.0 - light)
    }
}

/// A sphere about all finite positions, and the lowest of their heights.
fn bounds_of(surfaces: &[&Surface]) -> Option<(BoundingSphere, f64)> {
    let all = || surfaces.iter().flat_map(|s| &s.positions);
    let finite = || all().copied().filter(|p| p.is_finite());
    let (low, high) = finite().fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), p| {
        (low.min(p), high.max(p))
    });
    let centre = 0.5 * (low + high);
    let radius = finite()
        .map(|p| p.distance_squared(centre))
        .fold(0.0, f64::max)
        .sqrt();
    let bounds = BoundingSphere { centre, radius };
    (centre.is_finite() && radius > 0.0).then_some((bounds, low.y))
}

/// What a sample sees: a place on a surface.
pub(crate) struct Spot<'a> {
    surface: &'a Surface,
    corners: [usize; 3],
    weights: [f32; 3],
    triangle: &'a ScreenTriangle,
    place: PointInTriangle,
    at: Vec2,
}

impl<'a> Spot<'a> {
    /// Where the ray through a point of the raster meets a triangle; `None`
    /// where the triangle is seen edge-on.
    pub(crate) fn new(
        surface: &'a Surface,
        triangle: &'a ScreenTriangle,
        at: Vec2,
    ) -> Option<Self> {
        let place = PointInTriangle::within(triangle)?;
        let corners = surface.triangles[triangle.face.triangle as usize];
        Some(Self {
            surface,
            corners: corners.map(|c| c as usize),
            weights: face_weights(triangle, place.weights(at)),
            triangle,
            place,
            at,
        })
    }

    /// Its linear base colour, its texture read from `mips` if there are any.
    pub(crate) fn base_color(&self, mips: Option<MipSampler<'_>>) -> Vec3 {
        let (surface, weights) = (self.surface, self.weights);
        let uvs = self
            .corners
            .map(|c| surface.uvs.get(c).copied().unwrap_or_default());
        let vertex = self
            .corners
            .map(|c| surface.colors.get(c).copied().unwrap_or(Vec4::ONE));
        let uv = weights_of(weights, uvs);
        let texel = match mips {
            Some(mips) => mips.sample(uv, uv_steps(self.triangle, &self.place, self.at, uvs)),
            None => sample(surface.material.texture.as_deref(), uv),
        };
        let color =
            texel * Vec4::from_array(surface.material.base_color) * weights_of(weights, vertex);
        color.truncate()
    }

    /// The light that it sends on, as a factor of its base colour.
    pub(crate) fn light(&self, lens: &Lens, lighting: &Lighting, turns_normals: bool) -> Vec3 {
        let positions = self.corners.map(|c| self.surface.positions[c]);
        let world = weights_of(self.weights.map(f64::from), positions);
        let sight = world - lens.origin;
        let normal = match &self.surface.material.finish.normal_map {
            Some(map) => self.bent_normal(map, sight),
            None if turns_normals => self.normal_of_seen_side(sight),
            None => self.normal(sight),
        };
        light_on(normal, self.surface.material.double_sided, world, lighting)
    }

    /// The shading normal; that of a double-sided material turned around where its back is seen, as
    /// glTF has it.
    pub(crate) fn normal_of_seen_side(&self, sight: DVec3) -> Vec3 {
        let normal = self.normal(sight);
        match self.surface.material.double_sided && self.is_seen_from_behind(sight) {
            // A normal of the face's own is turned to the viewer already.
            true if !self.surface.normals.is_empty() => -normal,
            _ => normal,
        }
    }

    fn is_seen_from_behind(&self, sight: DVec3) -> bool {
        let [a, b, c] = self.corners.map(|c| self.surface.positions[c]);
        (b - a).cross(c - a).dot(sight) > 0.0
    }

    /// The shading normal that a normal map bends, on the side that is seen.
    fn bent_normal(&self, map: &NormalMap, sight: DVec3) -> Vec3 {
        let uvs = self
            .corners
            .map(|c| self.surface.uvs.get(c).copied().unwrap_or_default());
        let [a, b, c] = self.corners.map(|c| self.surface.positions[c]);
        let (ab, ac) = ((b - a).as_vec3(), (c - a).as_vec3());
        let (du, dv) = (uvs[1] - uvs[0], uvs[2] - uvs[0]);
        // How the place changes along u, and against v, for green points up.
        let side = du.perp_dot(dv).signum();
        let tangent = (ab * dv.y - ac * du.y) * side;
        let up = (ab * dv.x - ac * du.x) * side;
        let normal = self.normal_of_seen_side(sight);
        let turned = match self.surface.material.double_sided && self.is_seen_from_behind(sight) {
            true => -1.0,
            false => 1.0,
        };
        let [x, y, z] = sample_plain(&map.texture, weights_of(self.weights, uvs)).to_array();
        let bend = |axis: Vec3, amount: f32| axis.normalize_or_zero() * amount * map.scale * turned;
        (bend(tangent, x) + bend(up, y) + normal * z).normalize_or(normal)
    }

    /// The shading normal, or the face's own, turned to the viewer, where there
    /// is none.
    fn normal(&self, sight: DVec3) -> Vec3 {
        let normals = &self.surface.normals;
        let normals = self
            .corners
            .map(|c| normals.get(c).copied().unwrap_or_default());
        let shading = weights_of(self.weights, normals);
        if shading.length_squared() > 1e-12 {
            return shading.normalize();
        }
        let [a, b, c] = self.corners.map(|c| self.surface.positions[c]);
        let face = (b - a).cross(c - a).normalize_or(-sight);
        let face = if face.dot(sight) > 0.0 { -face } else { face };
        face.normalize_or(DVec3::Y).as_vec3()
    }
}

fn weights_of<T, W>(weights: [W; 3], values: [T; 3]) -> T
where
    T: Copy + std::ops::Mul<W, Output = T> + std::ops::Add<Output = T>,
    W: Copy,
{
    values[0] * weights[0] + values[1] * weights[1] + values[2] * weights[2]
}

fn light_on(normal: Vec3, two_sided: bool, world: DVec3, lighting: &Lighting) -> Vec3 {
    let facing = normal.dot(lighting.to_sun.as_vec3());
    let wrapped = ((facing + WRAP) / (1.0 + WRAP)).max(0.0);
    // Shading normals of leaves may point anywhere, and leaves let light
    // through: both sides are lit, the one turned to the sun more.
    let direct = if two_sided {
        0.55 * wrapped + 0.45 * facing.abs()
    } else {
        wrapped
    };
    let (sun, sky) = lighting.sun_and_sky_at(world, normal);
    let ambient = GROUND.lerp(SKY, 0.5 + 0.5 * normal.y);
    SUN * (direct * sun) + ambient * sky
}
