//! Needles grow across, not along.
//!
//! A leaf that stands for others grows. A needle that grows both ways sticks out of the crown and
//! stays thinner than a pixel, which shows as dots. So after leaves were chosen, and before sizes
//! are fitted, those that are much longer than wide get as long as they were and as much wider.

use glam::{DMat3, DVec3};
use rayon::prelude::*;
use secateur_model::{
    Foliage, LeafId, LeafTriangle, Lod, NewCorner, NewLeaf, Place, moment, principal_axes,
};

/// No needle becomes wider than a quarter of its length.
const LEAST_ASPECT: f64 = 4.0;

/// The length of a needle that became coarser, as a share of the original's. As long as that, one that ends in a point
/// has a tip that is thinner than the original anywhere is.
const LENGTH_SHARE: f64 = 0.85;

/// The vector sum of a needle's triangle areas is at least this share of their sum: it is flat, so that what it gains
/// in width it loses in length.
const LEAST_FLAT: f64 = 0.95;

/// One that is longer than wanted by no more than this factor stays as it is.
const HARDLY_LONGER: f64 = 1.001;

/// A leaf that takes the place of a needle.
#[derive(Clone, Debug, PartialEq)]
pub struct Needle {
    /// The name of the one that goes.
    pub removed: LeafId,
    /// The one that comes, of the size to which the other has grown.
    pub made: NewLeaf,
    /// By what the area of the other was multiplied.
    pub area_scale: f64,
}

/// What takes the place of the needles of a level, on the threads of the current rayon pool. Leaves
/// with a cut-out are none: how long a card is does not say how long what it shows is.
pub(crate) fn widened(foliage: &Foliage, lod: &Lod) -> Vec<Needle> {
    let originals = lod.leaves().map(|_| None);
    let made = lod.made().map(|(made, _)| Some(made));
    let all: Vec<_> = lod.all_leaves().zip(originals.chain(made)).collect();
    let needle = |((removed, area_scale), made): ((LeafId, f64), Option<&NewLeaf>)| {
        let donor = made.map_or(removed, |made| made.donor);
        if foliage.leaf(donor).cutout().is_some() {
            return None;
        }
        let original = foliage.triangles_of(donor);
        let (now, like, share) = match made {
            Some(made) => {
                let like = made.triangles.iter().map(|t| t.map(|corner| corner.like));
                (
                    made.triangles_in(foliage, 1.0),
                    like.collect(),
                    LENGTH_SHARE,
                )
            }
            None => {
                let like = (0..original.len() as u32).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]);
                (original.to_vec(), like.collect(), 1.0)
            }
        };
        Some(Needle {
            removed,
            made: NewLeaf {
                donor,
                triangles: wider(original, &now, like, area_scale, share)?,
            },
            area_scale,
        })
    };
    all.into_par_iter().filter_map(needle).collect()
}

/// The triangles `now` made shorter along and wider across, and `area_scale` times as large, so that they are no longer
/// than `share` times the original; none if they would be so anyway, or are no needle. `like` has, by corner, the
/// corner of the original whose texture coordinates and normal it keeps.
fn wider(
    original: &[LeafTriangle],
    now: &[LeafTriangle],
    like: Vec<[u32; 3]>,
    area_scale: f64,
    share: f64,
) -> Option<Vec<[NewCorner; 3]>> {
    let (_, spread) = centre_and_spread(original);
    let [.., along] = principal_axes(spread);
    let (centre, _) = centre_and_spread(now);
    let facing: DVec3 = now.iter().map(|t| facing(t.corners)).sum();
    let total: f64 = now.iter().map(|t| area(t.corners)).sum();
    let normal = facing.try_normalize()?;
    let in_plane = along.reject_from_normalized(normal).try_normalize()?;
    let across = normal.cross(in_plane);
    let (length, width) = (extent(now, in_plane), extent(now, across));
    let linear_scale = area_scale.sqrt();
    let too_long = length * linear_scale / (share * extent(original, along));
    let factor = too_long.min((length / width / LEAST_ASPECT).sqrt());
    let is_flat = facing.length() >= LEAST_FLAT * total;
    if !(is_flat && factor > HARDLY_LONGER && factor.is_finite()) {
        return None;
    }
    let placed = |corner: DVec3| {
        let from_centre = corner - centre;
        let along = in_plane * in_plane.dot(from_centre);
        let across = across * across.dot(from_centre);
        let moved = from_centre + along * (1.0 / factor - 1.0) + across * (factor - 1.0);
        centre + moved * linear_scale
    };
    let triangles = now.iter().zip(like).map(|(triangle, like)| {
        [0, 1, 2].map(|k| NewCorner {
            place: Place::At(placed(triangle.corners[k])),
            like: like[k],
        })
    });
    Some(triangles.collect())
}

/// The area of a triangle along its normal.
fn facing([a, b, c]: [DVec3; 3]) -> DVec3 {
    0.5 * (b - a).cross(c - a)
}

fn area(corners: [DVec3; 3]) -> f64 {
    facing(corners).length()
}

/// How far triangles reach along an axis.
fn extent(triangles: &[LeafTriangle], axis: DVec3) -> f64 {
    let along = triangles
        .iter()
        .flat_map(|t| t.corners)
        .map(|c| c.dot(axis));
    let (least, most) = along.fold((f64::INFINITY, f64::NEG_INFINITY), |(least, most), at| {
        (least.min(at), most.max(at))
    });
    most - least
}

/// The centre of the area of triangles, and its second moments about that.
fn centre_and_spread(triangles: &[LeafTriangle]) -> (DVec3, DMat3) {
    let centre_of = |[a, b, c]: [DVec3; 3]| (a + b + c) / 3.0;
    let parts = || triangles.iter().map(|t| t.corners);
    let total: f64 = parts().map(area).sum();
    let centre = parts().map(|t| area(t) * centre_of(t)).sum::<DVec3>() / total;
    let of_triangle = |t: [DVec3; 3]| {
        let corners: DMat3 = t.map(|corner| moment(corner - centre)).into_iter().sum();
        (corners + moment(centre_of(t) - centre) * 9.0) * (area(t) / 12.0)
    };
    (centre, parts().map(of_triangle).sum())
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use glam::DQuat;
    use secateur_model::{Cutout, Random, RemovalOrder, Step, Wrap};

    use super::*;
    use crate::hanging_leaves::HeldBy;
    use crate::{Options, Resolution, Target, simplify};

    /// A quad of this length and width, somewhere, and turned.
    fn quad(length: f64, width: f64) -> [LeafTriangle; 2] {
        let turn = DQuat::from_xyzw(0.1, 0.7, -0.5, 0.5).normalize();
        let corner = |x: f64, y: f64| {
            DVec3::new(3.0, -1.0, 2.0) + turn * DVec3::new(x * length, y * width, 0.0)
        };
        let [a, b, c, d] =
            [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)].map(|(x, y)| corner(x, y));
        [[a, b, c], [a, c, d]].map(LeafTriangle::plain)
    }

    fn foliage(leaves: &[&[LeafTriangle]]) -> Foliage {
        let mut foliage = Foliage::default();
        for triangles in leaves {
            foliage.push_leaf(triangles, None).unwrap();
        }
        foliage
    }

    fn grown(count: usize, area_scale: f64) -> Lod {
        let mut lod = Lod::original(count);
        for leaf in (0..count).map(LeafId::from_index) {
            lod.resize(leaf, area_scale);
        }
        lod
    }

    /// Length, width, area and centre.
    fn shape(triangles: &[LeafTriangle]) -> (f64, f64, f64, DVec3) {
        let alone = foliage(&[triangles]);
        let leaf = alone.leaf(LeafId::from_index(0));
        let (centre, spread) = centre_and_spread(triangles);
        assert!(centre.distance(leaf.centre()) < 1e-12);
        let [_, across, along] = principal_axes(spread);
        (
            extent(triangles, along),
            extent(triangles, across),
            leaf.area(),
            leaf.centre(),
        )
    }

    #[test]
    fn a_needle_that_grew_is_as_long_as_it_was_and_as_much_wider() {
        let needle = quad(1.0, 0.01);
        let foliage = foliage(&[&needle]);
        let found = widened(&foliage, &grown(1, 9.0));
        let [of_it] = &found[..] else {
            panic!("{found:?}");
        };
        assert_eq!(of_it.removed, LeafId::from_index(0));
        assert_eq!(of_it.area_scale, 9.0);
        let (length, width, area, centre) = shape(&of_it.made.triangles_in(&foliage, 1.0));
        let (.., centre_before) = shape(&needle);
        assert!((length - 1.0).abs() < 1e-9, "{length}");
        assert!((width - 0.09).abs() < 1e-9, "{width}");
        assert!((area - 0.09).abs() < 1e-9, "{area}");
        assert!(centre.distance(centre_before) < 1e-9);
        // Texture and normals are those of its own corners.
        let like = of_it.made.triangles.iter().flatten().map(|c| c.like);
        assert!(like.eq(0..6));
    }

    #[test]
    fn it_is_never_wider_than_a_quarter_of_its_length() {
        let foliage = foliage(&[&quad(1.0, 0.2), &quad(1.0, 0.3), &quad(1.0, 0.01)]);
        // As large as they were, or smaller: nothing needs to be done.
        for area_scale in [0.5, 1.0] {
            let found = widened(&foliage, &grown(3, area_scale));
            assert!(found.is_empty(), "{found:?}");
        }
        let found = widened(&foliage, &grown(3, 100.0));
        assert_eq!(found.len(), 2, "{found:?}");
        for needle in found {
            let triangles = needle.made.triangles_in(&foliage, 1.0);
            let (length, width, ..) = shape(&triangles);
            assert!((length / width - 4.0).abs() < 1e-9 || length <= 1.0 + 1e-9);
            assert!(length / width > 4.0 - 1e-9);
        }
    }

    #[test]
    fn a_leaf_that_was_made_has_the_length_of_the_one_it_is_made_of() {
        let foliage = foliage(&[&quad(1.0, 0.01)]);
        let leaf = LeafId::from_index(0);
        let triangle = &foliage.triangles_of(leaf)[0];
        let like = [0, 1, 2];
        // A triangle of twice the length.
        let made = NewLeaf {
            donor: leaf,
            triangles: vec![like.map(|k| NewCorner {
                place: Place::At(2.0 * triangle.corners[k as usize]),
                like: k,
            })],
        };
        let mut order = RemovalOrder::new(1);
        order.push_step(Step {
            removed: &[leaf],
            grown: &[],
            made: &[made],
            survivors_area_scale: 1.0,
        });
        let lod = Lod::after(&order, 1);
        let found = widened(&foliage, &lod);
        let [of_it] = &found[..] else {
            panic!("{found:?}");
        };
        assert_eq!(of_it.removed, LeafId::from_index(1));
        let triangles = of_it.made.triangles_in(&foliage, 1.0);
        let along = principal_axes(centre_and_spread(foliage.triangles_of(leaf)).1)[2];
        assert!((extent(&triangles, along) - LENGTH_SHARE).abs() < 1e-9);
        let like = of_it.made.triangles.iter().flatten().map(|c| c.like);
        assert!(like.eq(0..3));
    }

    /// Strips of three quads that sag more than they are wide: as many quads, and one triangle.
    #[test]
    fn one_that_sags_gains_in_width_what_it_loses_in_length_or_stays() {
        let strip = |sag: f64| -> Vec<LeafTriangle> {
            let at = |k: usize, side: f64| {
                let x = k as f64 / 3.0;
                DVec3::new(x, -4.0 * sag * x * (1.0 - x), 0.01 * side)
            };
            let quad = |k: usize| {
                let [a, b, c, d] = [at(k, 0.0), at(k + 1, 0.0), at(k + 1, 1.0), at(k, 1.0)];
                [[a, b, c], [a, c, d]].map(LeafTriangle::plain)
            };
            (0..3).flat_map(quad).collect()
        };
        let area_of = |triangles: &[LeafTriangle]| shape(triangles).2;
        let slight = strip(0.05);
        let foliage_of_slight = foliage(&[&slight]);
        let found = widened(&foliage_of_slight, &grown(1, 4.0));
        let triangles = found[0].made.triangles_in(&foliage_of_slight, 1.0);
        let ratio = area_of(&triangles) / area_of(&slight);
        assert!((ratio - 4.0).abs() < 0.1, "{ratio}");
        assert!(extent(&triangles, DVec3::Z) > 0.035);
        // A half circle is not flat.
        let deep = foliage(&[&strip(0.5)]);
        assert!(widened(&deep, &grown(1, 4.0)).is_empty());
        // Its chord as one triangle is, whatever the strip's own second axis was.
        let donor = LeafId::from_index(0);
        let like = [0, 8, 5];
        let corner = |like: u32| {
            let triangle = deep.triangles_of(donor)[like as usize / 3];
            NewCorner {
                place: Place::At(triangle.corners[like as usize % 3]),
                like,
            }
        };
        let mut order = RemovalOrder::new(1);
        order.push_step(Step {
            removed: &[donor],
            grown: &[],
            made: &[NewLeaf {
                donor,
                triangles: vec![like.map(corner)],
            }],
            survivors_area_scale: 1.0,
        });
        let mut lod = Lod::after(&order, 1);
        let before = lod.foliage(&deep).leaves()[0].area();
        lod.resize(LeafId::from_index(1), 4.0);
        let found = widened(&deep, &lod);
        let after = area_of(&found[0].made.triangles_in(&deep, 1.0));
        assert!((after / before - 4.0).abs() < 1e-6, "{after}, {before}");
    }

    #[test]
    fn a_card_with_a_cut_out_is_none() {
        let solid = Cutout::from_fn([1, 1], [Wrap::Repeat; 2], |_, _| true);
        let mut foliage = Foliage::new(vec![Arc::new(solid)]);
        let triangles = quad(1.0, 0.01);
        foliage.push_leaf(&triangles, Some(0)).unwrap();
        assert!(widened(&foliage, &grown(1, 9.0)).is_empty());
        foliage.push_leaf(&triangles, None).unwrap();
        assert_eq!(widened(&foliage, &grown(2, 9.0)).len(), 1);
    }

    /// Wood at the lower end of a crown bears what is near it; the rest hangs, and goes.
    #[test]
    fn needles_that_hang_in_the_air_go() {
        let mut random = Random::new(5);
        let mut crown = Foliage::default();
        for _ in 0..100 {
            let at = DVec3::from([0; 3].map(|_| random.between(-1.0, 1.0)));
            let needle = quad(0.4, 0.008).map(|t| LeafTriangle::plain(t.corners.map(|c| c + at)));
            crown.push_leaf(&needle, None).unwrap();
        }
        let middle = crown.bounding_sphere().unwrap().centre;
        let floor = [(-9.0, -9.0), (30.0, -9.0), (-9.0, 30.0)]
            .map(|(x, z)| middle + DVec3::new(x, -1.0, z));
        let wood = foliage(&[&[LeafTriangle::plain(floor)]]);
        let held_by = Arc::new(HeldBy::new(&wood, 0.35));
        let options = Options {
            held_by: Some(Arc::clone(&held_by)),
            resolution: Resolution::Pixels(64),
            ..Options::to(Target::triangle_share(0.5))
        };
        let mut passes = simplify(&crown, &options).unwrap().passes;
        let left = passes.lod().leaf_count();
        assert!(0 < left && left < 100, "{left}");
        // Every one that is left got wider, and has a size of its own.
        assert_eq!(passes.needles.len(), left);
        assert_eq!(passes.sizes.as_ref().unwrap().len(), left);
        assert!(held_by.hanging(&crown, &passes.lod()).is_empty());
        // With less to hang on some more go, with the needles and the sizes that they had.
        let nearer = held_by.with_gap(0.2);
        let before = passes.lod();
        let hanging = nearer.hanging(&crown, &before).len();
        assert!(0 < hanging && hanging < left, "{hanging}");
        let sizes_before: Vec<f64> = before.all_leaves().map(|(_, size)| size).collect();
        passes.take_hanging(&crown, &nearer);
        let after = passes.lod();
        assert_eq!(after.leaf_count(), left - hanging);
        assert_eq!(passes.needles.len(), left - hanging);
        assert!(nearer.hanging(&crown, &after).is_empty());
        passes.in_one_order().check(&crown).unwrap();
        // Leaves that stay are as they were.
        let is_there = |(_, size): (LeafId, f64)| sizes_before.contains(&size);
        assert!(after.all_leaves().all(is_there));
    }
}
