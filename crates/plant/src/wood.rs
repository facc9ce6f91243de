//! The surface of wood: segments become closed or joined prisms.

use std::f64::consts::TAU;
use std::sync::Arc;

use glam::{DVec3, Vec2, Vec3};
use secateur_model::{Hold, Material, Surface};

use crate::holds::hold;
use crate::{Segment, Skeleton};

/// Metres of branch that one height of the bark texture covers.
const BARK_HEIGHT_M: f64 = 1.0;

/// A ring of `sides + 1` vertices (the seam has two), or a single tip.
#[derive(Clone, Copy)]
struct Ring {
    first_vertex: u32,
    sides: u32,
    /// Points from the axis to the first vertex; carried along the branch so
    /// that it does not twist.
    side: DVec3,
    v: f64,
}

/// The bark of a skeleton's segments, and what each of its vertices hangs on. A segment that
/// continues its parent with as many sides shares its ring; one that ends in radius 0 ends in a
/// point. `starts_m` says how far along the wood segments start.
pub(crate) fn wood_surface(
    skeleton: &Skeleton,
    starts_m: &[f64],
    material: Arc<Material>,
) -> (Surface, Vec<Hold>) {
    let mut surface = Surface::empty(material);
    let mut holds = Vec::new();
    let mut end_rings: Vec<Ring> = Vec::with_capacity(skeleton.segments.len());
    for (index, segment) in skeleton.segments.iter().enumerate() {
        let parent = segment.parent.filter(|_| segment.continues_parent);
        let parent = parent.map(|index| end_rings[index.index()]);
        let start = match parent {
            Some(ring) if ring.sides == segment.sides => ring,
            other => start_ring(&mut surface, segment, other),
        };
        let start_m = starts_m[index];
        holds.resize(surface.positions.len(), hold(index, segment.start, start_m));
        let end = end_ring(&mut surface, segment, start);
        let end_m = start_m + segment.length_m();
        holds.resize(surface.positions.len(), hold(index, segment.end, end_m));
        join(&mut surface, start, end, segment.end_radius_m == 0.0);
        end_rings.push(end);
    }
    (surface, holds)
}

fn start_ring(surface: &mut Surface, segment: &Segment, before: Option<Ring>) -> Ring {
    let axis = axis_of(segment);
    let side = before.map_or_else(|| axis.any_orthonormal_vector(), |ring| ring.side);
    push_ring(
        surface,
        segment,
        segment.start,
        segment.start_radius_m,
        across(axis, side),
        before.map_or(0.0, |ring| ring.v),
    )
}

fn end_ring(surface: &mut Surface, segment: &Segment, start: Ring) -> Ring {
    let side = across(axis_of(segment), start.side);
    let v = start.v + (segment.end - segment.start).length() / BARK_HEIGHT_M;
    push_ring(surface, segment, segment.end, segment.end_radius_m, side, v)
}

/// The unit vector along a segment, up where it has no length.
fn axis_of(segment: &Segment) -> DVec3 {
    (segment.end - segment.start).normalize_or(DVec3::Y)
}

/// The part of `side` at right angles to `axis`, as a unit vector.
fn across(axis: DVec3, side: DVec3) -> DVec3 {
    (side - axis * axis.dot(side)).normalize_or(axis.any_orthonormal_vector())
}

fn push_ring(
    surface: &mut Surface,
    segment: &Segment,
    centre: DVec3,
    radius_m: f64,
    side: DVec3,
    v: f64,
) -> Ring {
    let axis = axis_of(segment);
    let other = axis.cross(side);
    let length = (segment.end - segment.start).length();
    let slope = if length > 0.0 {
        (segment.start_radius_m - segment.end_radius_m) / length
    } else {
        0.0
    };
    let ring = Ring {
        first_vertex: surface.positions.len() as u32,
        sides: segment.sides,
        side,
        v,
    };
    for corner in 0..=segment.sides {
        let turn = f64::from(corner) / f64::from(segment.sides);
        // The seam's two vertices are the same point to the last bit.
        let (sin, cos) = libm::sincos(TAU * if corner == segment.sides { 0.0 } else { turn });
        let outward = side * cos + other * sin;
        let normal = (outward + axis * slope).normalize();
        surface.positions.push(centre + outward * radius_m);
        surface.normals.push(normal.as_vec3().normalize_or(Vec3::Y));
        surface.uvs.push(Vec2::new(turn as f32, v as f32));
    }
    ring
}

fn join(surface: &mut Surface, start: Ring, end: Ring, ends_in_point: bool) {
    for corner in 0..start.sides {
        let [a, b] = [start.first_vertex + corner, start.first_vertex + corner + 1];
        let [c, d] = [end.first_vertex + corner, end.first_vertex + corner + 1];
        surface.triangles.push([a, b, d]);
        if !ends_in_point {
            surface.triangles.push([a, d, c]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::holds::starts_m;
    use crate::{Random, Rules, draw};

    fn wood(word: &str) -> Surface {
        let rules = Rules::parse(&format!("axiom: {word};")).unwrap();
        let word = rules.derive(1.0, &mut Random::new(0)).unwrap();
        let material = Arc::new(Material {
            name: "bark".into(),
            base_color: [1.0; 4],
            texture: None,
            alpha_mode: secateur_model::AlphaMode::Opaque,
            double_sided: false,
            finish: secateur_model::Finish::default(),
        });
        let skeleton = draw(&rules, &word).unwrap();
        let (surface, holds) = wood_surface(&skeleton, &starts_m(&skeleton.segments), material);
        assert_eq!(holds.len(), surface.positions.len());
        surface
    }

    fn face_normal(surface: &Surface, triangle: [u32; 3]) -> DVec3 {
        let [a, b, c] = triangle.map(|i| surface.positions[i as usize]);
        (b - a).cross(c - a)
    }

    #[test]
    fn a_stem_of_two_segments_shares_the_ring_between_them() {
        let stem = wood("sides(4) !(0.1) F(1, 0.1) F(1, 0)");
        // Three rings of 4 + 1 vertices; 8 triangles around, 4 to the point.
        assert_eq!(stem.positions.len(), 15);
        assert_eq!(stem.triangles.len(), 12);
        assert_eq!(stem.uvs[14], Vec2::new(1.0, 2.0));
    }

    #[test]
    fn faces_and_normals_look_outward() {
        let stem = wood("sides(5) !(0.2) F(1, 0.1) F(1, 0)");
        for &triangle in &stem.triangles {
            let face = face_normal(&stem, triangle);
            assert!(face.length() > 1e-6);
            for corner in triangle {
                assert!(face.dot(stem.normals[corner as usize].as_dvec3()) > 0.0);
            }
            let [a, ..] = triangle.map(|i| stem.positions[i as usize]);
            assert!(face.dot(DVec3::new(a.x, 0.0, a.z)) >= 0.0);
        }
    }

    #[test]
    fn a_segment_without_length_stays_finite() {
        let stump = wood("F(0, 0.1)");
        assert!(stump.positions.iter().all(|p| p.is_finite()));
        assert!(stump.normals.iter().all(|n| n.is_finite()));
    }
}
