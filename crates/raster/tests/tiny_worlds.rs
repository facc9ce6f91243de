//! Scenes of a few leaves whose images can be worked out by hand.

use std::collections::BTreeMap;
use std::sync::Arc;

use glam::{DVec2, DVec3};
use secateur_model::{Cutout, Facing, Foliage, LeafTriangle, Lod, Wrap};
use secateur_raster::abuffer::{ABuffer, Events};
use secateur_raster::{
    CpuRasteriser, Fragments, Rasteriser, Scene, TooManyFragments, View, ViewSet, cpu,
};

/// A camera at the origin looking along -z. At distance 8 an image of 16
/// pixels spans 16 units: a unit is a pixel, (0, 0) the image's middle.
fn ruler() -> ViewSet {
    let view = View::look_at(DVec3::ZERO, -DVec3::Z, DVec3::Y, 1.0, 0.5).unwrap();
    ViewSet::new(vec![view])
}

fn quad(x0: f64, y0: f64, x1: f64, y1: f64, distance: f64) -> [LeafTriangle; 2] {
    let at = |x, y| DVec3::new(x, y, -distance);
    let [a, b, c, d] = [at(x0, y0), at(x1, y0), at(x1, y1), at(x0, y1)];
    let [ua, ub, uc, ud] = [
        DVec2::new(0.0, 1.0),
        DVec2::new(1.0, 1.0),
        DVec2::new(1.0, 0.0),
        DVec2::new(0.0, 0.0),
    ];
    [
        LeafTriangle {
            corners: [a, b, c],
            uvs: [ua, ub, uc],
        },
        LeafTriangle {
            corners: [a, c, d],
            uvs: [ua, uc, ud],
        },
    ]
}

fn foliage(leaves: &[&[LeafTriangle]]) -> Foliage {
    let mut foliage = Foliage::default();
    for leaf in leaves {
        foliage.push_leaf(leaf, None).unwrap();
    }
    foliage
}

/// Areas of the only view, checked to be the same by drawing and by A-buffer,
/// and to sum to the pixels of the image.
fn areas(foliage: &Foliage, lod: &Lod) -> Vec<u32> {
    let views = ruler();
    let scene = Scene {
        foliage,
        lod,
        views: &views,
        resolution: 16,
    };
    let drawn = cpu::areas(&scene);
    let fragments = cpu::fragments(&scene);
    let fronts = cpu::histogram(&fragments.leaf_ids(0), foliage.leaves().len());
    assert_eq!(drawn.row(0), fronts);
    assert_eq!(fronts.iter().sum::<u32>(), 256);
    fronts
}

/// The A-buffer of the only view.
fn fragments(foliage: &Foliage, lod: &Lod) -> Fragments {
    cpu::fragments(&Scene {
        foliage,
        lod,
        views: &ruler(),
        resolution: 16,
    })
}

fn areas_of(leaves: &[&[LeafTriangle]]) -> Vec<u32> {
    areas(&foliage(leaves), &Lod::original(leaves.len()))
}

/// Two leaves that face the camera, and the same two with their corners the other way round.
#[test]
fn a_leaf_is_seen_from_the_sides_it_faces() {
    let front = quad(-4.0, -2.0, 4.0, 2.0, 8.0);
    let turned = front.map(|t| LeafTriangle {
        corners: [t.corners[0], t.corners[2], t.corners[1]],
        uvs: [t.uvs[0], t.uvs[2], t.uvs[1]],
    });
    for (triangles, facing, area_px) in [
        (front, Facing::Both, 32),
        (turned, Facing::Both, 32),
        (front, Facing::Counterclockwise, 32),
        (turned, Facing::Counterclockwise, 0),
        (front, Facing::Clockwise, 0),
        (turned, Facing::Clockwise, 32),
    ] {
        let mut alone = Foliage::default();
        alone.push_leaf_facing(&triangles, None, facing).unwrap();
        let seen = areas(&alone, &Lod::original(1));
        assert_eq!(seen[1], area_px, "{facing:?}");
        let both = alone.seen_from_both_sides();
        assert_eq!(areas(&both, &Lod::original(1))[1], 32);
    }
}

/// Two leaves of 4 x 4 pixels, one behind the other, from two cameras: 64
/// fragments, none too many, and one too many. The count is that of all views on
/// any number of threads.
#[test]
fn fragments_are_counted_before_they_take_memory() {
    let leaves = [
        quad(-2.0, -2.0, 2.0, 2.0, 8.0),
        quad(-2.0, -2.0, 2.0, 2.0, 8.0),
    ];
    let foliage = foliage(&[&leaves[0], &leaves[1]]);
    let view = ruler().views()[0];
    let scene = Scene {
        foliage: &foliage,
        lod: &Lod::original(2),
        views: &ViewSet::new(vec![view, view]),
        resolution: 16,
    };
    assert_eq!(
        cpu::fragments_within(&scene, 64),
        Ok(cpu::fragments(&scene))
    );
    for most in [0, 31, 32, 63] {
        for threads in [1, 3] {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
            let pool = pool.build().unwrap();
            let counted = pool.install(|| cpu::fragments_within(&scene, most));
            assert_eq!(counted, Err(TooManyFragments { found: 64, most }));
        }
    }
    let asked: &dyn Rasteriser = &CpuRasteriser;
    let error = asked.fragments_within(&scene, 63).unwrap_err();
    assert!(error.is::<TooManyFragments>(), "{error}");
}

#[test]
fn a_leaf_in_front_hides_half_of_another() {
    // Behind: 8 x 4 pixels. In front, at half the distance and half the size:
    // the left half of it.
    let back = quad(-4.0, -2.0, 4.0, 2.0, 8.0);
    let front = quad(-2.0, -1.0, 0.0, 1.0, 4.0);
    assert_eq!(areas_of(&[&back, &front]), [256 - 32, 16, 16]);
    assert_eq!(areas_of(&[&front, &back]), [256 - 32, 16, 16]);
}

#[test]
fn an_a_buffer_says_what_is_right_behind() {
    // The leaf in front hides the left half of the one behind; what is left of
    // that one, and nothing else, hides the background.
    let back = quad(-4.0, -2.0, 4.0, 2.0, 8.0);
    let front = quad(-2.0, -1.0, 0.0, 1.0, 4.0);
    let foliage = foliage(&[&back, &front]);
    let fragments = fragments(&foliage, &Lod::original(2));
    let mut events = Events::default();
    let a_buffer = ABuffer::new(fragments.into_views(), 2);
    for front in a_buffer.fronts().filter(|front| front[0] != 0) {
        events.push(0, [0, 0], front);
    }
    // Events of pixels that are not side by side stay apart: their pixels add up.
    let mut found: BTreeMap<[u32; 2], u32> = BTreeMap::new();
    for event in events.all() {
        *found.entry(event.after).or_default() += event.pixels;
    }
    assert_eq!(found, BTreeMap::from([([1, 0], 16), ([2, 1], 16)]));
}

#[test]
fn the_diagonal_belongs_to_one_triangle() {
    // Two leaves that share the diagonal of a square: together its 64 pixels,
    // none twice, none lost.
    let [lower, upper] = quad(-4.0, -4.0, 4.0, 4.0, 8.0);
    let areas = areas_of(&[&[lower], &[upper]]);
    assert_eq!(areas[1] + areas[2], 64);
    assert_eq!(areas[1].abs_diff(areas[2]), 8, "the diagonal's 8 pixels");
}

#[test]
fn an_edge_through_pixel_centres_has_those_on_top_and_left() {
    let small = quad(-3.5, -2.5, 3.5, 2.5, 8.0);
    assert_eq!(areas_of(&[&small]), [256 - 7 * 5, 7 * 5]);
    let wide = quad(-7.5, -2.5, 6.5, 2.5, 8.0);
    assert_eq!(areas_of(&[&wide]), [256 - 14 * 5, 14 * 5]);
}

#[test]
fn equal_depth_goes_to_the_lowest_number() {
    let leaf = quad(-4.0, -4.0, 4.0, 4.0, 8.0);
    assert_eq!(areas_of(&[&leaf, &leaf, &leaf]), [192, 64, 0, 0]);
    let mut lod = Lod::original(3);
    lod.remove(secateur_model::LeafId::new(1).unwrap());
    assert_eq!(
        areas(&foliage(&[&leaf, &leaf, &leaf]), &lod),
        [192, 0, 64, 0]
    );
}

#[test]
fn leaves_are_two_sided() {
    let turned = quad(-4.0, -4.0, 4.0, 4.0, 8.0).map(|mut t| {
        t.corners.swap(1, 2);
        t
    });
    assert_eq!(areas_of(&[&turned]), [192, 64]);
}

#[test]
fn a_leaf_may_fill_the_view() {
    // Far larger than the image, on every side.
    let wall = quad(-1e6, -1e6, 1e6, 1e6, 8.0);
    assert_eq!(areas_of(&[&wall]), [0, 256]);
}

#[test]
fn a_leaf_may_cross_the_edge() {
    let half_out = quad(6.0, -4.0, 60.0, 4.0, 8.0);
    assert_eq!(areas_of(&[&half_out]), [256 - 16, 16]);
}

#[test]
fn a_leaf_may_cross_the_near_plane() {
    // A floor one unit below the eye from behind the camera to 8 units ahead:
    // its far edge projects to y = -1, so it covers the 7 rows below that.
    let at = |x, z| DVec3::new(x, -1.0, z);
    let corners = [at(-1e3, 5.0), at(1e3, 5.0), at(1e3, -8.0), at(-1e3, -8.0)];
    let floor = [
        LeafTriangle::plain([corners[0], corners[1], corners[2]]),
        LeafTriangle::plain([corners[0], corners[2], corners[3]]),
    ];
    assert_eq!(areas_of(&[&floor]), [256 - 7 * 16, 7 * 16]);
}

#[test]
fn what_is_behind_or_beside_is_not_seen() {
    let behind = quad(-4.0, -4.0, 4.0, 4.0, -8.0);
    let beside = quad(40.0, -4.0, 44.0, 4.0, 8.0);
    let at_the_eye = [LeafTriangle::plain([DVec3::ZERO; 3])];
    assert_eq!(areas_of(&[&behind, &beside, &at_the_eye]), [256, 0, 0, 0]);
}

#[test]
fn leaves_below_a_pixel_are_seen_only_over_a_centre() {
    // Pixel centres lie at halves. The first square holds the one at (0.5,
    // 0.5), the second none; a line and a point have no area.
    let seen = quad(0.4, 0.4, 0.6, 0.6, 8.0);
    let missed = quad(0.6, 0.6, 0.9, 0.9, 8.0);
    let line = [LeafTriangle::plain([
        DVec3::new(-4.0, 0.5, -8.0),
        DVec3::new(0.0, 0.5, -8.0),
        DVec3::new(4.0, 0.5, -8.0),
    ])];
    assert_eq!(areas_of(&[&seen, &missed, &line]), [255, 1, 0, 0]);
}

#[test]
fn a_leaf_grows_about_its_centre() {
    let leaf = quad(-2.0, -1.0, 2.0, 1.0, 8.0);
    let foliage = foliage(&[&leaf]);
    let mut lod = Lod::original(1);
    assert_eq!(areas(&foliage, &lod), [256 - 8, 8]);
    lod.resize(secateur_model::LeafId::new(1).unwrap(), 4.0);
    assert_eq!(areas(&foliage, &lod), [256 - 32, 32]);
}

#[test]
fn holes_of_a_cutout_show_what_is_behind() {
    // A texture of 4 x 2 texels, the upper left 2 x 1 transparent, on a leaf of
    // 8 x 8 pixels: its upper left 4 x 4 pixels are a hole.
    let mask = Cutout::from_fn([4, 2], [Wrap::Repeat; 2], |x, y| x >= 2 || y >= 1);
    let mut foliage = Foliage::new(vec![Arc::new(mask)]);
    let card = quad(-2.0, -2.0, 2.0, 2.0, 4.0);
    foliage.push_leaf(&card, Some(0)).unwrap();
    let back = quad(-4.0, -4.0, 4.0, 4.0, 8.0);
    foliage.push_leaf(&back, None).unwrap();
    assert_eq!(areas(&foliage, &Lod::original(2)), [192, 48, 16]);
    let fragments = fragments(&foliage, &Lod::original(2));
    // Row 4 is the leaves' first row, columns 4..12; the hole is its left half.
    let front = |column: usize| fragments.views()[0].at(4 * 16 + column)[0].leaf();
    assert_eq!([front(4), front(7), front(8), front(11)], [2, 2, 1, 1]);
}

/// Each triangle is drawn alone, in each of two ways.
#[test]
fn holes_of_a_triangle_show_what_is_behind() {
    let mask = Cutout::from_fn([4, 2], [Wrap::Repeat; 2], |x, y| x >= 2 || y >= 1);
    let mut both = 0;
    for triangle in quad(-2.0, -2.0, 2.0, 2.0, 4.0) {
        let mut foliage = Foliage::new(vec![Arc::new(mask.clone())]);
        foliage.push_leaf(&[triangle], Some(0)).unwrap();
        let area_px = areas(&foliage, &Lod::original(1))[1];
        let fragments = fragments(&foliage, &Lod::original(1));
        let lists = fragments.views()[0].pixels();
        assert_eq!(lists.map(|list| list.len() as u32).sum::<u32>(), area_px);
        both += area_px;
    }
    assert_eq!(both, 48);
}

#[test]
fn texture_coordinates_stay_right_on_a_deep_leaf() {
    // A floor from distance 1 to 15 below the eye, its texture's far half
    // transparent: seen in perspective the hole starts at distance 8, not at
    // half the rows. One unit below the eye: row y = -8/distance.
    let mask = Cutout::from_fn([256, 256], [Wrap::ClampToEdge; 2], |_, y| y >= 128);
    let mut foliage = Foliage::new(vec![Arc::new(mask)]);
    let corner = |x: f64, distance: f64| DVec3::new(x * 100.0, -1.0, -distance);
    let uv = |x: f64, far: f64| DVec2::new(x, 1.0 - far);
    let triangle = |c: [(f64, f64); 3]| LeafTriangle {
        corners: c.map(|(x, far)| corner(x - 0.5, 1.0 + 14.0 * far)),
        uvs: c.map(|(x, far)| uv(x, far)),
    };
    let floor = [
        triangle([(0.0, 0.0), (1.0, 0.0), (1.0, 1.0)]),
        triangle([(0.0, 0.0), (1.0, 1.0), (0.0, 1.0)]),
    ];
    foliage.push_leaf(&floor, Some(0)).unwrap();
    let areas = areas(&foliage, &Lod::original(1));
    // From y = -8 to y = -8/8 = -1: seven rows. Linear on the image it would be
    // only the lower half of y = -8 .. -8/15, under four rows.
    assert_eq!(areas, [256 - 7 * 16, 7 * 16]);
}

#[test]
fn a_column_of_many_leaves_is_one_list() {
    let leaves: Vec<[LeafTriangle; 2]> = (0..3000)
        .map(|k| quad(0.1, 0.1, 0.9, 0.9, 8.0 - f64::from(k % 7) * 1e-3))
        .collect();
    let leaves: Vec<&[LeafTriangle]> = leaves.iter().map(|l| l.as_slice()).collect();
    let foliage = foliage(&leaves);
    let fragments = fragments(&foliage, &Lod::original(3000));
    assert_eq!(fragments.len(), 3000);
    let list = fragments.views()[0].at(7 * 16 + 8);
    assert!(list.is_sorted());
    // The nearest layer is k % 7 == 6; leaf numbers count from 1.
    assert_eq!(list[0].leaf(), 7);
    assert_eq!(list[1].leaf(), 14);
}
