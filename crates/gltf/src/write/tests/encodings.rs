//! One small tree for each way to encode it. Every one has at least two leaves:
//! the first goes, the second doubles its area.

use serde_json::{Map, Value, json};

use super::compressed::compress_view;
use super::fixture::*;

/// All of them, with their names.
pub(super) fn all() -> Vec<(&'static str, Fixture)> {
    vec![
        ("rich", rich()),
        ("non-indexed", non_indexed()),
        ("byte-indices", indexed_by(UNSIGNED_BYTE)),
        ("short-indices", indexed_by(UNSIGNED_SHORT)),
        ("interleaved", interleaved()),
        ("quantised-normalised", quantised_normalised()),
        ("quantised-integers", quantised_integers()),
        ("instanced-leaf", instanced_leaf()),
        ("instanced-twig", instanced_twig()),
        ("shared-twig", shared_twig()),
        ("shared-leaf", shared_leaf()),
        ("mirrored", transformed(json!({"scale": [-1, 1, 1]}))),
        ("nested", nested()),
        ("two-primitives", two_primitives()),
        ("shared-accessor", shared_accessor()),
        ("shared-view", shared_view()),
        ("morphed", morphed()),
        ("skinned", skinned()),
        ("sparse", sparse()),
        ("strip", strip()),
        ("fans", fans()),
        ("textured", textured()),
        ("second-scene", second_scene()),
        ("touching", touching()),
        ("meshopt", meshopt()),
    ]
}

pub(super) fn plain(count: usize) -> Fixture {
    let mut fixture = Fixture::new();
    let positions = fixture.vectors(&squares(count));
    let indices = fixture.indices(UNSIGNED_SHORT, &square_indices(count));
    fixture.with_leaves(json!({"POSITION": positions}), Some(indices))
}

/// Every attribute, and things that secateur does not know, everywhere.
pub(super) fn rich() -> Fixture {
    let mut fixture = Fixture::new();
    let of_vertex =
        |size: usize, f: &dyn Fn(usize) -> f64| -> Vec<f64> { (0..16 * size).map(f).collect() };
    let uvs = of_vertex(2, &|i| (i * 1000) as f64);
    let colors = of_vertex(3, &|i| (i * 5) as f64);
    let ages = of_vertex(1, &|i| (i * 7) as f64);
    let attributes = json!({
        "POSITION": fixture.vectors(&squares(4)),
        "NORMAL": fixture.vectors(&[[0.0, 0.6, 0.8], [0.0, 0.8, 0.6], [0.6, 0.0, 0.8], [0.0, 0.0, 1.0]].repeat(4)),
        "TANGENT": fixture.vectors(&[[1.0, 0.0, 0.0, -1.0]; 16]),
        "TEXCOORD_0": fixture.normalized(UNSIGNED_SHORT, 2, &uvs),
        "TEXCOORD_1": fixture.vectors(&[[0.25, 0.75], [0.5, 0.75], [0.5, 0.125], [0.25, 0.5]].repeat(4)),
        "COLOR_0": fixture.normalized(UNSIGNED_BYTE, 3, &colors),
        "_AGE": fixture.elements(UNSIGNED_SHORT, 1, &ages),
    });
    let indices = fixture.indices(UNSIGNED_INT, &square_indices(4));
    let mut fixture = fixture.with_leaves(attributes, Some(indices));
    fixture.use_extension("KHR_materials_variants", false);
    let mappings = json!([{"material": 0, "variants": [0]}]);
    let variants = json!({"KHR_materials_variants": {"mappings": mappings}});
    fixture.leaf_primitive()["extensions"] = variants;
    add_unknown_things(&mut fixture);
    let times = fixture.elements(FLOAT, 1, &[0.0, 1.0]);
    fixture.root["accessors"][times]["min"] = json!([0]);
    fixture.root["accessors"][times]["max"] = json!([1]);
    let moves = fixture.vectors(&[[0.0, 0.0, 0.0], [0.0, 1.0, 0.0]]);
    fixture.root["animations"] = json!([{
        "channels": [{"sampler": 0, "target": {"node": 1, "path": "translation"}}],
        "samplers": [{"input": times, "output": moves}],
    }]);
    fixture
}

fn add_unknown_things(fixture: &mut Fixture) {
    fixture.use_extension("ACME_forestry", false);
    let unknown = json!({"ACME_forestry": {"accessor": 3, "bufferView": 2, "mesh": 1}});
    let root = &mut fixture.root;
    root["extensions"] = json!({
        "KHR_materials_variants": {"variants": [{"name": "autumn"}]},
        "ACME_forestry": {"age": 80},
    });
    root["buffers"] = json!([{"name": "all of it"}]);
    root["cameras"] = json!([{"type": "perspective", "perspective": {"yfov": 1.0, "znear": 0.1}}]);
    root["nodes"]
        .as_array_mut()
        .unwrap()
        .push(json!({"name": "eye", "camera": 0}));
    root["scenes"]
        .as_array_mut()
        .unwrap()
        .push(json!({"name": "other", "nodes": [3]}));
    for list in [
        "accessors",
        "bufferViews",
        "buffers",
        "materials",
        "meshes",
        "nodes",
        "scenes",
    ] {
        for (number, item) in root[list].as_array_mut().unwrap().iter_mut().enumerate() {
            item["extras"] = json!({"note": format!("{list} {number}"), "exact": 0.1});
            if list != "nodes" {
                item["extensions"] = unknown.clone();
            }
        }
    }
    let primitive = &mut root["meshes"][1]["primitives"][0];
    primitive["extras"] = json!(["kept"]);
    root["asset"]["extras"] = json!({"from": "a nursery"});
}

fn non_indexed() -> Fixture {
    let mut fixture = Fixture::new();
    let corners = squares(4);
    let expanded: Vec<[f32; 3]> = square_indices(4)
        .iter()
        .map(|&i| corners[i as usize])
        .collect();
    let positions = fixture.vectors(&expanded);
    fixture.with_leaves(json!({"POSITION": positions}), None)
}

fn indexed_by(component: u32) -> Fixture {
    let mut fixture = Fixture::new();
    let positions = fixture.vectors(&squares(4));
    let indices = fixture.indices(component, &square_indices(4));
    fixture.with_leaves(json!({"POSITION": positions}), Some(indices))
}

fn interleaved() -> Fixture {
    let mut fixture = Fixture::new();
    let mut floats = Vec::new();
    for (k, position) in squares(4).iter().enumerate() {
        floats.extend_from_slice(position);
        floats.extend_from_slice(&[0.0, 0.0, 1.0, k as f32, 0.5]);
    }
    let bytes: Vec<u8> = floats.iter().flat_map(|x: &f32| x.to_le_bytes()).collect();
    let view = fixture.view(&bytes, Some(32));
    let mut accessor = |offset: u32, kind: &str| {
        fixture.accessor(json!({"bufferView": view, "byteOffset": offset, "componentType": FLOAT, "count": 16, "type": kind}))
    };
    let (position, normal, uv) = (
        accessor(0, "VEC3"),
        accessor(12, "VEC3"),
        accessor(24, "VEC2"),
    );
    fixture.root["accessors"][position]["min"] = json!([0, 0, 0]);
    fixture.root["accessors"][position]["max"] = json!([10, 2, 0.25]);
    let indices = fixture.indices(UNSIGNED_SHORT, &square_indices(4));
    let attributes = json!({"POSITION": position, "NORMAL": normal, "TEXCOORD_0": uv});
    fixture.with_leaves(attributes, Some(indices))
}

pub(super) fn quantised_normalised() -> Fixture {
    let mut fixture = Fixture::new();
    fixture.use_extension("KHR_mesh_quantization", true);
    let values: Vec<f64> = squares(4)
        .iter()
        .flatten()
        .map(|&x| f64::from(x * 2048.0))
        .collect();
    let positions = fixture.normalized(SHORT, 3, &values);
    let normals = fixture.normalized(BYTE, 3, &[0.0, 0.0, 127.0].repeat(16));
    let indices = fixture.indices(UNSIGNED_BYTE, &square_indices(4));
    fixture.root["nodes"][2]["scale"] = json!([16, 16, 16]);
    let attributes = json!({"POSITION": positions, "NORMAL": normals});
    fixture.with_leaves(attributes, Some(indices))
}

fn quantised_integers() -> Fixture {
    let mut fixture = Fixture::new();
    fixture.use_extension("KHR_mesh_quantization", true);
    let values: Vec<f64> = squares(4)
        .iter()
        .flatten()
        .map(|&x| f64::from(x * 100.0))
        .collect();
    let positions = fixture.elements(UNSIGNED_SHORT, 3, &values);
    let indices = fixture.indices(UNSIGNED_SHORT, &square_indices(4));
    fixture.root["nodes"][2]["scale"] = json!([0.01, 0.01, 0.01]);
    fixture.with_leaves(json!({"POSITION": positions}), Some(indices))
}

/// A mesh of one leaf, four instances, each turned, scaled and numbered.
pub(super) fn instanced_leaf() -> Fixture {
    let mut fixture = plain(1);
    let half = std::f32::consts::FRAC_1_SQRT_2;
    let mut attributes = Map::new();
    let translations = [
        [0.0, 0.0, 0.0],
        [5.0, 1.0, 0.0],
        [10.0, 0.0, 2.0],
        [15.0, 1.0, 1.0],
    ];
    let rotations = [
        [0.0, 0.0, 0.0, 1.0],
        [half, 0.0, 0.0, half],
        [0.0, half, 0.0, half],
        [0.0, 0.0, half, half],
    ];
    let scales = [
        [1.0, 1.0, 1.0],
        [2.0, 2.0, 2.0],
        [1.0, 3.0, 1.0],
        [-1.0, 1.0, 1.0],
    ];
    attributes.insert("TRANSLATION".into(), fixture.vectors(&translations).into());
    attributes.insert("ROTATION".into(), fixture.vectors(&rotations).into());
    attributes.insert("SCALE".into(), fixture.vectors(&scales).into());
    attributes.insert(
        "_ID".into(),
        fixture.elements(FLOAT, 1, &[7.0, 8.0, 9.0, 10.0]).into(),
    );
    fixture.instance(attributes);
    fixture
}

/// A mesh of two leaves, three instances: the first one's leaves both change.
pub(super) fn instanced_twig() -> Fixture {
    let mut fixture = plain(2);
    let translations = fixture.vectors(&[[0.0, 0.0, 0.0], [0.0, 5.0, 0.0], [0.0, 10.0, 0.0]]);
    let mut attributes = Map::new();
    attributes.insert("TRANSLATION".into(), translations.into());
    fixture.instance(attributes);
    fixture
}

fn add_leaf_nodes(fixture: &mut Fixture, transforms: &[Value]) {
    for transform in transforms {
        let mut node = json!({"name": "leaves", "mesh": 1, "extras": "may be scaled"});
        let fields = node.as_object_mut().unwrap();
        fields.extend(transform.as_object().unwrap().clone());
        let nodes = fixture.root["nodes"].as_array_mut().unwrap();
        nodes.push(node);
        let number = nodes.len() - 1;
        let children = fixture.root["nodes"][0]["children"].as_array_mut().unwrap();
        children.push(number.into());
    }
}

/// A mesh of two leaves, drawn by three nodes.
pub(super) fn shared_twig() -> Fixture {
    let mut fixture = plain(2);
    let transforms = [
        json!({"translation": [0, 5, 0]}),
        json!({"translation": [0, 10, 0]}),
    ];
    add_leaf_nodes(&mut fixture, &transforms);
    fixture
}

/// A mesh of one leaf, drawn by four nodes; the second has a matrix.
pub(super) fn shared_leaf() -> Fixture {
    let mut fixture = plain(1);
    let transforms = [
        json!({"matrix": [0, 2, 0, 0, -2, 0, 0, 0, 0, 0, 2, 0, 5, 6, 7, 1]}),
        json!({"translation": [0, 10, 0], "scale": [1, -2, 1]}),
        json!({"rotation": [0.6, 0, 0, 0.8], "translation": [9, 9, 9]}),
    ];
    add_leaf_nodes(&mut fixture, &transforms);
    fixture
}

fn transformed(transform: Value) -> Fixture {
    let mut fixture = plain(4);
    let node = fixture.root["nodes"][2].as_object_mut().unwrap();
    node.extend(transform.as_object().unwrap().clone());
    fixture
}

fn nested() -> Fixture {
    let mut fixture = transformed(json!({"rotation": [0, 0.6, 0, 0.8], "scale": [1, 2, 3]}));
    fixture.root["nodes"][0]["scale"] = json!([0.01, 0.01, 0.01]);
    fixture.root["nodes"][0]["rotation"] = json!([0.6, 0, 0, 0.8]);
    fixture.root["nodes"][0]["translation"] = json!([100, 200, 300]);
    fixture
}

/// Bark and leaves in one mesh, which is called leaves.
pub(super) fn two_primitives() -> Fixture {
    let mut fixture = plain(4);
    let bark = fixture.root["meshes"][0]["primitives"][0].clone();
    let primitives = fixture.root["meshes"][1]["primitives"]
        .as_array_mut()
        .unwrap();
    primitives.insert(0, bark);
    fixture.root["meshes"].as_array_mut().unwrap().remove(0);
    fixture.root["nodes"][1]
        .as_object_mut()
        .unwrap()
        .remove("mesh");
    fixture.root["nodes"][2]["mesh"] = 0.into();
    fixture
}

/// Bark and leaves use the same vertices.
pub(super) fn shared_accessor() -> Fixture {
    let mut fixture = Fixture::new();
    let mut positions = vec![[0.0, -9.0, 0.0], [1.0, -9.0, 0.0], [0.0, -8.0, 0.0]];
    positions.extend(squares(4));
    let positions = fixture.vectors(&positions);
    let bark = fixture.indices(UNSIGNED_SHORT, &[0, 1, 2]);
    fixture.root["meshes"][0]["primitives"][0] =
        json!({"attributes": {"POSITION": positions}, "indices": bark, "material": 0});
    let leaves: Vec<u32> = square_indices(4).iter().map(|i| i + 3).collect();
    let leaves = fixture.indices(UNSIGNED_SHORT, &leaves);
    fixture.with_leaves(json!({"POSITION": positions}), Some(leaves))
}

/// Bark and leaves have accessors of their own in one view, leaves first.
pub(super) fn shared_view() -> Fixture {
    let mut fixture = Fixture::new();
    let mut positions = squares(4);
    positions.extend([[0.0, -9.0, 0.0], [1.0, -9.0, 0.0], [0.0, -8.0, 0.0]]);
    let bytes: Vec<u8> = positions
        .iter()
        .flatten()
        .flat_map(|x| x.to_le_bytes())
        .collect();
    let view = fixture.view(&bytes, Some(12));
    let leaves = fixture.accessor(
        json!({"bufferView": view, "componentType": FLOAT, "count": 16,
        "type": "VEC3", "min": [0, 0, 0], "max": [10, 2, 0.25]}),
    );
    let bark = fixture.accessor(
        json!({"bufferView": view, "byteOffset": 192, "componentType": FLOAT,
        "count": 3, "type": "VEC3", "min": [0, -9, 0], "max": [1, -8, 0]}),
    );
    let bark_indices = fixture.indices(UNSIGNED_SHORT, &[0, 1, 2]);
    fixture.root["meshes"][0]["primitives"][0] =
        json!({"attributes": {"POSITION": bark}, "indices": bark_indices, "material": 0});
    let indices = fixture.indices(UNSIGNED_SHORT, &square_indices(4));
    fixture.with_leaves(json!({"POSITION": leaves}), Some(indices))
}

/// Two morph targets, the second all zeros, and an animation of their weights.
pub(super) fn morphed() -> Fixture {
    let mut fixture = plain(4);
    let moves: Vec<[f32; 3]> = (0..16).map(|k| [0.0, 0.0, 0.5 + k as f32]).collect();
    let targets = json!([
        {"POSITION": fixture.vectors(&moves), "NORMAL": fixture.vectors(&[[0.0, 0.1, 0.0]; 16])},
        {"POSITION": fixture.accessor(json!({"componentType": FLOAT, "count": 16, "type": "VEC3",
            "min": [0, 0, 0], "max": [0, 0, 0]}))},
    ]);
    let normals = fixture.vectors(&[[0.0, 0.0, 1.0]; 16]);
    fixture.leaf_primitive()["targets"] = targets;
    fixture.leaf_primitive()["attributes"]["NORMAL"] = normals.into();
    fixture.leaf_primitive()["targets"][1]["NORMAL"] =
        fixture.root["meshes"][1]["primitives"][0]["targets"][0]["NORMAL"].clone();
    fixture.root["meshes"][1]["weights"] = json!([0, 0]);
    let times = fixture.elements(FLOAT, 1, &[0.0, 1.0]);
    fixture.root["accessors"][times]["min"] = json!([0]);
    fixture.root["accessors"][times]["max"] = json!([1]);
    let weights = fixture.elements(FLOAT, 1, &[0.0, 0.0, 1.0, 1.0]);
    fixture.root["animations"] = json!([{
        "channels": [{"sampler": 0, "target": {"node": 2, "path": "weights"}}],
        "samplers": [{"input": times, "output": weights}],
    }]);
    fixture
}

fn skinned() -> Fixture {
    let mut fixture = plain(4);
    let joints = fixture.elements(UNSIGNED_BYTE, 4, &[0.0; 64]);
    let weights = fixture.vectors(&[[1.0, 0.0, 0.0, 0.0]; 16]);
    let attributes = &mut fixture.leaf_primitive()["attributes"];
    attributes["JOINTS_0"] = joints.into();
    attributes["WEIGHTS_0"] = weights.into();
    let identity: Vec<u8> = (0..16)
        .flat_map(|i| if i % 5 == 0 { 1.0f32 } else { 0.0 }.to_le_bytes())
        .collect();
    let view = fixture.view(&identity, None);
    let matrices = fixture
        .accessor(json!({"bufferView": view, "componentType": FLOAT, "count": 1, "type": "MAT4"}));
    fixture.root["skins"] = json!([{"joints": [0], "inverseBindMatrices": matrices}]);
    fixture.root["nodes"][2]["skin"] = 0.into();
    fixture
}

/// The positions of the last leaf are put in by a sparse accessor.
fn sparse() -> Fixture {
    let mut fixture = plain(4);
    let mut folded = squares(4);
    folded[12..].fill([0.0; 3]);
    let base = fixture.vectors(&folded);
    let places: Vec<u8> = vec![12, 13, 14, 15];
    let indices = fixture.view(&places, None);
    let values: Vec<u8> = square(3)
        .iter()
        .flatten()
        .flat_map(|x| x.to_le_bytes())
        .collect();
    let values = fixture.view(&values, None);
    let accessor = &mut fixture.root["accessors"][base];
    accessor["max"] = json!([10, 2, 0.25]);
    accessor["sparse"] = json!({
        "count": 4,
        "indices": {"bufferView": indices, "componentType": UNSIGNED_BYTE},
        "values": {"bufferView": values},
    });
    fixture.leaf_primitive()["attributes"]["POSITION"] = base.into();
    fixture
}

/// Four squares as one strip, joined by triangles without area.
fn strip() -> Fixture {
    let mut fixture = plain(4);
    let mut indices = Vec::new();
    for k in 0..4 {
        let [a, b, c, d] = [0, 1, 3, 2].map(|corner| corner + 4 * k);
        if k > 0 {
            indices.push(a);
        }
        indices.extend([a, b, c, d]);
        if k < 3 {
            indices.push(d);
        }
    }
    let indices = fixture.indices(UNSIGNED_SHORT, &indices);
    fixture.leaf_primitive()["indices"] = indices.into();
    fixture.leaf_primitive()["mode"] = 5.into();
    fixture
}

/// Three primitives, each one square as a fan without indices.
fn fans() -> Fixture {
    let mut fixture = Fixture::new();
    let mut primitives = Vec::new();
    for k in 0..3 {
        let positions = fixture.vectors(&square(k));
        primitives.push(json!({"attributes": {"POSITION": positions}, "material": 1, "mode": 6}));
    }
    fixture.root["meshes"][1]["primitives"] = primitives.into();
    fixture
}

/// An image in the buffer, and a texture transform.
pub(super) fn textured() -> Fixture {
    let mut fixture = plain(4);
    let uvs = fixture.vectors(&[[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]].repeat(4));
    fixture.leaf_primitive()["attributes"]["TEXCOORD_0"] = uvs.into();
    fixture.use_extension("KHR_texture_transform", false);
    let view = fixture.view(&one_texel_png(), None);
    fixture.root["images"] = json!([{"bufferView": view, "mimeType": "image/png", "name": "leaf"}]);
    fixture.root["textures"] = json!([{"source": 0}]);
    fixture.root["materials"][1]["alphaMode"] = "MASK".into();
    fixture.root["materials"][1]["pbrMetallicRoughness"] = json!({"baseColorTexture": {
        "index": 0,
        "extensions": {"KHR_texture_transform": {"scale": [0.5, 0.25], "rotation": 0.5}},
    }});
    fixture
}

pub(super) fn one_texel_png() -> Vec<u8> {
    let mut png = std::io::Cursor::new(Vec::new());
    let texel = image::RgbaImage::from_pixel(1, 1, image::Rgba([10, 200, 30, 255]));
    texel.write_to(&mut png, image::ImageFormat::Png).unwrap();
    png.into_inner()
}

/// A second scene draws the same leaves once more.
pub(super) fn second_scene() -> Fixture {
    let mut fixture = plain(4);
    let nodes = fixture.root["nodes"].as_array_mut().unwrap();
    nodes.push(json!({"name": "the tree elsewhere", "mesh": 1}));
    let scenes = fixture.root["scenes"].as_array_mut().unwrap();
    scenes.push(json!({"nodes": [3]}));
    fixture
}

/// Squares in a diagonal row: neighbours share a vertex, not an edge.
pub(super) fn touching() -> Fixture {
    let mut fixture = Fixture::new();
    let mut positions = vec![[0.0, 0.0, 0.0]];
    let mut indices = Vec::new();
    for k in 0..4u32 {
        let at = k as f32;
        positions.extend([
            [at + 1.0, at, 0.0],
            [at + 1.0, at + 1.0, 0.0],
            [at, at + 1.0, 0.0],
        ]);
        let [a, b, c, d] = [3 * k - u32::from(k > 0), 3 * k + 1, 3 * k + 2, 3 * k + 3];
        indices.extend([a, b, c, a, c, d]);
    }
    let positions = fixture.vectors(&positions);
    let indices = fixture.indices(UNSIGNED_SHORT, &indices);
    fixture.with_leaves(json!({"POSITION": positions}), Some(indices))
}

/// Positions of bark and leaves are meshopt-compressed; what a reader without
/// that would look at is a buffer without bytes.
pub(super) fn meshopt() -> Fixture {
    let mut fixture = plain(4);
    fixture.use_extension("EXT_meshopt_compression", true);
    for mesh in 0..2 {
        let number = &fixture.root["meshes"][mesh]["primitives"][0]["attributes"]["POSITION"];
        let accessor = number.as_u64().unwrap() as usize;
        let view = fixture.root["accessors"][accessor]["bufferView"]
            .as_u64()
            .unwrap() as usize;
        compress_view(&mut fixture, view, 12);
    }
    fixture
}
