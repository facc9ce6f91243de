//! Connected pieces of primitives, for who chooses among them: what a click meets, and which are leaves.

use std::collections::BTreeMap;

use glam::DVec3;

use super::cutouts::Cutouts;
use super::error::Fault;
use super::halves::runs_of;
use super::parts::Part;
use super::picture::Pictures;
use super::roles::Role;
use super::{GltfError, Tree};

/// A connected piece of a primitive.
#[derive(Clone, Debug, PartialEq)]
pub struct Piece {
    /// Its number in the primitive, from 0: as [`Selector::Pieces`](crate::Selector::Pieces) counts.
    pub number: u32,
    /// Its triangles where it was met, corners in world space.
    pub triangles: Vec<[DVec3; 3]>,
}

impl Tree {
    /// The piece of the primitive at a place, such as `meshes[0].primitives[1]`, that a ray meets first; what textures
    /// cut out is looked through. `None` where it meets none.
    ///
    /// # Errors
    /// [`GltfError`] if the primitive can't be read.
    pub fn piece_at(
        &self,
        place: &str,
        from: [f64; 3],
        along: [f64; 3],
    ) -> Result<Option<Piece>, GltfError> {
        let [from, along] = [from, along].map(DVec3::from_array);
        let met = self.piece_met(place, from, along);
        met.map_err(|fault| self.document.error(fault))
    }

    fn piece_met(&self, place: &str, from: DVec3, along: DVec3) -> Result<Option<Piece>, Fault> {
        let document = &self.document;
        let is_there = |part: &&Part| document.primitive_place(part.mesh, part.primitive) == place;
        let all = self.parts.iter().chain(&self.others);
        let parts: Vec<Part> = all.filter(is_there).cloned().collect();
        let mut budget = document.budget;
        let survey = document.survey(&parts, &mut budget)?;
        let Some(group) = survey.groups.first() else {
            return Ok(None);
        };
        let mut pictures = Pictures::new(document, budget);
        let mut cutouts = Cutouts::default();
        let uvs = match group.look.texture {
            Some(texture) => {
                let uvs =
                    document.texture_coordinates(group.mesh, group.primitive, texture.uv_set)?;
                let uvs = uvs.unwrap_or_default().into_iter();
                uvs.map(|uv| texture.transform.apply(uv)).collect()
            }
            None => Vec::new(),
        };
        let mask = cutouts.index(&group.look, &mut pictures)?;
        let mask = mask.map(|index| &cutouts.masks[index as usize]);
        let geometry = &group.geometry;
        let is_clear = |corners: [u32; 3], [u, v, w]: [f64; 3]| {
            let Some(mask) = mask.filter(|_| !uvs.is_empty()) else {
                return false;
            };
            let [a, b, c] = corners.map(|corner| uvs[corner as usize]);
            let size = glam::DVec2::new(f64::from(mask.width()), f64::from(mask.height()));
            let texel = ((u * a + v * b + w * c) * size).floor();
            !mask.is_opaque(texel.x as i32, texel.y as i32)
        };
        let mut nearest: Option<(f64, &Part, usize)> = None;
        for part in &parts {
            let world = |corner: u32| {
                let local = geometry.positions[corner as usize];
                part.world_from_local.transform_point3(local)
            };
            for (number, piece) in geometry.pieces().iter().enumerate() {
                for corners in piece.iter().map(|&t| geometry.triangles[t as usize]) {
                    if let Some((distance, weights)) = met(corners.map(world), from, along)
                        && nearest.is_none_or(|(other, ..)| distance < other)
                        && !is_clear(corners, weights)
                    {
                        nearest = Some((distance, part, number));
                    }
                }
            }
        }
        Ok(nearest.and_then(|(_, part, number)| {
            let piece = geometry.pieces().iter().nth(number)?;
            let world = |corner: u32| {
                let local = geometry.positions[corner as usize];
                part.world_from_local.transform_point3(local)
            };
            let corners = piece
                .iter()
                .map(|&t| geometry.triangles[t as usize].map(world));
            Some(Piece {
                number: document.piece_number(part.mesh, part.primitive, number),
                triangles: corners.collect(),
            })
        }))
    }

    /// By the places of primitives of which some pieces are leaves and some wood: the first and the last of each run of
    /// pieces that are leaves.
    pub fn leaf_pieces(&self) -> BTreeMap<String, Vec<[u32; 2]>> {
        let mut of_places = BTreeMap::new();
        for part in self.parts.iter().filter(|part| part.role == Role::Leaf) {
            let Some(is_wood) = &part.wood_pieces else {
                continue;
            };
            let document = &self.document;
            let number = |k| document.piece_number(part.mesh, part.primitive, k);
            let leaves = (0..is_wood.len()).filter(|&k| !is_wood[k]);
            let runs = runs_of(leaves.map(number));
            let place = document.primitive_place(part.mesh, part.primitive);
            of_places.insert(place, runs);
        }
        of_places
    }
}

/// Where a ray meets a triangle, from either side: how far along it, and the weights of the corners.
fn met([a, b, c]: [DVec3; 3], from: DVec3, along: DVec3) -> Option<(f64, [f64; 3])> {
    let (ab, ac) = (b - a, c - a);
    let across = along.cross(ac);
    let volume = ab.dot(across);
    if volume == 0.0 {
        return None;
    }
    let to_from = from - a;
    let v = to_from.dot(across) / volume;
    let around = to_from.cross(ab);
    let w = along.dot(around) / volume;
    let distance = ac.dot(around) / volume;
    let is_in = v >= 0.0 && w >= 0.0 && v + w <= 1.0 && distance > 0.0;
    is_in.then_some((distance, [1.0 - v - w, v, w]))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// From 2 above, down: the triangle of corners at 0, x and y is met in its inside alone, 2 away.
    #[test]
    fn a_ray_meets_a_triangle_from_either_side_and_not_beside_it() {
        let triangle = [DVec3::ZERO, DVec3::X, DVec3::Y];
        let from = DVec3::new(0.25, 0.25, 2.0);
        let (distance, weights) = met(triangle, from, -DVec3::Z).unwrap();
        assert_eq!(distance, 2.0);
        assert_eq!(weights, [0.5, 0.25, 0.25]);
        let [a, b, c] = triangle;
        assert!(met([a, c, b], from, -DVec3::Z).is_some());
        assert!(met(triangle, from, DVec3::Z).is_none(), "behind");
        assert!(met(triangle, from + DVec3::X, -DVec3::Z).is_none());
    }
}
