//! KHR_draco_mesh_compression: primitives whose geometry is compressed.
//!
//! They are decoded when the file is opened, by the crate `draco-core`. Their accessors then have bytes
//! as any others have, in a buffer that is new, and nothing of the extension is left: who reads or writes
//! the document need not know of it. Vertices and triangles have the order that the decoder gives them.
//!
//! What is decoded is at most what the accessors speak of, and that is held against the file's size and
//! the memory before. Where the decoder panics all the same, its data counts as damaged.

mod bits;
mod decoded;

use std::collections::{HashMap, HashSet};
use std::ops::Range;
use std::sync::OnceLock;

use draco_core::{DecodeLimits, DecoderBuffer, Mesh, MeshDecoder};
use serde_json::{Value, json};

use super::Document;
use super::accessor::{Accessor, Component, Shape, is_index};
use super::buffer::Buffer;
use super::error::{ALLOW_MORE, At, Fault, Problem};
use super::property::{self, push, remove};

pub(crate) use bits::DracoBits;
use decoded::{stride, wrong_kind};

const NAME: &str = "KHR_draco_mesh_compression";

/// Decoded bytes allowed however small the file: 16 MiB.
const FREE_BYTES: u64 = 16 << 20;

/// Decoded bytes allowed for each byte of the file's buffers.
const BYTES_PER_BYTE: u64 = 64;

/// What the decoder takes for its own use, for each byte that it decodes.
const WORKING_BYTES_PER_BYTE: u64 = 8;

/// Bytes of a triangle's three indices, as they are decoded.
const TRIANGLE_BYTES: u64 = 12;

/// The mode of a primitive in which every corner makes a triangle with the two before it.
const STRIP: u64 = 5;

const ARRAY_BUFFER: u32 = 34962;
const ELEMENT_ARRAY_BUFFER: u32 = 34963;

/// What of a stream an accessor stands for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
struct Key {
    /// The view with the stream.
    stream: usize,
    /// The attribute, by the stream's own number; `None` for the indices.
    attribute: Option<u32>,
    /// The accessor, if the primitive has one.
    accessor: Option<usize>,
}

/// A compressed primitive, as its JSON describes it.
struct Compressed {
    mesh: usize,
    primitive: usize,
    stream: usize,
    /// Its attributes: names, the stream's numbers of them, and accessors.
    attributes: Vec<(String, u32, Accessor)>,
    indices: Option<Accessor>,
    /// How many vertices and triangles its accessors speak of.
    points: u64,
    triangles: u64,
}

/// Elements of an accessor that were decoded.
struct Part {
    key: Key,
    component: Component,
    count: usize,
    /// Where they are in the new buffer.
    range: Range<usize>,
    /// Bytes from one to the next, where that is not what an element takes.
    stride: Option<usize>,
    /// Least and greatest of each component, of positions alone.
    bounds: Option<[Vec<f64>; 2]>,
}

/// What was decoded of a document.
#[derive(Default)]
struct Decoded {
    bytes: Vec<u8>,
    parts: Vec<Part>,
    known: HashSet<Key>,
    /// How many bytes the accessors spoke of.
    claimed: u64,
}

impl Document {
    /// Decodes all primitives that are compressed, but those that have all bytes without, too.
    pub(crate) fn decode_draco(&mut self) -> Result<(), Fault> {
        let compressed = self.compressed_primitives()?;
        let mut decoded = Decoded::default();
        let mut replaced = Vec::new();
        for one in compressed {
            if one.accessors().all(|accessor| accessor.view.is_some()) {
                continue;
            }
            if one.keys().any(|key| !decoded.known.contains(&key)) {
                self.reserve(&one, &mut decoded)?;
                let stream = self.view_bytes(one.stream)?;
                let added = decoded.add(&one, &stream);
                added.at(|| self.primitive_place(one.mesh, one.primitive))?;
            }
            replaced.push(one);
        }
        if !replaced.is_empty() {
            self.undecoded = Some(self.root.clone().into());
        }
        self.put(decoded, &replaced);
        self.draco_bits = match replaced.is_empty() {
            true => None,
            false => Some(DracoBits::of(self, &replaced)?),
        };
        self.forget_draco();
        Ok(())
    }

    fn compressed_primitives(&self) -> Result<Vec<Compressed>, Fault> {
        let mut found = Vec::new();
        for (mesh, json) in property::list(&self.root, "meshes")?.iter().enumerate() {
            let primitives = property::list(json, "primitives");
            let primitives = primitives.at(|| self.place("meshes", mesh))?;
            for (primitive, json) in primitives.iter().enumerate() {
                let place = || self.primitive_place(mesh, primitive);
                if let Some(extension) = property::extension(json, NAME) {
                    let one = self.compressed(mesh, primitive, json, extension);
                    found.push(one.at(place)?);
                }
            }
        }
        Ok(found)
    }

    fn compressed(
        &self,
        mesh: usize,
        primitive: usize,
        json: &Value,
        extension: &Value,
    ) -> Result<Compressed, Problem> {
        let accessor = |index| {
            let json = property::entry(&self.root, "accessors", index)?;
            self.describe(index, json)
        };
        let ids = extension.get("attributes").and_then(Value::as_object);
        let mut attributes = Vec::new();
        for (name, id) in ids.ok_or(Problem::Missing("attributes"))? {
            let Some(index) = json.get("attributes").and_then(|all| all.get(name)) else {
                continue;
            };
            let accessor = accessor(property::list_index("attributes", index)?)?;
            if matches!(accessor.shape, Shape::Matrix(_)) {
                return Err(wrong_kind(&accessor, name));
            }
            let number = id.as_u64().and_then(|id| u32::try_from(id).ok());
            let id = number.ok_or_else(|| property::bad("attributes", "a list of numbers", id))?;
            attributes.push((name.clone(), id, accessor));
        }
        let indices = property::index(json, "indices")?
            .map(accessor)
            .transpose()?;
        if let Some(indices) = indices.filter(|indices| !is_index(indices)) {
            return Err(wrong_kind(&indices, "indices"));
        }
        let points = attributes.iter().map(|(_, _, accessor)| accessor.count);
        let points = points.max().unwrap_or(0) as u64;
        let corners = indices.map_or(points, |indices| indices.count as u64);
        Ok(Compressed {
            mesh,
            primitive,
            stream: property::required_index(extension, "bufferView")?,
            attributes,
            indices,
            points,
            triangles: match property::whole(json, "mode")? {
                Some(STRIP) => corners.saturating_sub(2),
                _ => corners / 3,
            },
        })
    }

    /// Takes what a stream stands for from the memory, before it is decoded.
    fn reserve(&mut self, one: &Compressed, decoded: &mut Decoded) -> Result<(), Fault> {
        let bytes = one.claimed_bytes();
        decoded.claimed = decoded.claimed.saturating_add(bytes);
        let limit = FREE_BYTES.saturating_add(BYTES_PER_BYTE.saturating_mul(self.data_bytes));
        let what = || format!("its {} compressed triangles", one.triangles);
        let mut take = || {
            if decoded.claimed > limit {
                return Err(Problem::TooMuch {
                    what: "bytes of decoded geometry",
                    limit,
                });
            }
            self.budget.take(bytes, what, ALLOW_MORE)?;
            let working = bytes.saturating_mul(WORKING_BYTES_PER_BYTE);
            Ok(self.budget.clone().take(working, what, ALLOW_MORE)?)
        };
        let taken = take();
        taken.at(|| self.primitive_place(one.mesh, one.primitive))
    }

    /// Gives accessors what was decoded for them, and primitives these accessors.
    fn put(&mut self, decoded: Decoded, replaced: &[Compressed]) {
        if decoded.parts.is_empty() {
            return;
        }
        let buffer = self.buffers.len();
        let mut free_streams = self.streams_alone(replaced);
        let mut numbers: HashMap<Key, usize> = HashMap::new();
        let mut taken: HashSet<usize> = HashSet::new();
        for part in decoded.parts {
            let mut view = json!({
                "buffer": buffer,
                "byteOffset": part.range.start,
                "byteLength": part.range.len(),
                "target": match part.key.attribute {
                    Some(_) => ARRAY_BUFFER,
                    None => ELEMENT_ARRAY_BUFFER,
                },
            });
            if let Some(stride) = part.stride {
                view["byteStride"] = stride.into();
            }
            // The stream is not needed any more.
            let number = match free_streams.remove(&part.key.stream) {
                true => {
                    self.root["bufferViews"][part.key.stream] = view;
                    self.decompressed_views[part.key.stream] = OnceLock::new();
                    part.key.stream
                }
                false => {
                    self.decompressed_views.push(OnceLock::new());
                    push(&mut self.root, "bufferViews", view)
                }
            };
            let own = part.key.accessor.filter(|own| taken.insert(*own));
            let before = part
                .key
                .accessor
                .map(|own| self.root["accessors"][own].clone());
            let mut accessor = before.unwrap_or_else(|| json!({"type": "SCALAR"}));
            for gone in ["byteOffset", "min", "max", "sparse"] {
                remove(&mut accessor, gone);
            }
            accessor["bufferView"] = number.into();
            accessor["componentType"] = part.component.code().into();
            accessor["count"] = part.count.into();
            if let Some([least, greatest]) = part.bounds {
                accessor["min"] = least.into();
                accessor["max"] = greatest.into();
            }
            let number = match own {
                Some(own) => {
                    self.root["accessors"][own] = accessor;
                    own
                }
                None => push(&mut self.root, "accessors", accessor),
            };
            numbers.insert(part.key, number);
        }
        for one in replaced {
            let json = &mut self.root["meshes"][one.mesh]["primitives"][one.primitive];
            for (key, name) in one.keys().zip(one.names()) {
                match name {
                    Some(name) => json["attributes"][name] = numbers[&key].into(),
                    None => json["indices"] = numbers[&key].into(),
                }
            }
            if json["mode"] == STRIP {
                remove(json, "mode");
            }
        }
        push(
            &mut self.root,
            "buffers",
            json!({"byteLength": decoded.bytes.len()}),
        );
        self.buffers.push(Buffer::of(decoded.bytes));
    }

    /// The views of these streams that no accessor and no image names.
    fn streams_alone(&self, replaced: &[Compressed]) -> HashSet<usize> {
        let mut streams: HashSet<usize> = replaced.iter().map(|one| one.stream).collect();
        for list in ["accessors", "images"] {
            for entry in property::list(&self.root, list).unwrap_or_default() {
                for holder in ["", "/sparse/indices", "/sparse/values"] {
                    let view = entry.pointer(&format!("{holder}/bufferView"));
                    if let Some(view) = view.and_then(Value::as_u64) {
                        streams.remove(&(view as usize));
                    }
                }
            }
        }
        streams
    }

    /// Takes the extension out of all that names it.
    fn forget_draco(&mut self) {
        let meshes = self.root.get_mut("meshes").and_then(Value::as_array_mut);
        for mesh in meshes.into_iter().flatten() {
            let primitives = mesh.get_mut("primitives").and_then(Value::as_array_mut);
            for primitive in primitives.into_iter().flatten() {
                let Some(extensions) = primitive.get_mut("extensions") else {
                    continue;
                };
                remove(extensions, NAME);
                if extensions.as_object().is_some_and(|all| all.is_empty()) {
                    remove(primitive, "extensions");
                }
            }
        }
        for list in ["extensionsUsed", "extensionsRequired"] {
            let names = self.root.get_mut(list).and_then(Value::as_array_mut);
            let Some(names) = names.filter(|names| names.iter().any(|name| name == NAME)) else {
                continue;
            };
            names.retain(|name| name != NAME);
            if names.is_empty() {
                remove(&mut self.root, list);
            }
        }
    }
}

impl Compressed {
    fn accessors(&self) -> impl Iterator<Item = &Accessor> {
        let attributes = self.attributes.iter().map(|(_, _, accessor)| accessor);
        attributes.chain(&self.indices)
    }

    /// What of its stream its accessors stand for, the indices last.
    fn keys(&self) -> impl Iterator<Item = Key> {
        let stream = self.stream;
        let key = move |attribute, accessor| Key {
            stream,
            attribute,
            accessor,
        };
        let attributes = self.attributes.iter();
        let attributes = attributes.map(move |(_, id, a)| key(Some(*id), Some(a.index)));
        attributes.chain([key(None, self.indices.map(|indices| indices.index))])
    }

    /// The names of its attributes, in the order of [`keys`](Self::keys); `None` for the indices.
    fn names(&self) -> impl Iterator<Item = Option<&str>> {
        let names = self
            .attributes
            .iter()
            .map(|(name, _, _)| Some(name.as_str()));
        names.chain([None])
    }

    /// Bytes of the vertices and triangles that its accessors speak of.
    fn claimed_bytes(&self) -> u64 {
        let of_point = |(_, _, accessor): &(_, _, Accessor)| stride(accessor) as u64;
        let of_point: u64 = self.attributes.iter().map(of_point).sum();
        let points = self.points.saturating_mul(of_point);
        points.saturating_add(self.triangles.saturating_mul(TRIANGLE_BYTES))
    }

    /// The mesh that a stream stands for, if it is no more than the accessors speak of.
    fn mesh(&self, stream: &[u8]) -> Result<Mesh, Problem> {
        let limits = DecodeLimits::default()
            .with_max_faces(self.triangles)
            // Positions and the like may be decoded as wider numbers than they are stored as.
            .with_max_decoded_bytes(4 * self.claimed_bytes());
        let mut buffer = DecoderBuffer::new(stream).with_limits(limits);
        let mut mesh = Mesh::new();
        let decoded = MeshDecoder::new().decode(&mut buffer, &mut mesh);
        decoded.map_err(|error| Problem::Draco(error.to_string()))?;
        Ok(mesh)
    }
}
