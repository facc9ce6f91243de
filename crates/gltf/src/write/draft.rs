//! The file that is being written: its JSON and the bytes that are new in it.

use std::borrow::Cow;
use std::collections::HashMap;
use std::rc::Rc;

use rustc_hash::FxHashMap;
use serde_json::{Value, json};

use super::bounds::bounds;
use super::compress::Compression;
use super::references::len;
use crate::Document;
use crate::accessor::{Component, Elements, Shape};
use crate::error::{At, Fault, Problem};

/// What the elements of an accessor are for, which decides how they lie in
/// their view.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) enum Role {
    /// Vertex attributes start on multiples of four bytes.
    Vertex,
    Index,
    Instance,
    /// The bytes of an image, which no accessor names.
    Image,
}

/// Elements of an accessor that is not in the input.
pub(super) struct NewElements {
    pub(super) component: Component,
    pub(super) shape: Shape,
    pub(super) normalized: bool,
    pub(super) count: usize,
    /// Packed tightly; `None` for zeros, which need no bytes.
    pub(super) bytes: Option<Vec<u8>>,
    /// Whether `min` and `max` are needed.
    pub(super) bounded: bool,
    pub(super) role: Role,
}

/// A copy of a document's JSON that is being changed. New accessors and buffer
/// views get numbers after the document's own.
pub(super) struct Draft<'d> {
    pub(super) document: &'d Document,
    pub(super) root: Value,
    /// Bytes of new buffer views.
    pub(super) new_bytes: HashMap<usize, Vec<u8>>,
    /// For each new accessor the old one that it stands for.
    pub(super) accessor_origins: Vec<Option<usize>>,
    /// For each new buffer view the old one that it stands for.
    pub(super) view_origins: Vec<Option<usize>>,
    /// What the user should know about how the file changed.
    pub(super) notes: Vec<String>,
    /// How what is new is compressed: as the document is.
    pub(super) compression: Option<Compression>,
    gathered: FxHashMap<(usize, Role, Rc<[u32]>), usize>,
}

impl<'d> Draft<'d> {
    pub(super) fn new(document: &'d Document) -> Self {
        Self {
            document,
            root: document.root.clone(),
            new_bytes: HashMap::new(),
            accessor_origins: Vec::new(),
            view_origins: Vec::new(),
            notes: Vec::new(),
            compression: Compression::of(&document.root),
            gathered: FxHashMap::default(),
        }
    }

    /// Adds an item to a top-level list and returns its number.
    pub(super) fn push(&mut self, list: &str, item: Value) -> usize {
        let number = len(&self.root, list);
        match self.root.get_mut(list).and_then(Value::as_array_mut) {
            Some(items) => items.push(item),
            None => self.root[list] = json!([item]),
        }
        number
    }

    /// An accessor with the elements of an old one that `sources` names, in
    /// that order; the same one when asked again.
    pub(super) fn gather(
        &mut self,
        accessor: usize,
        role: Role,
        sources: &Rc<[u32]>,
    ) -> Result<usize, Fault> {
        let key = (accessor, role, Rc::clone(sources));
        if let Some(&known) = self.gathered.get(&key) {
            return Ok(known);
        }
        let elements = self.document.elements(accessor)?;
        let bytes = if is_all_zero(&elements) {
            None
        } else {
            Some(
                gather_bytes(&elements, sources)
                    .at(|| self.document.place("accessors", accessor))?,
            )
        };
        let old = &self.document.root["accessors"][accessor];
        let new = NewElements {
            component: elements.accessor.component,
            shape: elements.accessor.shape,
            normalized: elements.accessor.normalized,
            count: sources.len(),
            bytes,
            bounded: old.get("min").is_some() || old.get("max").is_some(),
            role,
        };
        let number = self.push_accessor(Some(accessor), new);
        self.gathered.insert(key, number);
        Ok(number)
    }

    /// Adds an accessor. What the old one it stands for has beside its data,
    /// such as a name, it gets too.
    pub(super) fn push_accessor(&mut self, origin: Option<usize>, new: NewElements) -> usize {
        let mut accessor = match origin {
            Some(origin) => self.document.root["accessors"][origin].clone(),
            None => json!({"type": shape_name(new.shape)}),
        };
        let fields = accessor.as_object_mut().expect("an accessor that was read");
        for stale in [
            "bufferView",
            "byteOffset",
            "sparse",
            "min",
            "max",
            "normalized",
        ] {
            fields.shift_remove(stale);
        }
        fields.insert("componentType".into(), new.component.code().into());
        fields.insert("count".into(), new.count.into());
        if new.normalized {
            fields.insert("normalized".into(), true.into());
        }
        if new.bounded && new.count > 0 {
            let (min, max) = match &new.bytes {
                Some(bytes) => bounds(new.component, new.shape.components(), bytes),
                None => bounds(new.component, new.shape.components(), &[0; 64]),
            };
            fields.insert("min".into(), min);
            fields.insert("max".into(), max);
        }
        if let Some(bytes) = new.bytes {
            let element_bytes = new.shape.bytes(new.component);
            let origin_view = origin.and_then(|origin| self.view_of(origin));
            let view = self.push_view(origin_view, bytes, element_bytes, new.role);
            accessor["bufferView"] = view.into();
        }
        self.accessor_origins.push(origin);
        self.push("accessors", accessor)
    }

    /// The elements of an accessor, one of the document or a new one.
    pub(super) fn elements(&self, accessor: usize) -> Result<Elements<'_>, Fault> {
        if accessor < len(&self.document.root, "accessors") {
            return self.document.elements(accessor);
        }
        let described = self
            .document
            .describe(accessor, &self.root["accessors"][accessor]);
        let described = described.at(|| format!("accessors[{accessor}]"))?;
        let size = described.element_bytes();
        let bytes = match described.view {
            None => Cow::Owned(vec![0; described.count * size]),
            Some(view) => {
                let stride = self.root["bufferViews"][view].get("byteStride");
                let stride = stride.and_then(super::references::as_index);
                let bytes = &self.new_bytes[&view];
                match stride.filter(|&stride| stride != size) {
                    None => Cow::Borrowed(bytes.as_slice()),
                    Some(stride) => {
                        let mut tight = Vec::with_capacity(bytes.len() / stride * size);
                        for padded in bytes.chunks_exact(stride) {
                            tight.extend_from_slice(&padded[..size]);
                        }
                        Cow::Owned(tight)
                    }
                }
            }
        };
        Ok(Elements {
            accessor: described,
            bytes,
        })
    }

    /// Adds a view with bytes that no accessor names: an image, or a stream.
    pub(super) fn push_bytes(&mut self, bytes: Vec<u8>) -> usize {
        let length = bytes.len();
        self.push_view(None, bytes, length, Role::Image)
    }

    /// Leaves a node in its place, drawing nothing.
    pub(super) fn take_mesh_away(&mut self, node: usize) {
        if let Some(fields) = self.root["nodes"][node].as_object_mut() {
            for needless in ["mesh", "skin", "weights"] {
                fields.shift_remove(needless);
            }
        }
    }

    /// The accessor of the document that an accessor is, or stands for.
    pub(super) fn origin_of(&self, accessor: usize) -> Option<usize> {
        match accessor.checked_sub(len(&self.document.root, "accessors")) {
            None => Some(accessor),
            Some(new) => self.accessor_origins[new],
        }
    }

    fn view_of(&self, accessor: usize) -> Option<usize> {
        let fields = &self.document.root["accessors"][accessor];
        super::references::as_index(fields.get("bufferView")?)
    }

    fn push_view(
        &mut self,
        origin: Option<usize>,
        tight: Vec<u8>,
        element_bytes: usize,
        role: Role,
    ) -> usize {
        const ARRAY_BUFFER: u32 = 34962;
        const ELEMENT_ARRAY_BUFFER: u32 = 34963;
        let stride = element_bytes.next_multiple_of(4);
        let mut view = json!({"buffer": 0, "byteOffset": 0, "byteLength": 0});
        let bytes = if role == Role::Vertex && stride != element_bytes {
            view["byteStride"] = stride.into();
            padded(&tight, element_bytes, stride)
        } else {
            tight
        };
        view["byteLength"] = bytes.len().into();
        match role {
            Role::Vertex => view["target"] = ARRAY_BUFFER.into(),
            Role::Index => view["target"] = ELEMENT_ARRAY_BUFFER.into(),
            Role::Instance | Role::Image => {}
        }
        self.view_origins.push(origin);
        let number = self.push("bufferViews", view);
        self.new_bytes.insert(number, bytes);
        number
    }
}

/// Whether an accessor has no data in the file, which stands for zeros.
pub(super) fn is_all_zero(elements: &Elements) -> bool {
    elements.accessor.view.is_none() && !elements.accessor.is_sparse
}

/// The elements that `sources` names, in that order.
pub(super) fn gather_bytes(elements: &Elements, sources: &[u32]) -> Result<Vec<u8>, Problem> {
    let size = elements.accessor.element_bytes();
    let mut gathered = Vec::with_capacity(sources.len() * size);
    for &source in sources {
        let start = source as usize * size;
        let element = elements.bytes.get(start..start + size);
        let missing = || Problem::CountMismatch {
            attribute: "an attribute".to_owned(),
            found: elements.accessor.count,
            other: "its primitive".to_owned(),
            expected: source as usize + 1,
        };
        gathered.extend_from_slice(element.ok_or_else(missing)?);
    }
    Ok(gathered)
}

fn padded(tight: &[u8], element_bytes: usize, stride: usize) -> Vec<u8> {
    let mut bytes = Vec::with_capacity(tight.len() / element_bytes * stride);
    for element in tight.chunks_exact(element_bytes) {
        bytes.extend_from_slice(element);
        bytes.resize(bytes.len() + stride - element_bytes, 0);
    }
    bytes
}

fn shape_name(shape: Shape) -> String {
    match shape {
        Shape::Scalar => "SCALAR".to_owned(),
        Shape::Vector(n) => format!("VEC{n}"),
        Shape::Matrix(n) => format!("MAT{n}"),
    }
}
