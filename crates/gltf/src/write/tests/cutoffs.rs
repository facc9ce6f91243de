//! Alpha cutoffs of a level's own.

use super::fixture::read;
use super::made::beyond_its_corners;
use super::{encodings, every_encoding::one_gone_one_grown};
use crate::Cutoffs;

/// Those of leaves that are cut out are written, and nothing else of the file changes.
#[test]
fn a_level_has_the_cutoffs_that_were_chosen() {
    let tree = encodings::textured().tree();
    assert_eq!(tree.cut_out_materials(), [1]);
    let lod = one_gone_one_grown(&tree);
    let root = |cutoffs: &Cutoffs| {
        let bytes = tree.lod_to_bytes_with(&lod, cutoffs).unwrap();
        read(bytes).document.root.clone()
    };
    let mut as_it_was = root(&Cutoffs::default());
    assert_eq!(
        as_it_was,
        read(tree.lod_to_bytes(&lod).unwrap()).document.root
    );
    // The wood is not cut out, and there is no seventh material.
    let chosen = Cutoffs::new([(0, 0.3), (1, 0.200_04), (7, 0.4)]);
    as_it_was["materials"][1]["alphaCutoff"] = 0.2.into();
    assert_eq!(root(&chosen), as_it_was);
}

#[test]
fn what_was_chosen_is_not_raised_against_specks_and_is_said() {
    let tree = super::beyond_cards::cards(0.1, super::beyond_cards::middle).tree();
    let lod = beyond_its_corners(&tree);
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("out.glb");
    let cutoffs = Cutoffs::new([(1, 0.12)]);
    let options = crate::WriteOptions::default();
    let prepared = tree
        .prepare_lod_with(&lod, &cutoffs, &path, options)
        .unwrap();
    let notes = &prepared.written().notes;
    let said: Vec<&String> = notes
        .iter()
        .filter(|note| note.contains("alphaCutoff"))
        .collect();
    assert_eq!(said.len(), 1, "{notes:?}");
    assert!(said[0].contains("is 0.12 instead of 0.1"), "{said:?}");
    let root = prepared.document().unwrap().root.clone();
    assert_eq!(root["materials"][1]["alphaCutoff"], 0.12);
}
