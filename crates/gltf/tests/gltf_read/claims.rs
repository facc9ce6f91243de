//! What a small file may claim: memory follows its size, and what it names twice is
//! there once.

use std::sync::Arc;

use image::{ImageFormat, RgbaImage};
use serde_json::{Value, json};

use crate::small_tree::SmallTree;

#[track_caller]
fn assert_error(tree: &SmallTree, sentence: &str) {
    assert_eq!(tree.error(), format!("small.glb: {sentence}"));
}

/// Adds an accessor of zeros, for which the file has no data.
fn zeros(tree: &mut SmallTree, kind: &str, code: u32, count: usize) -> usize {
    let zeros = json!({"type": kind, "componentType": code, "count": count});
    tree.append("accessors", zeros)
}

#[test]
fn zeros_do_not_become_millions_of_triangles() {
    let mut tree = SmallTree::squares();
    let positions = zeros(&mut tree, "VEC3", 5126, 5_592_405);
    tree.primitive(json!({"attributes": {"POSITION": positions}}));
    // 64 bytes for each of the file's 120, and 64 KiB.
    assert_error(
        &tree,
        "accessors[2]: asks for 5592405 elements of 12 bytes; at most 73216 bytes are allowed \
         without data in the file",
    );

    // What one may claim, many may not claim together.
    let mut tree = SmallTree::squares();
    let indices = zeros(&mut tree, "SCALAR", 5121, 60_000);
    let few = json!({"attributes": {"POSITION": 0}, "indices": indices});
    tree.primitive(few.clone());
    tree.tree();
    tree.primitive(few);
    assert_error(
        &tree,
        "holds more than 73216 bytes of vertices and indices without data",
    );
}

#[test]
fn numbers_that_name_nothing_are_refused_where_nobody_reads_them() {
    // The writer adds accessors: one of them would become the matrices of this skin.
    let tree =
        SmallTree::squares().set("/skins", json!([{"inverseBindMatrices": 2, "joints": []}]));
    assert_error(&tree, "`accessors[2]` does not exist: there are 2");
    let mut tree = SmallTree::squares();
    tree.append("nodes", json!({"name": "not drawn", "mesh": 1}));
    assert_error(&tree, "`meshes[1]` does not exist: there are 1");
}

fn png(image: &RgbaImage) -> Vec<u8> {
    let mut bytes = std::io::Cursor::new(Vec::new());
    image.write_to(&mut bytes, ImageFormat::Png).unwrap();
    bytes.into_inner()
}

/// The squares once for each of these materials, with texture coordinates, and an image of
/// this name for each of `images` entries, all in one view.
fn textured(image: &RgbaImage, images: usize, materials: Vec<Value>) -> SmallTree {
    let mut tree = SmallTree::squares();
    let uvs = tree.floats("VEC2", &[0.0; 16]);
    let view = tree.view(&png(image));
    for _ in 0..images {
        tree.append(
            "images",
            json!({"bufferView": view, "mimeType": "image/png"}),
        );
    }
    tree.append("samplers", json!({}));
    tree.append("samplers", json!({"wrapS": 33071}));
    for k in 0..2 * images {
        tree.append("textures", json!({"source": k / 2, "sampler": k % 2}));
    }
    let primitives = (0..materials.len()).map(|material| {
        json!({
            "attributes": {"POSITION": 0, "TEXCOORD_0": uvs}, "indices": 1, "material": material
        })
    });
    let primitives: Vec<Value> = primitives.collect();
    tree.set("/meshes/0/primitives", primitives.into())
        .set("/materials", materials.into())
}

#[test]
fn an_image_is_there_once_however_many_use_it() {
    let image = RgbaImage::from_pixel(4, 4, image::Rgba([1, 2, 3, 255]));
    let material = |texture: usize| json!({"name": "leaf", "pbrMetallicRoughness": {"baseColorTexture": {"index": texture}}});
    // Textures 0 and 2 repeat, 1 and 3 do not; 2 and 3 are of the second entry of `images`.
    let tree = textured(&image, 2, [0, 0, 2, 1, 3].map(material).to_vec());
    let surfaces = tree.document().surfaces(&[]).unwrap();
    let textures: Vec<_> = surfaces
        .iter()
        .map(|(surface, _)| surface.material.texture.as_ref().unwrap())
        .collect();
    assert_eq!(textures.len(), 5);
    assert!(
        [1, 2]
            .iter()
            .all(|&k| Arc::ptr_eq(textures[0], textures[k]))
    );
    assert!(Arc::ptr_eq(textures[3], textures[4]) && !Arc::ptr_eq(textures[0], textures[3]));
}

#[test]
fn hundreds_of_alpha_masks_are_as_good_as_one() {
    // Every cutoff keeps other texels of a ramp.
    let ramp = RgbaImage::from_fn(256, 1, |x, _| image::Rgba([0, 255, 0, x as u8]));
    let material = |k: usize| {
        json!({
            "name": "leaf", "alphaMode": "MASK", "alphaCutoff": (k % 200 + 1) as f64 / 255.0,
            "pbrMetallicRoughness": {"baseColorTexture": {"index": k / 200}}
        })
    };
    let tree = textured(&ramp, 1, (0..400).map(material).collect()).tree();
    assert_eq!(tree.foliage().cutouts().len(), 400);
    let last = tree.foliage().leaves().last().unwrap().cutout();
    assert_eq!(last, Some(399));
}
