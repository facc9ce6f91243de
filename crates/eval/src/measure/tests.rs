use glam::DVec3;
use proptest::prelude::*;
use secateur_model::{LeafId, LeafTriangle};
use secateur_raster::View;

use super::*;

/// A rectangle at z = 0 that faces +z.
fn rectangle([left, right]: [f64; 2], [bottom, top]: [f64; 2]) -> [LeafTriangle; 2] {
    let [a, b, c, d] = [(left, bottom), (right, bottom), (right, top), (left, top)]
        .map(|(x, y)| DVec3::new(x, y, 0.0));
    [
        LeafTriangle::plain([a, b, c]),
        LeafTriangle::plain([a, c, d]),
    ]
}

fn foliage(leaves: &[[LeafTriangle; 2]]) -> Foliage {
    let mut foliage = Foliage::default();
    for leaf in leaves {
        foliage.push_leaf(leaf, None).unwrap();
    }
    foliage
}

const LEFT: [f64; 2] = [-1.0, 0.0];
const RIGHT: [f64; 2] = [0.0, 1.0];
const ALL: [f64; 2] = [-1.0, 1.0];

/// From (0, 0, 2), of 4 x 4 pixels: one sees exactly -1 to 1 of the plane z = 0,
/// the other looks away.
fn towards_and_away() -> Judging {
    let look = |z| View::look_at(DVec3::Z * 2.0, DVec3::Z * z, DVec3::Y, 0.5, 0.1).unwrap();
    Judging {
        rigs: vec![ViewSet::new(vec![look(0.0), look(4.0)])],
        resolution: 4,
    }
}

fn values(scores: &Scores) -> Vec<f64> {
    scores.iter().map(|(_, value)| value).collect()
}

fn assert_close(scores: &Scores, expected: [f64; 5]) {
    for ((metric, value), expected) in scores.iter().zip(expected) {
        let key = metric.key;
        assert!(
            (value - expected).abs() < 1e-6,
            "{key}: {value}, not {expected}"
        );
    }
}

/// Left and right leaf fill the picture; the left one is kept.
///
/// Areas of 16 pixels, original: (0, 8, 8) and (16, 0, 0), so nothing is seen
/// in both views and I = 1 + 0 in each. Simplified: (8, 8) and (16, 0), the
/// background has 24 in all, so I = 1 + 8/16 (3 - log2 24) = 0.20751875 and
/// 1 + (4 - log2 24) = 0.41503750. Deviations 0.79248125 and 0.58496250 of 2.
#[test]
fn half_of_a_full_picture_removed() {
    let original = foliage(&[rectangle(LEFT, ALL), rectangle(RIGHT, ALL)]);
    let simplified = foliage(&[rectangle(LEFT, ALL)]);
    let found = measure(&original, &simplified, &towards_and_away()).unwrap();
    assert_close(&found.per_view[0], [79.248125, 0.5, 1.0, 0.5, 0.5]);
    // Nothing there in either: the silhouettes agree.
    assert_close(&found.per_view[1], [58.496250, 1.0, 1.0, 1.0, 1.0]);
    assert_close(&found.overall, [68.8721875, 0.75, 1.0, 0.75, 0.75]);
    assert_close(&found.worst, [79.248125, 0.5, 1.0, 0.5, 0.5]);
    assert_eq!((found.views, found.resolution), (2, 4));

    let mut lod = Lod::original(2);
    lod.remove(LeafId::new(2).unwrap());
    let level = measure_lod(&original, &lod, &towards_and_away()).unwrap();
    assert_eq!(level, found);
}

/// The view that sees, and the one that looks away, each a set by itself. In a set of one view I
/// is the entropy of nothing: 1 view tells nothing about which view it is, so both VMI are 0, no
/// error. The outline is that of the sets' mean, half of .5 and 1, and the worst set has .5.
#[test]
fn sets_of_views_are_judged_one_by_one() {
    let original = foliage(&[rectangle(LEFT, ALL), rectangle(RIGHT, ALL)]);
    let simplified = foliage(&[rectangle(LEFT, ALL)]);
    let together = towards_and_away();
    let alone = together.rigs[0].views().iter();
    let apart = Judging {
        rigs: alone.map(|view| ViewSet::new(vec![*view])).collect(),
        resolution: 4,
    };
    let found = measure(&original, &simplified, &apart).unwrap();
    assert_close(&found.overall, [0.0, 0.75, 1.0, 0.75, 0.75]);
    assert_close(&found.worst, [0.0, 0.5, 1.0, 0.5, 0.5]);
    assert_eq!((found.rigs.len(), found.views), (2, 2));
    assert_eq!(found.per_view[1], found.rigs[1].per_view[0]);

    // A set judges as it does alone, whatever stands beside it.
    let twice = Judging {
        rigs: [together.rigs.clone(), apart.rigs].concat(),
        resolution: 4,
    };
    let beside = measure(&original, &simplified, &twice).unwrap();
    let own = measure(&original, &simplified, &together).unwrap();
    assert_eq!(beside.rigs[0], own.rigs[0]);
    assert_eq!(
        (&own.overall, &own.worst),
        (&own.rigs[0].overall, &own.rigs[0].worst)
    );
    let error = own.vmi_error_percent();
    assert!((beside.vmi_error_percent() - error / 3.0).abs() < 1e-9);
    assert_eq!(beside.worst.get("vmi_error_percent"), Some(error));
}

/// A camera in a judge's direction is one that judges, however far off it stands.
#[test]
fn views_beside_judges_are_counted() {
    let tree = foliage(&[rectangle(ALL, ALL)]);
    let sphere = tree.bounding_sphere().unwrap();
    let centre = sphere.centre;
    let judging = Judging::held_out(&tree).unwrap();
    assert_eq!(
        judging.rigs.iter().map(ViewSet::len).collect::<Vec<_>>(),
        [12; 4]
    );
    let count = |views: &ViewSet| judging.views_that_judge(views, centre);
    for set in [
        ViewSet::dodecahedron(sphere),
        ViewSet::driving_icosahedron(sphere),
        ViewSet::icosahedron(sphere),
    ] {
        assert_eq!(count(&set), 0);
    }
    assert_eq!(count(&ViewSet::geodesic(sphere)), 12);
    let judge = &judging.rigs[2].views()[5];
    let nearer = View::look_at(
        centre - 0.5 * sphere.radius * judge.forward(),
        centre,
        judge.up(),
        0.5,
        0.1,
    );
    assert_eq!(count(&ViewSet::new(vec![nearer.unwrap()])), 1);
    let paper = Judging::icosahedron(&tree).unwrap();
    assert_eq!(paper.rigs.len(), 1);
    assert_eq!(
        paper.views_that_judge(&ViewSet::icosahedron(sphere), centre),
        12
    );
}

/// Original: the left half, 8 pixels. Simplified: the lower three quarters, 12
/// pixels, of which 6 are shared: IoU 6 / 14, precision 6 / 12, recall 6 / 8,
/// coverage 12 / 8.
#[test]
fn one_that_is_partly_elsewhere() {
    let original = foliage(&[rectangle(LEFT, ALL)]);
    let simplified = foliage(&[rectangle(ALL, [-1.0, 0.5])]);
    let found = measure(&original, &simplified, &towards_and_away()).unwrap();
    let silhouette = &values(&found.per_view[0])[1..];
    assert_eq!(silhouette, [6.0 / 14.0, 0.5, 0.75, 1.5]);
}

/// Coverage 1.5 is worse than 1, so the worst is the larger here, while of a
/// shrunk foliage it is the smaller.
#[test]
fn coverage_is_worst_where_it_is_farthest_from_one() {
    let [half, full] = [LEFT, ALL].map(|x| foliage(&[rectangle(x, ALL)]));
    let worst = |a, b| {
        let found = measure(a, b, &towards_and_away()).unwrap();
        found.worst.get("coverage_ratio").unwrap()
    };
    assert_eq!(worst(&half, &full), 2.0);
    assert_eq!(worst(&full, &half), 0.5);
}

/// Nothing drawn is nothing wrong: precision 1. All is missing: recall 0.
#[test]
fn an_empty_foliage_is_precise_and_forgets_everything() {
    let original = foliage(&[rectangle(ALL, ALL)]);
    let found = measure(&original, &Foliage::default(), &towards_and_away()).unwrap();
    assert_eq!(values(&found.per_view[0])[1..], [0.0, 1.0, 0.0, 0.0]);
}

#[test]
fn reports_have_the_overall_values_at_the_top() {
    let original = foliage(&[rectangle(ALL, ALL)]);
    let found = measure(&original, &original, &towards_and_away()).unwrap();
    let json = serde_json::to_value(&found).unwrap();
    assert_eq!(json["vmi_error_percent"], 0.0);
    assert_eq!(json["worst"]["recall"], 1.0);
    assert_eq!(json["per_view"][1]["precision"], 1.0);
    assert_eq!(json["views"], 2);
    assert_eq!(json["resolution"], 4);
}

#[test]
fn what_cannot_be_judged_is_an_error() {
    let empty = Foliage::default();
    assert_eq!(Judging::held_out(&empty), Err(MeasureError::NoFoliage));
    let refused = |views: usize, resolution| {
        let view = towards_and_away().rigs[0].views()[0];
        let rigs = vec![ViewSet::new(vec![view; views])];
        let judging = Judging { rigs, resolution };
        measure(&empty, &empty, &judging).unwrap_err()
    };
    assert_eq!(refused(0, 4), MeasureError::NoView);
    assert_eq!(refused(1, 0), MeasureError::Resolution(0));
    assert_eq!(refused(1, 2049), MeasureError::Resolution(2049));
    let none = Judging {
        rigs: Vec::new(),
        resolution: 4,
    };
    let refused_too = measure(&empty, &empty, &none);
    assert_eq!(refused_too.unwrap_err(), MeasureError::NoView);
    // 2048 * 2048 * 129 is one view more than 2^29.
    assert_eq!(refused(129, 2048), MeasureError::TooManyPixels(541_065_216));
}

fn any_foliage() -> impl Strategy<Value = Foliage> {
    let corner = prop::array::uniform3(-1.0..1.0f64).prop_map(DVec3::from_array);
    let triangle = prop::array::uniform3(corner).prop_map(LeafTriangle::plain);
    prop::collection::vec(triangle, 1..20).prop_map(|triangles| {
        let mut foliage = Foliage::default();
        for triangle in triangles {
            foliage.push_leaf(&[triangle], None).unwrap();
        }
        foliage
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(32))]

    #[test]
    fn a_foliage_is_like_itself(original in any_foliage()) {
        let judging = Judging { resolution: 32, ..Judging::held_out(&original).unwrap() };
        let found = measure(&original, &original, &judging).unwrap();
        prop_assert_eq!(values(&found.overall), [0.0, 1.0, 1.0, 1.0, 1.0]);
        prop_assert_eq!(&found.worst, &found.overall);
        prop_assert_eq!(found.rigs.len(), 4);
    }

    #[test]
    fn swapping_swaps_precision_and_recall(a in any_foliage(), b in any_foliage()) {
        let judging = Judging { resolution: 32, ..Judging::held_out(&a).unwrap() };
        let there = measure(&a, &b, &judging).unwrap();
        let back = measure(&b, &a, &judging).unwrap();
        prop_assert_eq!(there.precision(), back.recall());
        prop_assert_eq!(there.recall(), back.precision());
        prop_assert_eq!(there.silhouette_iou(), back.silhouette_iou());
        for scores in &there.per_view {
            let of = |key| scores.get(key).unwrap();
            let (iou, precision, recall) = (of("silhouette_iou"), of("precision"), of("recall"));
            prop_assert!(of("vmi_error_percent") >= 0.0 && of("coverage_ratio") >= 0.0);
            prop_assert!(0.0 <= iou && iou <= precision.min(recall));
            prop_assert!(precision <= 1.0 && recall <= 1.0);
        }
    }
}
