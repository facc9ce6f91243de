//! Leaves that are seen from one side are seen from the same side at every level.

use std::f64::consts::TAU;

use glam::{DQuat, DVec2, DVec3, EulerRot};
use secateur_gltf::{Document, Tree, surfaces_to_glb};
use secateur_model::{AlphaMode, Facing, Finish, Foliage, Leaf, LeafTriangle, Material, Surface};
use secateur_simplify::fsa::FsaOptions;
use secateur_simplify::meshopt::MeshoptOptions;
use secateur_simplify::{Method, Options, Target, simplify};
use serde_json::json;

/// Leaves of an arch of two quads each, on a cylinder about y, seen from outside only.
fn crown() -> Surface {
    let mut surface = Surface::empty(std::sync::Arc::new(Material {
        name: "leaf".to_owned(),
        base_color: [0.2, 0.6, 0.1, 1.0],
        texture: None,
        alpha_mode: AlphaMode::Opaque,
        double_sided: false,
        finish: Finish::default(),
    }));
    for k in 0..48 {
        let turn = DQuat::from_euler(EulerRot::YXZ, TAU * f64::from(k) / 12.0, 0.0, 0.4);
        let base = DVec3::new(0.0, f64::from(k / 12) * 0.6, 0.0);
        let first = surface.positions.len() as u32;
        for row in 0..3 {
            for side in [-0.2, 0.2] {
                let bend = if row == 1 { 0.05 } else { 0.0 };
                let along = 0.2 * f64::from(row) - 0.2;
                let local = DVec3::new(side, along, 1.0 + bend);
                surface.positions.push(base + turn * local);
            }
        }
        for row in [0, 2] {
            let [a, b, c, d] = [0, 1, 3, 2].map(|corner| first + row + corner);
            surface.triangles.extend([[a, b, c], [a, c, d]]);
        }
    }
    surface
}

/// The crown, its leaf node scaled by -1 along x if so wished.
fn tree(is_mirrored: bool) -> Tree {
    let glb = surfaces_to_glb("crown", &[(crown(), true)]);
    let length = |at: usize| u32::from_le_bytes(glb[at..at + 4].try_into().unwrap()) as usize;
    let json_end = 20 + length(12);
    let mut root: serde_json::Value = serde_json::from_slice(&glb[20..json_end]).unwrap();
    if is_mirrored {
        for node in root["nodes"].as_array_mut().unwrap() {
            if node.get("mesh").is_some() {
                node["scale"] = json!([-1, 1, 1]);
            }
        }
    }
    let mut text = root.to_string().into_bytes();
    text.resize(text.len().next_multiple_of(4), b' ');
    let mut bytes = glb[..12].to_vec();
    bytes.extend((text.len() as u32).to_le_bytes());
    bytes.extend(b"JSON");
    bytes.extend(text);
    bytes.extend(&glb[json_end..]);
    let all = bytes.len() as u32;
    bytes[8..12].copy_from_slice(&all.to_le_bytes());
    read(bytes)
}

fn read(bytes: Vec<u8>) -> Tree {
    let document = Document::from_bytes("crown.glb", bytes, None).unwrap();
    document
        .into_tree(&["material:*".parse().unwrap()])
        .unwrap()
}

/// Leaves whose triangles all show their front to the outside, and all leaves.
fn outward(foliage: &Foliage) -> [usize; 2] {
    let is_outward = |leaf: &Leaf, triangles: &[LeafTriangle]| {
        let out = DVec2::new(leaf.centre().x, leaf.centre().z);
        triangles.iter().all(|t| {
            let [a, b, c] = t.corners;
            let normal = (b - a).cross(c - a);
            let front = match leaf.facing() {
                Facing::Both => return false,
                Facing::Counterclockwise => normal,
                Facing::Clockwise => -normal,
            };
            DVec2::new(front.x, front.z).dot(out) > 0.0
        })
    };
    let leaves = foliage.leaves().iter().enumerate();
    let count = leaves.filter(|(index, leaf)| {
        let id = secateur_model::LeafId::from_index(*index);
        is_outward(leaf, foliage.triangles_of(id))
    });
    [count.count(), foliage.leaves().len()]
}

#[test]
fn leaves_that_grow_or_get_coarser_show_the_side_that_they_showed() {
    let by = |method: Option<Method>, target: Target| Options {
        audit: false,
        method: method.unwrap_or_else(|| Options::to(target).method),
        ..Options::to(target)
    };
    let quarter = Target::triangle_share(0.25);
    let runs = [
        by(None, quarter),
        by(None, Target::leaf_share(0.25)),
        by(
            Some(Method::Fsa(FsaOptions::default())),
            Target::leaf_share(0.5),
        ),
        by(Some(Method::Meshopt(MeshoptOptions::default())), quarter),
    ];
    for is_mirrored in [false, true] {
        let tree = tree(is_mirrored);
        assert_eq!(outward(tree.foliage()), [48, 48]);
        for options in &runs {
            let made = simplify(tree.foliage(), options).unwrap();
            let what = format!("{}, mirrored: {is_mirrored}", options.method.name());
            let level = made.lod.foliage(tree.foliage());
            let [outside, all] = outward(&level);
            assert!(all > 0 && outside == all, "{what}: {outside} of {all}");
            let file = read(tree.lod_to_bytes(&made.lod).unwrap());
            let [outside, all] = outward(file.foliage());
            assert!(
                all > 0 && outside == all,
                "{what}, file: {outside} of {all}"
            );
            let mut warnings = made.warnings.iter().map(ToString::to_string);
            let is_told = warnings.any(|w| w.contains("not doubleSided"));
            assert!(is_told, "{what}");
        }
    }
}
