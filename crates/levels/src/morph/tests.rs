use std::f64::consts::TAU;

use glam::{DVec2, DVec3};
use secateur_model::{LeafTriangle, NewCorner, NewLeaf, Place};

use super::*;

/// A card of two triangles about this point, with a texture from corner to corner.
fn card(at: DVec3, half: f64) -> Vec<LeafTriangle> {
    let corner = |x: f64, y: f64| {
        let uv = DVec2::new(x, y);
        (at + half * (2.0 * uv - DVec2::ONE).extend(0.0), uv)
    };
    let [a, b, c, d] = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)].map(|(x, y)| corner(x, y));
    let triangle = |t: [(DVec3, DVec2); 3]| LeafTriangle {
        corners: t.map(|(at, _)| at),
        uvs: t.map(|(_, uv)| uv),
    };
    vec![triangle([a, b, c]), triangle([a, c, d])]
}

/// An open tube of rings of this many corners, which share their places.
fn tube(from: DVec3, to: DVec3, radius: f64, sides: usize, rings: usize) -> Vec<LeafTriangle> {
    let along = (to - from).normalize();
    let (x, y) = along.any_orthonormal_pair();
    let at = |ring: usize, side: usize| {
        let angle = TAU * (side % sides) as f64 / sides as f64;
        let middle = from.lerp(to, ring as f64 / (rings - 1) as f64);
        middle + radius * (angle.cos() * x + angle.sin() * y)
    };
    let cells = (0..rings - 1).flat_map(|ring| (0..sides).map(move |side| (ring, side)));
    cells
        .flat_map(|(ring, side)| {
            let [a, b] = [side, side + 1].map(|side| at(ring, side));
            let [c, d] = [side, side + 1].map(|side| at(ring + 1, side));
            [[a, b, c], [b, d, c]].map(LeafTriangle::plain)
        })
        .collect()
}

fn id(index: usize) -> LeafId {
    LeafId::from_index(index)
}

/// A leaf that is made of these triangles.
fn made(donor: usize, triangles: &[LeafTriangle]) -> NewLeaf {
    let corner = |at| NewCorner {
        place: Place::At(at),
        like: 0,
    };
    NewLeaf {
        donor: id(donor),
        triangles: triangles.iter().map(|t| t.corners.map(corner)).collect(),
    }
}

fn places(items: &Foliage, first_of_wood: usize, level: &Lod, next: &Lod) -> Vec<Vec<[DVec3; 3]>> {
    let next = Next::of(items, next, first_of_wood);
    let [left, made] = forms(items, level);
    let all = left.iter().chain(&made);
    all.map(|(item, form)| next.places(*item, form)).collect()
}

#[test]
fn a_leaf_that_stays_grows_and_one_that_goes_shrinks_to_its_centre() {
    let mut items = Foliage::default();
    for x in [0.0, 10.0] {
        items.push_leaf(&card(x * DVec3::X, 1.0), None).unwrap();
    }
    let mut next = Lod::original(2);
    next.remove(id(1));
    next.resize(id(0), 4.0);
    let found = places(&items, 2, &Lod::original(2), &next);
    let corner = |x: f64, y: f64| DVec3::new(x, y, 0.0);
    assert_eq!(
        found[0][0],
        [corner(-2.0, -2.0), corner(2.0, -2.0), corner(2.0, 2.0)]
    );
    assert_eq!(found[1], [[10.0 * DVec3::X; 3]; 2]);
}

/// The next level has one triangle about the left half of the card's texture: the right corners show of it what is
/// nearest. With a clear border they stay where they are.
#[test]
fn a_card_goes_to_where_a_coarser_one_shows_the_same() {
    let mut items = Foliage::new(Vec::new());
    items.push_leaf(&card(DVec3::ZERO, 1.0), None).unwrap();
    let in_plane = |weights: [f64; 3]| NewCorner {
        place: Place::InPlaneOf {
            corners: [0, 1, 5],
            weights,
        },
        like: 0,
    };
    // Corners 0, 1 and 5 are those at (0, 0), (1, 0) and (0, 1) of the texture.
    let half = NewLeaf {
        donor: id(0),
        triangles: vec![[[1.0, 0.0, 0.0], [0.5, 0.5, 0.0], [0.0, 0.0, 1.0]].map(in_plane)],
    };
    let mut next = Lod::original(1);
    next.remove(id(0));
    next.make(half);
    let [ref first, _] = places(&items, 1, &Lod::original(1), &next)[0][..] else {
        unreachable!("two triangles");
    };
    assert!(first[0].distance(DVec3::new(-1.0, -1.0, 0.0)) < 1e-12);
    assert!(first[1].distance(DVec3::new(0.0, -1.0, 0.0)) < 1e-12);
    // Of the line from (.5, 0) to (0, 1) in the texture (.3, .4) is nearest to (1, 1); it is found in world space.
    assert!((2.0 * (first[2].x + 1.0) + (first[2].y + 1.0) - 2.0).abs() < 1e-12);
    let form = &forms(&items, &Lod::original(1))[0][0].1;
    let [_, of_next] = forms(&items, &next);
    let of_next: Vec<Form<'_>> = of_next.into_iter().map(|(_, form)| form).collect();
    let clear = moved_along_texture(form, &of_next, true);
    assert!(clear[0][1].distance(DVec3::new(1.0, -1.0, 0.0)) < 1e-12);
}

/// Three of eight corners of each ring are those of the prism; the others are on its sides.
#[test]
fn a_tube_becomes_a_prism() {
    let mut items = Foliage::default();
    let all = tube(DVec3::ZERO, 4.0 * DVec3::Y, 1.0, 6, 2);
    items.push_leaf(&all, None).unwrap();
    let prism = tube(DVec3::ZERO, 4.0 * DVec3::Y, 1.2, 3, 2);
    let mut next = Lod::original(1);
    next.remove(id(0));
    next.make(made(0, &prism));
    let found = &places(&items, 0, &Lod::original(1), &next)[0];
    let [_, of_next] = forms(&items, &next);
    let surface = Surface::of(of_next.iter().map(|(_, form)| form));
    let corners: Vec<DVec3> = found.iter().flatten().copied().collect();
    for corner in &corners {
        assert!(surface.nearest(*corner).unwrap().distance < 1e-9);
    }
    for corner in prism.iter().flat_map(|t| t.corners) {
        let is_met = corners.iter().any(|other| other.distance(corner) < 1e-9);
        assert!(is_met, "nothing meets {corner}");
    }
}

/// A bough between two that stay: it draws back to the trunk, and none of it goes to its neighbours.
#[test]
fn a_bough_that_is_gone_draws_back_along_itself() {
    let trunk = tube(DVec3::ZERO, 8.0 * DVec3::Y, 0.5, 8, 17);
    let from = trunk.iter().flat_map(|t| t.corners);
    let near = |at: DVec3| {
        from.clone()
            .min_by(|a, b| a.distance(at).total_cmp(&b.distance(at)))
    };
    let bough = |y: f64| {
        let from = near(DVec3::new(0.0, y, 0.5)).unwrap();
        let mut bough = tube(from, from + 6.0 * DVec3::Z, 0.05, 3, 13);
        // Its foot is on the trunk.
        let foot = bough[0].corners[0];
        for corner in bough.iter_mut().flat_map(|t| &mut t.corners) {
            if *corner == foot {
                *corner = from;
            }
        }
        bough
    };
    let [low, middle, high] = [4.0, 4.5, 5.0].map(bough);
    let mut items = Foliage::default();
    let all = [&trunk[..], &low, &middle, &high].concat();
    items.push_leaf(&all, None).unwrap();
    let mut next = Lod::original(1);
    next.remove(id(0));
    next.make(made(0, &[&trunk[..], &low, &high].concat()));
    let found = &places(&items, 0, &Lod::original(1), &next)[0];
    let before = [trunk.len(), low.len()].iter().sum::<usize>();
    let gone = &found[before..before + middle.len()];
    for corner in gone.iter().flatten() {
        let off = corner.distance(near(DVec3::new(0.0, 4.5, 0.5)).unwrap());
        assert!(off < 0.3, "{corner} is {off} from its foot");
    }
    let stays = found[..before].iter().zip(&all);
    assert!(stays.clone().all(|(to, t)| *to == t.corners));
}

#[test]
fn a_piece_that_is_gone_draws_back_to_where_it_grows_on() {
    let mut items = Foliage::default();
    let trunk = tube(DVec3::ZERO, 8.0 * DVec3::Y, 0.5, 8, 2);
    items.push_leaf(&trunk, None).unwrap();
    let twig = tube(
        DVec3::new(0.6, 3.0, 0.0),
        DVec3::new(3.0, 3.0, 0.0),
        0.05,
        3,
        2,
    );
    items.push_leaf(&twig, None).unwrap();
    let mut next = Lod::original(2);
    next.remove(id(1));
    let found = &places(&items, 0, &Lod::original(2), &next)[1];
    let point = found[0][0];
    assert!(found.iter().flatten().all(|corner| *corner == point));
    assert!(point.distance(DVec3::new(0.5, 3.0, 0.0)) < 0.15, "{point}");
}
