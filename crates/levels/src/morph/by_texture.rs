//! Leaves whose corners go to where the next level shows the same of their texture.

use glam::{DVec2, DVec3};
use secateur_model::LeafTriangle;
use secateur_simplify::wood::nearest;

use super::Form;

/// Weights of a point of a triangle's plane that are no further below 0 are taken for inside.
const TOLERANCE: f64 = 1e-9;

/// A corner beyond what a coarser leaf shows of the texture stays beyond it, where that is as near to where the corner
/// was, as a share of the leaf's size: what a card has there is clear. Other values were not tried.
const NEAR: f64 = 0.05;

/// Whether each form has a triangle with texture coordinates that differ.
pub(super) fn is_textured(forms: &[Form<'_>]) -> bool {
    let has_area = |t: &LeafTriangle| doubled_area(t.uvs) != 0.0;
    forms.iter().all(|form| form.triangles.iter().any(has_area))
}

/// Where the triangles of a leaf go.
pub(super) fn moved_along_texture(
    form: &Form<'_>,
    next: &[Form<'_>],
    is_cut_out: bool,
) -> Vec<[DVec3; 3]> {
    let corners = form.triangles.iter().flat_map(|t| t.corners);
    let reach = corners
        .map(|corner| corner.distance(form.centre))
        .fold(0.0, f64::max);
    let beyond = is_cut_out.then_some(NEAR * reach);
    let triangles = form.triangles.iter();
    let place = |at, uv| same_of_texture((at, uv), next, beyond);
    triangles
        .map(|t| [0, 1, 2].map(|k| place(t.corners[k], t.uvs[k])))
        .collect()
}

fn doubled_area([a, b, c]: [DVec2; 3]) -> f64 {
    (b - a).perp_dot(c - a)
}

/// The weights of the corners of which a point is made; some are below 0 beyond the triangle.
fn weights(uvs: [DVec2; 3], at: DVec2) -> [f64; 3] {
    let [a, b, c] = uvs;
    let all = doubled_area(uvs);
    [[at, b, c], [a, at, c], [a, b, at]].map(|part| doubled_area(part) / all)
}

/// A place of a form that may show what a corner shows.
#[derive(Clone, Copy)]
struct Candidate {
    /// How far it is off in the texture, then in the world.
    off: [f64; 2],
    place: DVec3,
}

/// Where the next level shows what this corner shows, or the nearest in the texture; of several places the nearest. Up
/// to `beyond` in world units off, where that is said, it may be in the plane of a triangle, beyond it.
fn same_of_texture((at, uv): (DVec3, DVec2), next: &[Form<'_>], beyond: Option<f64>) -> DVec3 {
    let mut best: Option<Candidate> = None;
    for form in next {
        for triangle in form.triangles.iter().filter(|t| doubled_area(t.uvs) != 0.0) {
            let own = weights(triangle.uvs, uv);
            let point = |w: [f64; 3]| (0..3).map(|k| w[k] * triangle.corners[k]).sum::<DVec3>();
            let is_inside = own.iter().all(|w| *w >= -TOLERANCE);
            let in_texture = nearest(triangle.uvs.map(|uv| uv.extend(0.0)), uv.extend(0.0));
            let off = match is_inside {
                true => 0.0,
                false => in_texture.point.truncate().distance(uv),
            };
            let outside = point(own);
            let place =
                match is_inside || beyond.is_some_and(|beyond| outside.distance(at) <= beyond) {
                    true => outside,
                    false => point(in_texture.weights),
                };
            let off = [off, place.distance(at)];
            if best.is_none_or(|best| off < best.off) {
                let place = form.placed(place);
                best = Some(Candidate { off, place });
            }
        }
    }
    best.map_or(at, |best| best.place)
}
