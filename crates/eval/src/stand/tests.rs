//! Squares, seen from the front.

use std::sync::Arc;

use glam::{DQuat, Vec3};
use secateur_model::{AlphaMode, Finish, Material};

use super::*;

/// A square of side 2 about the origin, across z, seen from both sides.
fn square() -> StandKind {
    let corners = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
    let material = Material {
        name: String::new(),
        base_color: [0.2, 0.4, 0.1, 1.0],
        texture: None,
        alpha_mode: AlphaMode::Opaque,
        double_sided: true,
        finish: Finish::default(),
    };
    StandKind::new(vec![Surface {
        positions: corners.map(|[x, y]| DVec3::new(x, y, 0.0)).into(),
        normals: vec![Vec3::Z; 4],
        uvs: Vec::new(),
        colors: Vec::new(),
        holds: Vec::new(),
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        material: Arc::new(material),
    }])
}

/// From (0, 0, 4), 90 degrees high and twice as wide.
fn camera() -> StandCamera {
    StandCamera {
        eye: DVec3::Z * 4.0,
        forward: DVec3::NEG_Z,
        up: DVec3::Y,
        tan_half_fov_y: 1.0,
        aspect: 2.0,
        near: 0.01,
    }
}

fn at(kind: &StandKind, world_from_own: DMat4) -> StandPlace<'_> {
    StandPlace {
        kind,
        world_from_own,
    }
}

/// 400 pixels show 8 m at that distance: a square of 2 m is 100 x 100 of them, one twice as far off a quarter. It
/// stands behind and to the left; the third is hidden by the first, the fourth stands behind the camera.
#[test]
fn what_is_seen_of_each_place_is_counted() {
    let kind = square();
    let at = |x: f64, z: f64| at(&kind, DMat4::from_translation(DVec3::new(x, 0.0, z)));
    let places = [at(0.0, 0.0), at(-5.0, -4.0), at(0.0, -4.0), at(0.0, 9.0)];
    let picture = StandPicture::of(&places, &camera(), 400);
    assert_eq!(picture.image.dimensions(), (800, 400));
    assert_eq!(picture.seen_px, [10_000.0, 2_500.0, 0.0, 0.0]);
    let judge = JudgedStand::new(picture);
    assert_eq!(judge.difference(&judge.picture).flip_mean, 0.0);
    // Without the second its own pixels differ, and those alone.
    let nothing = StandKind::new(Vec::new());
    let second = StandPlace {
        kind: &nothing,
        ..places[1]
    };
    let without = [places[0], second, places[2], places[3]];
    let found = judge.difference(&StandPicture::of(&without, &camera(), 400));
    assert!(
        found.flip_px[1] > 250.0 && found.flip_px[0] < 1.0,
        "{found:?}"
    );
    assert!(found.flip_mean > 0.0 && found.difference > 0.1);
}

/// A plant that is turned about y is drawn in its own space, one that leans in the world's: the same picture as that
/// of its vertices moved there.
#[test]
fn a_place_is_drawn_as_its_moved_vertices() {
    let kind = square();
    let lean = DQuat::from_rotation_x(0.5);
    for rotation in [DQuat::from_rotation_y(0.7), lean] {
        let scale = DVec3::splat(1.5);
        let place = DMat4::from_scale_rotation_translation(scale, rotation, DVec3::X);
        let moved = StandKind::new(kind.placed(place));
        let [one, other] = [at(&kind, place), at(&moved, DMat4::IDENTITY)]
            .map(|place| StandPicture::of(&[place], &camera(), 100));
        assert_eq!(one.seen_px, other.seen_px);
        let pairs = one.image.iter().zip(other.image.iter());
        assert!(pairs.into_iter().all(|(a, b)| a.abs_diff(*b) <= 1));
    }
}

#[test]
fn a_dithered_picture_has_a_share_of_the_next() {
    let kind = square();
    let shown = [at(&kind, DMat4::IDENTITY)];
    let [full, empty] = [&shown[..], &[]].map(|places| StandPicture::of(places, &camera(), 64));
    let covered = |picture: &StandPicture| picture.coverage.iter().sum::<f32>();
    assert_eq!(covered(&full.dithered(&empty, 0.25)), 0.75 * covered(&full));
    assert_eq!(full.dithered(&empty, 1.0).image, empty.image);
    assert_eq!(full.dithered(&empty, 0.0).image, full.image);
}

/// What the square hides stays hidden; where its edge halves a pixel, half of what is behind shows.
#[test]
fn another_picture_stands_behind_the_plants() {
    let kind = square();
    let camera = camera();
    // 50 pixels a metre: the right edge lies half a pixel beyond the 450th.
    let moved = DMat4::from_translation(DVec3::X * 0.01);
    let picture = StandPicture::of(&[at(&kind, moved)], &camera, 400);
    let plain = StandPicture::of(&[], &camera, 400).image;
    let red = RgbaImage::from_pixel(800, 400, image::Rgba([255, 0, 0, 255]));
    let mixed = picture.before(&red, &plain).image;
    assert_eq!(mixed.get_pixel(400, 200), picture.image.get_pixel(400, 200));
    assert_eq!(mixed.get_pixel(10, 10).0, [255, 0, 0, 255]);
    let [edge, own] = [&mixed, &picture.image].map(|image| image.get_pixel(450, 200).0);
    assert!(
        edge[0] > own[0] && edge[2] < own[2] && edge[2] > 0,
        "{edge:?} {own:?}"
    );
    assert_eq!(picture.before(&plain, &plain).image, picture.image);
}
