//! Where a material has its base colour: what specular-glossiness calls diffuse, and the emission of a black one.

use image::ImageFormat;
use secateur_gltf::Detail;
use secateur_model::AlphaMode;
use serde_json::{Value, json};

use crate::roles::case;
use crate::small_tree::SmallTree;
use crate::textures::{encoded, kept, row, textured};

/// A material of this extension whose base colour says nothing, with what the extension says.
fn glossy(image: &[u8], pbr: Value, extension: Value) -> SmallTree {
    textured(
        image,
        json!({"alphaMode": "MASK", "pbrMetallicRoughness": pbr}),
    )
    .set(
        "/extensionsUsed",
        json!(["KHR_materials_pbrSpecularGlossiness"]),
    )
    .set(
        "/materials/0/extensions",
        json!({"KHR_materials_pbrSpecularGlossiness": extension}),
    )
}

#[test]
fn the_diffuse_texture_and_factor_of_specular_glossiness_are_the_base_colour() {
    let png = encoded(&row(&[100, 255]), ImageFormat::Png);
    let diffuse = json!({"diffuseTexture": {"index": 0}, "diffuseFactor": [0.5, 1, 0.25, 1]});
    for pbr in [
        json!({"metallicFactor": 0}),
        json!({"baseColorFactor": [1, 0, 0, 1]}),
    ] {
        let tree = glossy(&png, pbr, diffuse.clone());
        assert_eq!(kept(&tree), Some(vec![false, true]));
        let drawn = tree.document().surfaces(&[]).unwrap();
        let material = &drawn[0].0.material;
        assert_eq!(material.base_color, [0.5, 1.0, 0.25, 1.0]);
        assert!(material.texture.is_some());
        assert!(tree.document().images_of_material(0)[0].is_base_color);
        let inspection = tree.document().inspect(&[]);
        let reasons = inspection.primitives[0].reasons.iter();
        let texts: Vec<&str> = reasons.map(|reason| reason.text.as_str()).collect();
        assert!(
            texts.contains(&"its texture cuts out 50 % of its texels"),
            "{texts:?}"
        );
        assert!(texts.contains(&"its colour is green"), "{texts:?}");
    }
    // The factor alone, which hides everything; and a material that has a texture for both.
    let faint = glossy(&png, json!({}), json!({"diffuseFactor": [1, 1, 1, 0.4]}));
    assert_eq!(kept(&faint), Some(vec![false]));
    let base = json!({"baseColorTexture": {"index": 0}, "baseColorFactor": [1, 1, 1, 0.4]});
    assert_eq!(kept(&glossy(&png, base, diffuse)), Some(vec![false, false]));
}

/// Scans whose light is in their texture are exported so: black, with the texture as emission.
#[test]
fn the_emission_of_a_black_material_is_its_colour() {
    let png = encoded(&row(&[100, 255]), ImageFormat::Png);
    let black = json!({"baseColorFactor": [0, 0, 0, 1], "metallicFactor": 0});
    let scan = |pbr: &Value| {
        let fields = json!({
            "pbrMetallicRoughness": pbr,
            "emissiveTexture": {"index": 0},
            "emissiveFactor": [1, 0.5, 1],
            "alphaMode": "MASK",
        });
        let mut tree = textured(&png, fields);
        let colors = tree.floats("VEC3", &[0.5; 24]);
        tree.set("/meshes/0/primitives/0/attributes/COLOR_0", json!(colors))
    };
    let tree = scan(&black);
    let drawn = tree.document().drawn_as_one(Detail::Color).unwrap();
    let material = &drawn[0].surface.material;
    assert_eq!(material.base_color, [1.0, 0.5, 1.0, 1.0]);
    assert!(material.texture.is_some());
    assert!(material.finish.is_unlit);
    // The alpha of what is emitted hides nothing, and no colour of a vertex dims it.
    assert_eq!(material.alpha_mode, AlphaMode::Opaque);
    assert!(drawn[0].surface.colors.is_empty());
    assert!(tree.document().images_of_material(0)[0].is_base_color);
    // What has a colour of its own glows beside it, and is drawn as it was.
    for pbr in [
        json!({"metallicFactor": 0}),
        json!({"baseColorFactor": [0.1, 0, 0, 1]}),
        json!({"baseColorFactor": [0, 0, 0, 1], "baseColorTexture": {"index": 0}}),
    ] {
        let drawn = scan(&pbr).document().drawn_as_one(Detail::Color).unwrap();
        assert!(!drawn[0].surface.material.finish.is_unlit, "{pbr}");
    }
    let dark = scan(&black).set("/materials/0/emissiveFactor", json!([0, 0, 0]));
    let drawn = dark.document().drawn_as_one(Detail::Color).unwrap();
    assert_eq!(drawn[0].surface.material.base_color, [0.0, 0.0, 0.0, 1.0]);
}

#[test]
fn a_strangers_diffuse_textures_are_read() {
    let Some(document) = case("specgloss.glb") else {
        return;
    };
    let tree = document.into_tree(&[]).unwrap();
    assert_eq!(tree.foliage().cutouts().len(), 1);
}
