//! Fewer bits for what vertices have: as many as nobody sees the lack of.
//!
//! Positions stay f32, on a grid of a power of two: their nodes need no other transforms, and
//! meshopt's exponential filter takes them for the whole numbers that they are.

use std::collections::{HashMap, HashSet};

use serde_json::Value;

use super::super::content::{Content, finished};
use super::super::draft::{Draft, NewElements, Role};
use super::super::drop_unreferenced::References;
use super::super::files::ImageFormat;
use super::super::grid::rounded;
use super::super::primitive::new_indices;
use super::super::references::{as_index, items, len};
use super::octahedral::nearest;
use super::{Compression, images, need_extension};
use crate::Document;
use crate::accessor::{Accessor, Component, Shape, is_index};
use crate::error::Fault;

/// Bits of the longest side of what an accessor's positions span: a millimetre of 16 metres.
const BITS: f64 = 14.0;

/// The most steps from zero: the exponential filter has whole numbers of 23 bits beside the sign.
const MOST_STEPS: f64 = (1 << 22) as f64;

/// Texture coordinates beyond 0 to 1 have a grid of as many steps to a texture.
const STEPS_OF_TEXTURE: f64 = 4096.0;

/// What vertices have, as far as it is quantised.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
enum Kind {
    Position,
    /// A unit vector: a normal or a tangent.
    Direction,
    TextureCoordinates,
    Colour,
}

impl Kind {
    fn of(semantic: &str) -> Option<Self> {
        Some(match semantic {
            "POSITION" => Self::Position,
            "NORMAL" | "TANGENT" => Self::Direction,
            _ if semantic.starts_with("TEXCOORD_") => Self::TextureCoordinates,
            _ if semantic.starts_with("COLOR_") => Self::Colour,
            _ => return None,
        })
    }
}

/// A file whose vertices have fewer bits, compressed, and whose images have a format of fewer bytes. What is no f32, is
/// animated or morphs, or has a name of its own stays as it is.
pub(in crate::write) fn quantised(
    document: &Document,
    format: ImageFormat,
) -> Result<Content, Fault> {
    let mut draft = Draft::new(document);
    draft.compression.get_or_insert(Compression::Ext);
    let before = References::of(&mut draft.root);
    let mut of_vertices: Vec<(usize, Kind)> = Vec::new();
    let mut morphing = HashSet::new();
    for mesh in items(&mut draft.root, "meshes") {
        for primitive in items(mesh, "primitives") {
            let attributes = primitive.get("attributes").and_then(Value::as_object);
            for (semantic, number) in attributes.into_iter().flatten() {
                if let (Some(kind), Some(number)) = (Kind::of(semantic), as_index(number)) {
                    of_vertices.push((number, kind));
                }
            }
            for target in items(primitive, "targets") {
                let numbers = target.as_object().into_iter().flat_map(|all| all.values());
                morphing.extend(numbers.filter_map(as_index));
            }
        }
    }
    index_apart(&mut draft)?;
    let mut new: HashMap<(usize, Kind), usize> = HashMap::new();
    for (accessor, kind) in of_vertices {
        if morphing.contains(&accessor) || new.contains_key(&(accessor, kind)) {
            continue;
        }
        if let Some(elements) = fewer_bits(document, accessor, kind)? {
            if elements.component == Component::I8 {
                need_extension(&mut draft.root, "KHR_mesh_quantization");
            }
            let number = draft.push_accessor(Some(accessor), elements);
            new.insert((accessor, kind), number);
        }
    }
    for mesh in items(&mut draft.root, "meshes") {
        for primitive in items(mesh, "primitives") {
            let attributes = primitive
                .get_mut("attributes")
                .and_then(Value::as_object_mut);
            for (semantic, number) in attributes.into_iter().flatten() {
                let key = Kind::of(semantic).zip(as_index(number));
                if let Some(&other) = key.and_then(|(kind, old)| new.get(&(old, kind))) {
                    *number = other.into();
                }
            }
        }
    }
    images::encode(&mut draft, format)?;
    finished(draft, &before, 0)
}

/// Gives indices that share a view, or are bytes, a view of their own: streams are of one kind.
fn index_apart(draft: &mut Draft) -> Result<(), Fault> {
    let document = draft.document;
    let mut new: HashMap<usize, usize> = HashMap::new();
    for mesh in 0..len(&draft.root, "meshes") {
        for primitive in 0..len(&draft.root["meshes"][mesh], "primitives") {
            let fields = &draft.root["meshes"][mesh]["primitives"][primitive];
            let position = fields.pointer("/attributes/POSITION").and_then(as_index);
            let old = fields.get("indices").and_then(as_index);
            let (Some(position), Some(old)) = (position, old) else {
                continue;
            };
            let number = match new.get(&old) {
                Some(&known) => known,
                None => {
                    let elements = document.elements(old)?;
                    if !is_index(&elements.accessor) {
                        continue;
                    }
                    let corners = elements.indices();
                    let vertices = document.accessor(position)?.count.max(1 << 8);
                    let elements = new_indices(draft, old, &corners, vertices)?;
                    *new.entry(old)
                        .or_insert(draft.push_accessor(Some(old), elements))
                }
            };
            draft.root["meshes"][mesh]["primitives"][primitive]["indices"] = number.into();
        }
    }
    Ok(())
}

/// The elements of an accessor of floats in fewer bits; nothing where there is no gain or some
/// is no number.
fn fewer_bits(
    document: &Document,
    accessor: usize,
    kind: Kind,
) -> Result<Option<NewElements>, Fault> {
    let elements = document.elements(accessor)?;
    let old = elements.accessor;
    let is_vector = matches!(old.shape, Shape::Vector(_));
    if old.component != Component::F32 || !is_vector || old.view.is_none() && !old.is_sparse {
        return Ok(None);
    }
    let number = |b: &[u8]| f64::from(f32::from_le_bytes([b[0], b[1], b[2], b[3]]));
    let numbers: Vec<f64> = elements.bytes.chunks_exact(4).map(number).collect();
    let largest = numbers.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
    // Zero tells nothing, and what is beyond these is no plant's.
    if numbers.iter().any(|x| !x.is_finite()) || !(1e-6..1e6).contains(&largest) {
        return Ok(None);
    }
    let is_share = numbers.iter().all(|x| (0.0..=1.0).contains(x));
    let bounded = kind == Kind::Position;
    let (component, numbers) = match kind {
        Kind::Position => {
            let steps = steps_per_unit(&numbers, old.shape.components(), largest);
            (Component::F32, on_grid(&numbers, steps))
        }
        Kind::Direction => match directions(&numbers, old.shape.components()) {
            Some(bytes) => (Component::I8, bytes),
            None => return Ok(None),
        },
        Kind::TextureCoordinates | Kind::Colour if is_share => {
            (Component::U16, times(&numbers, 65535.0))
        }
        Kind::TextureCoordinates => (Component::F32, on_grid(&numbers, STEPS_OF_TEXTURE)),
        Kind::Colour => return Ok(None),
    };
    let mut bytes = Vec::with_capacity(numbers.len() * component.bytes());
    numbers
        .iter()
        .for_each(|&number| component.push(number, &mut bytes));
    Ok(Some(vertices(&old, component, bytes, bounded)))
}

/// Steps of a grid that is as fine as what positions span, not as where they lie, asks for.
fn steps_per_unit(numbers: &[f64], components: usize, largest: f64) -> f64 {
    let side = |axis: usize| {
        let along = numbers.iter().skip(axis).step_by(components);
        let (low, high) = along.fold((f64::MAX, f64::MIN), |(low, high), x| {
            (low.min(*x), high.max(*x))
        });
        high - low
    };
    let longest = (0..components).map(side).fold(0.0, f64::max);
    let whole_power = |x: f64| libm::exp2(libm::ceil(libm::log2(x)));
    let finest = MOST_STEPS / whole_power(largest);
    match longest > 0.0 {
        true => finest.min(libm::exp2(BITS) / whole_power(longest)),
        false => finest,
    }
}

fn on_grid(numbers: &[f64], steps_per_unit: f64) -> Vec<f64> {
    let all = numbers.iter().map(|x| rounded(*x, steps_per_unit));
    all.collect()
}

/// Unit vectors of three components, or tangents of four, times 127; nothing where one has another length.
fn directions(numbers: &[f64], components: usize) -> Option<Vec<f64>> {
    let mut whole = Vec::with_capacity(numbers.len());
    for vector in numbers.chunks_exact(components) {
        let [x, y, z, ref rest @ ..] = *vector else {
            return None;
        };
        let length = x * x + y * y + z * z;
        if length > 0.0 && (length - 1.0).abs() > 0.01 {
            return None;
        }
        let near = nearest([x, y, z]).unwrap_or_default();
        whole.extend(near.map(f64::from));
        whole.extend(times(rest, 127.0));
    }
    Some(whole)
}

/// Whole numbers, of which the largest stands for 1.
fn times(numbers: &[f64], largest: f64) -> Vec<f64> {
    let whole = |x: &f64| (x * largest).round().clamp(-largest, largest);
    numbers.iter().map(whole).collect()
}

fn vertices(old: &Accessor, component: Component, bytes: Vec<u8>, bounded: bool) -> NewElements {
    NewElements {
        component,
        shape: old.shape,
        normalized: component != Component::F32,
        count: old.count,
        bytes: Some(bytes),
        bounded,
        role: Role::Vertex,
    }
}
