//! The crown of a plant without leaves: solid pieces in the air, as low-poly trees and mushrooms have.

use glam::DVec3;
use secateur_model::{Foliage, LeafId};

use super::thickness::thickness;

/// What begins no higher above the lowest piece than this share of the height of all is on the ground. Other values
/// were not tried.
const GROUND: f64 = 0.02;

/// A piece is of the crown if it is at least this share of its length thick: a ball is a third, a solid frond an eighth,
/// a twig or a stem less than a twentieth. Other values were not tried.
const LEAST_THICKNESS: f64 = 0.1;

/// The pieces that are the crown, and the others; nothing where what is in the air has less area than the rest, as
/// berries on a bush.
pub(crate) fn crown_and_rest(wood: &Foliage) -> Option<[Vec<LeafId>; 2]> {
    let pieces = || (0..wood.leaves().len()).map(LeafId::from_index);
    let bounds: Vec<[DVec3; 2]> = pieces().map(|piece| bounds(wood, piece)).collect();
    let low = bounds
        .iter()
        .map(|[low, _]| low.y)
        .fold(f64::INFINITY, f64::min);
    let high = bounds
        .iter()
        .map(|[_, high]| high.y)
        .fold(f64::NEG_INFINITY, f64::max);
    let is_of_crown = |piece: &LeafId| {
        let [from, to] = bounds[piece.index()];
        from.y > low + GROUND * (high - low)
            && thickness(wood, *piece) >= LEAST_THICKNESS * (to - from).length()
    };
    let (crown, rest): (Vec<LeafId>, Vec<LeafId>) = pieces().partition(is_of_crown);
    let area = |pieces: &[LeafId]| -> f64 {
        let areas = pieces.iter().map(|piece| wood.leaf(*piece).area());
        areas.sum()
    };
    (!rest.is_empty() && area(&crown) > area(&rest)).then_some([crown, rest])
}

fn bounds(wood: &Foliage, piece: LeafId) -> [DVec3; 2] {
    let corners = wood.triangles_of(piece).iter().flat_map(|t| t.corners);
    corners.fold([DVec3::INFINITY, DVec3::NEG_INFINITY], |[low, high], at| {
        [low.min(at), high.max(at)]
    })
}
