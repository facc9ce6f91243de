//! Materials of leaves that became triangles which reach beyond their cards.

use std::sync::Arc;

use serde_json::{Value, json};

use super::fixture::{Fixture, read};
use super::new_leaves::beyond_its_corners;
use super::validator::assert_valid;
use super::{encodings, every_encoding::one_gone_one_grown};
use crate::chain::{Layout, Level, LevelTexture};
use secateur_model::{Filters, Lod, Texture, Wrap};

/// Cards with a texture of 8 x 8 texels, repeated by default, and this cutoff.
pub(super) fn cards(cutoff: f64, alpha: impl Fn(u32, u32) -> u8) -> Fixture {
    let mut fixture = encodings::textured();
    let texel = |x, y| image::Rgba([10, 200, 30, alpha(x, y)]);
    let mut png = std::io::Cursor::new(Vec::new());
    let image = image::RgbaImage::from_fn(8, 8, texel);
    image.write_to(&mut png, image::ImageFormat::Png).unwrap();
    let view = fixture.view(&png.into_inner(), None);
    fixture.root["images"][0]["bufferView"] = view.into();
    let material = &mut fixture.root["materials"][1];
    material["alphaCutoff"] = cutoff.into();
    let info = &mut material["pbrMetallicRoughness"]["baseColorTexture"];
    info["extensions"]["KHR_texture_transform"] = json!({});
    fixture
}

/// Nine opaque texels in the middle of 64: a mean of .14.
pub(super) fn middle(x: u32, y: u32) -> u8 {
    match (3..6).contains(&x) && (3..6).contains(&y) {
        true => 255,
        false => 0,
    }
}

fn written(fixture: &Fixture, lod: impl Fn(&crate::Tree) -> Lod) -> Value {
    let tree = fixture.tree();
    let bytes = tree.lod_to_bytes(&lod(&tree)).unwrap();
    read(bytes).document.root.clone()
}

/// The leaves' cutoff, and how their texture wraps.
fn look(root: &Value) -> (f64, [Option<u64>; 2]) {
    look_of(root, 1)
}

fn look_of(root: &Value, material: usize) -> (f64, [Option<u64>; 2]) {
    let material = &root["materials"][material];
    let cutoff = material["alphaCutoff"].as_f64().unwrap();
    let texture = &material["pbrMetallicRoughness"]["baseColorTexture"]["index"];
    let texture = &root["textures"][texture.as_u64().unwrap() as usize];
    let sampler = texture["sampler"].as_u64();
    let wrap = |side: &str| root["samplers"][sampler? as usize][side].as_u64();
    (cutoff, ["wrapS", "wrapT"].map(wrap))
}

const CLAMPED: [Option<u64>; 2] = [Some(33071); 2];
const AS_IT_WAS: [Option<u64>; 2] = [None; 2];

#[test]
fn beside_triangles_around_cards_coarse_mips_show_nothing() {
    let fixture = cards(0.1, middle);
    // (255 * 9 / 64 + 2) / 255, rounded up.
    let root = written(&fixture, beyond_its_corners);
    assert_eq!(look(&root), (0.1485, CLAMPED));
    // Leaves that keep their cards keep their looks.
    let root = written(&fixture, one_gone_one_grown);
    assert_eq!(look(&root), (0.1, AS_IT_WAS));
}

#[test]
fn what_repeats_or_is_cut_at_its_rim_still_does() {
    let mut tiled = cards(0.1, middle);
    let uvs = [[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [0.0, 1.0]].repeat(4);
    let uvs = tiled.vectors(&uvs);
    tiled.leaf_primitive()["attributes"]["TEXCOORD_0"] = uvs.into();
    assert_eq!(look(&written(&tiled, beyond_its_corners)).1, AS_IT_WAS);
    let stem = cards(0.1, |x, y| middle(x, y).max(255 * u8::from(x == 4)));
    assert_eq!(look(&written(&stem, beyond_its_corners)).1, AS_IT_WAS);
}

#[test]
fn cutoffs_stay_where_a_higher_one_would_show() {
    let cutoff = |fixture: &Fixture| look(&written(fixture, beyond_its_corners)).0;
    assert_eq!(cutoff(&cards(0.5, middle)), 0.5, "the mean does not pass");
    let soft = |x, y| match middle(x, y) {
        0 => 30,
        alpha => alpha,
    };
    assert_eq!(cutoff(&cards(0.1, soft)), 0.1, "most texels would be lost");
    let full = |x, y| 255 - middle(x, y);
    assert_eq!(cutoff(&cards(0.1, full)), 0.1, "most of it is there");
}

/// Light that leaves give off comes from the same texture, with the sampler of before.
#[test]
fn what_shares_the_texture_stays_as_it_was() {
    let mut fixture = cards(0.5, middle);
    fixture.root["samplers"] = json!([{"minFilter": 9987}]);
    fixture.root["textures"][0]["sampler"] = 0.into();
    fixture.root["materials"][1]["emissiveTexture"] = json!({"index": 0});
    let root = written(&fixture, beyond_its_corners);
    assert_eq!(look(&root), (0.5, CLAMPED));
    assert_eq!(root["textures"][0], json!({"source": 0, "sampler": 0}));
    assert_eq!(root["samplers"][0], json!({"minFilter": 9987}));
    assert_eq!(root["samplers"][1]["minFilter"], 9987);

    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("shared.glb");
    let tree = fixture.tree();
    tree.write_lod(&beyond_its_corners(&tree), &path).unwrap();
    assert_valid(&[path]);
}

/// The material of the leaves of a level.
fn leaf_material(root: &Value, level: &str) -> usize {
    let nodes = root["nodes"].as_array().unwrap();
    let node = nodes.iter().find(|node| node["name"] == level).unwrap();
    let mesh = node["mesh"].as_u64().unwrap() as usize;
    let primitives = root["meshes"][mesh]["primitives"].as_array().unwrap();
    primitives.last().unwrap()["material"].as_u64().unwrap() as usize
}

/// In one file only the levels that need it have another cutoff and sampler, with or without a texture of
/// their own.
#[test]
fn levels_that_keep_their_cards_keep_their_looks_beside_others() {
    let folder = tempfile::tempdir().unwrap();
    let mut files = Vec::new();
    let tree = cards(0.1, middle).tree();
    let lods = [
        one_gone_one_grown(&tree),
        beyond_its_corners(&tree),
        beyond_its_corners(&tree),
    ];
    let texture = Texture {
        width: 2,
        height: 2,
        rgba: [10, 200, 30, 255].repeat(4),
        wrap: [Wrap::MirroredRepeat; 2],
        filters: Filters::default(),
    };
    let own = [LevelTexture {
        image: None,
        keeps_sampler: false,
        material: 1,
        texture: Arc::new(texture),
    }];
    for layout in [Layout::Siblings, Layout::Msft] {
        let level = |(k, lod)| {
            let facts = json!({ "screen_coverage": 0.5 / (k + 1) as f64 });
            Level::new("oak", k, lod, facts.as_object().unwrap().clone())
        };
        let mut levels: Vec<Level<'_>> = lods.iter().enumerate().map(level).collect();
        levels[2] = levels[2].clone().with_textures(&own);
        let chain = tree.chain_to_bytes("oak", &levels, layout).unwrap();
        let bytes = chain.files[0].bytes.clone();
        let root = read(bytes.clone()).document.root.clone();
        let of_level = |k: usize| look_of(&root, leaf_material(&root, &format!("oak_LOD{k}")));
        assert_eq!(of_level(0), (0.1, AS_IT_WAS), "{layout:?}");
        assert_eq!(of_level(1), (0.1485, CLAMPED), "{layout:?}");
        assert_eq!(of_level(2), (0.1485, [Some(33648); 2]), "{layout:?}");
        assert_eq!(root["images"].as_array().unwrap().len(), 2, "{layout:?}");
        files.push(folder.path().join(format!("{layout:?}.glb")));
        std::fs::write(files.last().unwrap(), bytes).unwrap();
        // Where all levels need it the tree's own material is changed.
        let chain = tree.chain_to_bytes("oak", &levels[1..2], layout).unwrap();
        let root = read(chain.files[0].bytes.clone()).document.root.clone();
        assert_eq!(root["materials"].as_array().unwrap().len(), 2, "{layout:?}");
        assert_eq!(look(&root), (0.1485, CLAMPED), "{layout:?}");
    }
    assert_valid(&files);
}
