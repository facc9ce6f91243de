//! Levels with textures of their own, and pictures as levels.

use super::fixtures::*;
use super::*;
use crate::TexelContent;
use crate::write::tests::texels::with_webp_beside;

#[test]
fn a_picture_is_the_last_level_in_every_layout() {
    let folder = tempfile::tempdir().unwrap();
    let picture = picture();
    let mut files = Vec::new();
    for (name, fixture) in all() {
        let tree = fixture.tree();
        let lods = lods(&tree);
        for layout in LAYOUTS {
            let what = format!("{name}, {layout:?}");
            let mut levels = levels(&lods[..2]);
            levels.push(Level::of_surface("oak", 2, &picture, facts(2)));
            let chain = tree.chain_to_bytes("oak", &levels, layout).unwrap();
            assert_eq!(chain.triangles[2], 2, "{what}");
            let is_alone = layout == Layout::Files;
            let last = document(&chain, if is_alone { 2 } else { 0 });
            let node = node_named(&last.root, "oak_LOD2");
            assert_eq!(triangles_below(&last, node), 2, "{what}");
            assert_eq!(last.root["nodes"][node]["extras"]["distance"], 20, "{what}");
            let mesh = last.root["nodes"][node]["mesh"].as_u64().unwrap() as usize;
            let primitive = &last.root["meshes"][mesh]["primitives"][0];
            // Along u is along x; the top of the picture is up.
            let tangents = primitive["attributes"]["TANGENT"].as_u64().unwrap();
            let tangents = last.elements(tangents as usize).unwrap();
            let tangents: Vec<[f64; 4]> = tangents.vectors::<4>().collect();
            assert_eq!(tangents, [[1.0, 0.0, 0.0, 1.0]; 4], "{what}");
            let material = primitive["material"].as_u64().unwrap() as usize;
            let material = &last.root["materials"][material];
            assert_eq!(material["alphaMode"], "MASK", "{what}");
            assert_eq!(material["doubleSided"], true, "{what}");
            if is_alone {
                let count = |list: &str| last.root[list].as_array().map_or(0, Vec::len);
                let counts = ["nodes", "meshes", "materials", "textures", "images"].map(count);
                assert_eq!(counts, [1, 1, 1, 2, 2], "{what}: nothing of the tree");
            }
            files.extend(written(
                &chain,
                folder.path(),
                &format!("{name}-{layout:?}"),
            ));
        }
    }
    assert_valid(&files);
    let mut warnings = warnings(&files);
    warnings.retain(|code| code != "NODE_SKINNED_MESH_NON_ROOT");
    assert_eq!(warnings, [""; 0]);
}

/// A texture of 2 x 2 texels of this colour, with a sampler of its own.
fn own_texture(color: [u8; 4], mips: Mips) -> LevelTexture {
    LevelTexture {
        image: None,
        keeps_sampler: false,
        material: 1,
        texture: Arc::new(Texture {
            width: 2,
            height: 2,
            rgba: color.repeat(4),
            wrap: [Wrap::ClampToEdge; 2],
            filters: Filters {
                mips,
                ..Filters::default()
            },
        }),
    }
}

/// The material of the leaves of a level.
fn leaf_material(document: &Document, level: usize) -> usize {
    let node = node_named(&document.root, &format!("oak_LOD{level}"));
    let mesh = document.root["nodes"][node]["mesh"].as_u64().unwrap();
    let primitives = document.root["meshes"][mesh as usize]["primitives"].as_array();
    let last = primitives.unwrap().last().unwrap();
    last["material"].as_u64().unwrap() as usize
}

/// Texels change, and what reads them stays: filters, wraps and names of samplers.
#[test]
fn levels_keep_the_sampler_where_that_is_asked_for() {
    let mut fixture = encodings::textured();
    let sampler = json!({"magFilter": 9728, "minFilter": 9986, "wrapS": 33648, "name": "crisp"});
    fixture.root["samplers"] = json!([sampler]);
    fixture.root["textures"][0]["sampler"] = 0.into();
    let plain = fixture.tree();
    let beside = with_webp_beside(fixture).tree();
    let own = [LevelTexture {
        image: None,
        keeps_sampler: true,
        ..own_texture([90, 80, 10, 255], Mips::None)
    }];
    for (layout, tree) in LAYOUTS
        .into_iter()
        .flat_map(|l| [(l, &plain), (l, &beside)])
    {
        let lods = lods(tree);
        let mut levels = levels(&lods);
        for level in &mut levels {
            level.textures = &own;
        }
        let chain = tree.chain_to_bytes("oak", &levels, layout).unwrap();
        for number in 0..levels.len() {
            let file = if layout == Layout::Files { number } else { 0 };
            let document = document(&chain, file);
            let material = leaf_material(&document, number);
            let root = &document.root;
            let index =
                &root["materials"][material]["pbrMetallicRoughness"]["baseColorTexture"]["index"];
            let texture = &root["textures"][index.as_u64().unwrap() as usize];
            let kept = texture["sampler"].as_u64().unwrap() as usize;
            assert_eq!(root["samplers"][kept], sampler, "{layout:?}");
            // A copy in another format would be of no extension that is used.
            assert_eq!(root["images"].as_array().unwrap().len(), 1, "{layout:?}");
            assert!(!root.to_string().contains("webp"), "{layout:?}");
            assert_eq!(document.images_of_material(material)[0].size, [2, 2]);
        }
    }
}

/// A normal map, and an image that is both roughness and occlusion: a level has others in their places, and its base
/// colour stays. Nothing is left of what nobody shows.
#[test]
fn levels_have_other_images_beside_the_base_colour() {
    let folder = tempfile::tempdir().unwrap();
    let mut files = Vec::new();
    let mut fixture = encodings::textured();
    for number in [1, 2] {
        let image = fixture.root["images"][0].clone();
        fixture.root["images"].as_array_mut().unwrap().push(image);
        let textures = fixture.root["textures"].as_array_mut().unwrap();
        textures.push(json!({"source": number}));
    }
    let material = &mut fixture.root["materials"][1];
    material["normalTexture"] = json!({"index": 1});
    material["occlusionTexture"] = json!({"index": 2});
    material["pbrMetallicRoughness"]["metallicRoughnessTexture"] = json!({"index": 2});
    let tree = fixture.tree();
    let lods = lods(&tree);
    let of_image = |image: usize| LevelTexture {
        image: Some(image),
        keeps_sampler: true,
        ..own_texture([128, 128, 255, 255], Mips::None)
    };
    let own = [of_image(1), of_image(2)];
    for layout in LAYOUTS {
        let mut levels = levels(&lods);
        for level in &mut levels[1..] {
            level.textures = &own;
        }
        let chain = tree.chain_to_bytes("oak", &levels, layout).unwrap();
        for number in 0..levels.len() {
            let file = if layout == Layout::Files { number } else { 0 };
            let document = document(&chain, file);
            let material = leaf_material(&document, number);
            let images = document.images_of_material(material);
            assert_eq!(images.len(), 4, "{layout:?}");
            for image in images {
                let expected = match image.is_base_color || number == 0 {
                    true => [1, 1],
                    false => [2, 2],
                };
                assert_eq!(image.size, expected, "{layout:?}, level {number}");
                let has_colors = image.content == TexelContent::Colors;
                assert_eq!(has_colors, image.is_base_color);
            }
            if layout == Layout::Files {
                let count = document.root["images"].as_array().unwrap().len();
                assert_eq!(count, 3, "level {number}");
            }
        }
        files.extend(written(&chain, folder.path(), &format!("{layout:?}")));
    }
    assert_valid(&files);
}

/// Leaf textures differ by level; what nobody needs any more is gone, and all else of the material
/// is as it was.
#[test]
fn levels_have_textures_of_their_own() {
    let folder = tempfile::tempdir().unwrap();
    let mut files = Vec::new();
    let tree = encodings::textured().tree();
    let lods = lods(&tree);
    let own = [
        vec![],
        vec![own_texture([10, 200, 30, 255], Mips::None)],
        vec![own_texture([90, 80, 10, 128], Mips::Blended)],
    ];
    let original = &tree.document.root["materials"][1];
    for layout in LAYOUTS {
        for is_all in [false, true] {
            let what = format!("{layout:?}, all {is_all}");
            let mut levels = levels(&lods);
            for (number, level) in levels.iter_mut().enumerate() {
                level.textures = &own[if is_all { number.max(1) } else { number }];
            }
            let chain = tree.chain_to_bytes("oak", &levels, layout).unwrap();
            let mut images = 0;
            for (number, level) in levels.iter().enumerate() {
                let file = if layout == Layout::Files { number } else { 0 };
                let mut document = document(&chain, file);
                // As if this level were all of the scene: else the finest is what is drawn.
                let node = node_named(&document.root, &level.name);
                document.root["scenes"][0]["nodes"] = json!([node]);
                let number = leaf_material(&document, number);
                let drawn = document.drawn(Detail::Color, &[]).unwrap();
                let leaf = drawn.iter().find(|d| d.material == Some(number));
                assert!(leaf.is_some(), "{what}");
                let shown = leaf.and_then(|leaf| leaf.surface.material.texture.as_ref());
                if let (Some(shown), [own]) = (shown, level.textures) {
                    assert_eq!(**shown, *own.texture, "{what}");
                }
                let mut material = document.root["materials"][number].clone();
                let index = &mut material["pbrMetallicRoughness"]["baseColorTexture"]["index"];
                *index = 0.into();
                material["name"] = original["name"].clone();
                assert_eq!(material, *original, "{what}");
                images = document.root["images"].as_array().unwrap().len();
                if layout == Layout::Files {
                    assert_eq!(images, 1, "{what}");
                }
                let of_material = document.images_of_material(number);
                let found = (of_material[0].size, of_material[0].has_mips);
                let expected = match level.textures {
                    [own] => ([2, 2], own.texture.filters.mips != Mips::None),
                    _ => ([1, 1], true),
                };
                assert_eq!(found, expected, "{what}");
                assert!(of_material[0].is_base_color && of_material.len() == 1);
            }
            if layout != Layout::Files {
                // The one of the tree is replaced where no level keeps it, and two levels share one.
                assert_eq!(images, if is_all { 2 } else { 3 }, "{what}");
            }
            for file in &chain.files {
                let path = folder
                    .path()
                    .join(format!("{layout:?}-{is_all}-{}", file.name));
                std::fs::write(&path, &file.bytes).unwrap();
                files.push(path);
            }
        }
    }
    assert_valid(&files);
    assert_eq!(warnings(&files), [""; 0]);
}

/// Importers that file materials and images by their names find those of each level: no two levels show another
/// thing of the same name, nothing that levels share is renamed, and the plant as it is keeps its names.
#[test]
fn what_a_level_shows_alone_is_called_after_it() {
    let mut fixture = encodings::textured();
    fixture.root["images"][0]["name"] = "foliage".into();
    fixture.root["textures"][0]["name"] = "crown".into();
    fixture.root["materials"][0]
        .as_object_mut()
        .unwrap()
        .remove("name");
    let tree = fixture.tree();
    let all = tree.foliage.leaves().len();
    let mut coarse = Lod::original(all);
    coarse.remove(secateur_model::LeafId::from_index(0));
    let lods = [Lod::original(all), coarse.clone(), coarse];
    let own = [own_texture([10, 200, 30, 255], Mips::None)];
    for layout in LAYOUTS {
        let mut levels = levels(&lods);
        levels[2].textures = &own;
        let chain = tree.chain_to_bytes("oak", &levels, layout).unwrap();
        for number in 0..levels.len() {
            let is_files = layout == Layout::Files;
            let document = document(&chain, if is_files { number } else { 0 });
            let root = &document.root;
            let material = &root["materials"][leaf_material(&document, number)];
            let texture = &material["pbrMetallicRoughness"]["baseColorTexture"]["index"];
            let texture = &root["textures"][texture.as_u64().unwrap() as usize];
            let image = &root["images"][texture["source"].as_u64().unwrap() as usize];
            let is_own = number == 2 || (is_files && number > 0);
            let suffix = if is_own {
                format!("_LOD{number}")
            } else {
                String::new()
            };
            let found =
                [material, texture, image].map(|entry| entry["name"].as_str().unwrap_or_default());
            let before = ["leaf", "crown", "foliage"].map(|name| format!("{name}{suffix}"));
            assert_eq!(found, before, "{layout:?} {number}");
            let bark = root["materials"][0].get("name");
            let expected = (is_files && number > 0).then(|| format!("material0_LOD{number}"));
            assert_eq!(
                bark.and_then(Value::as_str),
                expected.as_deref(),
                "{layout:?} {number}"
            );
        }
    }
}
