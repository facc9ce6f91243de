use std::sync::Arc;

use glam::Vec3;
use secateur_model::{
    AlphaMode, Finish, Foliage, LeafTriangle, Material, PlantSkeleton, Segment, SegmentIndex,
    Surface,
};

use super::*;

fn segment(parent: Option<usize>, continues_parent: bool, [start, end]: [DVec3; 2]) -> Segment {
    Segment {
        parent: parent.map(SegmentIndex::from_index),
        continues_parent,
        start,
        end,
        start_radius_m: 0.1,
        end_radius_m: 0.1,
        sides: 3,
    }
}

/// A trunk of two segments, a bough along x with a twig, and a tiny shoot; a leaf at the end of each,
/// and one that grows on nothing.
fn plant() -> (Foliage, PlantSkeleton) {
    let at = |x: f64, y: f64| DVec3::new(x, y, 0.0);
    let segments = vec![
        segment(None, false, [at(0.0, 0.0), at(0.0, 2.0)]),
        segment(Some(0), true, [at(0.0, 2.0), at(0.0, 4.0)]),
        segment(Some(0), false, [at(0.0, 2.0), at(3.0, 2.0)]),
        segment(Some(2), false, [at(2.0, 2.0), at(2.0, 3.0)]),
        segment(Some(1), false, [at(0.0, 3.0), at(-0.1, 3.0)]),
    ];
    let mut foliage = Foliage::default();
    // Leaves of the bough are apart from each other, so that its box has a volume.
    let ends = [
        at(0.0, 4.0),
        at(3.0, 2.0),
        at(2.0, 3.0),
        at(-0.1, 3.0),
        at(-1.0, 0.0),
    ];
    for end in ends {
        let corners = [
            end,
            end + DVec3::new(0.1, 0.0, 0.1),
            end + DVec3::new(0.0, 0.1, 0.2),
        ];
        foliage
            .push_leaf(&[LeafTriangle::plain(corners)], None)
            .unwrap();
    }
    let on = [Some(1), Some(2), Some(3), Some(4), None];
    let leaf_segments = on.map(|s| s.map(SegmentIndex::from_index)).to_vec();
    let skeleton = PlantSkeleton {
        segments,
        leaf_segments,
    };
    skeleton.check(5).unwrap();
    (foliage, skeleton)
}

fn boxes(top_level: u32, least_volume: f64) -> Vec<LeafBox> {
    let (foliage, skeleton) = plant();
    let limits = BoxLimits {
        top_level,
        least_volume,
    };
    leaf_boxes(&foliage, &skeleton, &limits)
}

fn numbers(leaves: &[LeafId]) -> Vec<usize> {
    leaves.iter().map(|leaf| leaf.index()).collect()
}

#[test]
fn a_branch_has_a_box_about_its_leaves_and_those_of_what_grows_from_it() {
    let boxes = boxes(2, 0.0);
    // The whole plant, the bough, its twig, the shoot.
    assert_eq!(boxes.len(), 4);
    assert_eq!(numbers(&boxes[0].leaves), [0, 1, 2, 3, 4]);
    assert_eq!(
        numbers(&boxes[0].own),
        [0, 4],
        "the trunk's, and the loose one"
    );
    let bough = &boxes[boxes[0].children[0]];
    assert_eq!(
        (numbers(&bough.leaves), numbers(&bough.own)),
        (vec![1, 2], vec![1])
    );
    assert_eq!(bough.bounds.axes[1], DVec3::X, "along the branch");
    // From 2 to 3.1 along x, from 2 to 3.1 upwards, .2 deep.
    let lengths = 2.0 * bough.bounds.half;
    assert!((lengths.y - 1.1).abs() < 1e-9, "{lengths}");
    assert!((lengths.element_product() - 1.1 * 1.1 * 0.2).abs() < 1e-9);
    assert!(bough.bounds.centre.distance(DVec3::new(2.55, 2.55, 0.1)) < 1e-9);
}

#[test]
fn the_top_level_and_small_volumes_end_the_boxes_and_leaves_stay_with_the_last() {
    let shallow = boxes(1, 0.0);
    assert_eq!(shallow.iter().map(|b| b.level).max(), Some(1));
    let bough = &shallow[shallow[0].children[0]];
    assert_eq!(numbers(&bough.own), [1, 2]);
    // The shoot's box holds one leaf.
    let large = boxes(2, 0.01);
    assert_eq!(large.len(), 2);
    assert_eq!(numbers(&large[0].own), [0, 3, 4]);
    assert_eq!(numbers(&large[1].own), [1, 2]);
    let none = boxes(0, 0.0);
    assert_eq!(none.len(), 1);
    assert_eq!(numbers(&none[0].own), [0, 1, 2, 3, 4]);
}

#[test]
fn every_leaf_is_drawn_once_at_every_size() {
    let boxes = boxes(2, 0.0);
    for px in [0.5, 1.0, 1.05, 1.2, 2.0, 50.0] {
        let cut = cut(&boxes, 1.0, 0.1, |bounds| px * bounds.radius());
        let mut counts = [0.0; 5];
        for (index, weight) in &cut.boxes {
            for leaf in &boxes[*index].leaves {
                counts[leaf.index()] += weight;
            }
        }
        for (index, weight) in &cut.own_leaves {
            for leaf in &boxes[*index].own {
                counts[leaf.index()] += weight;
            }
        }
        assert!(
            counts.iter().all(|count| (count - 1.0f64).abs() < 1e-9),
            "{px}: {counts:?}"
        );
    }
    let far = cut(&boxes, 1.0, 0.1, |_| 0.9);
    assert_eq!((far.boxes, far.own_leaves), (vec![(0, 1.0)], vec![]));
}

#[test]
fn diagonal_planes_hold_opposite_edges() {
    let bounds = OrientedBox {
        centre: DVec3::new(1.0, 0.0, 0.0),
        axes: [DVec3::X, DVec3::Y, DVec3::Z],
        half: DVec3::new(1.0, 2.0, 3.0),
    };
    let planes = diagonal_planes(&bounds);
    for plane in &planes {
        for (right, up) in [(1.0, 1.0), (-1.0, 1.0), (1.0, -1.0)] {
            let corner = plane.centre + right * plane.right + up * plane.up - bounds.centre;
            assert_eq!(corner.abs(), bounds.half, "a corner of the box");
        }
        assert!(plane.right.dot(plane.up).abs() < 1e-12);
        assert!(plane.toward.dot(plane.right).abs() < 1e-12);
        assert!((plane.toward.length() - 1.0).abs() < 1e-12);
    }
    for toward in [DVec3::X, DVec3::Y, DVec3::new(1.0, 1.0, 1.0).normalize()] {
        let found = weights(&planes, toward);
        assert!((found.iter().sum::<f64>() - 1.0).abs() < 1e-12);
    }
    // Who looks straight on a plane of a cube sees no other as squarely.
    let cube = diagonal_planes(&OrientedBox {
        half: DVec3::ONE,
        ..bounds
    });
    let found = weights(&cube, cube[2].toward);
    assert!(
        found
            .iter()
            .enumerate()
            .all(|(k, w)| k == 2 || *w < found[2])
    );
}

#[test]
fn a_picture_shows_what_is_in_the_box() {
    // A square of side 2 that faces the plane between x and z, red.
    let bounds = OrientedBox {
        centre: DVec3::ZERO,
        axes: [DVec3::X, DVec3::Y, DVec3::Z],
        half: DVec3::new(1.0, 2.0, 1.0),
    };
    let plane = diagonal_planes(&bounds)[2];
    let right = plane.right.normalize();
    let at = |x: f64, y: f64| right * x + DVec3::Y * y;
    let material = Material {
        name: String::new(),
        base_color: [1.0, 0.0, 0.0, 1.0],
        texture: None,
        alpha_mode: AlphaMode::Opaque,
        double_sided: true,
        finish: Finish::default(),
    };
    let square = Surface {
        positions: vec![at(-1.0, -1.0), at(1.0, -1.0), at(1.0, 1.0), at(-1.0, 1.0)],
        normals: vec![plane.toward.as_vec3(); 4],
        uvs: Vec::new(),
        colors: Vec::new(),
        holds: Vec::new(),
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        material: Arc::new(material),
    };
    let picture = picture(&[square], &plane, 8);
    // Half as high as the box: 4 of 8 rows and columns.
    let covered = picture.rgba.chunks(4).filter(|texel| texel[3] == 255);
    assert_eq!(covered.count(), 16);
    let middle = 4 * (4 * 8 + 4);
    assert_eq!(picture.rgba[middle..middle + 4], [255, 0, 0, 255]);
    let normal = picture.normals[middle..middle + 3].iter();
    let normal: Vec<f32> = normal.map(|b| f32::from(*b) / 127.5 - 1.0).collect();
    assert!(Vec3::from_slice(&normal).distance(plane.toward.as_vec3()) < 0.02);
    assert_eq!(picture.extent[1], 1.0);
    assert!((picture.extent[0] - 2.0f64.sqrt() / 2.0).abs() < 1e-12);
}
