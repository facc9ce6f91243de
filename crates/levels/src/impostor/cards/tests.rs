//! What cards show, and how many there are.

use std::sync::Arc;

use glam::Vec3;
use secateur_model::{AlphaMode, Finish, Material};

use super::*;

/// A square of side 1 that faces the eye at +z, from a corner on.
fn square(corner: DVec3, base_color: [f32; 4]) -> Surface {
    let at = |x, y| corner + DVec3::new(x, y, 0.0);
    Surface {
        positions: vec![at(0.0, 0.0), at(1.0, 0.0), at(1.0, 1.0), at(0.0, 1.0)],
        normals: vec![Vec3::Z; 4],
        uvs: Vec::new(),
        colors: Vec::new(),
        holds: Vec::new(),
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        material: Arc::new(Material {
            name: String::new(),
            base_color,
            texture: None,
            alpha_mode: AlphaMode::Opaque,
            double_sided: true,
            finish: Finish::default(),
        }),
    }
}

/// Two squares, one far behind the other.
fn two() -> [Surface; 2] {
    let red = square(DVec3::ZERO, [1.0, 0.0, 0.0, 1.0]);
    let green = square(DVec3::new(0.2, 0.0, -5.0), [0.0, 1.0, 0.0, 1.0]);
    [red, green]
}

#[test]
fn each_card_shows_what_lies_in_it_where_it_lies() {
    let surfaces = two();
    let cards = Cards::new(&surfaces, 2);
    assert_eq!(cards.count(), 2);
    let Baked { surface, texel_px } = cards
        .baked(64.0, Texels::up_to(f64::INFINITY, 64.0, false))
        .unwrap();
    assert_eq!(texel_px, 0.5);
    assert_eq!(surface.triangles.len(), 4);
    let texture = surface.material.texture.as_ref().unwrap();
    for (card, quad) in surface.positions.chunks(4).enumerate() {
        let middle = quad.iter().sum::<DVec3>() / 4.0;
        let uvs = &surface.uvs[4 * card..4 * card + 4];
        let uv = uvs.iter().sum::<Vec2>() / 4.0;
        let texel = uv * Vec2::new(texture.width as f32, texture.height as f32);
        let at = 4 * (texel.y as u32 * texture.width + texel.x as u32) as usize;
        let wanted: ([f64; 3], [u8; 4]) = match middle.z > -1.0 {
            true => ([0.5, 0.5, 0.0], [255, 0, 0, 255]),
            false => ([0.7, 0.5, -5.0], [0, 255, 0, 255]),
        };
        assert!(middle.distance(DVec3::from(wanted.0)) < 1e-9, "{middle}");
        assert_eq!(texture.rgba[at..at + 4], wanted.1);
        // A rim of a texel is about the square.
        let side = quad[0].distance(quad[1]);
        assert!(side > 1.0 && side < 1.0 + 4.0 / 64.0, "{side}");
    }
}

/// What has one side is seen from that side, whichever way it faces.
#[test]
fn what_has_one_side_is_baked_from_there() {
    for corners in [[0, 1, 2], [0, 2, 1]] {
        let mut surface = square(DVec3::ZERO, [1.0, 0.0, 0.0, 1.0]);
        Arc::make_mut(&mut surface.material).double_sided = false;
        surface.triangles = vec![corners];
        let surfaces = [surface];
        let Baked { surface, .. } = Cards::new(&surfaces, 1)
            .baked(64.0, Texels::up_to(2.0, 64.0, false))
            .unwrap();
        let texture = surface.material.texture.as_ref().unwrap();
        let is_there = texture
            .rgba
            .chunks(4)
            .filter(|texel| texel[3] > 128)
            .count();
        assert!(is_there > 128 * 128 / 3, "{corners:?}: {is_there} texels");
    }
}

/// Two sticks of one area: neither has more than layers have in the mean.
#[test]
fn stems_have_two_cards_where_they_are_to_cross() {
    let stick = |x: f64| {
        let mut stick = square(DVec3::ZERO, [0.3, 0.2, 0.1, 1.0]);
        Arc::make_mut(&mut stick.material).double_sided = false;
        let corners = [[0.0, 0.0], [0.1, 0.0], [0.0, 0.1]];
        stick.positions = [0.0, 1.0]
            .iter()
            .flat_map(|y| corners.map(|[dx, z]| DVec3::new(x + dx, *y, z)))
            .collect();
        stick.normals = vec![Vec3::X; 6];
        stick.triangles = [[0, 1], [1, 2], [2, 0]]
            .iter()
            .flat_map(|[a, b]| [[*a, *b, a + 3], [*b, b + 3, a + 3]])
            .collect();
        stick
    };
    let surfaces = [stick(0.0), stick(9.0)];
    assert_eq!(Cards::new(&surfaces, 2).count(), 2);
    assert_eq!(Cards::with_crossed_stems(&surfaces, 2).count(), 4);
}

/// From wherever a trunk is seen, one of its cards does not stand on edge.
#[test]
fn a_trunk_has_two_cards_that_cross() {
    let mut trunk = square(DVec3::ZERO, [0.3, 0.2, 0.1, 1.0]);
    Arc::make_mut(&mut trunk.material).double_sided = false;
    let leaf = |z: f64| {
        let mut leaf = square(DVec3::new(9.0, 9.0, z), [0.0, 1.0, 0.0, 1.0]);
        for position in &mut leaf.positions {
            *position = (*position - DVec3::new(9.0, 9.0, z)) * 0.1 + DVec3::new(9.0, 9.0, z);
        }
        leaf
    };
    let surfaces = [trunk, leaf(0.0), leaf(9.0)];
    let cards = Cards::new(&surfaces, 3);
    let of_trunk = cards
        .cards
        .iter()
        .filter(|card| card.triangles.contains_key(&0));
    let toward: Vec<DVec3> = of_trunk.map(|card| card.axes[2]).collect();
    let [one, other] = toward[..] else {
        panic!("{} cards of the trunk", toward.len())
    };
    assert!(one.dot(other).abs() < 1e-9, "{one} and {other}");
    assert_eq!(cards.count(), 4, "a leaf has one");
}

#[test]
fn texels_are_as_fine_as_an_atlas_has_room_for() {
    let surfaces = two();
    let cards = Cards::new(&surfaces, 2);
    assert!(
        cards.fit(256.0, Texels::up_to(0.5, 256.0, false))
            && !cards.fit(1e5, Texels::up_to(2.0, 1e5, false))
    );
    assert!(cards.baked(1e5, Texels::up_to(2.0, 1e5, false)).is_none());
    let Baked { surface, texel_px } = cards
        .baked(1e5, Texels::up_to(f64::INFINITY, 1e5, false))
        .unwrap();
    assert!(texel_px > 40.0, "{texel_px}");
    let texture = surface.material.texture.as_ref().unwrap();
    assert!(texture.width.max(texture.height) <= MOST_ATLAS);
    // Where there is nothing to see, there are no cards.
    assert!(
        Cards::<Surface>::new(&[], 5)
            .baked(64.0, Texels::up_to(2.0, 64.0, false))
            .is_none()
    );
}
