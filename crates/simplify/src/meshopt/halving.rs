//! Halving after halving, and after each the border of what is left moves outwards.
//!
//! So does meshoptimizer's example of cluster LODs with `simplify_dilate_borders`
//! (`demo/clusterlod.h`, pull request 1093, merged in 2026) for each group of clusters; here all
//! leaves are one group, so that what is lost anywhere is spread over all borders. With A and A'
//! the areas of the triangles that have an edge on the border, before a halving and after it, and p
//! the length of the border after it,
//!
//! ```text
//! d = (A - A') / p,  but 0 if A' >= A or A' < A / 4
//! ```
//!
//! and a vertex whose border edges have lengths e and unit vectors n outwards moves by
//!
//! ```text
//! d m / max(|m|^2, 0.15),  m = sum e n / sum e
//! ```

use glam::{DVec3, Vec3};
use rustc_hash::{FxHashMap, FxHashSet};

use super::{Mesh, Mode};

/// What of the border's area has to be left for a border to grow.
const LEAST_SHARE_LEFT: f64 = 0.25;
/// Sharper corners than this do not move further: they would become spikes.
const LEAST_SQUARED_LENGTH: f64 = 0.15;

/// The vertices of as many triangles as the goal or fewer, three each. Vertices of the border
/// move.
pub(super) fn simplified(mesh: &mut Mesh, goal: usize, mode: Mode) -> Vec<u32> {
    let first_at = first_at_its_place(&mesh.positions);
    let mut indices = mesh.indices.clone();
    while indices.len() > goal {
        let half = 3 * (indices.len() / 6);
        let left = mesh.simplified(&indices, goal.max(half), mode);
        if left.len() == indices.len() {
            break;
        }
        dilate(mesh, &first_at, &indices, &left);
        indices = left;
    }
    indices
}

/// For each vertex the first one at its place: they move together.
fn first_at_its_place(positions: &[[f32; 3]]) -> Vec<u32> {
    let mut known: FxHashMap<[u32; 3], u32> = FxHashMap::default();
    let place = |p: &[f32; 3]| p.map(|x| (x + 0.0).to_bits());
    (positions.iter().zip(0..))
        .map(|(position, vertex)| *known.entry(place(position)).or_insert(vertex))
        .collect()
}

/// Triangles, and which of their edges have no other triangle behind them.
struct Border<'m> {
    positions: &'m [[f32; 3]],
    first_at: &'m [u32],
    triangles: &'m [[u32; 3]],
    edges: FxHashSet<[u32; 2]>,
}

impl<'m> Border<'m> {
    fn of(mesh: &'m Mesh, first_at: &'m [u32], indices: &'m [u32]) -> Self {
        let triangles = indices.as_chunks().0;
        let mut border = Self {
            positions: &mesh.positions,
            first_at,
            triangles,
            edges: FxHashSet::default(),
        };
        border.edges = (triangles.iter())
            .flat_map(|t| edges(t).map(|edge| border.of_places(edge)))
            .collect();
        border
    }

    fn of_places(&self, [a, b, _]: [u32; 3]) -> [u32; 2] {
        [a, b].map(|vertex| self.first_at[vertex as usize])
    }

    fn has(&self, edge: [u32; 3]) -> bool {
        let [a, b] = self.of_places(edge);
        !self.edges.contains(&[b, a])
    }

    fn at(&self, vertex: u32) -> DVec3 {
        Vec3::from(self.positions[vertex as usize]).as_dvec3()
    }

    /// Of the triangles that have an edge on the border.
    fn area(&self) -> f64 {
        let has_border = |t: &&[u32; 3]| edges(t).into_iter().any(|edge| self.has(edge));
        let area = |t: &[u32; 3]| {
            let [a, b, c] = t.map(|vertex| self.at(vertex));
            0.5 * (b - a).cross(c - a).length()
        };
        self.triangles.iter().filter(has_border).map(area).sum()
    }
}

/// Two vertices of each edge, and the third of the triangle.
fn edges(&[a, b, c]: &[u32; 3]) -> [[u32; 3]; 3] {
    [[a, b, c], [b, c, a], [c, a, b]]
}

/// Moves the border of what is left of triangles.
fn dilate(mesh: &mut Mesh, first_at: &[u32], before: &[u32], left: &[u32]) {
    let area_before = Border::of(mesh, first_at, before).area();
    let border = Border::of(mesh, first_at, left);
    let area = border.area();
    if area >= area_before || area < LEAST_SHARE_LEFT * area_before {
        return;
    }
    let mut perimeter = 0.0;
    // For each place the border's edges outwards, by their lengths, and these lengths.
    let mut outwards: FxHashMap<u32, (DVec3, f64)> = FxHashMap::default();
    for triangle in border.triangles {
        for edge in edges(triangle).into_iter().filter(|edge| border.has(*edge)) {
            let [a, b, c] = edge.map(|vertex| border.at(vertex));
            let length = a.distance(b);
            let inwards = (c - a).reject_from_normalized((b - a).normalize_or_zero());
            let normal = -inwards.normalize_or_zero();
            for vertex in border.of_places(edge) {
                let (sum, lengths) = outwards.entry(vertex).or_default();
                *sum += length * normal;
                *lengths += length;
            }
            perimeter += length;
        }
    }
    if perimeter <= 0.0 {
        return;
    }
    let distance = (area_before - area) / perimeter;
    let mut moved: Vec<u32> = left.to_vec();
    moved.sort_unstable();
    moved.dedup();
    let places: Vec<(u32, DVec3)> = (moved.iter())
        .filter_map(|&vertex| {
            let (sum, lengths) = outwards.get(&first_at[vertex as usize])?;
            let mean = *sum / lengths.max(f64::MIN_POSITIVE);
            let step = distance / mean.length_squared().max(LEAST_SQUARED_LENGTH);
            Some((vertex, border.at(vertex) + step * mean))
        })
        .collect();
    for (vertex, place) in places {
        mesh.positions[vertex as usize] = place.as_vec3().to_array();
        mesh.is_moved[vertex as usize] = true;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Unit squares in a row, three apart: two triangles each.
    fn squares(count: usize) -> Mesh {
        let mut mesh = Mesh {
            positions: Vec::new(),
            is_moved: vec![false; 4 * count],
            corners: Vec::new(),
            indices: Vec::new(),
            centre: DVec3::ZERO,
            unit: 1.0,
        };
        for k in 0..count {
            let (x, first) = (3.0 * k as f32, 4 * k as u32);
            for corner in [[x, 0.0], [x + 1.0, 0.0], [x + 1.0, 1.0], [x, 1.0]] {
                mesh.positions.push([corner[0], corner[1], 0.0]);
            }
            (mesh.indices).extend([0, 1, 2, 0, 2, 3].map(|vertex| first + vertex));
        }
        mesh
    }

    fn after(count: usize, left: usize) -> Mesh {
        let mut mesh = squares(count);
        let first_at = first_at_its_place(&mesh.positions);
        let before = mesh.indices.clone();
        dilate(&mut mesh, &first_at, &before, &before[..6 * left]);
        mesh
    }

    /// Half of two unit squares is lost over a border of 4: a quarter each side, corners along
    /// their diagonals; the shared diagonal of a square's triangles is no border.
    #[test]
    fn a_border_moves_by_the_lost_area_over_its_length() {
        let mesh = after(2, 1);
        let expected = [[-0.25, -0.25], [1.25, -0.25], [1.25, 1.25], [-0.25, 1.25]];
        for (found, [x, y]) in mesh.positions.iter().zip(expected) {
            let far = Vec3::from(*found).distance(Vec3::new(x, y, 0.0));
            assert!(far < 1e-6, "{found:?}");
        }
        assert_eq!(mesh.is_moved, [[true; 4], [false; 4]].concat());
    }

    /// Of four squares one may grow, by 3/4; of five none does.
    #[test]
    fn nothing_grows_where_more_than_three_quarters_are_lost() {
        assert_eq!(after(4, 1).positions[0], [-0.75, -0.75, 0.0]);
        assert_eq!(after(5, 1).positions, squares(5).positions);
        assert_eq!(after(3, 3).positions, squares(3).positions, "nothing lost");
    }

    /// Two triangles whose tips have the same place: tip and tip move as one.
    #[test]
    fn vertices_at_one_place_move_together() {
        let mut mesh = squares(2);
        let (tip, other) = (mesh.positions[1], 4);
        mesh.positions[other] = tip;
        let first_at = first_at_its_place(&mesh.positions);
        let before = mesh.indices.clone();
        let left = [0, 1, 2, 4, 5, 6];
        dilate(&mut mesh, &first_at, &before, &left);
        assert_eq!(mesh.positions[1], mesh.positions[other]);
        assert_ne!(mesh.positions[1], tip);
    }
}
