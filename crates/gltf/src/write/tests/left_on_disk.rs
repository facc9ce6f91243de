//! What is read from a file when it is needed is what is read at once.

use std::fs;
use std::path::{Path, PathBuf};

use secateur_model::{LeafId, Lod, Memory};
use serde_json::json;

use super::fixture::{Fixture, UNSIGNED_INT, square_indices, squares};
use super::real_trees::{half, trees};
use crate::{Document, Problem, Tree};

fn three_leaves() -> Vec<u8> {
    let mut fixture = Fixture::new();
    let positions = fixture.vectors(&squares(3));
    let indices = fixture.indices(UNSIGNED_INT, &square_indices(3));
    let leaves = fixture.with_leaves(json!({ "POSITION": positions }), Some(indices));
    leaves.glb()
}

/// A folder with one file, whose buffer stays in it.
fn file(bytes: &[u8]) -> (tempfile::TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("tree.glb");
    fs::write(&path, bytes).unwrap();
    (folder, path)
}

#[test]
fn a_level_of_a_tree_that_stays_on_disk_has_the_same_bytes() {
    let (_folder, path) = file(&three_leaves());
    let mut lod = Lod::original(3);
    lod.remove(LeafId::from_index(1));
    lod.resize(LeafId::from_index(2), 4.0);
    check(&path, |_| lod.clone());
    trees().iter().for_each(|path| check(path, half));
}

fn check(path: &Path, lod: impl Fn(&Tree) -> Lod) {
    let written = [0, u64::MAX].map(|large_bytes| {
        let document = Document::open_keeping(path, Memory::Auto, large_bytes).unwrap();
        assert_eq!(document.buffers[0].is_on_disk(), large_bytes == 0);
        let tree = document.into_tree(&[]).unwrap();
        tree.lod_to_bytes(&lod(&tree)).unwrap()
    });
    assert!(written[0] == written[1], "{}", path.display());
}

#[test]
fn a_file_that_stays_on_disk_is_refused_for_the_same_reasons() {
    let whole = three_leaves();
    let ends = (0..whole.len())
        .step_by(7)
        .chain(whole.len() - 3..whole.len());
    let cut = ends.map(|end| whole[..end].to_vec());
    let changed = (0..24).map(|at| {
        let mut bytes = whole.clone();
        bytes[at] ^= 0x15;
        bytes
    });
    for bytes in cut.chain(changed) {
        let (_folder, path) = file(&bytes);
        let [on_disk, at_once] = [0, u64::MAX].map(|large_bytes| {
            let opened = Document::open_keeping(&path, Memory::Auto, large_bytes);
            opened.map(drop).map_err(|error| error.to_string())
        });
        assert_eq!(on_disk, at_once);
    }
}

#[test]
fn a_file_that_changes_while_it_is_read_is_refused() {
    let (_folder, path) = file(&three_leaves());
    let open = || Document::open_keeping(&path, Memory::Auto, 0).unwrap();
    let (longer, shorter) = (open(), open());
    let bytes = fs::read(&path).unwrap();
    fs::write(&path, [&bytes[..], b"more"].concat()).unwrap();
    let refused = |document: Document| match document.into_tree(&[]) {
        Err(error) => {
            assert!(matches!(error.problem(), Problem::Unreadable(_)), "{error}");
            assert!(
                error
                    .to_string()
                    .contains("changed while it was being read")
            );
        }
        Ok(_) => panic!("not refused"),
    };
    refused(longer);
    fs::write(&path, &bytes[..bytes.len() / 2]).unwrap();
    refused(shorter);
}

/// A megabyte that stays on the disk takes nothing of half a megabyte of memory.
#[test]
fn what_stays_on_disk_takes_no_memory() {
    let mut fixture = Fixture::new();
    let positions = fixture.vectors(&squares(3));
    let indices = fixture.indices(UNSIGNED_INT, &square_indices(3));
    let mut leaves = fixture.with_leaves(json!({ "POSITION": positions }), Some(indices));
    leaves.bin.resize(1 << 20, 0);
    let (_folder, path) = file(&leaves.glb());
    let open = |large_bytes| Document::open_keeping(&path, Memory::Bytes(512 << 10), large_bytes);
    let tree = open(0).unwrap().into_tree(&[]).unwrap();
    assert_eq!(tree.foliage().leaves().len(), 3);
    let refused = open(u64::MAX).unwrap_err();
    assert!(matches!(refused.problem(), Problem::Memory(_)), "{refused}");
}
