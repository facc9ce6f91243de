//! Meshopt compression of a finished file: the last step of writing one.
//!
//! Only buffer views that accessors alone use are compressed. Streams of the input come
//! through as they are.

mod images;
mod layout;
mod octahedral;
mod quantise;
mod streams;

use std::borrow::Cow;
use std::collections::{BTreeMap, HashMap, HashSet};

use serde_json::{Value, json};

use super::draft::Draft;
use super::drop_unreferenced::{drop_extension, remove_field};
use super::references::{as_index, items, len};
use crate::error::Fault;
use layout::Layout;
pub(super) use quantise::quantised;
use streams::{Bytes, Numbers, Stream};

/// An extension that compresses buffer views.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Compression {
    /// `EXT_meshopt_compression`, with the first version of the attribute codec.
    Ext,
    /// `KHR_meshopt_compression`, with the second version of the attribute codec.
    Khr,
}

impl Compression {
    const ALL: [Self; 2] = [Self::Ext, Self::Khr];

    fn name(self) -> &'static str {
        match self {
            Self::Ext => "EXT_meshopt_compression",
            Self::Khr => "KHR_meshopt_compression",
        }
    }

    fn attribute_version(self) -> u8 {
        match self {
            Self::Ext => 0,
            Self::Khr => 1,
        }
    }

    /// The extension of the first view that has one.
    pub(super) fn of(root: &Value) -> Option<Self> {
        let views = root.get("bufferViews").and_then(Value::as_array);
        views.into_iter().flatten().find_map(|view| {
            let has = |kind: &Self| view["extensions"].get(kind.name()).is_some();
            Self::ALL.into_iter().find(has)
        })
    }
}

/// Views whose streams come from the input.
#[derive(Default)]
pub(super) struct Kept {
    /// By view: its length without compression, the name of its extension, and what that says.
    views: BTreeMap<usize, (u64, &'static str, Value)>,
}

/// Takes the compression off the views of a draft. What `own` then has for a view is its
/// stream where the view is as it was, and its bytes where some of them go.
pub(super) fn take_off<'d>(
    draft: &mut Draft<'d>,
    partly_used: &HashSet<usize>,
    own: &mut HashMap<usize, Cow<'d, [u8]>>,
) -> Result<Kept, Fault> {
    let document = draft.document;
    let mut kept = Kept::default();
    for (number, view) in items(&mut draft.root, "bufferViews").enumerate() {
        let Some(extensions) = view.get_mut("extensions").and_then(Value::as_object_mut) else {
            continue;
        };
        let found = Compression::ALL.map(|kind| {
            let fields = extensions.shift_remove(kind.name());
            fields.map(|fields| (kind.name(), fields))
        });
        let Some((name, fields)) = found.into_iter().flatten().next() else {
            continue;
        };
        if extensions.is_empty() {
            remove_field(view, "extensions");
        }
        // From here on the view is known to be readable.
        let bytes = document.view_bytes(number)?;
        if partly_used.contains(&number) {
            own.insert(number, bytes);
            continue;
        }
        own.insert(number, document.stream_bytes(number, &fields)?);
        kept.views
            .insert(number, (bytes.len() as u64, name, fields));
    }
    for kind in Compression::ALL {
        drop_extension(&mut draft.root, kind.name(), |_| false);
    }
    Ok(kept)
}

/// Compresses what is not compressed of a file whose only buffer is `packed`, where that
/// makes it smaller. Returns the buffer from then on.
pub(super) fn compress(
    root: &mut Value,
    packed: Vec<u8>,
    compression: Compression,
    kept: &Kept,
) -> Vec<u8> {
    let encodable = encodable(root);
    let mut layout = Layout::new(root, &packed);
    let mut names: Vec<&'static str> = Vec::new();
    let mut uncompressed = 0;
    for view in 0..len(root, "bufferViews") {
        let (name, stream, length) = if let Some((length, name, fields)) = kept.views.get(&view) {
            let bytes = layout.bytes(view).to_vec();
            let fields = fields.clone();
            (*name, Stream { bytes, fields }, *length)
        } else {
            let kind = encodable.get(&view).filter(|_| layout.is_alone(view));
            let bytes = layout.bytes(view);
            let version = compression.attribute_version();
            let stream = kind.and_then(|&kind| streams::encode(bytes, kind, version));
            let Some(stream) = stream else {
                continue;
            };
            (compression.name(), stream, bytes.len() as u64)
        };
        let Stream { bytes, mut fields } = stream;
        fields["buffer"] = 0.into();
        fields["byteOffset"] = layout.push_stream(view, &bytes).into();
        let json = &mut root["bufferViews"][view];
        json["buffer"] = 1.into();
        json["byteOffset"] = uncompressed.into();
        json["byteLength"] = length.into();
        if json.get("extensions").is_none() {
            json["extensions"] = json!({});
        }
        json["extensions"][name] = fields;
        uncompressed = (uncompressed + length).next_multiple_of(4);
        if !names.contains(&name) {
            names.push(name);
        }
    }
    if names.is_empty() {
        return packed;
    }
    let packed = layout.finish(root);
    root["buffers"][0]["byteLength"] = packed.len().into();
    let fallback =
        json!({"byteLength": uncompressed, "extensions": {names[0]: {"fallback": true}}});
    items_of(root, "buffers").push(fallback);
    for name in names {
        for list in ["extensionsUsed", "extensionsRequired"] {
            items_of(root, list).push(name.into());
        }
    }
    packed
}

/// A list of an object, which is made where it is not there.
fn items_of<'v>(object: &'v mut Value, list: &str) -> &'v mut Vec<Value> {
    if !object[list].is_array() {
        object[list] = json!([]);
    }
    object[list].as_array_mut().expect("it is one now")
}

/// Names an extension that a reader must know.
pub(super) fn need_extension(root: &mut Value, name: &str) {
    for list in ["extensionsUsed", "extensionsRequired"] {
        let names = items_of(root, list);
        if !names.iter().any(|known| known == name) {
            names.push(name.into());
        }
    }
}

/// The views that accessors alone use, and what their bytes are.
fn encodable(root: &mut Value) -> HashMap<usize, Bytes> {
    let users = IndexUsers::of(root);
    let mut found: HashMap<usize, Option<Bytes>> = HashMap::new();
    let accessors = root.get("accessors").and_then(Value::as_array);
    for (number, accessor) in accessors.into_iter().flatten().enumerate() {
        for part in ["indices", "values"] {
            let view = accessor.pointer(&format!("/sparse/{part}/bufferView"));
            if let Some(view) = view.and_then(as_index) {
                found.insert(view, None);
            }
        }
        let Some(view) = accessor.get("bufferView").and_then(as_index) else {
            continue;
        };
        let kind = kind_of(accessor, &root["bufferViews"][view], users.0.get(&number));
        match found.get_mut(&view) {
            None => drop(found.insert(view, kind)),
            Some(known) => *known = together(*known, kind),
        }
    }
    let images = root.get("images").and_then(Value::as_array);
    for view in images
        .into_iter()
        .flatten()
        .filter_map(|image| image.get("bufferView"))
    {
        as_index(view).and_then(|view| found.remove(&view));
    }
    let all = found.into_iter();
    all.filter_map(|(view, kind)| Some((view, kind?))).collect()
}

/// The accessors that are indices of primitives; whether all of these are lists of triangles.
struct IndexUsers(HashMap<usize, bool>);

impl IndexUsers {
    fn of(root: &mut Value) -> Self {
        const TRIANGLES: usize = 4;
        let mut users: HashMap<usize, bool> = HashMap::new();
        for mesh in items(root, "meshes") {
            for primitive in items(mesh, "primitives") {
                let mode = primitive.get("mode").and_then(as_index);
                let is_list = mode.is_none_or(|mode| mode == TRIANGLES);
                if let Some(indices) = primitive.get("indices").and_then(as_index) {
                    *users.entry(indices).or_insert(true) &= is_list;
                }
            }
        }
        Self(users)
    }
}

fn kind_of(accessor: &Value, view: &Value, is_triangles: Option<&bool>) -> Option<Bytes> {
    let component = match accessor["componentType"].as_u64()? {
        5120 | 5121 => 1,
        5122 | 5123 => 2,
        _ => 4,
    };
    let components = match accessor["type"].as_str()? {
        "SCALAR" => 1,
        "VEC2" => 2,
        "VEC3" => 3,
        "VEC4" => 4,
        "MAT4" => 16,
        _ => return None,
    };
    let stride = view.get("byteStride").and_then(as_index);
    let stride = stride.unwrap_or(component * components);
    let length = view.get("byteLength").and_then(as_index)?;
    let offset = accessor.get("byteOffset").and_then(as_index).unwrap_or(0);
    if length == 0 || length % stride != 0 {
        return None;
    }
    match is_triangles {
        Some(&is_list) if matches!(stride, 2 | 4) => {
            let count = accessor.get("count").and_then(as_index)?;
            let is_whole = |indices: usize| indices.is_multiple_of(3);
            let is_triangles = is_list
                && is_whole(offset / stride)
                && is_whole(count)
                && is_whole(length / stride);
            Some(Bytes::Indices {
                stride,
                is_triangles,
            })
        }
        Some(_) => None,
        None if stride.is_multiple_of(4) && stride <= 256 => {
            let is_normalized = accessor["normalized"] == true;
            let numbers = match accessor["componentType"].as_u64()? {
                5126 => Numbers::Floats,
                5120 if stride == 4 && components >= 3 && is_normalized => Numbers::Directions,
                _ => Numbers::Others,
            };
            Some(Bytes::Elements { stride, numbers })
        }
        None => None,
    }
}

/// What the bytes of a view are that two accessors have.
fn together(a: Option<Bytes>, b: Option<Bytes>) -> Option<Bytes> {
    use Bytes::{Elements, Indices};
    match (a?, b?) {
        (same, other) if same == other => Some(same),
        (Elements { stride, .. }, Elements { stride: other, .. }) if stride == other => {
            let numbers = Numbers::Others;
            Some(Elements { stride, numbers })
        }
        (Indices { stride, .. }, Indices { stride: other, .. }) if stride == other => {
            let is_triangles = false;
            Some(Indices {
                stride,
                is_triangles,
            })
        }
        (Elements { .. } | Indices { .. }, Elements { .. } | Indices { .. }) => None,
    }
}
