//! Grown plants as GLB.

use std::sync::Arc;

use glam::{DVec3, Vec2, Vec3, Vec4};

use super::validator::assert_valid;
use crate::{Document, Selector, plant_into_glb, plant_to_glb};
use secateur_model::{AlphaMode, Material, Plant, Surface, Texture, Wrap};

fn material(name: &str, alpha_mode: AlphaMode, texture: Option<Arc<Texture>>) -> Arc<Material> {
    Arc::new(Material {
        name: name.to_owned(),
        base_color: [0.5, 0.25, 1.5, 1.0],
        texture,
        alpha_mode,
        double_sided: true,
        finish: secateur_model::Finish::default(),
    })
}

fn surface(squares: usize, material: Arc<Material>) -> Surface {
    let positions: Vec<DVec3> = super::fixture::squares(squares)
        .iter()
        .map(|p| Vec3::from_array(*p).as_dvec3())
        .collect();
    let indices = super::fixture::square_indices(squares);
    Surface {
        normals: vec![Vec3::new(0.0, 0.0, 0.5); positions.len()],
        uvs: [Vec2::ZERO, Vec2::X, Vec2::ONE, Vec2::Y].repeat(squares),
        colors: vec![Vec4::new(0.1, 0.2, 1.2, 1.0); positions.len()],
        holds: Vec::new(),
        triangles: indices.chunks(3).map(|t| [t[0], t[1], t[2]]).collect(),
        positions,
        material,
    }
}

pub(super) fn plant(leaves: usize) -> Plant {
    let texture = Arc::new(Texture {
        width: 2,
        height: 1,
        rgba: vec![10, 200, 30, 255, 0, 0, 0, 0],
        wrap: [Wrap::ClampToEdge, Wrap::MirroredRepeat],
        filters: secateur_model::Filters::default(),
    });
    Plant {
        name: "Larch".to_owned(),
        wood: surface(
            3,
            material("bark", AlphaMode::Opaque, Some(Arc::clone(&texture))),
        ),
        leaves: surface(
            leaves,
            material("leaf", AlphaMode::Mask(0.5), Some(texture)),
        ),
        triangles_per_leaf: vec![2; leaves],
        skeleton: None,
        holds: None,
    }
}

#[test]
fn a_grown_plant_can_be_read_back() {
    let folder = tempfile::tempdir().unwrap();
    let (path, bare) = (
        folder.path().join("larch.glb"),
        folder.path().join("bare.glb"),
    );
    std::fs::write(&path, plant_to_glb(&plant(5))).unwrap();
    std::fs::write(&bare, plant_to_glb(&plant(0))).unwrap();
    assert_valid(&[path.clone(), bare]);

    let leaves = [Selector::Material("leaf".to_owned())];
    let tree = Document::open(&path).unwrap().into_tree(&leaves).unwrap();
    let names = ["Tree", "Branches", "Leaves"];
    let nodes = tree.document.root["nodes"].as_array().unwrap();
    assert!(
        names
            .iter()
            .all(|name| nodes.iter().any(|node| node["name"] == *name))
    );
    assert_eq!(tree.document.root["scenes"][0]["name"], "Larch");
    assert_eq!(tree.document.root["images"].as_array().unwrap().len(), 1);
    assert_eq!(tree.foliage.leaves().len(), 5);
    assert_eq!(tree.wood_triangle_count(), 6);
    // One of two texels is opaque, and the corners are those of the plant.
    assert_eq!(tree.foliage.cutouts()[0].coverage(), 0.5);
    let plant = plant(5);
    for (triangle, corners) in tree.foliage.triangles().iter().zip(&plant.leaves.triangles) {
        let expected = corners.map(|corner| plant.leaves.positions[corner as usize]);
        assert_eq!(triangle.corners, expected);
    }
}

#[test]
fn the_same_plant_gives_the_same_bytes() {
    assert_eq!(plant_to_glb(&plant(2)), plant_to_glb(&plant(2)));
    assert_eq!(plant_to_glb(&plant(2)), plant_into_glb(plant(2)));
}

#[test]
#[should_panic = "a triangle names a position that is not there"]
fn a_broken_plant_is_not_written() {
    let mut plant = plant(1);
    plant.leaves.triangles[0][0] = 99;
    plant_to_glb(&plant);
}
