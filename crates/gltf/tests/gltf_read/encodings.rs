//! Every encoding of the same two squares gives the same two leaves.

use secateur_gltf::{Document, Tree};
use secateur_model::{LeafId, Lod};
use serde_json::{Value, json};

use crate::seeds::{DRACO_STREAMS, draco};
use crate::small_tree::{INDICES, SQUARES, SmallTree, assert_two_squares, centres};

#[test]
fn indices_of_every_size() {
    assert_two_squares(&SmallTree::squares());
    let mut bytes = SmallTree::squares();
    let small: Vec<u8> = INDICES.iter().map(|&i| i as u8).collect();
    let accessor = bytes.accessor("SCALAR", 5121, 12, &small);
    assert_two_squares(&bytes.set("/meshes/0/primitives/0/indices", json!(accessor)));
    let mut words = SmallTree::squares();
    let large: Vec<u8> = INDICES
        .iter()
        .flat_map(|&i| u32::from(i).to_le_bytes())
        .collect();
    let accessor = words.accessor("SCALAR", 5125, 12, &large);
    assert_two_squares(&words.set("/meshes/0/primitives/0/indices", json!(accessor)));
}

#[test]
fn no_indices() {
    let mut tree = SmallTree::empty();
    let corners: Vec<f32> = INDICES
        .iter()
        .flat_map(|&i| SQUARES[usize::from(i)])
        .collect();
    let positions = tree.floats("VEC3", &corners);
    tree.primitive(json!({"attributes": {"POSITION": positions}, "material": 0}));
    assert_two_squares(&tree);
}

#[test]
fn interleaved_with_an_offset() {
    // Five floats of something else before each position.
    let mut tree = SmallTree::squares();
    let mut bytes = Vec::new();
    for corner in SQUARES {
        bytes.extend([0xff; 20]);
        bytes.extend(corner.iter().flat_map(|x| x.to_le_bytes()));
    }
    let view = tree.view(&bytes);
    let tree = tree
        .set(&format!("/bufferViews/{view}/byteStride"), json!(32))
        .set("/accessors/0/bufferView", json!(view))
        .set("/accessors/0/byteOffset", json!(20));
    assert_two_squares(&tree);
}

#[test]
fn strips_joined_by_degenerate_triangles() {
    // 0 1 3 2 is one square; 2 4 lead over without area; 4 5 7 6 the other.
    let mut tree = SmallTree::squares();
    let strip = tree.shorts("SCALAR", &[0, 1, 3, 2, 2, 4, 4, 5, 7, 6]);
    let tree = tree
        .set("/meshes/0/primitives/0/indices", json!(strip))
        .set("/meshes/0/primitives/0/mode", json!(5));
    assert_two_squares(&tree);
}

#[test]
fn strips_turn_every_other_triangle() {
    // Both triangles of a square face the same way, which surfaces show.
    let mut tree = SmallTree::squares();
    let strip = tree.shorts("SCALAR", &[0, 1, 3, 2]);
    let tree = tree
        .set("/meshes/0/primitives/0/indices", json!(strip))
        .set("/meshes/0/primitives/0/mode", json!(5));
    let surfaces = tree.tree().surfaces().unwrap();
    let surface = &surfaces[0].0;
    for triangle in &surface.triangles {
        let [a, b, c] = triangle.map(|v| surface.positions[v as usize]);
        assert!((b - a).cross(c - a).z > 0.0, "{triangle:?}");
    }
}

#[test]
fn fans() {
    let mut tree = SmallTree::empty();
    let positions = tree.floats("VEC3", SQUARES.as_flattened());
    for fan in [[0, 1, 2, 3], [4, 5, 6, 7]] {
        let fan = tree.shorts("SCALAR", &fan);
        tree.primitive(json!({
            "attributes": {"POSITION": positions}, "indices": fan, "material": 0, "mode": 6
        }));
    }
    assert_two_squares(&tree);
}

#[test]
fn quantised_positions() {
    // Whole numbers 0..2 as bytes, not normalised; stride padded to four.
    let mut plain = SmallTree::squares();
    let bytes: Vec<u8> = SQUARES
        .iter()
        .flat_map(|p| [p[0] as u8, p[1] as u8, p[2] as u8, 0xee])
        .collect();
    let view = plain.view(&bytes);
    let plain = plain
        .set(&format!("/bufferViews/{view}/byteStride"), json!(4))
        .set("/accessors/0/bufferView", json!(view))
        .set("/accessors/0/componentType", json!(5121))
        .set("/extensionsRequired", json!(["KHR_mesh_quantization"]));
    assert_two_squares(&plain);
    // Normalised shorts, 32767 standing for 1; the node's scale of 2 undoes
    // the halving.
    let mut normalised = SmallTree::squares();
    let bytes: Vec<u8> = SQUARES
        .iter()
        .flat_map(|p| {
            p.map(|x| {
                if x == 2.0 {
                    32767
                } else {
                    (x * 16383.5) as i16
                }
            })
        })
        .flat_map(i16::to_le_bytes)
        .collect();
    let view = normalised.view(&bytes);
    let normalised = normalised
        .set("/accessors/0/bufferView", json!(view))
        .set("/accessors/0/componentType", json!(5122))
        .set("/accessors/0/normalized", json!(true))
        .set("/nodes/0/scale", json!([2.0, 2.0, 2.0]));
    let tree = normalised.tree();
    // 16383 of 32767 is not quite a half.
    let side: f64 = 2.0 * 16383.0 / 32767.0;
    assert_eq!(tree.foliage().leaves().len(), 2);
    assert!((tree.foliage().leaves()[0].area() - side * side).abs() < 1e-12);
    assert_eq!(tree.foliage().leaves()[1].centre().z, 2.0);
}

#[test]
fn the_lowest_normalised_number_is_minus_one() {
    // -128 of 127 counts as -1, not -1.008.
    let mut tree = SmallTree::empty();
    let bytes: Vec<u8> = [[-128i8, 0, 0, 0], [127, 0, 0, 0], [127, 127, 0, 0]]
        .as_flattened()
        .iter()
        .map(|&b| b as u8)
        .collect();
    let positions = tree.accessor("VEC3", 5120, 3, &bytes);
    tree.primitive(json!({"attributes": {"POSITION": positions}, "material": 0}));
    let tree = tree
        .set("/bufferViews/0/byteStride", json!(4))
        .set("/accessors/0/normalized", json!(true))
        .tree();
    assert_eq!(tree.foliage().triangles()[0].corners[0].x, -1.0);
}

#[test]
fn sparse_elements_replace_dense_ones_and_zeros() {
    for has_view in [true, false] {
        let mut tree = SmallTree::squares();
        // With the view corner 5 is wrong before it is replaced; without, all
        // corners but the first are.
        let replaced: Vec<u16> = if has_view { vec![5] } else { (1..8).collect() };
        if has_view {
            let at = 5 * 12;
            tree.bytes[at..at + 12].fill(0x40);
        } else {
            tree = tree.without("/accessors/0/bufferView");
        }
        let values: Vec<u8> = replaced
            .iter()
            .flat_map(|&i| SQUARES[usize::from(i)])
            .flat_map(f32::to_le_bytes)
            .collect();
        let numbers: Vec<u8> = replaced.iter().flat_map(|i| i.to_le_bytes()).collect();
        let (indices, values) = (tree.view(&numbers), tree.view(&values));
        let sparse = json!({
            "count": replaced.len(),
            "indices": {"bufferView": indices, "componentType": 5123},
            "values": {"bufferView": values},
        });
        assert_two_squares(&tree.set("/accessors/0/sparse", sparse));
    }
}

#[test]
fn two_primitives_and_a_shared_accessor() {
    let mut tree = SmallTree::empty();
    let positions = tree.floats("VEC3", SQUARES.as_flattened());
    for half in INDICES.chunks(6) {
        let indices = tree.shorts("SCALAR", half);
        tree.primitive(json!({
            "attributes": {"POSITION": positions}, "indices": indices, "material": 0
        }));
    }
    assert_two_squares(&tree);
}

#[test]
fn compressed_indices_beside_a_placeholder_buffer() {
    // EXT_meshopt_compression, mode 2: deltas of each index against the one
    // before, zigzagged, times two.
    let mut stream = vec![0xd1];
    let mut last = 0;
    for index in INDICES.map(i32::from) {
        let delta = index - last;
        let zigzag = if delta < 0 { -2 * delta - 1 } else { 2 * delta };
        stream.push(2 * zigzag as u8);
        last = index;
    }
    stream.extend([0; 4]);
    for name in ["EXT_meshopt_compression", "KHR_meshopt_compression"] {
        let mut tree = SmallTree::squares();
        let source = tree.view(&stream);
        let offset = tree.root["bufferViews"][source]["byteOffset"].clone();
        let length = tree.bytes.len();
        let compression = json!({
            "buffer": 0, "byteOffset": offset, "byteLength": stream.len(),
            "byteStride": 2, "count": 12, "mode": "INDICES",
        });
        let view = json!({
            "buffer": 1, "byteLength": 24, "extensions": {name: compression}
        });
        let tree = tree
            .set("/bufferViews/1", view)
            .set(
                "/buffers",
                json!([{"byteLength": length}, {"byteLength": 24}]),
            )
            .set("/extensionsRequired", json!([name]));
        assert_two_squares(&tree);
    }
}

#[test]
fn json_with_data_uris() {
    use base64::Engine;
    let mut tree = SmallTree::squares();
    let data = base64::engine::general_purpose::STANDARD.encode(&tree.bytes);
    let length = tree.bytes.len();
    tree.root["buffers"] = json!([{
        "byteLength": length, "uri": format!("data:application/octet-stream;base64,{data}")
    }]);
    let json = serde_json::to_vec(&tree.root).unwrap();
    let document = secateur_gltf::Document::from_bytes("a.gltf", json, None).unwrap();
    let tree = document.into_tree(&[]).unwrap();
    assert_eq!(tree.foliage().leaves().len(), 2);
}

#[test]
fn json_with_a_file_of_its_own_folder() {
    let folder = tempfile::tempdir().unwrap();
    let mut tree = SmallTree::squares();
    std::fs::create_dir(folder.path().join("data")).unwrap();
    std::fs::write(folder.path().join("data/my leaves.bin"), &tree.bytes).unwrap();
    tree.root["buffers"] = json!([{
        "byteLength": tree.bytes.len(), "uri": "data/my%20leaves.bin"
    }]);
    let path = folder.path().join("tree.gltf");
    // A byte order mark is not JSON, but some tools write one.
    let mut json = b"\xef\xbb\xbf".to_vec();
    json.extend(serde_json::to_vec(&tree.root).unwrap());
    std::fs::write(&path, json).unwrap();
    let tree = secateur_gltf::Tree::open(&path, &[]).unwrap();
    assert_eq!(tree.foliage().leaves().len(), 2);
}

/// As [`assert_two_squares`], whichever comes first: the decoder numbers them.
#[track_caller]
fn assert_squares_in_any_order(tree: &SmallTree) {
    let tree = tree.tree();
    let mut heights: Vec<f64> = centres(&tree).iter().map(|centre| centre.z).collect();
    heights.sort_by(f64::total_cmp);
    assert_eq!(heights, [0.0, 2.0]);
    let mut areas = tree.foliage().leaves().iter().map(|leaf| leaf.area());
    assert!(areas.all(|area| area == 1.0));
    assert_eq!(tree.triangle_count(), 4);
}

#[test]
fn draco_by_either_method() {
    for stream in DRACO_STREAMS {
        let tree = draco(stream);
        assert_squares_in_any_order(&tree);
        let document = tree.document();
        let surfaces = document.surfaces(&[]).unwrap();
        let surface = &surfaces[0].0;
        for (position, uv) in surface.positions.iter().zip(&surface.uvs) {
            assert_eq!([position.x as f32, position.y as f32], uv.to_array());
        }
        // Nothing speaks of the extension any more, and the stream is gone.
        let root = document.json();
        assert!(!root.to_string().contains("draco"), "{root}");
        assert_eq!(root["bufferViews"].as_array().unwrap().len(), 4);
        // Faces, a strip by its mode or without indices, are what the stream says.
        let strip = tree.clone().set("/meshes/0/primitives/0/mode", json!(5));
        assert_squares_in_any_order(&strip.set("/accessors/0/count", json!(14)));
        let bare = tree.without("/meshes/0/primitives/0/indices");
        assert_squares_in_any_order(&bare.set("/accessors/1/count", json!(12)));
    }
}

/// The corners of all triangles, in thousandths, whatever their order.
fn sorted_corners(document: &Document) -> Vec<Vec<[i64; 3]>> {
    let mut triangles = Vec::new();
    for (surface, _) in document.surfaces(&[]).unwrap() {
        for corners in &surface.triangles {
            let corner = |corner: &u32| {
                let at = surface.positions[*corner as usize].to_array();
                at.map(|value| (value * 1000.0).round() as i64)
            };
            let mut corners: Vec<[i64; 3]> = corners.iter().map(corner).collect();
            corners.sort_unstable();
            triangles.push(corners);
        }
    }
    triangles.sort_unstable();
    triangles
}

/// What is written of compressed squares is compressed, and has the triangles that a level without compression has.
#[test]
fn draco_is_written_compressed() {
    for stream in DRACO_STREAMS {
        let tree: Tree = draco(stream).tree();
        let mut lod = Lod::original(2);
        lod.remove(LeafId::from_index(0));
        assert!(tree.inspection().notes.is_empty());
        let glb = tree.lod_to_bytes(&lod).unwrap();
        let level = Document::from_bytes("level.glb", glb, None).unwrap();
        assert!(level.inspect(&[]).notes.is_empty());
        let plain = tree.lod_document(&lod).unwrap();
        assert_eq!(sorted_corners(&level), sorted_corners(&plain));
    }
}

/// Two primitives of one stream share its accessors, or have some of their own.
#[test]
fn draco_streams_are_shared() {
    for stream in DRACO_STREAMS {
        let mut tree = draco(stream);
        let primitive = tree.root["meshes"][0]["primitives"][0].clone();
        tree.primitive(primitive.clone());
        let mut own = primitive;
        let accessor = tree.root["accessors"][1].clone();
        own["attributes"]["POSITION"] = tree.append("accessors", accessor).into();
        tree.primitive(own);
        let document = tree.document();
        let accessors = document.json()["accessors"].as_array().unwrap();
        assert_eq!(accessors.len(), 5);
        assert!(
            accessors
                .iter()
                .all(|accessor| accessor["bufferView"].is_u64())
        );
        assert_eq!(document.surfaces(&[]).unwrap().len(), 3);
    }
}

/// Where everything is there without the stream, too, it is not decoded.
#[test]
fn draco_with_a_fallback() {
    let extension = json!({"KHR_draco_mesh_compression": {
        "bufferView": 0, "attributes": {"POSITION": 0}
    }});
    let tree = SmallTree::squares().set("/meshes/0/primitives/0/extensions", extension);
    assert_two_squares(&tree);
    assert_eq!(
        tree.document().json()["meshes"][0]["primitives"][0].get("extensions"),
        None::<&Value>
    );
}
