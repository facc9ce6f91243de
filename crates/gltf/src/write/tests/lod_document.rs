//! A level as a document, without writing and reading it.

use std::sync::Arc;

use secateur_model::Texture;

use super::encodings;
use super::every_encoding::one_gone_one_grown;
use crate::{Detail, Document, DrawnSurface};

fn drawn(document: &Document) -> Vec<DrawnSurface> {
    document.drawn_as_one(Detail::Full).unwrap()
}

fn textures(surfaces: &[DrawnSurface]) -> Vec<Arc<Texture>> {
    let textures = surfaces.iter().filter_map(|drawn| {
        let texture = drawn.surface.material.texture.as_ref();
        texture.map(Arc::clone)
    });
    textures.collect()
}

#[test]
fn it_is_drawn_as_its_bytes_are() {
    let tree = encodings::textured().tree();
    let lod = one_gone_one_grown(&tree);
    let bytes = tree.lod_to_bytes(&lod).unwrap();
    let read = Document::from_bytes("level.glb", bytes, None).unwrap();
    let made = tree.lod_document(&lod).unwrap();
    assert_eq!(made.json(), read.json());
    let [of_made, of_read] = [&made, &read].map(drawn);
    assert_eq!(of_made.len(), of_read.len());
    assert!(!of_made.is_empty());
    for (made, read) in of_made.iter().zip(&of_read) {
        assert_eq!(made.surface, read.surface);
        assert_eq!(made.material, read.material);
    }
}

#[test]
fn images_are_decoded_once_where_they_are_kept() {
    let tree = encodings::textured().tree();
    let lod = one_gone_one_grown(&tree);
    let of_level = || textures(&drawn(&tree.lod_document(&lod).unwrap()));
    let [first, again] = [of_level(), of_level()];
    assert!(!first.is_empty() && !Arc::ptr_eq(&first[0], &again[0]));
    tree.document().keep_images();
    let kept = textures(&drawn(tree.document()));
    let of_level = of_level();
    assert_eq!(of_level[0], first[0]);
    assert!(Arc::ptr_eq(&of_level[0], &kept[0]));
}
