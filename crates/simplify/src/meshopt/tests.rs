use glam::{DVec2, DVec3};
use secateur_model::{LeafTriangle, Lod};

use super::*;

/// Textured squares of side 1, two apart.
fn squares(count: usize) -> Foliage {
    let mut foliage = Foliage::default();
    for k in 0..count {
        let corners = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)];
        let place = DVec3::X * 3.0 * k as f64;
        let triangles = [[0, 1, 2], [0, 2, 3]].map(|t| LeafTriangle {
            corners: t.map(|k: usize| place + DVec3::new(corners[k].0, corners[k].1, 0.0)),
            uvs: t.map(|k| DVec2::from(corners[k])),
        });
        foliage.push_leaf(&triangles, None).unwrap();
    }
    foliage
}

fn level(foliage: &Foliage, leaves: usize, options: MeshoptOptions) -> Foliage {
    let share = leaves as f64 / foliage.leaves().len() as f64;
    let order = simplify(foliage, share, options);
    Lod::after(&order, order.len()).foliage(foliage)
}

fn with(mode: Mode) -> MeshoptOptions {
    MeshoptOptions {
        mode,
        borders: Borders::Stay,
    }
}

fn area(foliage: &Foliage) -> f64 {
    foliage.leaves().iter().map(|leaf| leaf.area()).sum()
}

/// Sixteen squares have 32 triangles, a quarter of them is 8.
#[test]
fn pruning_reaches_the_share_of_triangles() {
    let foliage = squares(16);
    let pruned = level(&foliage, 4, with(Mode::Prune));
    assert!(
        pruned.triangles().len() <= 8,
        "{}",
        pruned.triangles().len()
    );
    assert!(!pruned.leaves().is_empty());
}

/// What is left of a square is a triangle, or the square.
#[test]
fn no_mode_leaves_more_than_the_share() {
    let foliage = squares(16);
    for mode in [Mode::Plain, Mode::Prune, Mode::Sloppy] {
        let left = level(&foliage, 8, with(mode));
        assert!(left.triangles().len() <= 16, "{mode:?}");
        assert!((1..=16).contains(&left.leaves().len()), "{mode:?}");
    }
}

#[test]
fn no_vertex_moves_without_dilation() {
    let foliage = squares(12);
    let known: Vec<DVec3> = foliage.triangles().iter().flat_map(|t| t.corners).collect();
    for mode in [Mode::Plain, Mode::Prune, Mode::Sloppy] {
        let left = level(&foliage, 5, with(mode));
        let mut corners = left.triangles().iter().flat_map(|t| t.corners);
        assert!(corners.all(|c| known.contains(&c)), "{mode:?}");
    }
}

#[test]
fn lost_area_comes_back() {
    let foliage = squares(16);
    let plain = area(&level(&foliage, 4, with(Mode::Prune)));
    for borders in [Borders::PreserveArea, Borders::Dilate] {
        let options = MeshoptOptions {
            borders,
            ..with(Mode::Prune)
        };
        let wide = level(&foliage, 4, options);
        assert!(wide.triangles().len() <= 8, "{borders:?}");
        let wide = area(&wide);
        assert!(wide > 1.5 * plain, "{borders:?}: {wide} for {plain}");
        assert!(wide < 3.0 * area(&foliage), "{borders:?}: {wide}");
    }
}

#[test]
fn nothing_and_everything_are_levels() {
    let foliage = squares(3);
    assert!(simplify(&foliage, 1.0, with(Mode::Prune)).is_empty());
    assert!(level(&foliage, 0, with(Mode::Prune)).leaves().is_empty());
    let mut point = Foliage::default();
    point
        .push_leaf(&[LeafTriangle::plain([DVec3::ONE; 3])], None)
        .unwrap();
    assert!(level(&point, 0, with(Mode::Sloppy)).leaves().is_empty());
}
