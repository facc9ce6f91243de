//! Real trees, where ../shared is there.

use crate::program::{Bench, shared_tree};

#[test]
fn real_trees_are_simplified_without_naming_their_foliage() {
    for (name, leaves) in [
        ("ez_bush2.glb", 704),
        ("quat_commontree_1.glb", 960),
        ("sap_birch_hex_9k.glb", 9459),
        ("ez_oak_20k.glb", 20_160),
    ] {
        let Some(tree) = shared_tree(name) else {
            continue;
        };
        let bench = Bench::new();
        let tree = tree.to_str().unwrap();
        bench
            .simplify(&[
                tree, "-o", "out.glb", "--ratio", "0.9", "--report", "r.json",
            ])
            .succeeded();
        let report = bench.json("r.json");
        assert_eq!(report["leaves"]["original"], leaves, "{name}");
        let expected = (f64::from(leaves) * 0.9).round();
        assert_eq!(report["leaves"]["final"], expected as u64, "{name}");
        let again = bench.run(&["inspect", "out.glb", "--format", "json"]);
        let again: serde_json::Value = serde_json::from_str(&again.succeeded().stdout).unwrap();
        assert_eq!(again["foliage"]["leaves"], expected as u64, "{name}");
    }
}
