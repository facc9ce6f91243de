//! A grown plant as a GLB.

use std::borrow::Cow;
use std::io::Cursor;
use std::sync::Arc;

use glam::{DVec3, Vec2, Vec3, Vec4};
use image::{ExtendedColorType, ImageEncoder, codecs::png::PngEncoder};
use serde_json::{Map, Value, json};

use crate::container::glb_bytes;
use crate::skeleton::{
    EXTRAS_NAME, LEAF_SEGMENT, SEGMENT_CONTINUES, SEGMENT_END, SEGMENT_PARENT, SEGMENT_RADIUS,
    SEGMENT_SIDES, SEGMENT_START, VERSION, number_of,
};
use crate::wind;
use secateur_model::{AlphaMode, Hold, Material, Plant, PlantSkeleton, Surface, Texture, Wrap};

const UNSIGNED_BYTE: u32 = 5121;
const UNSIGNED_SHORT: u32 = 5123;
const FLOAT: u32 = 5126;
const UNSIGNED_INT: u32 = 5125;
const ARRAY_BUFFER: u32 = 34962;
const ELEMENT_ARRAY_BUFFER: u32 = 34963;
pub(super) const LINEAR: u32 = 9729;
pub(super) const LINEAR_MIPMAP_LINEAR: u32 = 9987;

/// A grown plant as the bytes of a GLB file: a scene named after the plant, its
/// node "Tree" with the children "Branches" and "Leaves", a mesh and a material
/// each, textures embedded as PNG; its skeleton, if it has one, which
/// [`Tree::skeleton`](crate::Tree::skeleton) reads; and, if it says so, what each vertex hangs on,
/// as the attributes that `wind.rs` describes.
///
/// Positions are rounded to f32; normals are made unit length, colours and
/// factors are held to 0..1, as glTF asks. A surface without triangles gets a
/// node without mesh. The same plant gives the same bytes. What a plant hangs on is in
/// [`Plant::holds`]; that of its surfaces is not written.
///
/// # Panics
/// If a surface is broken: a corner that names no position, a list of normals,
/// texture coordinates or colours that is neither empty nor as long as the
/// positions, a texture whose bytes do not fit its size, a position beyond the
/// range of f32, a skeleton that does not pass its check, or a file beyond 4 GiB.
pub fn plant_to_glb(plant: &Plant) -> Vec<u8> {
    let expected_bytes = expected_bytes(plant);
    let wood = Columns::borrowed(&plant.wood);
    write(
        plant,
        wood,
        Columns::borrowed(&plant.leaves),
        expected_bytes,
    )
}

/// [`plant_to_glb`] that gives the plant's memory back while it writes: a large
/// plant and its file are never there together.
///
/// # Panics
/// As [`plant_to_glb`].
pub fn plant_into_glb(mut plant: Plant) -> Vec<u8> {
    let expected_bytes = expected_bytes(&plant);
    let wood = Columns::taken(&mut plant.wood);
    let leaves = Columns::taken(&mut plant.leaves);
    write(&plant, wood, leaves, expected_bytes)
}

/// The lists of a surface, each of which goes when it is written.
pub(super) struct Columns<'a> {
    positions: Cow<'a, [DVec3]>,
    normals: Cow<'a, [Vec3]>,
    uvs: Cow<'a, [Vec2]>,
    colors: Cow<'a, [Vec4]>,
    triangles: Cow<'a, [[u32; 3]]>,
}

impl<'a> Columns<'a> {
    pub(super) fn borrowed(surface: &'a Surface) -> Self {
        Self {
            positions: Cow::Borrowed(&surface.positions),
            normals: Cow::Borrowed(&surface.normals),
            uvs: Cow::Borrowed(&surface.uvs),
            colors: Cow::Borrowed(&surface.colors),
            triangles: Cow::Borrowed(&surface.triangles),
        }
    }

    fn taken(surface: &mut Surface) -> Self {
        Self {
            positions: Cow::Owned(std::mem::take(&mut surface.positions)),
            normals: Cow::Owned(std::mem::take(&mut surface.normals)),
            uvs: Cow::Owned(std::mem::take(&mut surface.uvs)),
            colors: Cow::Owned(std::mem::take(&mut surface.colors)),
            triangles: Cow::Owned(std::mem::take(&mut surface.triangles)),
        }
    }
}

fn write(plant: &Plant, wood: Columns<'_>, leaves: Columns<'_>, expected_bytes: usize) -> Vec<u8> {
    let mut file = PlantFile::default();
    file.buffer.reserve_exact(expected_bytes);
    let holds = plant.holds.as_ref();
    let of_wood = holds.map(|holds| Cow::Borrowed(&holds.wood[..]));
    let branches = file.push_node("Branches", wood, &plant.wood.material, of_wood);
    let of_leaves = holds.map(|holds| Cow::Owned(of_leaf_vertices(plant, &holds.leaves, &leaves)));
    let leaves = file.push_node("Leaves", leaves, &plant.leaves.material, of_leaves);
    file.push(
        "nodes",
        json!({"name": "Tree", "children": [branches, leaves]}),
    );
    let skeleton = plant.skeleton.as_ref().filter(|s| !s.segments.is_empty());
    let skeleton = skeleton.map(|skeleton| {
        let checked = skeleton.check(plant.triangles_per_leaf.len());
        checked.expect("a plant has the skeleton of its own leaves");
        file.push_skeleton(skeleton)
    });
    let mut root = file.finish(&plant.name, leaves + 1);
    if let Some(skeleton) = skeleton {
        root["extras"] = json!({ EXTRAS_NAME: skeleton });
    }
    glb_bytes(&root, file.buffer).expect("a plant fits into 4 GiB")
}

/// For each vertex of the leaves what its leaf hangs on.
fn of_leaf_vertices(plant: &Plant, holds: &[Hold], leaves: &Columns<'_>) -> Vec<Hold> {
    assert_eq!(holds.len(), plant.triangles_per_leaf.len());
    let Some(&first) = holds.first() else {
        return Vec::new();
    };
    let mut of_vertices = vec![first; leaves.positions.len()];
    let mut triangles = leaves.triangles.iter();
    for (hold, &count) in holds.iter().zip(&plant.triangles_per_leaf) {
        for &corner in triangles.by_ref().take(count as usize).flatten() {
            of_vertices[corner as usize] = *hold;
        }
    }
    of_vertices
}

/// At least as many bytes as the vertices and corners take, and some for the rest:
/// memory that is reserved at once is never needed twice.
fn expected_bytes(plant: &Plant) -> usize {
    let bytes_a_vertex = match plant.holds {
        Some(_) => 48 + wind::BYTES_A_VERTEX,
        None => 48,
    };
    let of_surface =
        |surface: &Surface| bytes_a_vertex * surface.positions.len() + 12 * surface.triangles.len();
    let of_skeleton = |s: &PlantSkeleton| 40 * s.segments.len() + 4 * s.leaf_segments.len();
    let skeleton = plant.skeleton.as_ref().map_or(0, of_skeleton);
    of_surface(&plant.wood) + of_surface(&plant.leaves) + skeleton + (1 << 17)
}

#[derive(Default)]
pub(super) struct PlantFile {
    pub(super) lists: Map<String, Value>,
    pub(super) buffer: Vec<u8>,
    textures: Vec<Arc<Texture>>,
}

impl PlantFile {
    /// Appends to one of glTF's top-level lists and returns the item's number.
    pub(super) fn push(&mut self, list: &str, item: Value) -> usize {
        let list = self
            .lists
            .entry(list)
            .or_insert_with(|| Value::Array(Vec::new()));
        let items = list.as_array_mut().expect("top-level lists are arrays");
        items.push(item);
        items.len() - 1
    }

    pub(super) fn finish(&mut self, scene_name: &str, tree: usize) -> Value {
        let mut root = json!({
            "asset": {"version": "2.0", "generator": "secateur"},
            "scene": 0,
            "scenes": [named(scene_name, json!({"nodes": [tree]}))],
        });
        if !self.buffer.is_empty() {
            self.push("buffers", json!({"byteLength": self.buffer.len()}));
        }
        let fields = root.as_object_mut().expect("the root is an object");
        fields.extend(std::mem::take(&mut self.lists));
        root
    }

    pub(super) fn push_node(
        &mut self,
        name: &str,
        surface: Columns<'_>,
        material: &Material,
        holds: Option<Cow<'_, [Hold]>>,
    ) -> usize {
        if surface.triangles.is_empty() {
            return self.push("nodes", json!({"name": name}));
        }
        let material = self.push_material(material);
        let count = surface.positions.len();
        let mut primitive = self.push_primitive(surface, material);
        if let Some(holds) = holds {
            assert_eq!(holds.len(), count, "every vertex hangs on something");
            self.push_holds(&holds, &mut primitive["attributes"]);
        }
        let mesh = self.push("meshes", json!({"name": name, "primitives": [primitive]}));
        self.push("nodes", json!({"name": name, "mesh": mesh}))
    }

    fn push_primitive(&mut self, surface: Columns<'_>, material: usize) -> Value {
        let count = surface.positions.len();
        let of_every_position = |len: usize, what: &str| {
            assert!(
                len == 0 || len == count,
                "{len} {what} for {count} positions"
            );
            len > 0
        };
        let mut attributes = Map::new();
        attributes.insert(
            "POSITION".into(),
            self.push_positions(&surface.positions).into(),
        );
        drop(surface.positions);
        if of_every_position(surface.normals.len(), "normals") {
            let unit = |n: &Vec3| n.normalize_or(Vec3::Z).to_array();
            let normals = self.push_floats("VEC3", surface.normals.iter().map(unit));
            attributes.insert("NORMAL".into(), normals.into());
        }
        drop(surface.normals);
        if of_every_position(surface.uvs.len(), "texture coordinates") {
            let uvs = self.push_floats("VEC2", surface.uvs.iter().map(|uv| uv.to_array()));
            attributes.insert("TEXCOORD_0".into(), uvs.into());
        }
        drop(surface.uvs);
        if of_every_position(surface.colors.len(), "colours") {
            let held = |c: &Vec4| c.clamp(Vec4::ZERO, Vec4::ONE).to_array();
            let colors = self.push_floats("VEC4", surface.colors.iter().map(held));
            attributes.insert("COLOR_0".into(), colors.into());
        }
        let indices = self.push_indices(&surface.triangles, count);
        json!({"attributes": attributes, "indices": indices, "material": material})
    }

    fn push_positions(&mut self, positions: &[DVec3]) -> usize {
        let positions = || positions.iter().map(|p| p.as_vec3());
        assert!(
            positions().all(|p| p.is_finite()),
            "a position does not fit f32"
        );
        let min = positions().fold(Vec3::INFINITY, Vec3::min);
        let max = positions().fold(Vec3::NEG_INFINITY, Vec3::max);
        let accessor = self.push_floats("VEC3", positions().map(|p| p.to_array()));
        let fields = &mut self.lists["accessors"][accessor];
        fields["min"] = json!(min.to_array());
        fields["max"] = json!(max.to_array());
        accessor
    }

    fn push_floats<const N: usize>(
        &mut self,
        kind: &str,
        vectors: impl ExactSizeIterator<Item = [f32; N]>,
    ) -> usize {
        self.push_elements(Some(ARRAY_BUFFER), kind, vectors)
    }

    fn push_elements<const N: usize>(
        &mut self,
        target: Option<u32>,
        kind: &str,
        vectors: impl ExactSizeIterator<Item = [f32; N]>,
    ) -> usize {
        let count = vectors.len();
        let view = self.push_view(target, |buffer| {
            for number in vectors.flatten() {
                buffer.extend_from_slice(&number.to_le_bytes());
            }
        });
        self.push(
            "accessors",
            json!({"bufferView": view, "componentType": FLOAT, "count": count, "type": kind}),
        )
    }

    fn push_indices(&mut self, triangles: &[[u32; 3]], positions: usize) -> usize {
        let corners = || triangles.iter().flatten();
        assert!(
            corners().all(|&corner| (corner as usize) < positions),
            "a triangle names a position that is not there"
        );
        let view = self.push_view(Some(ELEMENT_ARRAY_BUFFER), |buffer| {
            for corner in corners() {
                buffer.extend_from_slice(&corner.to_le_bytes());
            }
        });
        let count = 3 * triangles.len();
        self.push(
            "accessors",
            json!({"bufferView": view, "componentType": UNSIGNED_INT, "count": count, "type": "SCALAR"}),
        )
    }

    /// See `skeleton.rs` for what it holds. There is at least one segment.
    fn push_skeleton(&mut self, skeleton: &PlantSkeleton) -> Value {
        let segments = &skeleton.segments;
        let mut accessors = Map::new();
        let mut put = |name: &str, accessor: usize| accessors.insert(name.into(), accessor.into());
        let parents = segments.iter().map(|s| number_of(s.parent));
        put(SEGMENT_PARENT, self.push_numbers(parents));
        let continues = segments.iter().map(|s| u8::from(s.continues_parent));
        put(SEGMENT_CONTINUES, self.push_bytes(continues));
        let sides = segments.iter().map(|s| s.sides as u8);
        put(SEGMENT_SIDES, self.push_bytes(sides));
        let starts = segments.iter().map(|s| s.start.as_vec3().to_array());
        put(SEGMENT_START, self.push_elements(None, "VEC3", starts));
        let ends = segments.iter().map(|s| s.end.as_vec3().to_array());
        put(SEGMENT_END, self.push_elements(None, "VEC3", ends));
        let radii = segments
            .iter()
            .map(|s| [s.start_radius_m as f32, s.end_radius_m as f32]);
        put(SEGMENT_RADIUS, self.push_elements(None, "VEC2", radii));
        if !skeleton.leaf_segments.is_empty() {
            let of_leaves = skeleton.leaf_segments.iter().map(|s| number_of(*s));
            put(LEAF_SEGMENT, self.push_numbers(of_leaves));
        }
        json!({"version": VERSION, "accessors": accessors})
    }

    /// See `wind.rs` for what they are.
    fn push_holds(&mut self, holds: &[Hold], attributes: &mut Value) {
        let pivots = holds.iter().map(|hold| hold.pivot.to_array());
        attributes[wind::PIVOT] = self.push_floats("VEC3", pivots).into();
        let along = holds.iter().map(|hold| [hold.along_m]);
        attributes[wind::ALONG] = self.push_floats("SCALAR", along).into();
        let segments = holds.iter().map(|hold| number_of(hold.segment));
        let segments = self.push_numbers(segments);
        let view = &self.lists["accessors"][segments]["bufferView"];
        let view = view.as_u64().expect("a view was pushed") as usize;
        self.lists["bufferViews"][view]["target"] = ARRAY_BUFFER.into();
        attributes[wind::SEGMENT] = segments.into();
    }

    fn push_numbers(&mut self, numbers: impl ExactSizeIterator<Item = [u16; 2]>) -> usize {
        let count = numbers.len();
        let view = self.push_view(None, |buffer| {
            for half in numbers.flatten() {
                buffer.extend_from_slice(&half.to_le_bytes());
            }
        });
        self.push(
            "accessors",
            json!({"bufferView": view, "componentType": UNSIGNED_SHORT, "count": count, "type": "VEC2"}),
        )
    }

    fn push_bytes(&mut self, bytes: impl ExactSizeIterator<Item = u8>) -> usize {
        let count = bytes.len();
        let view = self.push_view(None, |buffer| buffer.extend(bytes));
        self.push(
            "accessors",
            json!({"bufferView": view, "componentType": UNSIGNED_BYTE, "count": count, "type": "SCALAR"}),
        )
    }

    fn push_view(&mut self, target: Option<u32>, append: impl FnOnce(&mut Vec<u8>)) -> usize {
        let offset = self.buffer.len().next_multiple_of(4);
        self.buffer.resize(offset, 0);
        append(&mut self.buffer);
        let length = self.buffer.len() - offset;
        let mut view = json!({"buffer": 0, "byteOffset": offset, "byteLength": length});
        if let Some(target) = target {
            view["target"] = target.into();
        }
        self.push("bufferViews", view)
    }

    fn push_material(&mut self, material: &Material) -> usize {
        let color = material.base_color.map(|c| c.clamp(0.0, 1.0));
        let mut pbr = json!({
            "baseColorFactor": color,
            "metallicFactor": 0,
            "roughnessFactor": 1,
        });
        if let Some(texture) = &material.texture {
            pbr["baseColorTexture"] = json!({"index": self.texture(texture)});
        }
        let mut fields = named(&material.name, json!({"pbrMetallicRoughness": pbr}));
        match material.alpha_mode {
            AlphaMode::Opaque => {}
            AlphaMode::Mask(cutoff) => {
                fields["alphaMode"] = "MASK".into();
                fields["alphaCutoff"] = json!(cutoff.max(0.0));
            }
            AlphaMode::Blend => fields["alphaMode"] = "BLEND".into(),
        }
        if material.double_sided {
            fields["doubleSided"] = true.into();
        }
        self.push("materials", fields)
    }

    /// The number of a texture, which is written once however many use it.
    pub(super) fn texture(&mut self, texture: &Arc<Texture>) -> usize {
        let known = self.textures.iter().position(|t| t == texture);
        known.unwrap_or_else(|| {
            self.textures.push(Arc::clone(texture));
            self.push_texture(texture)
        })
    }

    fn push_texture(&mut self, texture: &Texture) -> usize {
        let png = png_bytes(texture);
        let view = self.push_view(None, |buffer| buffer.extend_from_slice(&png));
        let source = self.push(
            "images",
            json!({"bufferView": view, "mimeType": "image/png"}),
        );
        let [wrap_s, wrap_t] = texture.wrap.map(wrap_code);
        let sampler = self.push(
            "samplers",
            json!({
                "magFilter": LINEAR,
                "minFilter": LINEAR_MIPMAP_LINEAR,
                "wrapS": wrap_s,
                "wrapT": wrap_t,
            }),
        );
        self.push("textures", json!({"sampler": sampler, "source": source}))
    }
}

/// `fields` with this name in front, or none where it is empty.
fn named(name: &str, fields: Value) -> Value {
    if name.is_empty() {
        return fields;
    }
    let mut all = json!({ "name": name });
    if let (Value::Object(all), Value::Object(fields)) = (&mut all, fields) {
        all.extend(fields);
    }
    all
}

pub(super) fn wrap_code(wrap: Wrap) -> u32 {
    match wrap {
        Wrap::Repeat => 10497,
        Wrap::ClampToEdge => 33071,
        Wrap::MirroredRepeat => 33648,
    }
}

pub(super) fn png_bytes(texture: &Texture) -> Vec<u8> {
    let mut png = Cursor::new(Vec::new());
    PngEncoder::new(&mut png)
        .write_image(
            &texture.rgba,
            texture.width,
            texture.height,
            ExtendedColorType::Rgba8,
        )
        .expect("a texture has four bytes for each of its texels");
    png.into_inner()
}
