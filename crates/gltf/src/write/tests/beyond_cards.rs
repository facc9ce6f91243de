//! Materials of leaves that became triangles which reach beyond their cards.

use serde_json::{Value, json};

use super::fixture::{Fixture, read};
use super::made::beyond_its_corners;
use super::validator::assert_valid;
use super::{encodings, every_encoding::one_gone_one_grown};
use secateur_model::Lod;

/// Cards with a texture of 8 x 8 texels, repeated by default, and this cutoff.
fn cards(cutoff: f64, alpha: impl Fn(u32, u32) -> u8) -> Fixture {
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
fn middle(x: u32, y: u32) -> u8 {
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
    let material = &root["materials"][1];
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
