//! The triangles of all wood as a mesh, and what a half-edge collapse makes of it.

use glam::DVec3;
use rustc_hash::FxHashMap;
use secateur_model::{Foliage, LeafId, LeafTriangle};

use super::super::nearest::{Nearest, nearest};
use super::super::thickness::thickness;

/// The most triangles at a place: where more meet, as at the middle of a fan, nothing collapses,
/// since each try looks at all of them.
const MOST_AROUND: usize = 64;

/// The mesh. A *corner* is one of a triangle as the wood has it: three times the triangle's number
/// and which of its three. A *place* is a position of a piece, a *wedge* a place with one texture
/// coordinate. Collapses give triangles other corners; no place and no wedge ever moves.
#[derive(Clone, Debug)]
pub(super) struct Mesh<'a> {
    wood: &'a Foliage,
    /// The piece of each triangle.
    pieces: Vec<u32>,
    /// By piece, its first triangle; then the number of all triangles.
    first_triangles: Vec<u32>,
    thicknesses: Vec<f64>,
    corners: Vec<[u32; 3]>,
    is_there: Vec<bool>,
    /// The place of each corner that triangles name.
    places: Vec<u32>,
    /// The wedge of each corner that triangles name.
    wedges: Vec<u32>,
    /// By place, the triangles that are there, in their order.
    around: Vec<Vec<u32>>,
}

/// What a collapse does to the triangles.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Effect {
    /// Triangles that have both ends of the edge.
    pub(super) removed: Vec<u32>,
    /// The others at the place that goes, with their new corners.
    pub(super) changed: Vec<(u32, [u32; 3])>,
    /// How far the place that goes is from the surface that is left, in world units.
    pub(super) distance: f64,
}

impl<'a> Mesh<'a> {
    pub(super) fn new(wood: &'a Foliage) -> Self {
        let triangles = wood.triangles();
        let mut mesh = Self {
            wood,
            pieces: Vec::with_capacity(triangles.len()),
            first_triangles: vec![0],
            thicknesses: Vec::new(),
            corners: (0..triangles.len() as u32)
                .map(|t| [3 * t, 3 * t + 1, 3 * t + 2])
                .collect(),
            is_there: vec![true; triangles.len()],
            places: Vec::with_capacity(3 * triangles.len()),
            wedges: Vec::with_capacity(3 * triangles.len()),
            around: Vec::new(),
        };
        let mut wedge_count = 0;
        let bits = |x: f64| (x + 0.0).to_bits();
        for index in 0..wood.leaves().len() {
            let piece = LeafId::from_index(index);
            let mut places: FxHashMap<[u64; 3], u32> = FxHashMap::default();
            let mut wedges: FxHashMap<(u32, [u64; 2]), u32> = FxHashMap::default();
            for triangle in wood.triangles_of(piece) {
                mesh.pieces.push(index as u32);
                for (corner, uv) in triangle.corners.iter().zip(triangle.uvs) {
                    let next = mesh.around.len() as u32;
                    let place = *places.entry(corner.to_array().map(bits)).or_insert(next);
                    if place == next {
                        mesh.around.push(Vec::new());
                    }
                    let wedge = *wedges
                        .entry((place, uv.to_array().map(bits)))
                        .or_insert(wedge_count);
                    wedge_count += u32::from(wedge == wedge_count);
                    mesh.places.push(place);
                    mesh.wedges.push(wedge);
                }
            }
            mesh.first_triangles.push(mesh.pieces.len() as u32);
            mesh.thicknesses.push(thickness(wood, piece));
        }
        for triangle in 0..triangles.len() as u32 {
            let [a, b, c] = mesh.corners[triangle as usize].map(|c| mesh.places[c as usize]);
            // What two corners at one place make a line of shows nothing.
            if a == b || b == c || c == a {
                mesh.is_there[triangle as usize] = false;
                continue;
            }
            for place in [a, b, c] {
                mesh.around[place as usize].push(triangle);
            }
        }
        mesh
    }

    pub(super) fn place_count(&self) -> u32 {
        self.around.len() as u32
    }

    pub(super) fn wood(&self) -> &'a Foliage {
        self.wood
    }

    /// The piece that a triangle is of.
    pub(super) fn piece_of(&self, triangle: u32) -> LeafId {
        LeafId::from_index(self.pieces[triangle as usize] as usize)
    }

    pub(super) fn is_there(&self, triangle: u32) -> bool {
        self.is_there[triangle as usize]
    }

    /// Triangles of a piece that are left, as corners numbered within the piece.
    pub(super) fn left_of(&self, piece: LeafId) -> Vec<[u32; 3]> {
        let [first, end] = [0, 1].map(|k| self.first_triangles[piece.index() + k]);
        let left = (first..end).filter(|t| self.is_there(*t));
        left.map(|t| self.corners[t as usize].map(|corner| corner - 3 * first))
            .collect()
    }

    /// A triangle with these corners.
    pub(super) fn triangle(&self, corners: [u32; 3]) -> LeafTriangle {
        let all = self.wood.triangles();
        let of = |corner: u32| (&all[corner as usize / 3], corner as usize % 3);
        LeafTriangle {
            corners: corners.map(of).map(|(t, k)| t.corners[k]),
            uvs: corners.map(of).map(|(t, k)| t.uvs[k]),
        }
    }

    /// A triangle as it is now.
    pub(super) fn now(&self, triangle: u32) -> LeafTriangle {
        self.triangle(self.corners[triangle as usize])
    }

    /// The other places of the triangles at a place, in their order.
    pub(super) fn neighbours(&self, place: u32) -> Vec<u32> {
        let around = self.around[place as usize].iter();
        let others = around.flat_map(|t| self.places_of(*t));
        let mut others: Vec<u32> = others.filter(|other| *other != place).collect();
        others.sort_unstable();
        others.dedup();
        others
    }

    fn places_of(&self, triangle: u32) -> [u32; 3] {
        self.corners[triangle as usize].map(|c| self.places[c as usize])
    }

    fn corner_at(&self, triangle: u32, place: u32) -> u32 {
        let corners = self.corners[triangle as usize];
        let at = corners.iter().find(|c| self.places[**c as usize] == place);
        *at.expect("a triangle at its place")
    }

    /// What becomes of the mesh if a place moves onto a neighbour; nothing if it may not: at a border
    /// or a seam of texture coordinates it stays on that line, no triangle may turn over or become a
    /// line, the texture may slide by no more than the piece is thick, and something must be left.
    pub(super) fn effect(&self, from: u32, to: u32) -> Option<Effect> {
        let around = &self.around[from as usize];
        if around.len() > MOST_AROUND {
            return None;
        }
        let has = |t: &u32, place: u32| self.places_of(*t).contains(&place);
        let (removed, kept): (Vec<u32>, Vec<u32>) = around.iter().partition(|t| has(t, to));
        if removed.is_empty() || kept.is_empty() {
            return None;
        }
        let is_border = |edge_to: &u32| around.iter().filter(|t| has(t, *edge_to)).count() == 1;
        if removed.len() > 1 && self.neighbours(from).iter().any(is_border) {
            return None;
        }
        let mut changed = Vec::with_capacity(kept.len());
        for &triangle in &kept {
            let gone = self.corner_at(triangle, from);
            let onto = self.onto(triangle, gone, &removed, to, from)?;
            let corners = self.corners[triangle as usize].map(|c| if c == gone { onto } else { c });
            let normal = |t: LeafTriangle| {
                let [a, b, c] = t.corners;
                (b - a).cross(c - a)
            };
            let [before, after] = [self.now(triangle), self.triangle(corners)].map(normal);
            if before != DVec3::ZERO && before.dot(after) <= 0.0 {
                return None;
            }
            changed.push((triangle, corners));
        }
        let distance = self.distance(from, &changed)?;
        Some(Effect {
            removed,
            changed,
            distance,
        })
    }

    /// The corner that a triangle gets for the one that goes: of a removed triangle of the same
    /// texture on that side of a seam, the one that faces most alike.
    fn onto(&self, triangle: u32, gone: u32, removed: &[u32], to: u32, from: u32) -> Option<u32> {
        let facing = |t: u32| {
            let [a, b, c] = self.now(t).corners;
            (b - a).cross(c - a).normalize_or_zero()
        };
        let own = facing(triangle);
        let wedge = |corner: u32| self.wedges[corner as usize];
        let mut best: Option<(f64, u32)> = None;
        for &other in removed {
            if wedge(self.corner_at(other, from)) != wedge(gone) {
                continue;
            }
            let corner = self.corner_at(other, to);
            if best.is_some_and(|(_, known)| wedge(known) != wedge(corner)) {
                return None;
            }
            let likeness = own.dot(facing(other));
            if best.is_none_or(|(most, _)| likeness > most) {
                best = Some((likeness, corner));
            }
        }
        best.map(|(_, corner)| corner)
    }

    /// How far a place is from triangles that are changed; nothing if the texture there would be
    /// further off than the piece is thick.
    fn distance(&self, from: u32, changed: &[(u32, [u32; 3])]) -> Option<f64> {
        let mut best: Option<(f64, usize, Nearest)> = None;
        let at = self.now(changed[0].0);
        let corner = self.corner_at(changed[0].0, from);
        let k = self.corners[changed[0].0 as usize]
            .iter()
            .position(|c| *c == corner)?;
        let place: DVec3 = at.corners[k];
        for (index, (_, corners)) in changed.iter().enumerate() {
            let found = nearest(self.triangle(*corners).corners, place);
            let distance_2 = (found.point - place).length_squared();
            if best.as_ref().is_none_or(|(least, ..)| distance_2 < *least) {
                best = Some((distance_2, index, found));
            }
        }
        let (distance_2, index, found) = best?;
        let (triangle, corners) = changed[index];
        let after = self.triangle(corners);
        let gone = self.corner_at(triangle, from);
        let uv = self.wood.triangles()[gone as usize / 3].uvs[gone as usize % 3];
        let shown = (0..3).map(|k| found.weights[k] * after.uvs[k]);
        let off = (shown.fold(glam::DVec2::ZERO, |sum, uv| sum + uv) - uv).length();
        // World units that texture coordinates take at most, by the sides of the triangle.
        let per_uv = [(0, 1), (1, 2), (2, 0)].map(|(a, b)| {
            let uvs = (after.uvs[a] - after.uvs[b]).length();
            (after.corners[a] - after.corners[b]).length() / uvs
        });
        let per_uv = per_uv.into_iter().filter(|x| x.is_finite());
        let slide = off * per_uv.fold(f64::INFINITY, f64::min).min(f64::MAX);
        let thickness = self.thicknesses[self.pieces[triangle as usize] as usize];
        (off == 0.0 || slide <= thickness).then(|| distance_2.sqrt())
    }

    /// Makes the mesh what a collapse makes of it.
    pub(super) fn commit(&mut self, from: u32, effect: &Effect) {
        for &triangle in &effect.removed {
            self.is_there[triangle as usize] = false;
            for place in self.places_of(triangle) {
                self.around[place as usize].retain(|t| *t != triangle);
            }
        }
        for &(triangle, corners) in &effect.changed {
            let old = self.places_of(triangle);
            self.corners[triangle as usize] = corners;
            for place in self.places_of(triangle) {
                let around = &mut self.around[place as usize];
                if !old.contains(&place) {
                    let at = around.partition_point(|t| *t < triangle);
                    around.insert(at, triangle);
                }
            }
        }
        self.around[from as usize].clear();
    }
}
