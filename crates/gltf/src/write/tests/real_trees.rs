//! Trees made by other people's tools.

use std::path::{Path, PathBuf};

use super::check::check_lod;
use super::validator::assert_valid;
use crate::{Document, Tree};
use secateur_model::LeafId;
use secateur_model::Lod;

/// The shared trees that are there.
pub(super) fn trees() -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/trees");
    let names = [
        "ez_bush2",
        "ez_oak_20k",
        "sap_birch_hex_9k",
        "sap_pine_needles_48k",
        "quat_commontree_1",
    ];
    let paths = names.map(|name| folder.join(name).with_extension("glb"));
    let there: Vec<PathBuf> = paths.into_iter().filter(|path| path.is_file()).collect();
    if there.is_empty() {
        eprintln!("SKIPPED: no trees in ../shared/trees");
    }
    there
}

fn open(path: &Path) -> Tree {
    Document::open(path).unwrap().into_tree(&[]).unwrap()
}

/// Every other leaf goes; of those left every third grows by half.
pub(super) fn half(tree: &Tree) -> Lod {
    let count = tree.foliage.leaves().len();
    let mut lod = Lod::original(count);
    for index in 0..count {
        let leaf = LeafId::from_index(index);
        if index % 2 == 1 {
            lod.remove(leaf);
        } else if index % 3 == 0 {
            lod.resize(leaf, 1.5);
        }
    }
    lod
}

#[test]
fn half_of_a_real_tree_is_a_valid_tree() {
    let folder = tempfile::tempdir().unwrap();
    let mut files = Vec::new();
    for path in trees() {
        let tree = open(&path);
        let output = folder.path().join(path.file_name().unwrap());
        let written = tree.write_lod(&half(&tree), &output).unwrap();
        assert_eq!(written.files, std::slice::from_ref(&output));
        check_lod(&tree, &half(&tree), &open(&output));
        files.push(output);
    }
    assert_valid(&files);
}
