//! Skeletons as any file may have them: what a fuzzer starts from, and what is
//! said of those that cannot be.

use std::path::Path;

use secateur_gltf::{Document, GltfError};
use secateur_model::PlantSkeleton;
use serde_json::{Value, json};

use crate::small_tree::SmallTree;

/// The two squares on a stem of three segments: the second and the third are
/// numbers 2 and 3, so that parents and leaves have something to miss.
struct Stem {
    parents: [[u16; 2]; 3],
    continues: Vec<u8>,
    sides: [u8; 3],
    ends: [f32; 9],
    radii: [f32; 6],
    leaves: Vec<[u16; 2]>,
}

impl Default for Stem {
    fn default() -> Self {
        Self {
            parents: [[0, 0], [1, 0], [1, 0]],
            continues: vec![0, 1, 0],
            sides: [5, 4, 3],
            ends: [0.0, 1.0, 0.0, 0.0, 2.0, 0.0, 1.0, 1.5, 2.0],
            radii: [0.2, 0.1, 0.1, 0.05, 0.05, 0.0],
            leaves: vec![[2, 0], [3, 0]],
        }
    }
}

impl Stem {
    fn tree(&self) -> SmallTree {
        let mut tree = SmallTree::squares();
        let starts = [0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 0.0];
        let accessors = json!({
            "segment_parent": tree.shorts("VEC2", self.parents.as_flattened()),
            "segment_continues": tree.accessor("SCALAR", 5121, self.continues.len(), &self.continues),
            "segment_sides": tree.accessor("SCALAR", 5121, 3, &self.sides),
            "segment_start": tree.floats("VEC3", &starts),
            "segment_end": tree.floats("VEC3", &self.ends),
            "segment_radius": tree.floats("VEC2", &self.radii),
            "leaf_segment": tree.shorts("VEC2", self.leaves.as_flattened()),
        });
        tree.root["extras"] = json!({"secateur_skeleton": {"version": 1, "accessors": accessors}});
        tree
    }
}

/// File names, trees, and what is said of those whose names start with `broken`.
fn all() -> Vec<(&'static str, SmallTree, &'static str)> {
    let stem = Stem::default().tree();
    let of = |path: &str| {
        let path = format!("/extras/secateur_skeleton/accessors/{path}");
        stem.root.pointer(&path).unwrap().as_u64().unwrap()
    };
    let skeleton = "/extras/secateur_skeleton";
    let changed = |path: &str, value: Value| stem.clone().set(path, value);
    let accessor = |name: &str, key: &str, value: Value| {
        changed(&format!("/accessors/{}/{key}", of(name)), value)
    };
    // Zeros of a count that no file of this size holds.
    let endless = |name: &str| {
        accessor(name, "count", json!(4_000_000_000u32))
            .without(&format!("/accessors/{}/bufferView", of(name)))
    };
    let bent = |change: fn(&mut Stem)| {
        let mut stem = Stem::default();
        change(&mut stem);
        stem.tree()
    };
    vec![
        ("stem.glb", stem.clone(), ""),
        (
            "two_stems.glb",
            bent(|s| (s.parents[1], s.leaves[1]) = ([0, 0], [0, 0])),
            "",
        ),
        (
            "broken_parent_later.glb",
            bent(|s| s.parents[1] = [3, 0]),
            "segment 1 of the skeleton grows from one that is not before it",
        ),
        (
            "broken_parent_itself.glb",
            bent(|s| s.parents[2] = [3, 0]),
            "segment 2 of the skeleton grows from one that is not before it",
        ),
        (
            "broken_parent_far.glb",
            bent(|s| s.parents[2] = [0xffff; 2]),
            "segment 2 of the skeleton grows from one that is not before it",
        ),
        (
            "broken_leaf_beyond.glb",
            bent(|s| s.leaves[1] = [4, 0]),
            "leaf 1 of the skeleton grows on segment 3, of 3",
        ),
        (
            "broken_leaf_far.glb",
            bent(|s| s.leaves[0] = [2, 1]),
            "leaf 0 of the skeleton grows on segment 65537, of 3",
        ),
        (
            "broken_leaf_missing.glb",
            bent(|s| s.leaves.truncate(1)),
            "the skeleton knows 1 leaves where the foliage has 2",
        ),
        (
            "broken_end_nan.glb",
            bent(|s| s.ends[4] = f32::NAN),
            "segment 1 of the skeleton has a number out of range",
        ),
        (
            "broken_end_infinite.glb",
            bent(|s| s.ends[0] = f32::NEG_INFINITY),
            "segment 0 of the skeleton has a number out of range",
        ),
        (
            "broken_radius_negative.glb",
            bent(|s| s.radii[3] = -0.01),
            "segment 1 of the skeleton has a number out of range",
        ),
        (
            "broken_sides_few.glb",
            bent(|s| s.sides[0] = 2),
            "segment 0 of the skeleton has a number out of range",
        ),
        (
            "broken_sides_many.glb",
            bent(|s| s.sides[2] = 65),
            "segment 2 of the skeleton has a number out of range",
        ),
        (
            "broken_count_differs.glb",
            bent(|s| s.continues.push(1)),
            "segment_continues has 4 elements where segment_parent has 3",
        ),
        (
            "broken_count_beyond.glb",
            accessor("segment_parent", "count", json!(4)),
            "asks for bytes 0..16 of bufferViews[2], which has 12",
        ),
        (
            "broken_endless_segments.glb",
            endless("segment_parent"),
            "asks for 4000000000 elements of 4 bytes",
        ),
        (
            "broken_endless_leaves.glb",
            endless("leaf_segment"),
            "asks for 4000000000 elements of 4 bytes",
        ),
        (
            "broken_count_negative.glb",
            accessor("segment_sides", "count", json!(-3)),
            "`count`",
        ),
        (
            "broken_shape.glb",
            accessor("segment_radius", "type", json!("SCALAR")),
            "is SCALAR of FLOAT, which cannot be used as segment_radius",
        ),
        (
            "broken_component.glb",
            accessor("segment_parent", "componentType", json!(5122)),
            "is VEC2 of SHORT, which cannot be used as segment_parent",
        ),
        (
            "broken_normalized.glb",
            accessor("leaf_segment", "normalized", json!(true)),
            "which cannot be used as leaf_segment",
        ),
        (
            "broken_index_text.glb",
            changed(&format!("{skeleton}/accessors/leaf_segment"), json!("two")),
            "`leaf_segment`",
        ),
        (
            "broken_index_beyond.glb",
            changed(
                &format!("{skeleton}/accessors/segment_end"),
                json!(1u64 << 40),
            ),
            "`accessors[1099511627776]` does not exist",
        ),
        (
            "broken_accessors_list.glb",
            changed(&format!("{skeleton}/accessors"), json!([2, 3])),
            "has no `segment_parent`",
        ),
        (
            "broken_version_text.glb",
            changed(&format!("{skeleton}/version"), json!("1")),
            "`version`",
        ),
        (
            "broken_version_missing.glb",
            stem.clone().without(&format!("{skeleton}/version")),
            "`version` is missing, not 1",
        ),
        (
            "broken_null.glb",
            changed(skeleton, Value::Null),
            "`version`",
        ),
        (
            "broken_number.glb",
            changed(skeleton, json!(7)),
            "`version`",
        ),
    ]
}

fn read(bytes: Vec<u8>) -> Result<Option<PlantSkeleton>, GltfError> {
    let document = Document::from_bytes("fuzz.glb", bytes, None)?;
    document
        .into_tree(&["material:*".parse().unwrap()])?
        .skeleton()
}

/// The fuzzer starts from the very files that these are. When there is a new one,
/// run this with `SECATEUR_WRITE_SEEDS=1` to write them.
#[test]
fn skeletons_that_cannot_be_are_one_sentence() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fuzz/corpus/skeleton");
    let writes = std::env::var_os("SECATEUR_WRITE_SEEDS").is_some();
    let mut wrong = Vec::new();
    for (name, tree, says) in all() {
        let (path, bytes) = (folder.join(name), tree.glb());
        if writes {
            std::fs::create_dir_all(&folder).unwrap();
            std::fs::write(&path, &bytes).unwrap();
        }
        let kept = std::fs::read(&path).unwrap_or_default();
        assert!(kept == bytes, "{} is not what is made now", path.display());
        let said = read(bytes).map_or_else(|e| e.to_string(), |s| format!("{}", s.is_some()));
        let is_said = match says {
            "" => said == "true",
            says => said.contains(says) && !said.contains('\n') && said.len() < 200,
        };
        if !is_said {
            wrong.push(format!("{name}: {said}"));
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
    let kept = std::fs::read_dir(&folder).unwrap().count();
    assert_eq!(kept, all().len(), "files that no one makes any more");
}

#[test]
fn both_halves_of_a_number_count() {
    let skeleton = read(Stem::default().tree().glb()).unwrap().unwrap();
    let parents = skeleton
        .segments
        .iter()
        .map(|s| s.parent.map(|p| p.index()));
    assert_eq!(parents.collect::<Vec<_>>(), [None, Some(0), Some(0)]);
    let leaves = skeleton.leaf_segments.iter().map(|s| s.map(|s| s.index()));
    assert_eq!(leaves.collect::<Vec<_>>(), [Some(1), Some(2)]);
}
