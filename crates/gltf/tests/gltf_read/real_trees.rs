//! Trees made by other people's tools, where they are at hand.

use std::path::PathBuf;

use secateur_gltf::{Document, TakenFor, Tree};

/// A tree of the shared folder, or `None`, said aloud, where it isn't there.
fn shared_tree(name: &str) -> Option<PathBuf> {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared/trees");
    let path = PathBuf::from(folder).join(name);
    if path.is_file() {
        return Some(path);
    }
    eprintln!("SKIPPED: ../shared/trees/{name} is not there");
    None
}

/// File, leaves, triangles of a leaf, masks, triangles of wood.
const TREES: [(&str, usize, f64, usize, u64); 5] = [
    ("ez_bush2.glb", 704, 2.0, 1, 3352),
    ("ez_oak_20k.glb", 20_160, 2.0, 1, 12_006),
    ("sap_birch_hex_9k.glb", 9_459, 4.0, 0, 47_024),
    ("sap_pine_needles_48k.glb", 48_607, 2.0, 0, 7_528),
    ("quat_commontree_1.glb", 960, 2.0, 1, 4_345),
];

#[test]
fn leaves_of_real_trees_are_counted() {
    for (name, leaves, triangles, masks, wood) in TREES {
        let Some(path) = shared_tree(name) else {
            continue;
        };
        let tree = Tree::open(&path, &[]).unwrap();
        let facts = tree.inspection().foliage.as_ref().unwrap();
        assert_eq!(tree.foliage().leaves().len(), leaves, "{name}");
        assert_eq!(facts.triangles_per_leaf.min, triangles, "{name}");
        assert_eq!(facts.triangles_per_leaf.max, triangles, "{name}");
        assert_eq!(tree.foliage().cutouts().len(), masks, "{name}");
        assert_eq!(tree.wood_triangle_count(), wood, "{name}");
    }
}

#[test]
fn the_foliage_of_real_trees_is_found_without_their_names() {
    for (name, leaves, ..) in TREES {
        let Some(path) = shared_tree(name) else {
            continue;
        };
        let bytes = without_names(&std::fs::read(path).unwrap());
        let document = Document::from_bytes(name, bytes, None).unwrap();
        let inspection = document.inspect(&[]);
        let taken = |what| {
            let primitives = inspection.primitives.iter();
            primitives.filter(|p| p.taken_for == what).count()
        };
        assert_eq!(taken(TakenFor::Foliage), 1, "{inspection}");
        assert_eq!(taken(TakenFor::Wood), 1, "{inspection}");
        assert_eq!(inspection.foliage.unwrap().leaves, leaves as u64);
    }
}

/// A GLB with every `name` taken out of its JSON.
fn without_names(glb: &[u8]) -> Vec<u8> {
    let length = u32::from_le_bytes(glb[12..16].try_into().unwrap()) as usize;
    let (json, rest) = glb[20..].split_at(length);
    let mut root: serde_json::Value = serde_json::from_slice(json).unwrap();
    for list in root.as_object_mut().unwrap().values_mut() {
        for entry in list.as_array_mut().into_iter().flatten() {
            if let Some(entry) = entry.as_object_mut() {
                entry.remove("name");
            }
        }
    }
    let mut json = serde_json::to_vec(&root).unwrap();
    json.resize(json.len().next_multiple_of(4), b' ');
    let total = 20 + json.len() + rest.len();
    let mut out = b"glTF\x02\0\0\0".to_vec();
    out.extend((total as u32).to_le_bytes());
    out.extend((json.len() as u32).to_le_bytes());
    out.extend(b"JSON");
    out.extend(json);
    out.extend(rest);
    out
}
