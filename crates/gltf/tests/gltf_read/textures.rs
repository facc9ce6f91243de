//! Cut-outs and texture coordinates.

use std::io::Cursor;

use image::{ImageFormat, Rgba, RgbaImage};
use secateur_gltf::{Detail, VertexAlpha};
use secateur_model::{Filters, Material, Mips, Wrap};
use serde_json::{Value, json};

use crate::roles::case;
use crate::small_tree::{SQUARES, SmallTree};

/// An image of one row with these alphas.
pub(crate) fn row(alphas: &[u8]) -> RgbaImage {
    RgbaImage::from_fn(alphas.len() as u32, 1, |x, _| {
        Rgba([50, 200, 50, alphas[x as usize]])
    })
}

pub(crate) fn encoded(image: &RgbaImage, format: ImageFormat) -> Vec<u8> {
    let mut bytes = Cursor::new(Vec::new());
    image.write_to(&mut bytes, format).unwrap();
    bytes.into_inner()
}

/// The squares with texture coordinates x, y and this image on the leaf.
pub(crate) fn textured(image: &[u8], material: Value) -> SmallTree {
    let mut tree = SmallTree::squares();
    let uvs: Vec<f32> = SQUARES.iter().flat_map(|p| [p[0], p[1]]).collect();
    let uvs = tree.floats("VEC2", &uvs);
    let view = tree.view(image);
    tree.append(
        "images",
        json!({"bufferView": view, "mimeType": "image/png"}),
    );
    tree.append("samplers", json!({"wrapS": 33071, "wrapT": 33648}));
    tree.append("textures", json!({"source": 0, "sampler": 0}));
    let mut full = json!({
        "name": "leaf", "pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}
    });
    for (key, value) in material.as_object().unwrap() {
        full[key] = value.clone();
    }
    tree.set("/materials/0", full)
        .set("/meshes/0/primitives/0/attributes/TEXCOORD_0", json!(uvs))
}

/// Which texels of the first row the leaf's mask keeps; `None` without mask.
pub(crate) fn kept(tree: &SmallTree) -> Option<Vec<bool>> {
    let tree = tree.tree();
    let index = tree.foliage().leaves()[0].cutout()?;
    let mask = &tree.foliage().cutouts()[index as usize];
    Some(
        (0..mask.width() as i32)
            .map(|u| mask.is_opaque(u, 0))
            .collect(),
    )
}

#[test]
fn a_mask_keeps_texels_from_the_cutoff_on() {
    // 51 of 255 is 0.2, exactly the cutoff: kept.
    let png = encoded(&row(&[0, 50, 51, 255]), ImageFormat::Png);
    let tree = textured(&png, json!({"alphaMode": "MASK", "alphaCutoff": 0.2}));
    assert_eq!(kept(&tree), Some(vec![false, false, true, true]));
    let tree = tree.tree();
    assert_eq!(tree.foliage().cutouts().len(), 1, "leaves share a mask");
    let wrap = tree.foliage().cutouts()[0].wrap();
    assert_eq!(wrap, [Wrap::ClampToEdge, Wrap::MirroredRepeat]);
}

#[test]
fn the_factor_counts_blend_is_cut_in_the_middle_and_opaque_not_at_all() {
    let png = encoded(&row(&[100, 255]), ImageFormat::Png);
    let blend = textured(&png, json!({"alphaMode": "BLEND"}));
    assert_eq!(kept(&blend), Some(vec![false, true]));
    // 255 * 0.4 stays below one half: nothing is left.
    let faint = blend.clone().set(
        "/materials/0/pbrMetallicRoughness/baseColorFactor",
        json!([1, 1, 1, 0.4]),
    );
    assert_eq!(kept(&faint), Some(vec![false, false]));
    assert_eq!(
        kept(&blend.set("/materials/0/alphaMode", json!("OPAQUE"))),
        None
    );
}

#[test]
fn a_mask_that_keeps_everything_is_none() {
    let png = encoded(&row(&[200, 255]), ImageFormat::Png);
    assert_eq!(kept(&textured(&png, json!({"alphaMode": "MASK"}))), None);
}

#[test]
fn webp_and_jpeg_are_read() {
    let webp = encoded(&row(&[0, 255]), ImageFormat::WebP);
    let tree = textured(&webp, json!({"alphaMode": "MASK"})).set(
        "/textures/0",
        json!({"extensions": {"EXT_texture_webp": {"source": 0}}}),
    );
    assert_eq!(kept(&tree), Some(vec![false, true]));
    let rgb = image::DynamicImage::from(row(&[255, 255])).into_rgb8();
    let mut jpeg = Cursor::new(Vec::new());
    rgb.write_to(&mut jpeg, ImageFormat::Jpeg).unwrap();
    assert_eq!(
        kept(&textured(jpeg.get_ref(), json!({"alphaMode": "MASK"}))),
        None
    );
}

/// An image of 8 x 8 texels, clear on the left, in each encoding of KHR_texture_basisu.
const KTX2_IMAGES: [&[u8]; 3] = [
    include_bytes!("../data/half_etc1s.ktx2"),
    include_bytes!("../data/half_uastc.ktx2"),
    include_bytes!("../data/half_uastc_zstd.ktx2"),
];

fn basisu(image: &[u8]) -> SmallTree {
    textured(image, json!({"alphaMode": "MASK"})).set(
        "/textures/0",
        json!({"extensions": {"KHR_texture_basisu": {"source": 0}}}),
    )
}

#[test]
fn ktx2_is_read_in_every_encoding() {
    for image in KTX2_IMAGES {
        let tree = basisu(image);
        let halves = [[false; 4], [true; 4]].concat();
        assert_eq!(kept(&tree), Some(halves));
        let document = tree.document();
        assert_eq!(document.images_of_material(0)[0].size, [8, 8]);
        let drawn = document.surfaces(&[]).unwrap();
        let texture = drawn[0].0.material.texture.clone().unwrap();
        let last = texture.rgba.last_chunk::<4>().unwrap();
        let apart = last.iter().zip([40, 160, 30, 255]);
        assert!(apart.clone().all(|(a, b)| a.abs_diff(b) <= 8), "{last:?}");
    }
}

/// Where an image is there in two formats, the one that every client reads is taken.
#[test]
fn a_plain_image_goes_before_ktx2() {
    let png = encoded(&row(&[255, 0]), ImageFormat::Png);
    let mut tree = textured(&png, json!({"alphaMode": "MASK"}));
    let view = tree.view(KTX2_IMAGES[0]);
    tree.append(
        "images",
        json!({"bufferView": view, "mimeType": "image/ktx2"}),
    );
    let texture = json!({"source": 0, "extensions": {"KHR_texture_basisu": {"source": 1}}});
    assert_eq!(
        kept(&tree.set("/textures/0", texture)),
        Some(vec![true, false])
    );
}

/// What a KTX2 image with these bytes at this place is said to be.
fn changed_ktx2(image: &[u8], at: usize, bytes: &[u8]) -> String {
    let mut image = image.to_vec();
    image[at..at + bytes.len()].copy_from_slice(bytes);
    basisu(&image).tree().inspection().warnings.join("; ")
}

#[test]
fn ktx2_that_lies_is_not_decoded() {
    let [etc1s, uastc, zstandard] = KTX2_IMAGES;
    // 65,536 texels wide and high.
    let large = changed_ktx2(etc1s, 20, &[0, 0, 1, 0, 0, 0, 1, 0]);
    assert!(
        large.contains("65536 x 65536 texels are more than"),
        "{large}"
    );
    let cube = changed_ktx2(etc1s, 36, &[6]);
    assert!(cube.contains("holds no single plain image"), "{cube}");
    let model = u32::from_le_bytes(*uastc[48..].first_chunk().unwrap()) as usize + 12;
    let hdr = changed_ktx2(uastc, model, &[167]);
    assert!(
        hdr.contains(
            "neither ETC1S nor UASTC; convert it with `npx @gltf-transform/cli ktxdecompress"
        ),
        "{hdr}"
    );
    // A gigabyte decompressed, for 64 texels.
    let bomb = changed_ktx2(zstandard, 96, &[0, 0, 0, 64]);
    assert!(bomb.contains("its KTX2 data is damaged"), "{bomb}");
    // A window of a terabyte.
    let level = u32::from_le_bytes(*zstandard[80..].first_chunk().unwrap()) as usize;
    let window = changed_ktx2(zstandard, level + 4, &[0, 0xf0]);
    assert!(window.contains("its KTX2 data is damaged"), "{window}");
}

#[test]
fn ktx2_that_is_cut_off_or_changed_is_an_image_or_a_sentence() {
    for image in KTX2_IMAGES {
        for end in 0..image.len() {
            let cut = &image[..end];
            assert_eq!(kept(&basisu(cut)), None, "{end}");
            let mut changed = image.to_vec();
            changed[end] ^= 0x55;
            let _ = kept(&basisu(&changed));
        }
    }
}

#[test]
fn an_image_that_cannot_be_decoded_is_opaque_with_a_warning() {
    let tree = textured(b"\xabKTX 20\xbb\r\n\x1a\n", json!({"alphaMode": "MASK"}));
    assert_eq!(kept(&tree), None);
    let warnings = &tree.tree().inspection().warnings.join("\n");
    assert!(
        warnings.contains("images[0]: its KTX2 header is damaged; it is taken for opaque"),
        "{warnings}"
    );
    // Only in a format that is not read: it is said all the same, with what converts it.
    for (name, bytes) in [
        ("EXT_texture_avif", b"\0\0\0\x20ftypavif"),
        ("MSFT_texture_dds", b"DDS \x7c\0\0\0\x07\x10\0\0"),
    ] {
        let tree = textured(bytes, json!({"alphaMode": "MASK"}))
            .set("/textures/0", json!({"extensions": {name: {"source": 0}}}));
        assert_eq!(kept(&tree), None);
        let warnings = &tree.tree().inspection().warnings.join("\n");
        assert!(
            warnings.contains(
                "images[0]: its format is not PNG, JPEG, WebP or KTX2; convert it with \
                 `npx @gltf-transform/cli png IN.glb OUT.glb`; it is taken for opaque"
            ),
            "{warnings}"
        );
    }
}

#[test]
fn an_image_of_too_many_texels_is_not_decoded() {
    // A PNG header that speaks of 65,535 x 65,535 texels and goes no further.
    let mut png = encoded(&row(&[0]), ImageFormat::Png);
    png[16..24].copy_from_slice(&[0, 0, 0xff, 0xff, 0, 0, 0xff, 0xff]);
    let tree = textured(&png, json!({"alphaMode": "MASK"}));
    assert_eq!(kept(&tree), None);
    let warnings = tree.tree().inspection().warnings.clone();
    assert_eq!(warnings.len(), 1, "{warnings:?}");
}

#[test]
fn texture_coordinates_are_transformed() {
    let png = encoded(&row(&[0, 255]), ImageFormat::Png);
    let mut tree = textured(&png, json!({"alphaMode": "MASK"}));
    let other: Vec<f32> = SQUARES
        .iter()
        .flat_map(|p| [p[0] * 8.0, p[1] * 8.0])
        .collect();
    let other = tree.floats("VEC2", &other);
    let info = "/materials/0/pbrMetallicRoughness/baseColorTexture";
    let tree = tree
        .set("/meshes/0/primitives/0/attributes/TEXCOORD_3", json!(other))
        .set(
            &format!("{info}/extensions"),
            json!({
                "KHR_texture_transform": {"offset": [0.25, 0.5], "scale": [0.5, 2], "texCoord": 3}
            }),
        );
    // Corner (1, 1) of set 3 is (8, 8): 0.25 + 4, 0.5 + 16.
    let uv = tree.tree().foliage().triangles()[0].uvs[2];
    assert_eq!(uv.to_array(), [4.25, 16.5]);
}

#[test]
fn quantised_texture_coordinates() {
    let png = encoded(&row(&[0, 255]), ImageFormat::Png);
    let mut tree = textured(&png, json!({"alphaMode": "MASK"}));
    let uvs: Vec<u16> = SQUARES
        .iter()
        .flat_map(|p| [p[0] as u16 * 65535, 0])
        .collect();
    let uvs = tree.shorts("VEC2", &uvs);
    let tree = tree
        .set(&format!("/accessors/{uvs}/normalized"), json!(true))
        .set("/meshes/0/primitives/0/attributes/TEXCOORD_0", json!(uvs));
    let uv = tree.tree().foliage().triangles()[0].uvs[1];
    assert_eq!(uv.to_array(), [1.0, 0.0]);
}

#[test]
fn a_texture_without_coordinates_cuts_nothing_out() {
    let png = encoded(&row(&[0, 255]), ImageFormat::Png);
    let tree = textured(&png, json!({"alphaMode": "MASK"}))
        .without("/meshes/0/primitives/0/attributes/TEXCOORD_0");
    assert_eq!(kept(&tree), None);
    let warnings = tree.tree().inspection().warnings.clone();
    assert!(warnings[0].contains("has no TEXCOORD_0"), "{warnings:?}");
}

#[test]
fn surfaces_carry_texture_and_colour() {
    let png = encoded(&row(&[0, 255]), ImageFormat::Png);
    let mut tree = textured(&png, json!({"alphaMode": "MASK", "doubleSided": true}));
    let colors = tree.accessor("VEC3", 5121, 8, &[255; 24]);
    let tree = tree
        .set(&format!("/accessors/{colors}/normalized"), json!(true))
        .set("/meshes/0/primitives/0/attributes/COLOR_0", json!(colors));
    let surfaces = tree.document().surfaces(&[]).unwrap();
    let [(surface, is_foliage)] = surfaces.as_slice() else {
        panic!("one surface");
    };
    assert!(is_foliage);
    assert_eq!(surface.colors, vec![glam::Vec4::ONE; 8]);
    assert_eq!(surface.uvs[2], glam::Vec2::ONE);
    assert!(surface.material.double_sided);
    let texture = surface.material.texture.as_ref().unwrap();
    assert_eq!((texture.width, texture.height), (2, 1));
    assert_eq!(texture.rgba[..4], [50, 200, 50, 0]);
}

/// The material of the squares, with all its detail.
fn detailed(tree: &SmallTree) -> Material {
    let surfaces = tree.tree().surfaces_with(Detail::Full).unwrap();
    Material::clone(&surfaces[0].0.material)
}

#[test]
fn filters_are_smooth_where_the_file_does_not_say() {
    let png = encoded(&row(&[255]), ImageFormat::Png);
    let tree = textured(&png, json!({}));
    let filters = |tree: &SmallTree| detailed(tree).texture.unwrap().filters;
    assert_eq!(filters(&tree), Filters::default());
    let blocky = tree
        .set("/samplers/0/magFilter", json!(9728))
        .set("/samplers/0/minFilter", json!(9985));
    let expected = Filters {
        is_smooth_near: false,
        is_smooth_far: true,
        mips: Mips::Nearest,
    };
    assert_eq!(filters(&blocky), expected);
}

#[test]
fn normal_maps_are_read_when_asked_for_and_placed_as_the_colour() {
    let png = encoded(&row(&[255]), ImageFormat::Png);
    let tree = textured(
        &png,
        json!({"normalTexture": {"index": 0, "scale": 0.5}, "extensions": {"KHR_materials_unlit": {}}}),
    );
    let finish = detailed(&tree).finish;
    assert_eq!((finish.roughness, finish.is_unlit), (1.0, true));
    assert_eq!(finish.normal_map.unwrap().scale, 0.5);
    let plain = tree.tree().surfaces().unwrap();
    assert_eq!(plain[0].0.material.finish.normal_map, None);
    // A surface has one set of texture coordinates: the colour's.
    let elsewhere = tree
        .clone()
        .set("/materials/0/normalTexture/texCoord", json!(1));
    assert_eq!(detailed(&elsewhere).finish.normal_map, None);
    // Without a colour texture, the normals'.
    let alone = tree.without("/materials/0/pbrMetallicRoughness/baseColorTexture");
    let surfaces = alone.tree().surfaces_with(Detail::Full).unwrap();
    assert!(surfaces[0].0.material.finish.normal_map.is_some());
    assert_eq!(surfaces[0].0.uvs.len(), 8);
    // What is broken and only looks is left out.
    let broken = alone.set("/materials/0/normalTexture/index", json!(7));
    assert_eq!(detailed(&broken).finish.normal_map, None);
}

/// The textured squares with these alphas in the colours of the vertices of each.
fn colored(alphas: [f32; 2]) -> SmallTree {
    colored_by_vertex([0, 1].map(|k| [alphas[k]; 4]).concat())
}

fn colored_by_vertex(alphas: Vec<f32>) -> SmallTree {
    let png = encoded(&row(&[255, 255]), ImageFormat::Png);
    let mut tree = textured(&png, json!({"alphaMode": "MASK"}));
    let colors: Vec<f32> = (0..8).flat_map(|k| [0.5, 0.5, 0.5, alphas[k]]).collect();
    let colors = tree.floats("VEC4", &colors);
    tree.set("/meshes/0/primitives/0/attributes/COLOR_0", json!(colors))
}

/// The alphas that renderers get, and whether the first leaf is hidden from who simplifies.
fn alphas_and_hidden(tree: &SmallTree) -> (Vec<f32>, bool) {
    let drawn = tree.document().drawn_as_one(Detail::Color).unwrap();
    let alphas = drawn[0]
        .surface
        .colors
        .iter()
        .map(|color| color.w)
        .collect();
    let tree = tree.tree();
    let mask = tree.foliage().leaves()[0].cutout();
    let is_hidden =
        mask.is_some_and(|mask| !tree.foliage().cutouts()[mask as usize].is_opaque(0, 0));
    (alphas, is_hidden)
}

#[test]
fn alpha_of_vertices_that_hides_most_is_ignored_by_everyone() {
    let tree = colored([0.0, 0.0]);
    assert_eq!(alphas_and_hidden(&tree), (vec![1.0; 8], false));
    let warnings = tree.document().inspect(&[]).warnings;
    let says =
        "meshes[0].primitives[0]: the alpha of its COLOR_0 would hide most of it and is ignored";
    assert!(
        warnings.iter().any(|warning| warning.starts_with(says)),
        "{warnings:?}"
    );
    // The level of a tree is read as the tree, even if half of what is left would be hidden.
    let mut alphas = vec![0.0; 8];
    alphas[7] = 0.75;
    let tree = colored_by_vertex(alphas).tree();
    let mut lod = secateur_model::Lod::original(2);
    lod.remove(secateur_model::LeafId::from_index(0));
    let drawn = tree
        .lod_document(&lod)
        .unwrap()
        .drawn_as_one(Detail::Color)
        .unwrap();
    assert!(drawn[0].surface.colors.iter().all(|color| color.w == 1.0));
}

#[test]
fn alpha_of_vertices_that_hides_some_hides_them_from_everyone() {
    let half = [vec![0.0; 4], vec![0.75; 4]].concat();
    let tree = colored([0.0, 0.75]);
    assert_eq!(alphas_and_hidden(&tree), (half, true));
    assert_eq!(tree.document().inspect(&[]).warnings, [""; 0]);
    // What an opaque material does not test hides nothing.
    let opaque = colored([0.0, 0.0]).set("/materials/0/alphaMode", json!("OPAQUE"));
    assert_eq!(alphas_and_hidden(&opaque), (vec![0.0; 8], false));
}

/// Who knows better than the file says so, and everybody looks at it so.
#[test]
fn alpha_of_vertices_can_be_kept_and_ignored() {
    for (tree, alpha, expected) in [
        (colored([0.0, 0.0]), VertexAlpha::Keep, [0.0, 0.0]),
        (colored([0.0, 0.75]), VertexAlpha::Ignore, [1.0, 1.0]),
    ] {
        let document = tree.document().with_vertex_alpha(alpha);
        assert_eq!(document.inspect(&[]).warnings, [""; 0]);
        let selectors = ["material:leaf".parse().unwrap()];
        let tree = document.into_tree(&selectors).unwrap();
        let drawn = tree.document().drawn_as_one(Detail::Color).unwrap();
        let colors = &drawn[0].surface.colors;
        assert_eq!([colors[0].w, colors[7].w], expected);
        let leaf = &tree.foliage().leaves()[0];
        let is_hidden = leaf
            .cutout()
            .is_some_and(|mask| !tree.foliage().cutouts()[mask as usize].is_opaque(0, 0));
        assert_eq!(is_hidden, expected[0] == 0.0);
    }
}

#[test]
fn a_strangers_wind_data_hides_no_leaf() {
    let Some(document) = case("windcolor_a0.glb") else {
        return;
    };
    let warnings = document.inspect(&[]).warnings;
    assert!(
        warnings.iter().any(|warning| warning.contains("COLOR_0")),
        "{warnings:?}"
    );
    for drawn in document.drawn_as_one(Detail::Color).unwrap() {
        assert!(drawn.surface.colors.iter().all(|color| color.w == 1.0));
    }
}

/// Crowns that have no colour but that of their vertices are judged by it; beside a texture it may be wind.
#[test]
fn colours_of_vertices_are_evidence_where_there_is_no_texture() {
    let reasons = |rgb: [f32; 3], textured: bool| -> Vec<String> {
        let mut tree = SmallTree::squares();
        let colors = tree.floats("VEC3", &[rgb; 8].concat());
        let uvs = tree.floats("VEC2", &[0.0; 16]);
        let view = tree.view(&encoded(&row(&[255, 255]), ImageFormat::Png));
        let attributes = &mut tree.root["meshes"][0]["primitives"][0]["attributes"];
        attributes["COLOR_0"] = colors.into();
        attributes["TEXCOORD_0"] = uvs.into();
        if textured {
            tree.append(
                "images",
                json!({"bufferView": view, "mimeType": "image/png"}),
            );
            tree.append("textures", json!({"source": 0}));
            let texture = json!({"baseColorTexture": {"index": 0}});
            tree.root["materials"][0]["pbrMetallicRoughness"] = texture;
        }
        let inspection = tree.tree().document().inspect(&[]);
        let reasons = inspection.primitives[0].reasons.iter();
        reasons.map(|reason| reason.text.clone()).collect()
    };
    let has =
        |reasons: Vec<String>, color: &str| reasons.contains(&format!("its colour is {color}"));
    assert!(has(reasons([0.1, 0.5, 0.1], false), "green"));
    assert!(has(reasons([0.4, 0.2, 0.1], false), "brown"));
    assert!(!has(reasons([0.1, 0.5, 0.1], true), "green"));
}
