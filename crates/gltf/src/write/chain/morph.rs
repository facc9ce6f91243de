//! Where the vertices of a level are at the end of the way to the next one, as a vertex attribute.
//!
//! ```text
//! _MORPH  VEC3 of FLOAT, in the space of POSITION
//! ```

use std::collections::HashMap;

use glam::{DMat4, DVec3, Vec3};
use serde_json::Value;

use super::super::draft::{Draft, NewElements, Role, gather_bytes};
use super::super::leaf_edits::LeafEdits;
use super::super::references::{as_index, items};
use super::vertices::{corners_of, push_indices, topology_of};
use crate::accessor::{Component, Shape};
use crate::error::{At, Fault};
use crate::tree::Tree;
use secateur_model::Lod;

/// The vertex attribute that says where a vertex is when the next level takes over.
pub const MORPH: &str = "_MORPH";

/// Where the corners of a level are at the end of the way to the next level, in world space.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Morph {
    /// By original leaf, its triangles; none where it is gone.
    pub originals: Vec<Vec<[DVec3; 3]>>,
    /// The triangles of each leaf that was made, in the order of [`Lod::made`].
    pub made: Vec<Vec<[DVec3; 3]>>,
}

/// The places of a part's triangles in its level, in the order in which they are written; nothing for triangles of no
/// leaf, which stay.
pub(super) fn places(
    tree: &Tree,
    (lod, edits): (&Lod, &LeafEdits<'_>),
    part_number: usize,
    morph: &Morph,
) -> Result<Vec<Option<[DVec3; 3]>>, Fault> {
    let part = &tree.parts[part_number];
    let count = tree.document.triangles(part.mesh, part.primitive)?.len();
    let mut is_kept = vec![true; count];
    let mut places = vec![None; count];
    for edit in edits.of_part(part_number) {
        let of_leaf = &morph.originals[edit.leaf.index()];
        for (k, &triangle) in edit.triangles.iter().enumerate() {
            is_kept[triangle as usize] = edit.area_scale.is_some();
            places[triangle as usize] = of_leaf.get(k).copied();
        }
    }
    let kept = places.into_iter().zip(is_kept);
    let mut places: Vec<_> = kept
        .filter_map(|(place, kept)| kept.then_some(place))
        .collect();
    for ((leaf, _), of_leaf) in lod.made().zip(&morph.made) {
        if tree.leaf_sources[leaf.donor.index()].part as usize == part_number {
            places.extend(of_leaf.iter().copied().map(Some));
        }
    }
    Ok(places)
}

/// Adds the attribute to a primitive that a transform was put into, and whose triangles go to these places of the
/// scene. A vertex that is to go to several becomes several.
pub(super) fn add(
    draft: &mut Draft,
    primitive: &mut Value,
    places: &[Option<[DVec3; 3]>],
    pivot: DVec3,
    baked: DMat4,
) -> Result<(), Fault> {
    let Some(position) = primitive.pointer("/attributes/POSITION").and_then(as_index) else {
        return Ok(());
    };
    let (corners, count) = corners_of(draft, primitive, position)?;
    let triangles = topology_of(primitive).triangles(&corners);
    if triangles.len() != places.len()
        || draft.elements(position)?.accessor.shape != Shape::Vector(3)
    {
        return Ok(());
    }
    let is_mirrored = baked.determinant() < 0.0;
    let mut split = Split::of(count);
    let mut renumbered = Vec::with_capacity(corners.len());
    for (triangle, place) in triangles.into_iter().zip(places) {
        let place = match (place, is_mirrored) {
            (Some([a, b, c]), true) => Some([*a, *c, *b]),
            (place, _) => *place,
        };
        for (k, vertex) in triangle.into_iter().enumerate() {
            let to = place.map(|place| (place[k] - pivot).as_vec3());
            renumbered.push(split.vertex(vertex, to));
        }
    }
    if split.sources.len() > count {
        gather(draft, primitive, &split.sources)?;
        let old = primitive.get("indices").and_then(as_index);
        primitive["indices"] = push_indices(draft, old, &renumbered, split.sources.len()).into();
        if let Some(fields) = primitive.as_object_mut() {
            fields.shift_remove("mode");
        }
    }
    let elements = draft.elements(position)?;
    let stays: Vec<[f64; 3]> = elements.vectors::<3>().collect();
    let goes = |(source, place): (&u32, &Goes)| match place {
        Goes::To(place) => place.to_array(),
        Goes::Nowhere => stays[*source as usize].map(|x| x as f32),
    };
    let floats = split.sources.iter().zip(&split.places).flat_map(goes);
    let new = NewElements {
        component: Component::F32,
        shape: Shape::Vector(3),
        normalized: false,
        count: split.sources.len(),
        bytes: Some(floats.flat_map(f32::to_le_bytes).collect()),
        bounded: false,
        role: Role::Vertex,
    };
    primitive["attributes"][MORPH] = draft.push_accessor(None, new).into();
    Ok(())
}

/// Where a vertex goes.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Goes {
    Nowhere,
    To(Vec3),
}

/// The vertices of a primitive, each going to one place.
struct Split {
    /// By new vertex, the old one that it is a copy of; the old ones come first.
    sources: Vec<u32>,
    places: Vec<Goes>,
    is_used: Vec<bool>,
    /// By old vertex and the bits of its place; what has none stays.
    copies: HashMap<(u32, Option<[u32; 3]>), u32>,
}

impl Split {
    fn of(count: usize) -> Self {
        Self {
            sources: (0..count as u32).collect(),
            places: vec![Goes::Nowhere; count],
            is_used: vec![false; count],
            copies: HashMap::new(),
        }
    }

    /// The new vertex of an old one that goes there, or stays.
    fn vertex(&mut self, old: u32, to: Option<Vec3>) -> u32 {
        let goes = to.map_or(Goes::Nowhere, Goes::To);
        let used = &mut self.is_used[old as usize];
        if !std::mem::replace(used, true) {
            self.places[old as usize] = goes;
        }
        if self.places[old as usize] == goes {
            return old;
        }
        let key = (old, to.map(|to| to.to_array().map(f32::to_bits)));
        let next = self.sources.len() as u32;
        let number = *self.copies.entry(key).or_insert(next);
        if number == next {
            self.sources.push(old);
            self.places.push(goes);
        }
        number
    }
}

/// Gives all that a primitive has a vertex to copies of its vertices.
fn gather(draft: &mut Draft, primitive: &mut Value, sources: &[u32]) -> Result<(), Fault> {
    let mut of_set = |attributes: &mut Value| -> Result<(), Fault> {
        let fields = attributes.as_object_mut();
        for number in fields.into_iter().flat_map(|fields| fields.values_mut()) {
            let Some(old) = as_index(number) else {
                continue;
            };
            let elements = draft.elements(old)?;
            let accessor = elements.accessor;
            let bytes = gather_bytes(&elements, sources);
            let bytes = bytes.at(|| format!("accessors[{old}]"))?;
            let fields = &draft.root["accessors"][old];
            let new = NewElements {
                component: accessor.component,
                shape: accessor.shape,
                normalized: accessor.normalized,
                count: sources.len(),
                bytes: Some(bytes),
                bounded: fields.get("min").is_some() || fields.get("max").is_some(),
                role: Role::Vertex,
            };
            let origin = draft.origin_of(old);
            *number = draft.push_accessor(origin, new).into();
        }
        Ok(())
    };
    of_set(&mut primitive["attributes"])?;
    for target in items(primitive, "targets") {
        of_set(target)?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Vertex 1 stays for one triangle and goes to two places for others: two copies, each there once.
    #[test]
    fn a_vertex_that_goes_to_several_places_becomes_several() {
        let mut split = Split::of(3);
        let numbers = [
            split.vertex(1, None),
            split.vertex(1, Some(Vec3::X)),
            split.vertex(2, Some(Vec3::X)),
            split.vertex(1, Some(Vec3::Y)),
            split.vertex(1, Some(Vec3::X)),
            split.vertex(2, Some(Vec3::X)),
        ];
        assert_eq!(numbers, [1, 3, 2, 4, 3, 2]);
        assert_eq!(split.sources, [0, 1, 2, 1, 1]);
        assert_eq!(
            split.places[1..4],
            [Goes::Nowhere, Goes::To(Vec3::X), Goes::To(Vec3::X)]
        );
    }
}
