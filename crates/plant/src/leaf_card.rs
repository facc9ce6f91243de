//! The surface of leaves: each a card of two triangles.

use std::sync::Arc;

use glam::{DVec3, Vec2, Vec3, Vec4};
use secateur_model::{Material, Surface};

use crate::{LeafPose, Random};

/// How leaf cards are cut and lit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct CardStyle {
    /// The width of a card as a share of its length.
    pub(crate) width: f64,
    /// How far shading normals lean from the card's own (0) to straight out of
    /// the crown (1).
    pub(crate) outward: f64,
}

/// Cards for these leaves, four vertices and two triangles each, no vertex
/// shared, in order. The texture's bottom middle is the leaf's base.
pub(crate) fn leaf_surface(
    poses: &[LeafPose],
    style: CardStyle,
    material: Arc<Material>,
    random: &mut Random,
) -> Surface {
    let mut surface = Surface {
        positions: Vec::with_capacity(4 * poses.len()),
        normals: Vec::with_capacity(4 * poses.len()),
        uvs: Vec::with_capacity(4 * poses.len()),
        colors: Vec::with_capacity(4 * poses.len()),
        triangles: Vec::with_capacity(2 * poses.len()),
        material,
    };
    let centre = middle_of(poses);
    for pose in poses {
        push_card(&mut surface, pose, style, centre, tint(random));
    }
    surface
}

/// The middle of the leaves' bounding box.
fn middle_of(poses: &[LeafPose]) -> DVec3 {
    let first = poses.first().map_or(DVec3::ZERO, |pose| pose.base);
    let (low, high) = poses.iter().fold((first, first), |(low, high), pose| {
        (low.min(pose.base), high.max(pose.base))
    });
    0.5 * (low + high)
}

/// A linear vertex colour: leaves differ in brightness and in how yellow they are.
fn tint(random: &mut Random) -> Vec4 {
    let brightness = random.between(0.68, 0.95);
    let yellow = random.between(-0.12, 0.12);
    let channel = |share: f64| (brightness * share).min(1.0) as f32;
    Vec4::new(
        channel(1.0 + yellow),
        channel(1.0),
        channel(1.0 - yellow),
        1.0,
    )
}

fn push_card(surface: &mut Surface, pose: &LeafPose, style: CardStyle, centre: DVec3, color: Vec4) {
    let right = pose.along.cross(pose.facing);
    let half_width = right * (0.5 * style.width * pose.length_m);
    let tip = pose.base + pose.along * pose.length_m;
    let corners = [
        (pose.base - half_width, Vec2::new(0.0, 1.0)),
        (pose.base + half_width, Vec2::new(1.0, 1.0)),
        (tip + half_width, Vec2::new(1.0, 0.0)),
        (tip - half_width, Vec2::new(0.0, 0.0)),
    ];
    let first = surface.positions.len() as u32;
    for (position, uv) in corners {
        let outward = (position - centre).normalize_or(pose.facing);
        let normal = pose.facing.lerp(outward, style.outward);
        surface.positions.push(position);
        surface.normals.push(normal.as_vec3().normalize_or(Vec3::Y));
        surface.uvs.push(uv);
        surface.colors.push(color);
    }
    surface.triangles.push([first, first + 1, first + 2]);
    surface.triangles.push([first, first + 2, first + 3]);
}
