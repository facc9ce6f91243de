//! What carries the crown to the ground, and how coarse it may be for that.
//!
//! Triangles go where they save the most pixels, and thin stems save few: a stem that is a pixel or two
//! off shows nothing where it was. But a crown without stems is a cloud in the air. So pieces that rise from
//! the ground, or grow on nothing, and carry a good part of the leaves stay at every level, in the
//! coarsest form that still goes where they went and is seen from all sides; more triangles they get only
//! for the pixels these save.

use glam::DVec3;
use secateur_model::{Foliage, LeafId};

use super::Piece;
use super::parts::Parts;

/// A piece that grows on none carries the crown if it carries this share of what the one that carries most does,
/// itself or by what grows on it, in pixels that the views show of the leaves. Of the eleven stems of `ez_bush2` the last
/// carries .47. Where boughs stood too, if they carried .05 of all leaves, FLIP at a tenth of all
/// triangles was .0198 instead of .0181 on `quat_commontree_1`, and .0417 instead of .0396 on a palmetto.
const LEAST_CARRIED: f64 = 1.0 / 3.0;

/// A piece that carries a part of the crown.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Carrier {
    pub(super) piece: usize,
    /// The coarsest level that stands for it; 0 is the piece as it is.
    pub(super) level: usize,
}

/// A piece that grows on another piece carries the crown too if it carries this share of what that does: the trunk
/// in a pot.
const MOST_OF_CARRIED: f64 = 0.5;

/// Pieces that carry the crown, what carries most first, and then what these stand on. `nearest`: by leaf, the
/// piece that it hangs on; `seen_px`: by leaf, how many pixels the views show of it.
///
/// # Panics
/// If there is not one number for each leaf.
pub(super) fn carriers(
    parts: &Parts,
    pieces: &[Piece],
    nearest: &[Option<u32>],
    seen_px: &[f64],
) -> Vec<Carrier> {
    assert_eq!(nearest.len(), seen_px.len());
    let mut own_px = vec![0.0; pieces.len()];
    for (piece, px) in nearest.iter().zip(seen_px) {
        if let Some(piece) = piece {
            own_px[*piece as usize] += px;
        }
    }
    let down = |piece: usize| std::iter::successors(Some(piece), |piece| pieces[*piece].support);
    let mut carried_px = vec![0.0; pieces.len()];
    for (piece, px) in own_px.iter().enumerate() {
        for below in down(piece) {
            carried_px[below] += px;
        }
    }
    let grows_on_none = |piece: &usize| pieces[*piece].support.is_none();
    let mut found: Vec<usize> = (0..pieces.len()).filter(grows_on_none).collect();
    let most_px = found
        .iter()
        .map(|piece| carried_px[*piece])
        .fold(0.0, f64::max);
    let carries = |px: f64| px > 0.0 && px >= LEAST_CARRIED * most_px;
    let (mut found, others): (Vec<usize>, Vec<usize>) = found
        .drain(..)
        .partition(|piece| carries(carried_px[*piece]));
    found.sort_by(|&a, &b| carried_px[b].total_cmp(&carried_px[a]).then(a.cmp(&b)));
    let mut all = with_trunks(parts, pieces, &carried_px, found);
    let bounds = |piece: usize| Bounds::of(parts.foliage(), piece);
    let stand: Vec<Bounds> = all.iter().map(|piece| bounds(*piece)).collect();
    all.extend(others.into_iter().filter(|piece| {
        let below = bounds(*piece);
        stand.iter().any(|above| below.is_stood_on_by(above))
    }));
    let carrier = |piece: usize| Carrier {
        piece,
        level: standing(&pieces[piece]),
    };
    all.into_iter().map(carrier).collect()
}

/// Each of these, followed by pieces that grow on it and carry most of what it does.
fn with_trunks(
    parts: &Parts,
    pieces: &[Piece],
    carried_px: &[f64],
    found: Vec<usize>,
) -> Vec<usize> {
    let mut all = Vec::new();
    for root in found {
        let mut next = Some(root);
        while let Some(piece) = next {
            all.push(piece);
            let is_trunk = |other: &usize| {
                let is_of_another = parts.piece_of(*other) != parts.piece_of(piece);
                let is_most = carried_px[*other] > MOST_OF_CARRIED * carried_px[piece];
                pieces[*other].support == Some(piece) && is_of_another && is_most
            };
            next = (0..pieces.len()).find(is_trunk);
        }
    }
    all
}

/// The place that a piece takes.
struct Bounds {
    low: DVec3,
    high: DVec3,
    /// Its lowest place.
    foot: DVec3,
}

impl Bounds {
    fn of(wood: &Foliage, piece: usize) -> Self {
        let triangles = wood.triangles_of(LeafId::from_index(piece));
        let mut bounds = Self {
            low: DVec3::INFINITY,
            high: DVec3::NEG_INFINITY,
            foot: DVec3::INFINITY,
        };
        for corner in triangles.iter().flat_map(|t| t.corners) {
            bounds.low = bounds.low.min(corner);
            bounds.high = bounds.high.max(corner);
            if corner.y < bounds.foot.y {
                bounds.foot = corner;
            }
        }
        bounds
    }

    /// Whether what is above has its foot within it, and it goes further down: as a pot does.
    fn is_stood_on_by(&self, above: &Self) -> bool {
        let foot = above.foot;
        let is_within = |low: f64, at: f64, high: f64| low <= at && at <= high;
        self.low.y < foot.y
            && is_within(self.low.x, foot.x, self.high.x)
            && is_within(self.low.z, foot.z, self.high.z)
            && foot.y <= self.high.y + (self.high.y - self.low.y)
    }
}

/// The coarsest level of a piece that stands; 0 where none does.
fn standing(piece: &Piece) -> usize {
    let stands = |number: &usize| piece.levels[number - 1].stands;
    (1..=piece.levels.len()).rev().find(stands).unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use glam::DVec3;
    use secateur_model::{Foliage, LeafId, LeafTriangle, Lod};

    use super::super::tests::{by_geometry, tube};
    use super::super::{Wood, WoodBudget};

    const STEMS: usize = 5;

    /// Bent stems that get thinner and lean outward from one place on the ground, with leaves at the end of each, more
    /// on the first ones; and a twig on the first stem.
    fn bush() -> (Foliage, Foliage) {
        let (mut wood, mut leaves) = (Foliage::default(), Foliage::default());
        let lean = |stem: usize| {
            let angle = std::f64::consts::TAU * stem as f64 / STEMS as f64;
            DVec3::new(angle.cos(), 0.0, angle.sin())
        };
        for stem in 0..STEMS {
            let mut triangles = tube(DVec3::ZERO, 8.0 * DVec3::Y, 0.08, 16);
            for corner in triangles.iter_mut().flat_map(|t| &mut t.corners) {
                let share = corner.y / 8.0;
                let bend = 0.3 + 3.0 * share + 0.6 * (3.0 * share).sin();
                let round = (1.0 - 0.6 * share) * DVec3::new(corner.x, 0.0, corner.z);
                *corner = round + bend * lean(stem) + corner.y * DVec3::Y;
            }
            wood.push_leaf(&triangles, None).unwrap();
            for k in 0..10 - stem {
                let at = 3.4 * lean(stem) + DVec3::new(0.0, 7.0 + 0.1 * k as f64, 0.1 * k as f64);
                let corners = [DVec3::ZERO, DVec3::X, DVec3::Y].map(|c| at + 0.5 * c);
                let leaf = LeafTriangle::plain(corners);
                leaves.push_leaf(&[leaf], None).unwrap();
            }
        }
        let from = 2.0 * lean(0) + 4.0 * DVec3::Y;
        let twig = tube(from, from + DVec3::new(1.0, 0.5, 0.0), 0.02, 4);
        wood.push_leaf(&twig, None).unwrap();
        (wood, leaves)
    }

    /// Wood that shows next to nothing.
    fn leafy((wood, leaves): &(Foliage, Foliage)) -> Wood {
        let px = vec![100.0; leaves.leaves().len()];
        by_geometry(wood, &[1.0; STEMS + 1]).with_leaves(leaves, &px)
    }

    /// The lowest and highest place of what is left of each stem.
    fn reach(wood: &Foliage, left: &Lod) -> Vec<Option<[f64; 2]>> {
        let all = left.foliage(wood);
        let of_stem = |stem: usize| {
            let name = LeafId::from_index(stem);
            let originals = left.leaves().map(|(leaf, _)| leaf);
            let donors = left.made().map(|(made, _)| made.donor);
            let at = originals.chain(donors).position(|leaf| leaf == name)?;
            let corners = all.triangles_of(LeafId::from_index(at)).iter();
            let heights = corners.flat_map(|t| t.corners).map(|c| c.y);
            let low = heights.clone().fold(f64::INFINITY, f64::min);
            Some([low, heights.fold(f64::NEG_INFINITY, f64::max)])
        };
        (0..STEMS).map(of_stem).collect()
    }

    #[test]
    fn stems_that_bear_leaves_stay_from_the_ground_to_their_ends() {
        let plant = bush();
        let wood = leafy(&plant);
        // No triangle saves so many pixels, but they carry the crown: three or so each.
        let count = wood.worth(&[], f64::INFINITY, WoodBudget::all(200));
        assert!((3 * STEMS..=10 * STEMS).contains(&count), "{count}");
        for budget in [count, 2 * count, 300, 600] {
            let (left, _) = wood.bearing(&[], WoodBudget::all(budget));
            for ends in reach(&plant.0, &left) {
                let [low, high] = ends.expect("a stem");
                assert!(low < 0.1 && high > 7.9, "{low} to {high} of {budget}");
            }
        }
        // Without leaves nothing carries them.
        let bare = by_geometry(&plant.0, &[1.0; STEMS + 1]);
        assert_eq!(bare.worth(&[], f64::INFINITY, WoodBudget::all(200)), 0);
    }

    /// A stub of a stem that shows all of it for a triangle more than what stands.
    #[test]
    fn a_stem_does_not_end_half_way_for_more_pixels() {
        let plant = bush();
        let of = |reaches: bool| {
            let mut wood = leafy(&plant);
            let number = wood.carriers[0].level;
            let stem = &mut wood.pieces[0];
            stem.seen_px = 1e6;
            let standing = stem.levels[number - 1].triangles.len();
            let whole = plant.0.triangles_of(LeafId::from_index(0));
            let low = (0..whole.len() as u32).filter(|t| {
                let corners = whole[*t as usize].corners;
                corners.iter().all(|corner| corner.y < 4.0)
            });
            let stub = &mut stem.levels[number - 2];
            stub.triangles = low
                .map(|t| [3 * t, 3 * t + 1, 3 * t + 2])
                .take(standing + 1)
                .collect();
            stub.loss = 0.0;
            stub.reaches = reaches;
            let (left, _) = wood.bearing(&[], WoodBudget::all(200));
            let [low, high] = reach(&plant.0, &left)[0].expect("a stem");
            assert!(low < 0.1, "{low}");
            high
        };
        assert!(of(false) > 7.9);
        assert!(of(true) < 4.1);
    }

    #[test]
    fn what_carries_most_stands_first() {
        let plant = bush();
        let wood = leafy(&plant);
        let px = f64::INFINITY;
        let of = |standing: usize| {
            let triangles = 100;
            let budget = WoodBudget {
                triangles,
                standing,
                first: triangles,
            };
            wood.worth(&[], px, budget)
        };
        let all = of(100);
        let one = of(0);
        assert!(one >= 2 && 2 * one <= all, "{one} of {all}");
        assert!(of(all - 1) < all);
        let (left, _) = wood.bearing(&[], WoodBudget::all(one));
        let stands: Vec<bool> = reach(&plant.0, &left).iter().map(Option::is_some).collect();
        assert_eq!(stands, [true, false, false, false, false]);
        // A budget that holds none is kept.
        assert_eq!(wood.worth(&[], px, WoodBudget::all(one - 1)), 0);
    }

    #[test]
    fn a_stem_of_few_leaves_and_a_bough_need_not_stand() {
        let (wood, leaves) = bush();
        let of = |px: &dyn Fn(usize) -> f64| {
            let px: Vec<f64> = (0..leaves.leaves().len()).map(px).collect();
            let wood = by_geometry(&wood, &[1.0; STEMS + 1]).with_leaves(&leaves, &px);
            let carriers = wood.carriers.iter().map(|carrier| carrier.piece);
            carriers.collect::<Vec<usize>>()
        };
        assert_eq!(of(&|_| 1.0), [0, 1, 2, 3, 4]);
        // The last six leaves are those of the last stem.
        let last = leaves.leaves().len() - 6;
        assert_eq!(
            of(&|leaf| if leaf < last { 1.0 } else { 0.1 }),
            [0, 1, 2, 3]
        );
        assert!(of(&|_| 0.0).is_empty());
    }

    /// A pot that is no tube, a trunk that rises from within it where there is one, and leaves on a ring above.
    fn potted(trunk: Option<f64>) -> (Foliage, Foliage) {
        let (mut wood, mut leaves) = (Foliage::default(), Foliage::default());
        wood.push_leaf(&tube(DVec3::ZERO, 0.8 * DVec3::Y, 0.6, 24), None)
            .unwrap();
        if let Some(radius) = trunk {
            let trunk = tube(0.4 * DVec3::Y, 4.0 * DVec3::Y, radius, 16);
            wood.push_leaf(&trunk, None).unwrap();
        }
        let high = if trunk.is_some() { 4.0 } else { 1.0 };
        for k in 0..12 {
            let (sin, cos) = f64::from(k).sin_cos();
            let at = DVec3::new(0.3 * cos, high, 0.3 * sin);
            let corners = [DVec3::ZERO, DVec3::X, DVec3::Y].map(|c| at + 0.5 * c);
            leaves
                .push_leaf(&[LeafTriangle::plain(corners)], None)
                .unwrap();
        }
        (wood, leaves)
    }

    fn ready((wood, leaves): &(Foliage, Foliage)) -> Wood {
        let px = vec![100.0; leaves.leaves().len()];
        by_geometry(wood, &vec![1.0; wood.leaves().len()]).with_leaves(leaves, &px)
    }

    #[test]
    fn a_pot_stays_while_anything_of_it_fits() {
        let plant = potted(None);
        let mut wood = ready(&plant);
        // As where nothing that collapses leave stands.
        wood.carriers[0].level = 0;
        for of_plant in [4, 7, 12, 21, 42] {
            // Pixels of wood are worth nothing beside those of leaves.
            let budget = WoodBudget::of_plant(of_plant / 2, of_plant);
            let count = wood.worth(&[], f64::INFINITY, budget);
            assert!((3..of_plant).contains(&count), "{count} of {of_plant}");
            let budget = WoodBudget::of_plant(count, of_plant);
            let chosen = wood.chosen(&[], budget);
            assert_eq!(wood.carriers_gone(&chosen), [0, 1]);
            let left = wood.lod(&chosen).foliage(&plant.0);
            let count = left.triangles().len();
            assert!((3..of_plant).contains(&count), "{count} of {of_plant}");
        }
        let chosen = wood.chosen(&[], WoodBudget::of_plant(1, 3));
        assert_eq!(wood.carriers_gone(&chosen), [1, 1]);
    }

    /// The pot carries a thin trunk, and a thick trunk stands on the pot.
    #[test]
    fn a_trunk_and_its_pot_stay_whichever_is_larger() {
        for radius in [0.1, 0.5] {
            let plant = potted(Some(radius));
            let wood = ready(&plant);
            let mut pieces: Vec<usize> = wood.carriers.iter().map(|c| c.piece).collect();
            pieces.sort_unstable();
            assert_eq!(pieces, [0, 1], "{radius}");
        }
    }

    #[test]
    fn pieces_get_levels_in_between() {
        let plant = potted(Some(0.1));
        let wood = ready(&plant);
        let count = |lod: &Lod| lod.foliage(&plant.0).triangles().len();
        let chosen = wood.chosen(&[], WoodBudget::all(40));
        let before = count(&wood.lod(&chosen));
        for more in [0, 5, 11, 17] {
            let now = count(&wood.refined(&chosen, more));
            assert!(
                now <= before + more && now + 2 >= before + more,
                "{now} of {before} + {more}"
            );
        }
    }
}
