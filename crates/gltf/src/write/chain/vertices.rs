//! A primitive in another space: what its node's transform would do to its
//! vertices is done to them once and for all.

use std::collections::HashMap;

use glam::{DMat3, DMat4, DVec3};
use serde_json::Value;

use super::super::draft::{Draft, NewElements, Role, is_all_zero};
use super::super::references::{as_index, items};
use crate::accessor::{Component, Shape, is_index};
use crate::error::Fault;
use crate::primitive::Topology;
use crate::wind;

/// What a transform means for an attribute.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
enum Kind {
    /// A position: the whole matrix applies to it, its translation too.
    Point,
    /// Displacements of positions turn, and get as long as the space gets.
    Displacement,
    /// Normals stay perpendicular to their surface.
    Normal,
    /// Changes of the normals of this accessor, if there are any.
    NormalChange(Option<usize>),
    /// Tangents stay along their surface; their fourth number says on which side
    /// the bitangent is.
    Tangent,
    /// Changes of the tangents of this accessor, if there are any.
    TangentChange(Option<usize>),
    /// A number of metres, which get as long as the space gets.
    Length,
}

/// Moves primitives into the space of the scene. An accessor that several of
/// them have is moved once for each transform.
#[derive(Default)]
pub(in crate::write) struct Baker {
    moved: HashMap<(usize, Kind, [u64; 16]), usize>,
    /// Places whose quantised positions became f32.
    pub(super) became_f32: Vec<String>,
}

/// A transform of vertices.
struct Transform {
    world_from_local: DMat4,
    linear: DMat3,
    /// Of normals, up to a positive factor.
    of_normals: DMat3,
    is_mirror: bool,
    key: [u64; 16],
}

impl Transform {
    fn new(world_from_local: DMat4) -> Self {
        let linear = DMat3::from_mat4(world_from_local);
        let [x, y, z] = [linear.x_axis, linear.y_axis, linear.z_axis];
        // The inverse of the transpose times the determinant: it is there even
        // where a node is flat.
        let cofactors = DMat3::from_cols(y.cross(z), z.cross(x), x.cross(y));
        let is_mirror = linear.determinant() < 0.0;
        Self {
            world_from_local,
            linear,
            of_normals: if is_mirror { -cofactors } else { cofactors },
            is_mirror,
            key: world_from_local.to_cols_array().map(f64::to_bits),
        }
    }

    fn side(&self) -> f64 {
        if self.is_mirror { -1.0 } else { 1.0 }
    }
}

impl Baker {
    /// The primitive as a node with this transform draws it, for a node that has
    /// none. `place` is what notes call it.
    pub(in crate::write) fn bake(
        &mut self,
        draft: &mut Draft,
        primitive: &mut Value,
        world_from_local: DMat4,
        place: &str,
    ) -> Result<(), Fault> {
        if world_from_local == DMat4::IDENTITY {
            return Ok(());
        }
        let transform = Transform::new(world_from_local);
        let attribute = |name: &str| primitive["attributes"].get(name).and_then(as_index);
        let (position, normal, tangent) = (
            attribute("POSITION"),
            attribute("NORMAL"),
            attribute("TANGENT"),
        );
        if let Some(position) = position {
            let component = draft.elements(position)?.accessor.component;
            if component != Component::F32 {
                self.became_f32.push(place.to_owned());
            }
            if transform.is_mirror {
                turn_triangles(draft, primitive, position)?;
            }
        }
        self.move_all(
            draft,
            &mut primitive["attributes"],
            &transform,
            [Kind::Point, Kind::Normal, Kind::Tangent],
        )?;
        self.move_holds(draft, &mut primitive["attributes"], &transform)?;
        for target in items(primitive, "targets") {
            let kinds = [
                Kind::Displacement,
                Kind::NormalChange(normal),
                Kind::TangentChange(tangent),
            ];
            self.move_all(draft, target, &transform, kinds)?;
        }
        Ok(())
    }

    fn move_all(
        &mut self,
        draft: &mut Draft,
        attributes: &mut Value,
        transform: &Transform,
        kinds: [Kind; 3],
    ) -> Result<(), Fault> {
        for (name, kind) in ["POSITION", "NORMAL", "TANGENT"].into_iter().zip(kinds) {
            if let Some(old) = attributes.get(name).and_then(as_index) {
                attributes[name] = self.moved(draft, old, transform, kind)?.into();
            }
        }
        Ok(())
    }

    /// What vertices hang on, where they say it as `wind.rs` has it, goes with them.
    fn move_holds(
        &mut self,
        draft: &mut Draft,
        attributes: &mut Value,
        transform: &Transform,
    ) -> Result<(), Fault> {
        let index = |name: &str| attributes.get(name).and_then(as_index);
        let found = [wind::PIVOT, wind::ALONG, wind::SEGMENT].map(index);
        let [Some(pivot), Some(along), Some(_)] = found else {
            return Ok(());
        };
        attributes[wind::PIVOT] = self.moved(draft, pivot, transform, Kind::Point)?.into();
        attributes[wind::ALONG] = self.moved(draft, along, transform, Kind::Length)?.into();
        Ok(())
    }

    fn moved(
        &mut self,
        draft: &mut Draft,
        accessor: usize,
        transform: &Transform,
        kind: Kind,
    ) -> Result<usize, Fault> {
        let key = (accessor, kind, transform.key);
        if let Some(&known) = self.moved.get(&key) {
            return Ok(known);
        }
        let elements = draft.elements(accessor)?;
        let is_change = matches!(
            kind,
            Kind::Displacement | Kind::NormalChange(_) | Kind::TangentChange(_)
        );
        let shape = elements.accessor.shape;
        let expected = match kind {
            Kind::Length => Shape::Scalar,
            Kind::Tangent => Shape::Vector(4),
            _ => Shape::Vector(3),
        };
        let is_expected = shape == expected;
        if !is_expected || is_change && is_all_zero(&elements) {
            return Ok(accessor);
        }
        let count = elements.accessor.count;
        let floats = match kind {
            Kind::Tangent => bytes_of(elements.vectors::<4>().map(|[x, y, z, w]| {
                let along = transform.linear * DVec3::new(x, y, z);
                let [x, y, z] = unit_or_as_is(along).to_array();
                [x, y, z, w * transform.side()]
            })),
            Kind::Length => {
                let factor = transform.linear.determinant().abs().cbrt();
                bytes_of(elements.vectors::<1>().map(|[metres]| [metres * factor]))
            }
            _ => {
                let vectors = elements.vectors::<3>().map(DVec3::from_array);
                let shrinks = shrinks(draft, transform, kind, count)?;
                let moved = vectors
                    .zip(0..)
                    .map(|(v, vertex): (DVec3, usize)| match kind {
                        Kind::Point => transform.world_from_local.transform_point3(v),
                        Kind::Displacement => transform.linear * v,
                        Kind::Normal => unit_or_as_is(transform.of_normals * v),
                        Kind::NormalChange(_) => {
                            transform.of_normals * v * factor(&shrinks, vertex)
                        }
                        _ => transform.linear * v * factor(&shrinks, vertex),
                    });
                bytes_of(moved.map(|v| v.to_array()))
            }
        };
        let fields = &draft.root["accessors"][accessor];
        let had_bounds = fields.get("min").is_some() || fields.get("max").is_some();
        let new = NewElements {
            component: Component::F32,
            shape,
            normalized: false,
            count,
            bytes: Some(floats),
            bounded: had_bounds || matches!(kind, Kind::Point | Kind::Displacement),
            role: Role::Vertex,
        };
        let origin = draft.origin_of(accessor);
        let number = draft.push_accessor(origin, new);
        self.moved.insert(key, number);
        Ok(number)
    }
}

/// How much shorter a vertex's normal, or tangent, is made after the transform to
/// be of unit length; its changes must get as much shorter. Empty where it has none.
fn shrinks(
    draft: &Draft,
    transform: &Transform,
    kind: Kind,
    count: usize,
) -> Result<Vec<f64>, Fault> {
    let shrink = |moved: DVec3| match moved.length() {
        length if length > 0.0 && length.is_finite() => 1.0 / length,
        _ => 1.0,
    };
    let shrinks: Vec<f64> = match kind {
        Kind::NormalChange(Some(base)) => {
            let base = draft.elements(base)?;
            if base.accessor.shape != Shape::Vector(3) {
                return Ok(Vec::new());
            }
            let normals = base.vectors::<3>().map(DVec3::from_array);
            normals.map(|n| shrink(transform.of_normals * n)).collect()
        }
        Kind::TangentChange(Some(base)) => {
            let base = draft.elements(base)?;
            if base.accessor.shape != Shape::Vector(4) {
                return Ok(Vec::new());
            }
            let tangents = base.vectors::<4>().map(|[x, y, z, _]| DVec3::new(x, y, z));
            tangents.map(|t| shrink(transform.linear * t)).collect()
        }
        _ => Vec::new(),
    };
    Ok(if shrinks.len() == count {
        shrinks
    } else {
        Vec::new()
    })
}

fn factor(shrinks: &[f64], vertex: usize) -> f64 {
    shrinks.get(vertex).copied().unwrap_or(1.0)
}

fn unit_or_as_is(v: DVec3) -> DVec3 {
    v.try_normalize().unwrap_or(v)
}

fn bytes_of<const N: usize>(vectors: impl Iterator<Item = [f64; N]>) -> Vec<u8> {
    let in_range = |x: f64| (x as f32).clamp(f32::MIN, f32::MAX);
    let floats = vectors.flat_map(|v| v.map(in_range));
    floats.flat_map(f32::to_le_bytes).collect()
}

/// Makes triangles face the other way: a mirror has turned them around.
fn turn_triangles(draft: &mut Draft, primitive: &mut Value, position: usize) -> Result<(), Fault> {
    let (corners, vertices) = corners_of(draft, primitive, position)?;
    let topology = topology_of(primitive);
    if topology == Topology::None {
        return Ok(());
    }
    let turned: Vec<u32> = topology
        .triangles(&corners)
        .into_iter()
        .flat_map(|[a, b, c]| [a, c, b])
        .collect();
    let old = primitive.get("indices").and_then(as_index);
    primitive["indices"] = push_indices(draft, old, &turned, vertices).into();
    if let Some(fields) = primitive.as_object_mut() {
        fields.shift_remove("mode");
    }
    Ok(())
}

/// How the corners of a primitive make triangles.
pub(super) fn topology_of(primitive: &Value) -> Topology {
    match primitive.get("mode").map_or(Some(4), as_index) {
        Some(4) => Topology::List,
        Some(5) => Topology::Strip,
        Some(6) => Topology::Fan,
        _ => Topology::None,
    }
}

/// The vertices that the corners of a primitive name, one after the other, and
/// how many vertices there are.
pub(super) fn corners_of(
    draft: &Draft,
    primitive: &Value,
    position: usize,
) -> Result<(Vec<u32>, usize), Fault> {
    let vertices = draft.elements(position)?.accessor.count;
    let indices = match primitive.get("indices").and_then(as_index) {
        Some(indices) => Some(draft.elements(indices)?),
        None => None,
    };
    let corners = match indices {
        Some(elements) if is_index(&elements.accessor) => elements.indices(),
        _ => (0..vertices as u32).collect(),
    };
    Ok((corners, vertices))
}

/// Indices of a list of triangles, in 16 bits where they hold them.
pub(super) fn push_indices(
    draft: &mut Draft,
    old: Option<usize>,
    corners: &[u32],
    vertices: usize,
) -> usize {
    // The largest value of a type names no vertex.
    let (component, bytes) = if vertices <= 0xffff {
        let shorts = corners.iter().map(|&corner| corner as u16);
        (Component::U16, shorts.flat_map(u16::to_le_bytes).collect())
    } else {
        let words = corners.iter().flat_map(|corner| corner.to_le_bytes());
        (Component::U32, words.collect())
    };
    let new = NewElements {
        component,
        shape: Shape::Scalar,
        normalized: false,
        count: corners.len(),
        bytes: Some(bytes),
        bounded: false,
        role: Role::Index,
    };
    let origin = old.and_then(|old| draft.origin_of(old));
    draft.push_accessor(origin, new)
}
