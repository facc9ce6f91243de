//! How thick a piece of wood is.

use glam::DVec3;
use secateur_model::{Foliage, LeafId};

/// The diameter of a tube as long as the piece and of its area, in world units.
pub(super) fn thickness(wood: &Foliage, piece: LeafId) -> f64 {
    let corners = || wood.triangles_of(piece).iter().flat_map(|t| t.corners);
    let (low, high) = corners().fold(
        (DVec3::INFINITY, DVec3::NEG_INFINITY),
        |(low, high), corner| (low.min(corner), high.max(corner)),
    );
    let length = (high - low).length();
    match length > 0.0 {
        true => wood.leaf(piece).area() / (std::f64::consts::PI * length),
        false => 0.0,
    }
}
