//! KHR_draco_mesh_compression, written where the input has it, so that what is made of a small file is no larger one.
//!
//! Vertices and triangles get another order, by which neighbours follow each other: what names leaves by number is not
//! compressed.

use std::panic::{AssertUnwindSafe, catch_unwind};

use draco_core::{
    DataType, DecoderBuffer, EncoderBuffer, EncoderOptions, FaceIndex, GeometryAttributeType, Mesh,
    MeshDecoder, MeshEncoder, PointAttribute, PointIndex,
};
use serde_json::{Map, Value, json};

use super::compress::need_extension;
use super::content::{Content, finished};
use super::draft::Draft;
use super::drop_unreferenced::{References, remove_field};
use super::references::{as_index, count_references, len, visit_accessor_numbers};
use crate::Document;
use crate::accessor::{Component, Elements, Shape};
use crate::draco::DracoBits;
use crate::error::Fault;
use crate::order_extras::ORDER_EXTRAS_NAME;

const NAME: &str = "KHR_draco_mesh_compression";

/// EdgeBreaker, as the encoder's method: half of the bytes of triangles in the order that they have.
const EDGEBREAKER: i32 = 1;

/// How hard the encoder tries, of 10.
const LEVEL: i32 = 7;

/// A primitive as the encoder writes it.
struct Stream {
    bytes: Vec<u8>,
    /// The encoder's number of each attribute.
    attributes: Map<String, Value>,
    /// How many vertices it has: those are two that two fans of triangles share.
    count: usize,
    /// Least and greatest of its positions.
    bounds: [Vec<f64>; 2],
}

/// The file of a document with its primitives compressed, where that makes them smaller: lists of triangles with indices,
/// whose accessors nothing else uses.
pub(super) fn compressed(document: &Document, bits: DracoBits) -> Result<Content, Fault> {
    let mut draft = Draft::new(document);
    let names_leaves = document
        .root
        .pointer("/extras")
        .and_then(|extras| extras.get(ORDER_EXTRAS_NAME));
    let before = References::of(&mut draft.root);
    if names_leaves.is_some() {
        return finished(draft, &before, 0);
    }
    let count = len(&draft.root, "accessors");
    let users = count_references(&mut draft.root, count, visit_accessor_numbers);
    for mesh in 0..len(&draft.root, "meshes") {
        for number in 0..len(&draft.root["meshes"][mesh], "primitives") {
            let primitive = &draft.root["meshes"][mesh]["primitives"][number];
            let Some((attributes, indices)) = accessors_of(primitive, &users) else {
                continue;
            };
            let Some(stream) = stream(document, &attributes, indices, bits)? else {
                continue;
            };
            for (name, accessor) in &attributes {
                let fields = &mut draft.root["accessors"][*accessor];
                take_bytes_away(fields);
                fields["count"] = stream.count.into();
                if name == "POSITION" {
                    let [least, greatest] = stream.bounds.clone();
                    fields["min"] = least.into();
                    fields["max"] = greatest.into();
                }
            }
            let fields = &mut draft.root["accessors"][indices];
            take_bytes_away(fields);
            fields["componentType"] = index_type(stream.count).code().into();
            let view = draft.push_bytes(stream.bytes);
            let primitive = &mut draft.root["meshes"][mesh]["primitives"][number];
            if primitive.get("extensions").is_none() {
                primitive["extensions"] = json!({});
            }
            primitive["extensions"][NAME] =
                json!({"bufferView": view, "attributes": stream.attributes});
            need_extension(&mut draft.root, NAME);
        }
    }
    finished(draft, &before, 0)
}

/// The type of indices that can name each of this many vertices. The greatest number of a type names none in glTF.
fn index_type(vertex_count: usize) -> Component {
    match vertex_count <= usize::from(u16::MAX) {
        true => Component::U16,
        false => Component::U32,
    }
}

fn take_bytes_away(accessor: &mut Value) {
    for gone in ["bufferView", "byteOffset"] {
        remove_field(accessor, gone);
    }
}

/// The attributes of a primitive, with their accessors, and that of its indices; none where it cannot be compressed.
fn accessors_of(primitive: &Value, users: &[u32]) -> Option<(Vec<(String, usize)>, usize)> {
    let is_list = primitive.get("mode").is_none_or(|mode| mode == 4);
    let indices = primitive.get("indices").and_then(as_index)?;
    let attributes = primitive.get("attributes")?.as_object()?.iter();
    let attributes = attributes.map(|(name, number)| Some((name.clone(), as_index(number)?)));
    let attributes = attributes.collect::<Option<Vec<_>>>()?;
    let mut all = attributes
        .iter()
        .map(|(_, number)| *number)
        .chain([indices]);
    let is_alone = all.all(|number| users.get(number) == Some(&1));
    (is_list && is_alone && primitive.get("targets").is_none()).then_some((attributes, indices))
}

/// A primitive of these accessors as a stream; none where that is no smaller, or cannot be.
fn stream(
    document: &Document,
    attributes: &[(String, usize)],
    indices: usize,
    bits: DracoBits,
) -> Result<Option<Stream>, Fault> {
    let mut all = Vec::new();
    for (name, accessor) in attributes {
        all.push((name.as_str(), document.elements(*accessor)?));
    }
    let corners = document.elements(indices)?;
    let has_bytes =
        |elements: &Elements| elements.accessor.view.is_some() && !elements.accessor.is_sparse;
    let mut elements = all.iter().map(|(_, elements)| elements).chain([&corners]);
    let plain: usize = all.iter().map(|(_, elements)| elements.bytes.len()).sum();
    let plain = plain + corners.bytes.len();
    if !elements.all(has_bytes) {
        return Ok(None);
    }
    // The encoder is no code of ours: what it cannot do stays as it is.
    let made = catch_unwind(AssertUnwindSafe(|| encoded(&all, &corners.indices(), bits)));
    Ok(made
        .ok()
        .flatten()
        .filter(|stream| stream.bytes.len() < plain))
}

fn encoded(
    attributes: &[(&str, Elements<'_>)],
    corners: &[u32],
    bits: DracoBits,
) -> Option<Stream> {
    let (_, positions) = attributes.iter().find(|(name, _)| *name == "POSITION")?;
    let count = positions.accessor.count;
    let mut options = EncoderOptions::new();
    options.set_compression_level(LEVEL);
    options.set_encoding_method(EDGEBREAKER);
    let mut mesh = Mesh::new();
    let mut numbers = Map::new();
    for (name, elements) in attributes {
        let (kind, bits) = treatment(name, bits);
        let mut attribute = PointAttribute::new();
        attribute.init(
            kind,
            components(elements.accessor.shape)?,
            data_type(elements.accessor.component),
            elements.accessor.normalized,
            count,
        );
        if elements.accessor.count != count {
            return None;
        }
        attribute.buffer_mut().write(0, &elements.bytes);
        let number = mesh.add_attribute(attribute);
        if elements.accessor.component == Component::F32 {
            options.set_attribute_quantization(number, bits?);
        }
        numbers.insert((*name).to_owned(), number.into());
    }
    mesh.set_num_points(count);
    mesh.set_num_faces(corners.len() / 3);
    for (face, corners) in corners.as_chunks::<3>().0.iter().enumerate() {
        mesh.set_face(FaceIndex(face as u32), corners.map(PointIndex));
    }
    // Triangles that meet where normals or texture coordinates differ are neighbours too.
    mesh.deduplicate_attribute_values().ok()?;
    let mut encoder = MeshEncoder::new();
    encoder.set_mesh(mesh);
    let mut out = EncoderBuffer::new();
    encoder.encode(&options, &mut out).ok()?;
    let bytes = out.data().to_vec();
    let (count, bounds) = decoded(&bytes, &numbers, corners.len() / 3)?;
    Some(Stream {
        bytes,
        attributes: numbers,
        count,
        bounds,
    })
}

/// How the encoder takes an attribute, and to how many bits it rounds its floats; none where that may not be.
fn treatment(name: &str, bits: DracoBits) -> (GeometryAttributeType, Option<i32>) {
    match name {
        "POSITION" => (GeometryAttributeType::Position, Some(bits.positions)),
        "NORMAL" => (GeometryAttributeType::Normal, Some(10)),
        "TANGENT" => (GeometryAttributeType::Generic, Some(10)),
        "_MORPH" => (GeometryAttributeType::Generic, Some(14)),
        _ if name.starts_with("TEXCOORD_") => (
            GeometryAttributeType::TexCoord,
            Some(bits.texture_coordinates),
        ),
        _ if name.starts_with("COLOR_") => (GeometryAttributeType::Color, Some(10)),
        _ => (GeometryAttributeType::Generic, None),
    }
}

fn components(shape: Shape) -> Option<u8> {
    match shape {
        Shape::Scalar => Some(1),
        Shape::Vector(count) => u8::try_from(count).ok(),
        Shape::Matrix(_) => None,
    }
}

fn data_type(component: Component) -> DataType {
    match component {
        Component::I8 => DataType::Int8,
        Component::U8 => DataType::Uint8,
        Component::I16 => DataType::Int16,
        Component::U16 => DataType::Uint16,
        Component::U32 => DataType::Uint32,
        Component::F32 => DataType::Float32,
    }
}

/// How many vertices a stream stands for, and the least and greatest of their positions; none unless it has all
/// triangles.
fn decoded(
    stream: &[u8],
    numbers: &Map<String, Value>,
    triangles: usize,
) -> Option<(usize, [Vec<f64>; 2])> {
    let mut mesh = Mesh::new();
    MeshDecoder::new()
        .decode(&mut DecoderBuffer::new(stream), &mut mesh)
        .ok()?;
    // Triangles without an area are left out.
    if mesh.num_faces() != triangles {
        return None;
    }
    let number = numbers.get("POSITION")?.as_u64()? as u32;
    let positions = mesh.attribute_by_unique_id(number)?;
    let mut bounds = [vec![f64::INFINITY; 3], vec![f64::NEG_INFINITY; 3]];
    let count = mesh.num_points();
    for point in 0..count {
        let at = positions.mapped_index(PointIndex(point as u32)).0 as usize * 12;
        let bytes = positions.buffer().data().get(at..at + 12)?;
        for (axis, bytes) in bytes.as_chunks::<4>().0.iter().enumerate() {
            let value = f64::from(f32::from_le_bytes(*bytes));
            bounds[0][axis] = bounds[0][axis].min(value);
            bounds[1][axis] = bounds[1][axis].max(value);
        }
    }
    Some((count, bounds))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::container::glb_bytes;

    /// Squares along each side of a sheet.
    const SIDE: u32 = 12;

    /// Two sheets that meet in one vertex, the last of the first, as a document.
    fn two_sheets() -> Document {
        let row = SIDE + 1;
        let place = |sheet: u32, x: u32, y: u32| (sheet * (row * row - 1)) + y * row + x;
        let mut positions: Vec<u8> = Vec::new();
        let mut corners: Vec<u8> = Vec::new();
        for sheet in 0..2 {
            for (y, x) in (0..row).flat_map(|y| (0..row).map(move |x| (y, x))) {
                if (sheet, x, y) != (1, 0, 0) {
                    let place = [x + sheet * SIDE, y + sheet * SIDE, sheet];
                    positions.extend(place.iter().flat_map(|at| (*at as f32).to_le_bytes()));
                }
                if x < SIDE && y < SIDE {
                    let [a, b] = [place(sheet, x, y), place(sheet, x + 1, y)];
                    let [c, d] = [place(sheet, x, y + 1), place(sheet, x + 1, y + 1)];
                    let both = [a, b, c, b, d, c];
                    corners.extend(
                        both.iter()
                            .flat_map(|corner| (*corner as u16).to_le_bytes()),
                    );
                }
            }
        }
        let [first, second] = [positions.len(), corners.len()];
        let root = json!({
            "asset": {"version": "2.0"},
            "scenes": [{"nodes": [0]}],
            "nodes": [{"mesh": 0}],
            "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
            "accessors": [
                {"bufferView": 0, "componentType": 5126, "count": first / 12, "type": "VEC3",
                    "min": [0, 0, 0], "max": [2 * SIDE, 2 * SIDE, 1]},
                {"bufferView": 1, "componentType": 5123, "count": second / 2, "type": "SCALAR"}],
            "bufferViews": [
                {"buffer": 0, "byteLength": first},
                {"buffer": 0, "byteOffset": first, "byteLength": second}],
            "buffers": [{"byteLength": first + second}],
        });
        positions.extend(corners);
        let glb = glb_bytes(&root, positions).unwrap();
        Document::from_bytes("sheets.glb", glb, None).unwrap()
    }

    #[test]
    fn a_vertex_of_two_fans_becomes_two_and_is_counted_so() {
        let bits = DracoBits {
            positions: 14,
            texture_coordinates: 12,
        };
        let sheets = two_sheets();
        let before = sheets.json()["accessors"][0]["count"].as_u64().unwrap();
        let content = compressed(&sheets, bits).unwrap();
        let said = content.root["accessors"][0].clone();
        assert_eq!(said["count"], before + 1);
        assert_eq!(said["max"][0], f64::from(2 * SIDE));
        let glb = glb_bytes(&content.root, content.buffer).unwrap();
        let read = Document::from_bytes("sheets.glb", glb, None).unwrap();
        assert_eq!(read.json()["accessors"][0]["count"], said["count"]);
        assert_eq!(read.triangles(0, 0).unwrap().len() as u32, 4 * SIDE * SIDE);
    }
}
