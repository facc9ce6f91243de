//! Accessors that name what is not there or is none.

use super::*;

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
        "accessors[0]: asks for 1000000000 elements of 12 bytes; at most 73216 bytes are \
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
