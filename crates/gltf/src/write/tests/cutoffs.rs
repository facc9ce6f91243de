//! Alpha cutoffs of a level's own.

use serde_json::json;

use super::fixture::read;
use super::new_leaves::beyond_its_corners;
use super::{encodings, every_encoding::one_gone_one_grown};
use crate::Cutoffs;

/// Cutoffs of leaves that are cut out are written, and nothing else of the file changes.
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

/// The sampler of leaves alone changes, and keeps all but its mip maps.
#[test]
fn a_level_is_read_without_mip_maps_where_that_was_chosen() {
    let without = |min_filter: Option<u64>| {
        let mut fixture = super::beyond_cards::cards(0.1, super::beyond_cards::middle);
        fixture.root["samplers"] = json!([{"wrapS": 33071}]);
        if let Some(code) = min_filter {
            fixture.root["samplers"][0]["minFilter"] = code.into();
        }
        fixture.root["textures"][0]["sampler"] = 0.into();
        // What the wood shows of the same texture is no leaf's.
        fixture.root["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"] =
            json!({"index": 0});
        let tree = fixture.tree();
        // The wood is not cut out, and there is no seventh material.
        let chosen = Cutoffs::new([(1, 0.2)]).without_mips([0, 1, 7]);
        let lod = one_gone_one_grown(&tree);
        let written = read(tree.lod_to_bytes_with(&lod, &chosen).unwrap());
        let root = written.document.root.clone();
        let sampler = |material: usize| {
            let color = &root["materials"][material]["pbrMetallicRoughness"]["baseColorTexture"];
            let texture = color["index"].as_u64().unwrap() as usize;
            let sampler = root["textures"][texture]["sampler"].as_u64().unwrap() as usize;
            root["samplers"][sampler].clone()
        };
        let of_wood = sampler(0);
        assert_eq!(of_wood["minFilter"].as_u64(), min_filter);
        assert!(written.cut_out_materials().is_empty());
        assert_eq!(root["materials"][1]["alphaCutoff"], 0.2);
        let of_leaves = sampler(1);
        assert_eq!(of_leaves["wrapS"], 33071);
        of_leaves["minFilter"].as_u64().unwrap()
    };
    assert_eq!(without(None), 9729, "most clients blend four mip texels");
    assert_eq!(without(Some(9987)), 9729);
    assert_eq!(without(Some(9985)), 9729);
    assert_eq!(without(Some(9984)), 9728);
    assert_eq!(without(Some(9986)), 9728);
}

#[test]
fn without_mip_maps_no_cutoff_is_raised_and_that_is_said() {
    let tree = super::beyond_cards::cards(0.1, super::beyond_cards::middle).tree();
    let lod = beyond_its_corners(&tree);
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("out.glb");
    let chosen = Cutoffs::default().without_mips([1]);
    let options = crate::WriteOptions::default();
    let prepared = tree
        .prepare_lod_with(&lod, &chosen, &path, options)
        .unwrap();
    let root = prepared.document().unwrap().root.clone();
    assert_eq!(root["materials"][1]["alphaCutoff"], 0.1);
    let notes = &prepared.written().notes;
    let said = notes
        .iter()
        .filter(|note| note.contains("without mip maps"));
    assert_eq!(said.count(), 1, "{notes:?}");
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
