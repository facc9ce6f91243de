//! Primitives of which some pieces are not the plant: each becomes two, so that all else knows whole primitives only.
//!
//! The plant's half keeps the number of the primitive, the other half comes last in its mesh. Both keep the vertices
//! and get triangles of their own, in a buffer that is new. Pieces keep the numbers that they have in the file.

use std::collections::BTreeMap;
use std::sync::OnceLock;

use serde_json::{Value, json};

use super::Document;
use super::accessor::Component;
use super::buffer::{Buffer, distinct_bytes};
use super::error::{ALLOW_MORE, Fault, Problem};
use super::leaves::{Leaves, find_leaves};
use super::property::{push, remove};
use super::selector::Selector;

/// What primitives that are not the plant have in their `extras`, so that levels are read as they were made.
const MARK: &str = "secateur_not_plant";

const ELEMENT_ARRAY_BUFFER: u32 = 34963;

/// The most vertices of which 16 bits can name each.
const MOST_OF_16_BITS: usize = 0xffff;

/// What reading a primitive and finding its pieces takes, in bytes for a vertex or a triangle.
const BYTES_A_CORNER: u64 = 100;

/// Some of the pieces of a primitive of the file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Half {
    /// The number of that primitive in the mesh.
    pub(crate) source: usize,
    /// How many pieces that has.
    pub(crate) of: usize,
    /// The numbers of these pieces in it, rising.
    pub(crate) pieces: Vec<u32>,
    /// Whether they are the plant.
    pub(crate) is_plant: bool,
}

/// By mesh and primitive, what became of primitives of which pieces are not the plant.
pub(crate) type Halves = BTreeMap<[usize; 2], Half>;

/// Pieces of a primitive that are not the plant.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct OtherPieces {
    /// The place of the primitive in the file that they are of.
    pub source: String,
    /// The first and the last number of each run of them.
    pub runs: Vec<[u32; 2]>,
}

impl Document {
    /// Parts the pieces that selectors name from their primitives.
    pub(crate) fn part_pieces(&mut self, selectors: &[Selector]) -> Result<(), Fault> {
        let mut named: BTreeMap<[usize; 2], Vec<&Selector>> = BTreeMap::new();
        for selector in selectors {
            if let Selector::Pieces {
                mesh, primitive, ..
            } = selector
            {
                let of_primitive = named.entry([mesh, primitive].map(|k| *k as usize));
                of_primitive.or_default().push(selector);
            }
        }
        let mut indices = Vec::new();
        for (place, selectors) in named {
            self.part_primitive(place, &selectors, &mut indices)?;
        }
        if !indices.is_empty() {
            push(
                &mut self.root,
                "buffers",
                json!({"byteLength": indices.len()}),
            );
            self.buffers.push(Buffer::of(indices));
            self.data_bytes = distinct_bytes(&self.buffers);
        }
        Ok(())
    }

    fn part_primitive(
        &mut self,
        place: [usize; 2],
        selectors: &[&Selector],
        indices: &mut Vec<u8>,
    ) -> Result<(), Fault> {
        let [mesh, primitive] = place;
        if self.primitive(mesh, primitive).is_err() {
            return Err(matches_nothing(selectors[0], 0).into());
        }
        let vertices = self.vertex_count(mesh, primitive)?;
        let corners = (self.triangle_bound(mesh, primitive)? + vertices) as u64;
        let what = || "the pieces of a primitive".to_owned();
        let mut working = self.budget;
        let taken = working.take(BYTES_A_CORNER * corners, what, ALLOW_MORE);
        taken.map_err(Problem::from)?;
        let triangles = self.triangles(mesh, primitive)?;
        let pieces = find_leaves(&self.positions(mesh, primitive)?, &triangles);
        let is_other = named_pieces(selectors, pieces.len())?;
        let half = |is_plant: bool| Half {
            source: primitive,
            of: pieces.len(),
            pieces: (0..)
                .zip(&is_other)
                .filter(|(_, is_other)| **is_other != is_plant)
                .map(|(number, _)| number)
                .collect(),
            is_plant,
        };
        let [mut plant, mut other] = [(); 2].map(|()| {
            let fields = &self.root["meshes"][mesh]["primitives"][primitive];
            fields.clone()
        });
        mark(&mut other);
        // As it came, all of it was the plant.
        self.undecoded = None;
        let bytes = size_of_val(&triangles[..]) as u64;
        let taken = self.budget.take(bytes, what, ALLOW_MORE);
        taken.map_err(Problem::from)?;
        if is_other.iter().all(|is_other| *is_other) {
            self.root["meshes"][mesh]["primitives"][primitive] = other;
            self.halves.insert(place, half(false));
            return Ok(());
        }
        for (fields, is_plant) in [(&mut plant, true), (&mut other, false)] {
            let of_half = triangles_of(&triangles, &pieces, &half(is_plant).pieces);
            fields["indices"] = self.push_indices(indices, &of_half, vertices).into();
            remove(fields, "mode");
        }
        self.root["meshes"][mesh]["primitives"][primitive] = plant;
        let last = push(&mut self.root["meshes"][mesh], "primitives", other);
        self.halves.insert(place, half(true));
        self.halves.insert([mesh, last], half(false));
        Ok(())
    }

    /// Adds an accessor of these triangles, whose bytes go behind those of the buffer that is being made.
    fn push_indices(
        &mut self,
        buffer: &mut Vec<u8>,
        triangles: &[[u32; 3]],
        vertices: usize,
    ) -> usize {
        let corners = triangles.as_flattened();
        let start = buffer.len();
        let component = match vertices <= MOST_OF_16_BITS {
            true => {
                buffer.extend(corners.iter().flat_map(|&v| (v as u16).to_le_bytes()));
                Component::U16
            }
            false => {
                buffer.extend(corners.iter().flat_map(|v| v.to_le_bytes()));
                Component::U32
            }
        };
        let view = json!({
            "buffer": self.buffers.len(),
            "byteOffset": start,
            "byteLength": buffer.len() - start,
            "target": ELEMENT_ARRAY_BUFFER,
        });
        buffer.resize(buffer.len().next_multiple_of(4), 0);
        self.decompressed_views.push(OnceLock::new());
        let accessor = json!({
            "bufferView": push(&mut self.root, "bufferViews", view),
            "componentType": component.code(),
            "count": corners.len(),
            "type": "SCALAR",
        });
        push(&mut self.root, "accessors", accessor)
    }

    /// Whether a primitive says of itself that it is not the plant.
    pub(crate) fn is_marked(&self, mesh: usize, primitive: usize) -> bool {
        let fields = &self.root["meshes"][mesh]["primitives"][primitive];
        fields["extras"][MARK] == true
    }

    /// The number that a piece of a primitive has in the file.
    pub(crate) fn piece_number(&self, mesh: usize, primitive: usize, piece: usize) -> u32 {
        let half = self.halves.get(&[mesh, primitive]);
        half.map_or(piece as u32, |half| half.pieces[piece])
    }

    /// By the places of primitives, the pieces in them that were named as not the plant.
    pub fn other_pieces(&self) -> BTreeMap<String, OtherPieces> {
        let others = self.halves.iter().filter(|(_, half)| !half.is_plant);
        let placed = others.map(|(&[mesh, primitive], half)| {
            let pieces = OtherPieces {
                source: self.primitive_place(mesh, half.source),
                runs: runs_of(half.pieces.iter().copied()),
            };
            (self.primitive_place(mesh, primitive), pieces)
        });
        placed.collect()
    }
}

/// Rising numbers as the first and the last of each run.
pub(crate) fn runs_of(numbers: impl Iterator<Item = u32>) -> Vec<[u32; 2]> {
    let mut runs: Vec<[u32; 2]> = Vec::new();
    for number in numbers {
        match runs.last_mut() {
            Some([_, last]) if *last + 1 == number => *last = number,
            _ => runs.push([number; 2]),
        }
    }
    runs
}

/// For each piece of a primitive of `count` pieces, whether one of these selectors names it.
fn named_pieces(selectors: &[&Selector], count: usize) -> Result<Vec<bool>, Problem> {
    let mut is_named = vec![false; count];
    for selector in selectors {
        if let Selector::Pieces { first, last, .. } = selector {
            let run = is_named.get_mut(*first as usize..=*last as usize);
            run.ok_or_else(|| matches_nothing(selector, count))?
                .fill(true);
        }
    }
    Ok(is_named)
}

/// The problem of a selector that names pieces beyond the `count` that its primitive has.
fn matches_nothing(selector: &Selector, count: usize) -> Problem {
    let known = match (selector, count.checked_sub(1)) {
        (
            &Selector::Pieces {
                mesh, primitive, ..
            },
            Some(last),
        ) => Selector::Pieces {
            mesh,
            primitive,
            first: 0,
            last: last as u32,
        }
        .to_string(),
        _ => "no such primitive".to_owned(),
    };
    Problem::SelectorMatchesNothing {
        selector: selector.to_string(),
        known: vec![known],
    }
}

/// The triangles of some pieces, as the primitive has them in order.
fn triangles_of(triangles: &[[u32; 3]], pieces: &Leaves, chosen: &[u32]) -> Vec<[u32; 3]> {
    let mut is_chosen = vec![false; triangles.len()];
    let mut numbers = chosen.iter().peekable();
    for (number, piece) in (0..).zip(pieces.iter()) {
        if numbers.next_if_eq(&&number).is_some() {
            piece.iter().for_each(|&t| is_chosen[t as usize] = true);
        }
    }
    let all = triangles.iter().zip(is_chosen);
    all.filter(|(_, is_chosen)| *is_chosen)
        .map(|(triangle, _)| *triangle)
        .collect()
}

/// Says of a primitive that it is not the plant. Extras that are no object, which glTF advises against, give way.
fn mark(primitive: &mut Value) {
    if !primitive["extras"].is_object() {
        primitive["extras"] = json!({});
    }
    primitive["extras"][MARK] = true.into();
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_said_as_runs() {
        assert_eq!(
            runs_of([0, 1, 4, 6, 7].into_iter()),
            [[0, 1], [4, 4], [6, 7]]
        );
        assert!(runs_of([].into_iter()).is_empty());
    }

    #[test]
    fn a_primitive_keeps_what_its_extras_say() {
        let mut primitive = json!({"extras": {"season": "spring"}});
        mark(&mut primitive);
        assert_eq!(primitive["extras"], json!({"season": "spring", MARK: true}));
    }
}
