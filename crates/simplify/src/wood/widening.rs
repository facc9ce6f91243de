//! Thin wood is as wide as it was.
//!
//! The corners of a coarser level lie on the tube that the part was, so one of three sides is narrower than
//! one of six, and one that ends in a point narrower still. A trunk that is somewhat narrower is hardly
//! seen; a twig of less than a pixel breaks up into dots, and leaves beside it are islands. So thin parts
//! are widened about their axis until they have the area that they had: seen from all around, closed shapes of
//! as much area show about as much. Where thin wood is gone, the rest of it may be widened further, to show as much.

use glam::DVec3;
use rayon::prelude::*;
use secateur_model::{Facing, LeafId, LeafTriangle, NewCorner, Place};

use super::parts::{Parts, of_corners};
use super::rings::ring_centres;
use super::thickness::thickness;

/// A part is thin if its thickness is at most this share of the radius of all wood: a pixel where pictures of
/// the judge are 256 pixels wide.
const THIN: f64 = 1.0 / 75.0;

/// The most that a part is widened for what its level is narrower by: a strip with a back has two thirds of the
/// area of a tube, one that ends in a point a third.
const MOST_FOR_ITSELF: f64 = 3.0;

/// And of a plant without leaves, where a thorn in the place of a twig is seen as such. Of 1.3, 1.6, 2 and 3, tried at
/// .3, .1 and .03 of a grown oak, birch and willow, 1.3 had the least difference at 540 pixels, or nearly.
const MOST_OF_BARE: f64 = 1.3;

/// A part of which a ring has a radius of more than this many times the thickness is no single tube: at a fork a ring
/// has places of both prongs.
const MOST_SPREAD: f64 = 1.5;

/// The most that it is widened besides for thin parts that are gone.
const MOST_FOR_OTHERS: f64 = 1.5;

/// The axes of thin parts.
#[derive(Clone, Debug)]
pub(super) struct Widening {
    /// By part, and by its corner what that moves away from: the centre of its ring; nothing for parts that
    /// are thick or no tubes.
    axes: Vec<Option<Vec<DVec3>>>,
    /// Whether the plant has no leaves.
    pub(super) is_bare: bool,
}

impl Widening {
    /// Finds the axes. Joints stay where they are, as parts meet there.
    pub(super) fn of(parts: &Parts, is_joint: &(dyn Fn(DVec3) -> bool + Sync)) -> Self {
        let wood = parts.foliage();
        let radius = wood.bounding_sphere().map_or(0.0, |sphere| sphere.radius);
        let axis = |part: usize| {
            let part = LeafId::from_index(part);
            let thickness = thickness(wood, part);
            if thickness > THIN * radius {
                return None;
            }
            let triangles = wood.triangles_of(part);
            let mut axis = ring_centres(triangles)?;
            let corners = || triangles.iter().flat_map(|t| t.corners);
            let is_far =
                |(from, corner): (&DVec3, DVec3)| from.distance(corner) > MOST_SPREAD * thickness;
            if axis.iter().zip(corners()).any(is_far) {
                return None;
            }
            for (from, corner) in axis.iter_mut().zip(corners()) {
                if is_joint(corner) {
                    *from = corner;
                }
            }
            Some(axis)
        };
        let parts = (0..wood.leaves().len()).into_par_iter();
        Self {
            axes: parts.map(axis).collect(),
            is_bare: false,
        }
    }

    /// How much further thin parts are widened for those that are gone, from 1. `seen_px`: the pixels that
    /// show each part; `is_left`: whether it is left.
    pub(super) fn for_others(
        &self,
        seen_px: impl Fn(usize) -> f64,
        is_left: impl Fn(usize) -> bool,
    ) -> f64 {
        let thin = || (0..self.axes.len()).filter(|part| self.axes[*part].is_some());
        let all: f64 = thin().map(&seen_px).sum();
        let left: f64 = thin().filter(|part| is_left(*part)).map(&seen_px).sum();
        match left > 0.0 {
            true => (all / left).min(MOST_FOR_OTHERS),
            false => 1.0,
        }
    }

    /// A level of a part: its corners as those of its piece, moved where the part is thin.
    pub(super) fn made(
        &self,
        parts: &Parts,
        part: usize,
        level: &[[u32; 3]],
        for_others: f64,
    ) -> Vec<[NewCorner; 3]> {
        let mut made = parts.made(part, level);
        let Some(axis) = &self.axes[part] else {
            return made;
        };
        let part = LeafId::from_index(part);
        let all = parts.foliage().triangles_of(part);
        let left = of_corners(all, level);
        let facing = parts.foliage().leaf(part).facing();
        let before_over_after = shown_area(all, facing) / shown_area(&left, facing);
        let most = match self.is_bare {
            true => MOST_OF_BARE,
            false => MOST_FOR_ITSELF,
        };
        let for_itself = before_over_after.clamp(1.0, most);
        let factor = for_itself * for_others;
        if factor == 1.0 || !factor.is_finite() {
            return made;
        }
        let corners = made.as_flattened_mut().iter_mut();
        let places = left.iter().flat_map(|t| t.corners);
        for ((made, number), at) in corners.zip(level.as_flattened()).zip(places) {
            let from = axis[*number as usize];
            if from != at {
                made.place = Place::At(from + (at - from) * factor);
            }
        }
        made
    }
}

/// What views from all around see of triangles, but for a factor. Where both sides are seen, what lies open counts
/// twice: the areas along the normals of a tube make up for each other, those of a strip do not.
fn shown_area(triangles: &[LeafTriangle], facing: Facing) -> f64 {
    let along_normal = |[a, b, c]: [DVec3; 3]| 0.5 * (b - a).cross(c - a);
    let all = || triangles.iter().map(|t| along_normal(t.corners));
    let area: f64 = all().map(DVec3::length).sum();
    match facing {
        Facing::Both => area + all().sum::<DVec3>().length(),
        _ => area,
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;
    use secateur_model::{Foliage, NewLeaf};

    use super::super::rings::tubes;
    use super::super::tests::tube;
    use super::*;

    const NO_JOINT: fn(DVec3) -> bool = |_| false;

    /// A trunk of radius .4, and twigs of radius .02.
    fn wood(twigs: usize) -> Foliage {
        let mut wood = Foliage::default();
        wood.push_leaf(&tube(DVec3::ZERO, 8.0 * DVec3::Y, 0.4, 12), None)
            .unwrap();
        for k in 0..twigs {
            let from = DVec3::new(0.4, 1.0 + k as f64, 0.0);
            let twig = tube(from, from + DVec3::new(2.0, 0.5, 0.0), 0.02, 4);
            wood.push_leaf(&twig, None).unwrap();
        }
        wood
    }

    /// The area of a part, of a level of this many triangles, and of that level as it is made.
    fn areas(wood: &Foliage, part: usize, count: usize, for_others: f64) -> [f64; 3] {
        let parts = Parts::of(wood);
        let widening = Widening::of(&parts, &NO_JOINT);
        let all = wood.triangles_of(LeafId::from_index(part));
        let levels = tubes(all, false);
        let level = levels.iter().find(|level| level.len() == count).unwrap();
        let made = NewLeaf {
            donor: LeafId::from_index(part),
            triangles: widening.made(&parts, part, level, for_others),
        };
        let left = of_corners(all, level);
        let made = made.triangles_in(wood, 1.0);
        [all, &left, &made].map(|triangles| shown_area(triangles, Facing::Both))
    }

    #[test]
    fn a_twig_of_fewer_sides_has_the_area_that_it_had_and_a_trunk_what_is_left() {
        let wood = wood(1);
        // Three sides, and a strip with a back.
        for count in [6, 4] {
            let [all, left, made] = areas(&wood, 1, count, 1.0);
            assert!(left < 0.9 * all, "{left} of {all}");
            assert!((made / all - 1.0).abs() < 0.01, "{made} of {all}");
        }
        let [all, left, made] = areas(&wood, 0, 6, 1.3);
        assert!(left < 0.9 * all && made == left, "{left}, {made}");
    }

    /// A thorn of three triangles has a third of the area: among leaves it grows to all of it, and where it is seen as it
    /// stands it is hardly wider than the twig was.
    #[test]
    fn a_twig_of_a_plant_without_leaves_is_no_thorn() {
        let wood = wood(1);
        let parts = Parts::of(&wood);
        let twig = LeafId::from_index(1);
        let all = wood.triangles_of(twig);
        let level = tubes(all, false).into_iter().min_by_key(Vec::len).unwrap();
        let area = |is_bare: bool| {
            let mut widening = Widening::of(&parts, &NO_JOINT);
            widening.is_bare = is_bare;
            let made = NewLeaf {
                donor: twig,
                triangles: widening.made(&parts, 1, &level, 1.0),
            };
            shown_area(&made.triangles_in(&wood, 1.0), Facing::Both)
        };
        let of_level = shown_area(&of_corners(all, &level), Facing::Both);
        assert!((area(true) / of_level - MOST_OF_BARE).abs() < 0.01);
        assert!(area(false) > 1.4 * of_level, "{}", area(false) / of_level);
    }

    #[test]
    fn it_is_wider_where_others_are_gone() {
        let wood = wood(4);
        let [all, _, made] = areas(&wood, 1, 6, 1.3);
        assert!((made / all - 1.3).abs() < 0.01, "{made} of {all}");
        let widening = Widening::of(&Parts::of(&wood), &NO_JOINT);
        let for_others = |left: &[usize]| {
            // The trunk shows the most, and counts for nothing.
            let seen_px = |part: usize| [900.0, 40.0, 10.0, 20.0, 10.0][part];
            widening.for_others(seen_px, |part| left.contains(&part))
        };
        assert_eq!(for_others(&[0, 1, 2, 3, 4]), 1.0);
        assert_eq!(for_others(&[1, 3, 4]), 80.0 / 70.0);
        assert_eq!(for_others(&[0, 4]), MOST_FOR_OTHERS);
        assert_eq!(for_others(&[0]), 1.0);
    }

    /// A strip without a back is seen from both sides: it needs half the area of a tube.
    #[test]
    fn a_strip_that_is_seen_from_both_sides_counts_twice() {
        let tube = tube(DVec3::ZERO, 2.0 * DVec3::X, 0.02, 4);
        let strip = |count: usize| {
            let levels = tubes(&tube, true);
            let level = levels.iter().find(|level| level.len() == count);
            of_corners(&tube, level.unwrap())
        };
        // Flat, and two that cross.
        for (count, times) in [(2, 2.0), (4, 1.0 + 0.5f64.sqrt())] {
            let strip = strip(count);
            let front = shown_area(&strip, Facing::Counterclockwise);
            let both = shown_area(&strip, Facing::Both);
            assert!((both / front - times).abs() < 0.01, "{}", both / front);
        }
        let [front, both] = [Facing::Clockwise, Facing::Both].map(|f| shown_area(&tube, f));
        assert!((both / front - 1.0).abs() < 1e-9);
    }

    #[test]
    fn joints_stay_where_they_are() {
        let wood = wood(1);
        let parts = Parts::of(&wood);
        let all = wood.triangles_of(LeafId::from_index(1));
        let is_joint = |place: DVec3| place.x < 1.0;
        let widening = Widening::of(&parts, &is_joint);
        let level = &tubes(all, false)[0];
        let made = widening.made(&parts, 1, level, 1.0);
        let places = of_corners(all, level).into_iter().flat_map(|t| t.corners);
        for (corner, at) in made.as_flattened().iter().zip(places) {
            assert_eq!(matches!(corner.place, Place::Of(_)), is_joint(at), "{at}");
        }
    }
}
