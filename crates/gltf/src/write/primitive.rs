//! One primitive with fewer leaves, or leaves of another size.

use std::borrow::Cow;
use std::rc::Rc;

use glam::DVec3;
use rustc_hash::FxHashMap;
use serde_json::Value;

use super::draft::{Draft, NewElements, Role, gather_bytes, is_all_zero};
use super::grid::{Grid, elements_like};
use super::leaf_edits::{Blend, LeafEdits, MadeCorner};
use super::references::as_index;
use super::vertices::{KeptTriangle, Resize, Vertices, corner_vertices, shared_vertices};
use crate::accessor::{Component, Elements, Shape};
use crate::error::{At, Fault, Problem};
use crate::roles;
use crate::tree::Tree;

/// A primitive's JSON after the edits of a part's leaves, or `None` if no
/// triangle is left.
pub(super) fn rewrite_primitive(
    draft: &mut Draft,
    tree: &Tree,
    edits: &LeafEdits,
    part_number: usize,
) -> Result<Option<Value>, Fault> {
    let part = &tree.parts[part_number];
    let Kept {
        triangles: kept,
        resizes,
        blends,
        surfaces,
        normals,
    } = kept_triangles(draft, tree, edits, part_number)?;
    if kept.is_empty() {
        return Ok(None);
    }
    let document = draft.document;
    let mut primitive = document.primitive(part.mesh, part.primitive)?.clone();
    let old_indices = primitive.get("indices").and_then(as_index);
    let vertices = match old_indices {
        Some(_) => {
            let position = accessor_of(&primitive["attributes"]["POSITION"]);
            let vertices = shared_vertices(document.accessor(position)?.count, &kept);
            match draft.compression {
                Some(_) => vertices.in_order_of_use(),
                None => vertices,
            }
        }
        None => corner_vertices(&kept),
    };
    let moves = Moves {
        vertices: &vertices,
        resizes: &resizes,
        blends: &blends,
        normals: &normals,
        sources: Sources::of(&vertices, &surfaces),
        place: document.primitive_place(part.mesh, part.primitive),
    };
    moves.rewrite_attributes(draft, &mut primitive["attributes"], Mover::Point)?;
    for target in super::references::items(&mut primitive, "targets") {
        moves.rewrite_attributes(draft, target, Mover::Delta)?;
    }
    if let (Some(old), Some(triangles)) = (old_indices, &vertices.triangles) {
        let new = new_indices(draft, old, triangles.as_flattened(), vertices.sources.len())?;
        primitive["indices"] = draft.push_accessor(Some(old), new).into();
    }
    if primitive
        .get("mode")
        .and_then(as_index)
        .is_some_and(|mode| mode != TRIANGLES)
    {
        primitive["mode"] = TRIANGLES.into();
    }
    note_extensions(draft, &primitive, &moves.place);
    Ok(Some(primitive))
}

const TRIANGLES: usize = 4;

fn accessor_of(number: &Value) -> usize {
    as_index(number).expect("a primitive with triangles was read")
}

/// The triangles that a primitive has from now on.
struct Kept {
    triangles: Vec<KeptTriangle>,
    resizes: Vec<Resize>,
    /// By resize: old vertices, and how much what it moves has of each, where it has not all
    /// of one.
    blends: FxHashMap<u32, ([u32; 3], [f64; 3])>,
    /// By resize: the old vertex of whose surface what it moves is, where that has texture
    /// coordinates of another one.
    surfaces: FxHashMap<u32, u32>,
    /// By resize: the normal of what it moves, where that is the triangle's own.
    normals: FxHashMap<u32, DVec3>,
}

/// The old vertices that new ones are copies of.
struct Sources {
    /// For texture coordinates, and tangents, which follow them.
    textures: Rc<[u32]>,
    /// For positions, normals, colours and all other attributes.
    surfaces: Rc<[u32]>,
}

impl Sources {
    fn of(vertices: &Vertices, surfaces: &FxHashMap<u32, u32>) -> Self {
        let textures: Rc<[u32]> = vertices.sources.as_slice().into();
        let mut of_surfaces = Rc::clone(&textures);
        if !surfaces.is_empty() {
            let of_surfaces = Rc::make_mut(&mut of_surfaces);
            for (vertex, resize) in &vertices.moved {
                if let Some(old) = surfaces.get(resize) {
                    of_surfaces[*vertex as usize] = *old;
                }
            }
        }
        Self {
            textures,
            surfaces: of_surfaces,
        }
    }

    fn of_attribute(&self, semantic: &str) -> &Rc<[u32]> {
        match semantic.starts_with("TEXCOORD_") || semantic == "TANGENT" {
            true => &self.textures,
            false => &self.surfaces,
        }
    }
}

fn kept_triangles(
    draft: &Draft,
    tree: &Tree,
    edits: &LeafEdits,
    part_number: usize,
) -> Result<Kept, Fault> {
    let part = &tree.parts[part_number];
    let triangles = draft.document.triangles(part.mesh, part.primitive)?;
    let mut made = Made {
        kept: Kept::of_old(edits, part_number, &triangles),
        old: &triangles,
        placed: FxHashMap::default(),
    };
    let old_normals = match edits.has_made(part_number) {
        true => {
            let primitive = draft.document.primitive(part.mesh, part.primitive)?;
            let known = &tree.old_normals;
            known.of_part(part_number, draft.document, primitive, &triangles)?
        }
        false => None,
    };
    for triangle in edits.made_in(part_number) {
        let own_normal = old_normals.as_ref().and_then(|old| {
            let places = triangle.map(|corner| corner.position_local);
            let surfaces = triangle.map(|corner| corner.surface_of.unwrap_or(corner.like));
            let vertices = surfaces.map(|corner| made.vertex(corner));
            // Cards keep the normals of their plane, and what is bent on purpose.
            let is_solid = part.role == roles::Role::Wood || old.are_facets(vertices);
            let of_triangles = surfaces.map(|(triangle, _)| triangle);
            is_solid.then(|| old.normal_of(places, of_triangles, vertices))?
        });
        made.push(triangle, own_normal);
    }
    Ok(made.kept)
}

impl Kept {
    /// The old triangles that stay, smaller or larger where their leaves are.
    fn of_old(edits: &LeafEdits, part_number: usize, triangles: &[[u32; 3]]) -> Self {
        let mut is_kept = vec![true; triangles.len()];
        let mut resize_of = vec![None; triangles.len()];
        let mut resizes = Vec::new();
        for edit in edits.of_part(part_number) {
            if edit.area_scale.is_none() {
                for &triangle in edit.triangles {
                    is_kept[triangle as usize] = false;
                }
            } else if let Some(resize) = edits.resize(part_number, &edit) {
                for &triangle in edit.triangles {
                    resize_of[triangle as usize] = Some(resizes.len() as u32);
                }
                resizes.push(resize);
            }
        }
        let old = triangles.iter().zip(resize_of).zip(is_kept);
        let kept = old.filter(|(_, is_kept)| *is_kept);
        Self {
            triangles: kept
                .map(|((&corners, resize), _)| KeptTriangle {
                    corners,
                    resizes: [resize; 3],
                })
                .collect(),
            resizes,
            blends: FxHashMap::default(),
            surfaces: FxHashMap::default(),
            normals: FxHashMap::default(),
        }
    }
}

/// What tells corners of new triangles apart, floats by their bits: the place, the vertices that are blended with their
/// weights, the corner whose surface it has, and the normal.
type CornerKey = (
    [u64; 3],
    Option<([(u32, usize); 3], [u64; 3])>,
    Option<(u32, usize)>,
    Option<[u64; 3]>,
);

/// Triangles that were made, added to those that are kept. A vertex that shrinks to a point is one that moves there.
/// Corners that are alike and at one place stay one vertex.
struct Made<'a> {
    kept: Kept,
    old: &'a [[u32; 3]],
    /// The resizes that move corners to their places.
    placed: FxHashMap<CornerKey, u32>,
}

impl Made<'_> {
    /// The vertex at a corner of an old triangle.
    fn vertex(&self, (triangle, corner): (u32, usize)) -> u32 {
        self.old[triangle as usize][corner]
    }

    fn push(&mut self, triangle: [MadeCorner; 3], own_normal: Option<DVec3>) {
        let triangle = KeptTriangle {
            corners: triangle.map(|corner| self.vertex(corner.like)),
            resizes: triangle.map(|corner| Some(self.resize(corner, own_normal))),
        };
        self.kept.triangles.push(triangle);
    }

    /// The number of the resize that moves a vertex to this corner.
    fn resize(&mut self, corner: MadeCorner, own_normal: Option<DVec3>) -> u32 {
        let MadeCorner {
            position_local,
            blend,
            surface_of,
            ..
        } = corner;
        let bits = |vector: DVec3| vector.to_array().map(f64::to_bits);
        let blend_bits = blend.map(|t: Blend| (t.corners, t.weights.map(f64::to_bits)));
        let key = (
            bits(position_local),
            blend_bits,
            surface_of,
            own_normal.map(bits),
        );
        if let Some(known) = self.placed.get(&key) {
            return *known;
        }
        let number = self.kept.resizes.len() as u32;
        self.placed.insert(key, number);
        self.kept.resizes.push(Resize {
            centre_local: position_local,
            linear_scale: 0.0,
        });
        if let Some(Blend { corners, weights }) = blend {
            let vertices = corners.map(|corner| self.vertex(corner));
            self.kept.blends.insert(number, (vertices, weights));
        }
        if let Some(corner) = surface_of {
            let vertex = self.vertex(corner);
            self.kept.surfaces.insert(number, vertex);
        }
        if let Some(normal) = own_normal {
            self.kept.normals.insert(number, normal);
        }
        number
    }
}

/// How a resize acts on a vector of a vertex.
#[derive(Clone, Copy)]
enum Mover {
    /// A position: away from the leaf's centre.
    Point,
    /// The displacement of a morph target: in proportion; of a corner of a new leaf, that
    /// of what the corner is like.
    Delta,
}

/// The vertices of a rewritten primitive and how some of them move.
struct Moves<'a> {
    vertices: &'a Vertices,
    resizes: &'a [Resize],
    blends: &'a FxHashMap<u32, ([u32; 3], [f64; 3])>,
    normals: &'a FxHashMap<u32, DVec3>,
    sources: Sources,
    place: String,
}

impl Moves<'_> {
    fn rewrite_attributes(
        &self,
        draft: &mut Draft,
        attributes: &mut Value,
        mover: Mover,
    ) -> Result<(), Fault> {
        let Some(attributes) = attributes.as_object_mut() else {
            return Ok(());
        };
        for (semantic, number) in attributes {
            let Some(old) = as_index(number) else {
                continue;
            };
            let sources = self.sources.of_attribute(semantic);
            let moves = semantic == "POSITION" && !self.vertices.moved.is_empty();
            let is_point = matches!(mover, Mover::Point);
            let is_blended = is_point && !self.blends.is_empty();
            let has_own_normals = is_point && !self.normals.is_empty();
            let new = if moves {
                self.move_vectors(draft, old, sources, mover)?
            } else if is_blended && semantic.starts_with("TEXCOORD_") {
                self.blend::<2>(draft, old, sources, |sum, _| sum)?
            } else if (is_blended || has_own_normals) && semantic == "NORMAL" {
                self.blend::<3>(draft, old, sources, |sum, resize| {
                    let own = self.normals.get(&resize).copied();
                    let unit = own.or_else(|| DVec3::from_array(sum?).try_normalize());
                    unit.map(|unit| unit.to_array())
                })?
            } else {
                draft.gather(old, Role::Vertex, sources)?
            };
            *number = new.into();
        }
        Ok(())
    }

    /// The accessor of an attribute that some new vertices have of several old ones, or of their own: of that sum,
    /// where there is one, and their resize. The others have that of the vertex that they are copies of.
    fn blend<const N: usize>(
        &self,
        draft: &mut Draft,
        old: usize,
        sources: &Rc<[u32]>,
        of_sum: impl Fn(Option<[f64; N]>, u32) -> Option<[f64; N]>,
    ) -> Result<usize, Fault> {
        let elements = draft.document.elements(old)?;
        if elements.accessor.shape != Shape::Vector(N) {
            return draft.gather(old, Role::Vertex, sources);
        }
        let at = || draft.document.place("accessors", old);
        let mut vectors = gather_vectors::<N>(&elements, sources).at(at)?;
        for (vertex, resize) in &self.vertices.moved {
            let sum = match self.blends.get(resize) {
                Some(blend) => Some(blended::<N>(&elements, blend).at(at)?),
                None => None,
            };
            if let Some(vector) = of_sum(sum, *resize) {
                vectors[*vertex as usize] = vector;
            }
        }
        let fields = &draft.document.root["accessors"][old];
        let bounded = fields.get("min").is_some() || fields.get("max").is_some();
        let (new, grid) = elements_like(&elements.accessor, &vectors, bounded);
        if grid == Grid::BecameFloats {
            draft.notes.push(format!(
                "{}: quantised texture coordinates or normals became f32, because those of new leaves leave their grid",
                self.place
            ));
        }
        Ok(draft.push_accessor(Some(old), new))
    }

    /// The accessor of positions, or of their displacements, of which some move.
    fn move_vectors(
        &self,
        draft: &mut Draft,
        old: usize,
        sources: &Rc<[u32]>,
        mover: Mover,
    ) -> Result<usize, Fault> {
        let elements = draft.document.elements(old)?;
        let is_displacement = matches!(mover, Mover::Delta);
        if is_displacement
            && (is_all_zero(&elements) || elements.accessor.shape != Shape::Vector(3))
        {
            return draft.gather(old, Role::Vertex, sources);
        }
        let vectors = gather_vectors::<3>(&elements, sources)
            .at(|| draft.document.place("accessors", old))?;
        let mut vectors: Vec<DVec3> = vectors.into_iter().map(DVec3::from_array).collect();
        for &(vertex, resize) in &self.vertices.moved {
            let vector = &mut vectors[vertex as usize];
            *vector = match self.blends.get(&resize) {
                Some(blend) if is_displacement => {
                    let sum = blended::<3>(&elements, blend)
                        .at(|| draft.document.place("accessors", old))?;
                    DVec3::from_array(sum)
                }
                _ => moved(*vector, &self.resizes[resize as usize], mover),
            };
        }
        let vectors: Vec<[f64; 3]> = vectors.iter().map(DVec3::to_array).collect();
        let (new, grid) = elements_like(&elements.accessor, &vectors, true);
        if grid == Grid::BecameFloats {
            draft.notes.push(format!(
                "{}: its quantised positions became f32, because leaves that grow or are new leave their grid",
                self.place
            ));
        }
        Ok(draft.push_accessor(Some(old), new))
    }
}

/// Vectors that are f32 in the file come back to the same bits.
fn gather_vectors<const N: usize>(
    elements: &Elements,
    sources: &[u32],
) -> Result<Vec<[f64; N]>, Problem> {
    let gathered = Elements {
        accessor: elements.accessor,
        bytes: Cow::Owned(gather_bytes(elements, sources)?),
    };
    Ok(gathered.vectors().collect())
}

fn blended<const N: usize>(
    elements: &Elements,
    (corners, weights): &([u32; 3], [f64; 3]),
) -> Result<[f64; N], Problem> {
    let of_corners = gather_vectors::<N>(elements, corners)?;
    Ok(std::array::from_fn(|k| {
        let pairs = of_corners.iter().zip(weights);
        pairs.map(|(vector, weight)| weight * vector[k]).sum()
    }))
}

fn moved(vector: DVec3, resize: &Resize, mover: Mover) -> DVec3 {
    match mover {
        Mover::Point => resize.centre_local + resize.linear_scale * (vector - resize.centre_local),
        Mover::Delta if resize.linear_scale == 0.0 => vector,
        Mover::Delta => resize.linear_scale * vector,
    }
}

/// Indices in the smallest type that holds them, though never smaller than
/// 16 bits where they were larger: many GPUs dislike 8.
pub(super) fn new_indices(
    draft: &Draft,
    old: usize,
    corners: &[u32],
    vertex_count: usize,
) -> Result<NewElements, Fault> {
    // The largest value of a type means a new strip and names no vertex.
    let old_component = draft.document.accessor(old)?.component;
    let component = match vertex_count {
        0..=0xff if old_component == Component::U8 => Component::U8,
        0..=0xffff => Component::U16,
        _ => Component::U32,
    };
    let bytes = match component {
        Component::U8 => corners.iter().map(|&corner| corner as u8).collect(),
        Component::U16 => corners
            .iter()
            .flat_map(|&corner| (corner as u16).to_le_bytes())
            .collect(),
        _ => corners
            .iter()
            .flat_map(|&corner| corner.to_le_bytes())
            .collect(),
    };
    let fields = &draft.document.root["accessors"][old];
    Ok(NewElements {
        component,
        shape: Shape::Scalar,
        normalized: false,
        count: corners.len(),
        bytes: Some(bytes),
        bounded: fields.get("min").is_some() || fields.get("max").is_some(),
        role: Role::Index,
    })
}

/// An extension of a primitive that is not known may speak of vertices by
/// number.
fn note_extensions(draft: &mut Draft, primitive: &Value, place: &str) {
    let extensions = primitive.get("extensions").and_then(Value::as_object);
    for name in extensions.into_iter().flatten().map(|(name, _)| name) {
        if name != "KHR_materials_variants" {
            draft.notes.push(format!(
                "{place}: {name} was kept as it was; if it names vertices, it names those of the original"
            ));
        }
    }
}
