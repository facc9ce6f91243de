//! Base colour textures of a level with other texels.

use std::sync::Arc;

use serde_json::{Value, json};

use super::beyond_cards::{cards, middle};
use super::every_encoding::one_gone_one_grown;
use super::fixture::{Fixture, read};
use super::validator::assert_valid;
use crate::write::drop_unreferenced::remove_field;
use crate::{Cutoffs, Tree};
use secateur_model::Texture;

/// Cards whose sampler is one that no new texture would get.
fn with_nearest_texels() -> Fixture {
    let mut fixture = cards(0.3, middle);
    fixture.root["samplers"] = json!([{"magFilter": 9728, "minFilter": 9986, "wrapS": 33648}]);
    fixture.root["textures"][0]["sampler"] = 0.into();
    fixture
}

/// The texture of the leaves, all of one colour.
fn painted(tree: &Tree) -> Arc<Texture> {
    let [own] = &tree.cut_out_textures().unwrap()[..] else {
        panic!("one material is cut out");
    };
    assert_eq!((own.material, own.cutoff), (1, 0.3));
    let mut texture = Texture::clone(&own.texture);
    for texel in texture.rgba.chunks_exact_mut(4) {
        texel[..3].copy_from_slice(&[70, 110, 40]);
    }
    Arc::new(texture)
}

/// What is written of a level with these texels in materials.
fn written(fixture: &Fixture, materials: &[usize]) -> (Tree, Value, Arc<Texture>) {
    let tree = fixture.tree();
    let texture = painted(&tree);
    let own = materials
        .iter()
        .map(|material| (*material, texture.clone()));
    let chosen = Cutoffs::default().with_texels(own);
    let bytes = tree.lod_to_bytes_with(&one_gone_one_grown(&tree), &chosen);
    let bytes = bytes.unwrap();
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("level.glb");
    std::fs::write(&file, &bytes).unwrap();
    assert_valid(&[file]);
    let tree = read(bytes);
    let root = tree.document.root.clone();
    (tree, root, texture)
}

#[test]
fn texels_change_and_nothing_else() {
    let fixture = with_nearest_texels();
    // There is no seventh material.
    let (tree, root, texture) = written(&fixture, &[1, 7]);
    let found = tree.cut_out_textures().unwrap();
    assert_eq!(found[0].texture, texture, "alpha and sampler stay");
    for list in ["images", "textures", "samplers", "materials"] {
        let count = |root: &Value| root[list].as_array().unwrap().len();
        assert_eq!(count(&root), count(&fixture.root), "{list}");
    }
    assert_eq!(root["images"][0]["name"], "leaf");
    assert_eq!(root["samplers"], fixture.root["samplers"]);
    // The old image went: there are as many views as without the change.
    let before = fixture.tree();
    let as_it_was = before.lod_to_bytes(&one_gone_one_grown(&before)).unwrap();
    let as_it_was = read(as_it_was).document.root.clone();
    let views = |root: &Value| root["bufferViews"].as_array().unwrap().len();
    assert_eq!(views(&root), views(&as_it_was));
}

#[test]
fn what_the_wood_shows_of_the_same_texture_stays() {
    let mut fixture = with_nearest_texels();
    fixture.root["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"] = json!({"index": 0});
    let attributes = &fixture.root["meshes"][0]["primitives"][0]["attributes"];
    let positions = attributes["POSITION"].as_u64().unwrap() as usize;
    let count = fixture.root["accessors"][positions]["count"]
        .as_u64()
        .unwrap();
    let uvs = fixture.vectors(&vec![[0.5, 0.5]; count as usize]);
    fixture.root["meshes"][0]["primitives"][0]["attributes"]["TEXCOORD_0"] = uvs.into();
    let (tree, root, texture) = written(&fixture, &[1]);
    assert_eq!(tree.cut_out_textures().unwrap()[0].texture, texture);
    assert_eq!(root["images"].as_array().unwrap().len(), 2);
    let color = |material: usize| {
        let drawn = tree.document.surfaces(&[]).unwrap();
        let leaves = drawn
            .iter()
            .find(|(_, is_foliage)| *is_foliage == (material == 1));
        let texture = leaves.unwrap().0.material.texture.clone().unwrap();
        [texture.rgba[0], texture.rgba[1], texture.rgba[2]]
    };
    assert_eq!([color(0), color(1)], [[10, 200, 30], [70, 110, 40]]);
}

/// Materials that share a texture, and textures that share an image, share the new one.
#[test]
fn what_was_shared_still_is() {
    let mut fixture = with_nearest_texels();
    let leaves = fixture.root["materials"][1].clone();
    let mut other = leaves.clone();
    other["pbrMetallicRoughness"]["baseColorTexture"]["index"] = 1.into();
    let materials = fixture.root["materials"].as_array_mut().unwrap();
    let first = materials.len();
    materials.extend([leaves, other]);
    let textures = fixture.root["textures"].as_array_mut().unwrap();
    textures.push(json!({"source": 0}));
    let (tree, root, texture) = written(&fixture, &[1, first, first + 1]);
    assert_eq!(tree.cut_out_textures().unwrap()[0].texture, texture);
    for (list, count) in [("images", 1), ("textures", 2)] {
        assert_eq!(root[list].as_array().unwrap().len(), count, "{list}");
    }
    // One of them keeps its texels where they are not to change.
    let (_, root, _) = written(&fixture, &[1]);
    for (list, count) in [("images", 2), ("textures", 3)] {
        assert_eq!(root[list].as_array().unwrap().len(), count, "{list}");
    }
}

/// A client may read the other one, so that neither may change alone.
#[test]
fn images_with_a_copy_in_another_format_are_left_alone() {
    let mut fixture = with_nearest_texels();
    fixture.use_extension("EXT_texture_webp", false);
    fixture.root["textures"][0]["extensions"] = json!({"EXT_texture_webp": {"source": 0}});
    let tree = fixture.tree();
    assert_eq!(tree.cut_out_materials(), [1]);
    assert!(tree.cut_out_textures().unwrap().is_empty());
    // Nor does the number of an image do harm that the file does not have.
    fixture.root["textures"][0]["source"] = 99.into();
    let texture = painted(&with_nearest_texels().tree());
    let tree = fixture.tree();
    let chosen = Cutoffs::default().with_texels([(1, texture.clone())]);
    let bytes = tree.lod_to_bytes_with(&one_gone_one_grown(&tree), &chosen);
    let tree = read(bytes.unwrap());
    assert_eq!(tree.cut_out_textures().unwrap()[0].texture, texture);
}

/// The texels as WebP too, which clients with the extension read: a texture, an extension and an image that
/// belong together.
pub(super) fn with_webp_beside(mut fixture: Fixture) -> Fixture {
    let mut webp = std::io::Cursor::new(Vec::new());
    let image = image::RgbaImage::from_pixel(2, 2, image::Rgba([10, 200, 30, 255]));
    image.write_to(&mut webp, image::ImageFormat::WebP).unwrap();
    let view = fixture.view(&webp.into_inner(), None);
    let images = fixture.root["images"].as_array_mut().unwrap();
    let number = images.len();
    images.push(json!({"bufferView": view, "mimeType": "image/webp"}));
    fixture.root["textures"][0]["extensions"] = json!({"EXT_texture_webp": {"source": number}});
    fixture.use_extension("EXT_texture_webp", false);
    fixture
}

#[test]
fn a_copy_in_another_format_goes_with_its_extension() {
    let fixture = with_webp_beside(with_nearest_texels());
    let texture = painted(&with_nearest_texels().tree());
    // The copy is the last image, or one of a lower number than an image that stays.
    let mut before_another = with_webp_beside(with_nearest_texels());
    let images = before_another.root["images"].as_array_mut().unwrap();
    images.push(json!({"bufferView": images[0]["bufferView"], "mimeType": "image/png"}));
    let another = images.len() - 1;
    let textures = before_another.root["textures"].as_array_mut().unwrap();
    textures.push(json!({"source": another}));
    before_another.root["materials"][0]["emissiveTexture"] = json!({"index": textures.len() - 1});
    for (fixture, count) in [(fixture, 1), (before_another, 3)] {
        let tree = fixture.tree();
        let chosen = Cutoffs::default().with_texels([(1, texture.clone())]);
        let bytes = tree.lod_to_bytes_with(&one_gone_one_grown(&tree), &chosen);
        let bytes = bytes.unwrap();
        let root = read(bytes.clone()).document.root.clone();
        assert_eq!(root["images"].as_array().unwrap().len(), count);
        let images = root["images"].as_array().unwrap().iter();
        assert!(images.clone().all(|image| image["mimeType"] == "image/png"));
        assert_eq!(root["textures"][0]["extensions"], Value::Null);
        let used = root["extensionsUsed"].as_array().unwrap();
        assert!(!used.contains(&json!("EXT_texture_webp")));
        assert_eq!(read(bytes).cut_out_textures().unwrap()[0].texture, texture);
    }
}

/// Where a texture has no image but that, it is no copy.
#[test]
fn an_image_in_the_format_of_an_extension_alone_can_change() {
    let mut fixture = with_nearest_texels();
    fixture.use_extension("EXT_texture_webp", true);
    fixture.root["textures"][0] = json!({
        "sampler": 0,
        "extensions": {"EXT_texture_webp": {"source": 0}},
    });
    let (tree, root, texture) = written(&fixture, &[1]);
    assert_eq!(tree.cut_out_textures().unwrap()[0].texture, texture);
    assert_eq!(root["images"].as_array().unwrap().len(), 1);
    assert_eq!(root["textures"][0], json!({"sampler": 0, "source": 0}));
    assert_eq!(root.get("extensionsRequired"), None);
}

/// The diffuse texture of specular-glossiness is the base colour, and stays where it was.
#[test]
fn a_diffuse_texture_changes_in_its_extension() {
    const NAME: &str = "KHR_materials_pbrSpecularGlossiness";
    let mut fixture = with_nearest_texels();
    fixture.use_extension(NAME, false);
    let material = &mut fixture.root["materials"][1];
    let info = material["pbrMetallicRoughness"]["baseColorTexture"].take();
    material["extensions"][NAME] = json!({"diffuseTexture": info});
    remove_field(&mut material["pbrMetallicRoughness"], "baseColorTexture");
    let before = material["extensions"].clone();
    let (tree, root, texture) = written(&fixture, &[1]);
    assert_eq!(tree.cut_out_textures().unwrap()[0].texture, texture);
    assert_eq!(root["materials"][1]["extensions"], before);
    assert_eq!(root["images"].as_array().unwrap().len(), 1);
}
