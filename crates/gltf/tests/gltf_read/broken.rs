//! What bad files get: one sentence each, and no more memory than they bring.

mod accessors;
mod files;

use secateur_gltf::Document;
use secateur_model::Memory;
use serde_json::{Value, json};

use crate::seeds::{DRACO_STREAMS, draco};
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
    // Two million translations of a node, three bytes each.
    let mut tree = SmallTree::squares();
    let many = tree.accessor("VEC3", 5120, 2_000_000, &vec![0; 6_000_000]);
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
fn draco_that_lies() {
    for stream in DRACO_STREAMS {
        let tree = draco(stream);
        let place = "small.glb: meshes[0].primitives[0]: ";
        let decode = "decode it first: npx @gltf-transform/cli copy IN.glb OUT.glb";
        let assert_refused = |tree: &SmallTree, why: &str| {
            let error = tree.error();
            assert!(error.starts_with(place) && error.contains(why), "{error}");
        };
        for end in 0..stream.len() - 1 {
            let error = draco(&stream[..end]).error();
            assert!(
                error.starts_with(place) && error.ends_with(decode),
                "{error}"
            );
        }
        // Fewer triangles than the stream has, and more than the file could hold.
        assert_refused(
            &tree.clone().set("/accessors/0/count", json!(9)),
            "cannot be decoded",
        );
        let many = tree
            .clone()
            .set("/accessors/0/count", json!(3_000_000_000u64));
        assert_refused(&many, "holds more than 16");
        let wide = tree.clone().set("/accessors/2/type", json!("VEC3"));
        assert_refused(
            &wide,
            "is accessors[2] (VEC3 of FLOAT), which cannot be used as TEXCOORD_0",
        );
        let whole = tree.clone().set("/accessors/1/componentType", json!(5122));
        assert_refused(&whole, "cannot be used as POSITION of its Draco data");
        let extension = "/meshes/0/primitives/0/extensions/KHR_draco_mesh_compression";
        let stray = tree
            .clone()
            .set(&format!("{extension}/attributes/POSITION"), json!(9));
        assert_refused(&stray, "cannot be used as POSITION of its Draco data");
        // Within what the file's size allows, but not within the memory.
        let many = tree.clone().set("/accessors/0/count", json!(300_000));
        let memory = Memory::Bytes(4 << 20);
        let read = Document::from_bytes_within("small.glb", many.glb(), None, memory);
        let error = read.expect_err("there is no memory for it").to_string();
        let says = format!("{place}its 100000 compressed triangles would take 9.2 MiB of memory");
        assert!(error.starts_with(&says), "{error}");
        let gone = tree.without(&format!("{extension}/bufferView"));
        assert_refused(&gone, "has no `bufferView`");
    }
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
