//! The last forms of what carries the crown: a prism of three sides, and a pyramid.
//!
//! A pot is no tube, and of a trunk with a seam at every triangle collapses leave too much. These forms have
//! corners of the piece, are seen from all around, and go from its lowest places to its highest.

use glam::DVec3;
use secateur_model::LeafTriangle;

/// Places within this share of a piece's height of its end are that end.
const END: f64 = 0.1;

/// Directions to the three sides of a form.
const SIDES: [[f64; 2]; 3] = [[1.0, 0.0], [-0.5, 0.866], [-0.5, -0.866]];

/// The forms of a piece as its corners, the finer first; none of what has no height or no width.
pub(super) fn last_forms(triangles: &[LeafTriangle]) -> Vec<Vec<[u32; 3]>> {
    let at = |corner: u32| triangles[corner as usize / 3].corners[corner as usize % 3];
    let corners = 0..3 * triangles.len() as u32;
    let heights = corners.clone().map(|corner| at(corner).y);
    let [low, high] = heights.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], y| {
        [low.min(y), high.max(y)]
    });
    let end = END * (high - low);
    let of_end = |y: f64| {
        let is_in = |corner: &u32| (at(*corner).y - y).abs() <= end;
        let corners: Vec<u32> = corners.clone().filter(is_in).collect();
        End::of(&corners, y, at)
    };
    let [bottom, top] = [low, high].map(of_end);
    let (base, tip) = match bottom.width >= top.width {
        true => (&bottom, &top),
        false => (&top, &bottom),
    };
    let sides = [[0, 1], [1, 2], [2, 0]];
    let prism = sides.iter().flat_map(|&[a, b]| {
        let [b0, b1] = [bottom.corners[a], bottom.corners[b]];
        let [t0, t1] = [top.corners[a], top.corners[b]];
        [[b0, t0, b1], [b1, t0, t1]]
    });
    let pyramid = sides
        .iter()
        .map(|&[a, b]| [base.corners[a], tip.middle, base.corners[b]]);
    let middle = 0.5 * (bottom.centre + top.centre);
    let is_inward = is_inward(triangles, middle);
    let forms = [prism.collect::<Vec<_>>(), pyramid.collect()];
    let turned = |form: Vec<[u32; 3]>| -> Vec<[u32; 3]> {
        let form = form
            .into_iter()
            .filter(|t| normal(t.map(at)).length() > 0.0);
        let turned = form.map(
            |t| match (outwardness(t.map(at), middle) < 0.0) != is_inward {
                true => [t[0], t[2], t[1]],
                false => t,
            },
        );
        turned.collect()
    };
    let forms = forms.map(turned).into_iter();
    // Fewer than three triangles are not seen from all sides.
    forms
        .filter(|form| form.len() >= 3 && form.len() < triangles.len())
        .collect()
}

/// The corners at one end of a piece.
struct End {
    /// Corners that reach furthest to each of three sides.
    corners: [u32; 3],
    /// The one that is nearest to the centre.
    middle: u32,
    centre: DVec3,
    width: f64,
}

impl End {
    /// Of at least one corner, at this height: the nearer to that, the better.
    fn of(corners: &[u32], y: f64, at: impl Fn(u32) -> DVec3) -> Self {
        let centre = corners.iter().map(|c| at(*c)).sum::<DVec3>() / corners.len() as f64;
        let best = |value: &dyn Fn(DVec3) -> f64| {
            let mut best = (f64::NEG_INFINITY, corners[0]);
            for &corner in corners {
                let value = value(at(corner)) - 2.0 * (at(corner).y - y).abs();
                if value > best.0 {
                    best = (value, corner);
                }
            }
            best.1
        };
        let sides = SIDES.map(|[x, z]| best(&|place: DVec3| x * place.x + z * place.z));
        let reach = sides.map(|corner| (at(corner) - centre).length());
        Self {
            corners: sides,
            middle: best(&|place: DVec3| -place.distance(centre)),
            centre,
            width: reach.iter().sum(),
        }
    }
}

fn normal([a, b, c]: [DVec3; 3]) -> DVec3 {
    (b - a).cross(c - a)
}

/// How much a triangle faces away from a place.
fn outwardness(corners: [DVec3; 3], from: DVec3) -> f64 {
    let centre = corners.iter().sum::<DVec3>() / 3.0;
    normal(corners).dot(centre - from)
}

/// Whether triangles face inward for the most part.
fn is_inward(triangles: &[LeafTriangle], middle: DVec3) -> bool {
    let all = triangles.iter().map(|t| outwardness(t.corners, middle));
    all.sum::<f64>() < 0.0
}

#[cfg(test)]
mod tests {
    use super::super::parts::of_corners;
    use super::super::tests::tube;
    use super::*;

    /// As wide as high, and open above: no tube.
    #[test]
    fn a_pot_has_forms_that_are_seen_from_all_sides() {
        let pot = tube(DVec3::ZERO, DVec3::Y, 0.6, 12);
        let forms = last_forms(&pot);
        assert_eq!(forms.iter().map(Vec::len).collect::<Vec<_>>(), [6, 3]);
        let width = |triangles: &[LeafTriangle], side: DVec3| {
            let along = triangles
                .iter()
                .flat_map(|t| t.corners)
                .map(|c| c.dot(side));
            let along: Vec<f64> = along.collect();
            let most = along.iter().copied().fold(f64::NEG_INFINITY, f64::max);
            most - along.iter().copied().fold(f64::INFINITY, f64::min)
        };
        for form in &forms {
            let left = of_corners(&pot, form);
            for angle in (0..12).map(|k| 0.5 * f64::from(k)) {
                let side = DVec3::new(angle.cos(), 0.0, angle.sin());
                assert!(width(&left, side) > 0.6 * width(&pot, side));
            }
            assert_eq!(width(&left, DVec3::Y), width(&pot, DVec3::Y));
            for triangle in left {
                assert!(outwardness(triangle.corners, 0.5 * DVec3::Y) > 0.0);
            }
        }
        let flat: Vec<LeafTriangle> = pot
            .iter()
            .map(|t| LeafTriangle::plain(t.corners.map(|c| DVec3::new(c.x, 0.0, 0.0))))
            .collect();
        assert!(last_forms(&flat).is_empty());
    }
}
