//! What bad files get: one sentence each, and no more memory than they bring.

use secateur_model::gltf::Document;
use serde_json::{Value, json};

use crate::small_tree::SmallTree;

/// The sentence about these bytes.
fn refused(bytes: &[u8]) -> String {
    let read = Document::from_bytes("small.glb", bytes.to_vec(), None);
    read.expect_err("a broken file is refused").to_string()
}

#[track_caller]
fn assert_error(tree: &SmallTree, expected: &str) {
    assert_eq!(tree.error(), format!("small.glb: {expected}"));
}

/// The squares with one value of the JSON replaced.
fn with(path: &str, value: Value) -> SmallTree {
    SmallTree::squares().set(path, value)
}

#[test]
fn files_that_are_no_gltf() {
    assert_eq!(refused(b""), "small.glb: is not glTF: it is empty");
    assert!(
        refused(b"\x89PNG\r\n").starts_with("small.glb: is not glTF: its JSON cannot be parsed")
    );
    assert_eq!(
        refused(b"{}"),
        "small.glb: is not glTF: its JSON has no `asset`"
    );
    assert_eq!(
        refused(b"[1]"),
        "small.glb: is not glTF: its JSON has no `asset`"
    );
    let deep = "[".repeat(100_000);
    assert!(refused(deep.as_bytes()).contains("recursion limit"));
    let huge = br#"{"asset": {"version": "2.0"}, "scene": 1e999}"#;
    assert!(refused(huge).contains("number out of range"));
}

#[test]
fn damaged_containers() {
    let glb = SmallTree::squares().glb();
    let total = glb.len();
    assert_eq!(
        refused(&glb[..total - 1]),
        format!(
            "small.glb: is truncated: its header speaks of {total} bytes, it has {}",
            total - 1
        )
    );
    assert_eq!(
        refused(&glb[..7]),
        "small.glb: is truncated: its header speaks of 12 bytes, it has 7"
    );
    let with_word = |at: usize, word: u32| {
        let mut glb = glb.clone();
        glb[at..at + 4].copy_from_slice(&word.to_le_bytes());
        refused(&glb)
    };
    assert_eq!(
        with_word(4, 1),
        "small.glb: is glTF 1; only version 2.0 can be read"
    );
    assert_eq!(
        with_word(8, 3),
        "small.glb: is a damaged GLB: its header gives a length of 3 bytes"
    );
    assert!(with_word(12, u32::MAX).starts_with("small.glb: is a damaged GLB: "));
    assert!(with_word(16, 0).starts_with("small.glb: is a damaged GLB: "));
}

#[test]
fn versions_and_extensions() {
    assert_error(
        &with("/asset/version", json!("1.0")),
        "is glTF 1.0; only version 2.0 can be read",
    );
    assert_error(
        &with("/asset/minVersion", json!("2.1")),
        "is glTF 2.1; only version 2.0 can be read",
    );
    assert_error(
        &with("/asset/version", json!(2)),
        "`version` is 2, not a string",
    );
    assert_error(
        &with(
            "/extensionsRequired",
            json!(["KHR_materials_unlit", "ACME_leaves"]),
        ),
        "needs the extension ACME_leaves, which is not supported",
    );
    assert_error(
        &with("/extensionsRequired", json!(["KHR_draco_mesh_compression"])),
        "needs the extension KHR_draco_mesh_compression, which is not supported; decode it \
         first: npx @gltf-transform/cli copy IN.glb OUT.glb",
    );
}

#[test]
fn buffers_that_are_not_there() {
    let buffer = |json: Value| with("/buffers", json!([json]));
    assert_error(
        &buffer(json!({"byteLength": 9, "uri": "leaves.bin"})),
        "buffers[0]: the file `leaves.bin` cannot be read: the glTF itself is in no folder",
    );
    assert_error(
        &buffer(json!({"byteLength": 4096})),
        "buffers[0]: says it has 4096 bytes; only 120 are there",
    );
    assert_error(&buffer(json!({})), "buffers[0]: has no `byteLength`");
    assert_error(
        &with(
            "/buffers",
            json!([{"byteLength": 120}, {"byteLength": 200}]),
        )
        .set("/bufferViews/0/buffer", json!(1)),
        "bufferViews[0]: has neither a URI nor a GLB chunk to take its bytes from",
    );
    assert_error(
        &with("/bufferViews/0/buffer", json!(7)),
        "bufferViews[0]: `buffers[7]` does not exist: there are 1",
    );
}

#[test]
fn uris_that_leave_the_folder() {
    for uri in [
        "../leaves.bin",
        "a/../../leaves.bin",
        "%2e%2e/leaves.bin",
        "..%5cleaves.bin",
        "a\\..\\..\\leaves.bin",
        "/etc/passwd",
        "%2Fetc/passwd",
        "\\\\server\\leaves.bin",
        "file:///etc/passwd",
        "FILE:leaves.bin",
        "https://example.com/leaves.bin",
        "C:/leaves.bin",
        "c%3A/leaves.bin",
    ] {
        let tree = with("/buffers", json!([{"byteLength": 120, "uri": uri}]));
        assert_error(
            &tree,
            &format!(
                "buffers[0]: the URI `{uri}` is not a file in the glTF's own folder; put the \
                 file there and name it without a path outside"
            ),
        );
    }
}

#[test]
fn uris_that_are_none() {
    for (uri, why) in [
        (
            "leaves%2",
            "a `%` is not followed by two hexadecimal digits",
        ),
        (
            "%zzleaves",
            "a `%` is not followed by two hexadecimal digits",
        ),
        ("%ff%fe", "it is not UTF-8"),
        ("a%00b", "it has a control character"),
        ("", "it is empty"),
        (
            "data:application/octet-stream;base64",
            "a data URI has a comma before its data",
        ),
    ] {
        let tree = with("/buffers", json!([{"byteLength": 120, "uri": uri}]));
        assert_error(
            &tree,
            &format!("buffers[0]: the URI `{uri}` is malformed: {why}"),
        );
    }
    let bad = with(
        "/buffers",
        json!([{"byteLength": 120, "uri": "data:;base64,A*B="}]),
    );
    assert!(bad.error().contains("its base64 is damaged"));
}

#[test]
fn accessors_out_of_range() {
    assert_error(
        &with("/accessors/0/count", json!(9)),
        "accessors[0]: asks for bytes 0..108 of bufferViews[0], which has 96",
    );
    assert_error(
        &with("/accessors/0/count", json!(4_000_000_000_000_000u64)),
        "accessors[0]: asks for bytes 0..48000000000000000 of bufferViews[0], which has 96",
    );
    assert_error(
        &with("/accessors/0/byteOffset", json!(4)),
        "accessors[0]: asks for bytes 4..100 of bufferViews[0], which has 96",
    );
    assert_error(
        &with("/bufferViews/0/byteLength", json!(9_007_199_254_740_991u64)),
        "bufferViews[0]: asks for bytes 0..9007199254740991 of buffers[0], which has 120",
    );
    assert_error(
        &with("/bufferViews/0/byteOffset", json!(100)),
        "bufferViews[0]: asks for bytes 100..196 of buffers[0], which has 120",
    );
    assert_error(
        &with("/accessors/0/bufferView", json!(9)),
        "accessors[0]: `bufferViews[9]` does not exist: there are 2",
    );
    assert_error(
        &with("/meshes/0/primitives/0/attributes/POSITION", json!(9)),
        "`accessors[9]` does not exist: there are 2",
    );
}

#[test]
fn strides_that_do_not_suit() {
    for stride in [0, 11, 253, 65_536] {
        assert_error(
            &with("/bufferViews/0/byteStride", json!(stride)),
            &format!(
                "bufferViews[0]: `byteStride` is {stride}, elements of 12 bytes need 12 to 252"
            ),
        );
    }
}

#[test]
fn accessors_without_data_are_bounded() {
    // A few hundred bytes that ask for gigabytes.
    let tree = with("/accessors/0/count", json!(1_000_000_000)).without("/accessors/0/bufferView");
    assert!(tree.glb().len() < 1024);
    assert_error(
        &tree,
        "accessors[0]: asks for 1000000000 elements of 12 bytes; at most 67108864 bytes are \
         allowed without data in the file",
    );
}

#[test]
fn numbers_that_are_none() {
    for value in [
        json!(-1),
        json!(1.5),
        json!("8"),
        json!(1e300),
        json!(18_446_744_073_709_551_615u64),
        json!(null),
    ] {
        let found = value.to_string();
        assert_error(
            &with("/accessors/0/count", value),
            &format!("accessors[0]: `count` is {found}, not a whole number from 0 to 2^53"),
        );
    }
    assert_error(
        &with("/nodes/0/scale", json!([1, "x", 1])),
        "nodes[0] \"crown\": `scale` is [1,\"x\",1], not a list of 3 numbers",
    );
    assert_error(
        &with("/nodes/0/matrix", json!([1, 2])),
        "nodes[0] \"crown\": `matrix` is [1,2], not a list of 16 numbers",
    );
}

#[test]
fn types_that_do_not_suit() {
    assert_error(
        &with("/accessors/0/type", json!("VEC2")),
        "meshes[0].primitives[0]: is accessors[0] (VEC2 of FLOAT), which cannot be used as \
         POSITION",
    );
    assert_error(
        &with("/meshes/0/primitives/0/indices", json!(0)),
        "meshes[0].primitives[0]: is accessors[0] (VEC3 of FLOAT), which cannot be used as \
         indices",
    );
    assert_error(
        &with("/accessors/0/componentType", json!(5130)),
        "accessors[0]: `componentType` is 5130, not one of 5120 to 5123, 5125 and 5126",
    );
    assert_error(
        &with("/meshes/0/primitives/0/mode", json!(7)),
        "meshes[0].primitives[0]: `mode` is 7, not 0 to 6",
    );
}

#[test]
fn indices_that_name_no_vertex() {
    let mut tree = SmallTree::squares();
    // The third index, after 96 bytes of positions.
    tree.bytes[100] = 200;
    assert_error(
        &tree,
        "meshes[0].primitives[0]: index 2 names vertex 200, of 8",
    );
}

#[test]
fn sparse_indices() {
    let sparse = |indices: [u16; 2]| {
        let mut tree = SmallTree::squares();
        let bytes: Vec<u8> = indices.iter().flat_map(|i| i.to_le_bytes()).collect();
        let (indices, values) = (tree.view(&bytes), tree.view(&[0; 24]));
        tree.set(
            "/accessors/0/sparse",
            json!({
                "count": 2,
                "indices": {"bufferView": indices, "componentType": 5123},
                "values": {"bufferView": values},
            }),
        )
    };
    for (indices, bad) in [([1, 8], 8), ([3, 3], 3), ([5, 2], 2)] {
        assert_error(
            &sparse(indices),
            &format!(
                "accessors[0].sparse: sparse index {bad} does not come after the one before it, \
                 or is outside the accessor's 8 elements"
            ),
        );
    }
    assert_error(
        &sparse([1, 2]).set("/accessors/0/sparse/count", json!(1_000_000_000)),
        "accessors[0].sparse: asks for bytes 0..2000000000 of bufferViews[2], which has 4",
    );
    assert_error(
        &sparse([1, 2]).set("/accessors/0/sparse/indices/componentType", json!(5126)),
        "accessors[0].sparse: is SCALAR of FLOAT, which cannot be used as sparse indices",
    );
}

#[test]
fn positions_that_are_not_finite() {
    for bad in [f32::NAN, f32::INFINITY] {
        let mut tree = SmallTree::squares();
        tree.bytes[3 * 12..3 * 12 + 4].copy_from_slice(&bad.to_le_bytes());
        assert_error(&tree, "accessors[0]: position 3 is not a finite number");
    }
    assert_error(
        &with("/nodes/0/scale", json!([1e300, 1e300, 1e300]))
            .set("/nodes/0/translation", json!([1e308, 0, 0]))
            .set(
                "/nodes",
                json!([
                    {"mesh": 0, "name": "crown", "matrix":
                        [1e308,0,0,0, 1e308,1,0,0, 0,0,1,0, 0,0,0,1]},
                ]),
            ),
        "meshes[0].primitives[0] at nodes[0] \"crown\": the world position of vertex 2 is not a \
         finite number",
    );
}

#[test]
fn hierarchies_that_are_no_trees() {
    let twice = "is the child of two nodes, or of itself";
    let nodes = |nodes: Value| with("/nodes", nodes);
    assert_error(
        &nodes(json!([{"mesh": 0, "children": [0]}])),
        &format!("nodes[0]: {twice}"),
    );
    assert_error(
        &nodes(json!([{"children": [1, 2]}, {"children": [2]}, {"mesh": 0}])),
        &format!("nodes[2]: {twice}"),
    );
    let chain: Vec<Value> = (1..=5000).map(|k| json!({"children": [k]})).collect();
    assert_error(
        &nodes(json!(chain)),
        "nodes[1024]: lies deeper than 1024 nodes",
    );
    assert_error(
        &nodes(json!([{"children": [3]}])),
        "`nodes[3]` does not exist: there are 1",
    );
}

#[test]
fn instances_without_end_are_refused_before_they_are_made() {
    // Zeros stand for five million translations of a node.
    let mut tree = SmallTree::squares();
    let many = tree.append(
        "accessors",
        json!({"type": "VEC3", "componentType": 5126, "count": 5_000_000}),
    );
    let attributes = json!({"attributes": {"TRANSLATION": many}});
    let tree = tree.set(
        "/nodes/0/extensions",
        json!({"EXT_mesh_gpu_instancing": attributes}),
    );
    assert_error(
        &tree,
        "nodes[0] \"crown\": holds more than 1048576 parts (nodes x instances x primitives)",
    );
    let mut uneven = SmallTree::squares();
    let one = uneven.floats("VEC3", &[0.0; 3]);
    let two = uneven.floats("VEC3", &[0.0; 6]);
    let uneven = uneven.set(
        "/nodes/0/extensions",
        json!({"EXT_mesh_gpu_instancing": {"attributes": {"TRANSLATION": one, "SCALE": two}}}),
    );
    assert_error(
        &uneven,
        "nodes[0] \"crown\".EXT_mesh_gpu_instancing: SCALE has 2 elements where the attribute \
         before it has 1",
    );
}

#[test]
fn triangles_without_end_are_refused_before_they_are_made() {
    // A thousand nodes with fifty instances each of a mesh of 1,800 triangles.
    let mut tree = SmallTree::empty();
    let positions = tree.floats("VEC3", &[0.0; 3 * 5400]);
    tree.primitive(json!({"attributes": {"POSITION": positions}, "material": 0}));
    let places = tree.floats("VEC3", &[0.0; 150]);
    let node = json!({"mesh": 0, "extensions": {
        "EXT_mesh_gpu_instancing": {"attributes": {"TRANSLATION": places}}
    }});
    let tree = tree
        .set("/nodes", json!(vec![node; 1000]))
        .set("/scenes/0/nodes", json!((0..1000).collect::<Vec<_>>()));
    assert!(
        tree.error().ends_with("holds more than 67108864 triangles"),
        "{}",
        tree.error()
    );
}

#[test]
fn image_ranges_out_of_the_buffer() {
    let mut tree = SmallTree::squares();
    let view = tree.append(
        "bufferViews",
        json!({"buffer": 0, "byteOffset": 119, "byteLength": 100}),
    );
    let tree = tree
        .set(
            "/images",
            json!([{"bufferView": view, "mimeType": "image/png"}]),
        )
        .set("/textures", json!([{"source": 0}]))
        .set(
            "/materials/0",
            json!({
                "name": "leaf", "alphaMode": "MASK",
                "pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}
            }),
        );
    assert_error(
        &tree,
        "bufferViews[2]: asks for bytes 119..219 of buffers[0], which has 120",
    );
    let foreign = tree.clone().set("/images/0", json!({"uri": "../leaf.png"}));
    assert!(
        foreign
            .error()
            .contains("images[0]: the URI `../leaf.png` is not a file in")
    );
    assert_error(
        &tree.set("/textures/0/source", json!(4)),
        "materials[0] \"leaf\": `images[4]` does not exist: there are 1",
    );
}

#[test]
fn compressed_views_that_ask_for_too_much_or_are_damaged() {
    let compressed = |json: Value, length: u64| {
        let mut tree = SmallTree::squares();
        let view = tree.append(
            "bufferViews",
            json!({
                "buffer": 0, "byteLength": length,
                "extensions": {"EXT_meshopt_compression": json}
            }),
        );
        tree.set("/accessors/0/bufferView", json!(view))
    };
    let stream = |count: u64, stride: u64| {
        json!({
            "buffer": 0, "byteLength": 120, "byteStride": stride, "count": count, "mode": "ATTRIBUTES"
        })
    };
    let damaged = "bufferViews[2]: its meshopt-compressed data cannot be decoded: ";
    assert_error(
        &compressed(stream(8, 12), 96),
        &format!("{damaged}its first byte is of no known version"),
    );
    assert_error(
        &compressed(stream(9, 12), 96),
        &format!("{damaged}its count and stride don't make up the view's length"),
    );
    assert_error(
        &compressed(stream(8, 3), 24).set("/accessors/0/count", json!(2)),
        &format!("{damaged}its stride doesn't suit its mode or filter"),
    );
    let count = 1u64 << 40;
    assert!(
        compressed(stream(count, 12), 12 * count)
            .error()
            .starts_with("small.glb: bufferViews[2]: holds more than 16784896 decompressed bytes"),
        "{}",
        compressed(stream(count, 12), 12 * count).error()
    );
}

#[test]
fn draco_without_a_fallback() {
    let tree = with(
        "/meshes/0/primitives/0/extensions",
        json!({"KHR_draco_mesh_compression": {}}),
    )
    .without("/accessors/0/bufferView");
    assert!(
        tree.error()
            .starts_with("small.glb: meshes[0].primitives[0]: needs the extension KHR_draco"),
        "{}",
        tree.error()
    );
}

#[test]
fn an_empty_foliage() {
    let tree = with("/accessors/1/count", json!(0));
    assert_error(&tree, "its foliage has no triangle");
}

#[test]
fn texture_coordinates_of_another_count() {
    let mut tree = SmallTree::squares();
    let uvs = tree.floats("VEC2", &[0.0; 4]);
    let tree = tree
        .set("/meshes/0/primitives/0/attributes/TEXCOORD_0", json!(uvs))
        .set("/textures", json!([{}]))
        .set(
            "/materials/0/pbrMetallicRoughness",
            json!({"baseColorTexture": {"index": 0}}),
        );
    assert_error(
        &tree,
        "meshes[0].primitives[0]: TEXCOORD_0 has 2 elements where POSITION has 8",
    );
}

#[test]
fn inspecting_a_broken_file_tells_what_is_wrong() {
    let tree = with("/accessors/0/count", json!(9));
    let inspection = tree.document().inspect(&[]);
    assert_eq!(inspection.problem, Some(tree.error()));
    assert!(
        inspection
            .to_string()
            .contains("problem: small.glb: accessors[0]: asks for")
    );
}

#[test]
fn errors_tell_file_and_place_apart() {
    let tree = with("/accessors/0/count", json!(9));
    let error = tree.document().into_tree(&[]).unwrap_err();
    assert_eq!((error.file(), error.place()), ("small.glb", "accessors[0]"));
}

#[test]
fn a_missing_file_and_a_folder() {
    let folder = tempfile::tempdir().unwrap();
    for path in [folder.path().join("no.glb"), folder.path().to_owned()] {
        let sentence = Document::open(&path).unwrap_err().to_string();
        assert!(sentence.starts_with(&format!("{}: cannot be read: ", path.display())));
    }
}
