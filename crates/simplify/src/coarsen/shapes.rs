//! Which shapes leaves take with fewer triangles, and what they lose by it.

use rayon::prelude::*;
use rustc_hash::FxHashMap;
use secateur_model::{Foliage, LeafId, LeafTriangle, NewLeaf};
use secateur_raster::ViewSet;
use secateur_raster::cpu::LeafFragments;

use super::triangle::{self, Three};
use super::{Cards, collapsed, leaf_mesh};

/// Leaves are looked at in images of the crown of at most so many pixels a side, those
/// of the judge.
const MOST_RESOLUTION: f64 = 512.0;

/// But of no more than shows the root of a leaf's area as so many pixels.
const MOST_PIXELS_A_LEAF: f64 = 16.0;

/// So many leaves of a kind are looked at, of more triangles fewer.
const LEAVES_A_KIND: usize = 64;

/// But so many at least, which is also how many try all triangles.
const LEAVES_AT_LEAST: usize = 8;

/// The share of an image's width that a crown takes.
const CROWN_SHARE: f64 = 0.57;

/// So many triangles are tried by all that are looked at.
const FINALISTS: usize = 4;

/// What loses less than this share of what another does is clearly better: losses say what
/// single leaves lose, not what the crown does.
const CLEARLY_LESS: f64 = 0.9;

/// Of so many kinds; those that have the most triangles in all.
const MOST_KINDS: usize = 64;

/// Leaves of more triangles are not looked at.
const MOST_TRIANGLES: usize = 128;

/// A leaf with a cut-out keeps two triangles where fewer show too little of its texture.
const LEAST_WITH_CUTOUT: usize = 2;

/// How leaves become coarser, kind by kind: leaves of a kind have as many triangles, meeting
/// at the same corners, and the same cut-out.
#[derive(Debug)]
pub struct Shapes {
    cards: Cards,
    kind_of: Vec<u32>,
    kinds: Vec<OfKind>,
}

#[derive(Clone, Debug)]
struct OfKind {
    /// Numbers of triangles that it can keep, the fewest first.
    all: Vec<Kept>,
    /// Those of which each triangle more is worth less than the one before.
    kept: Vec<Kept>,
    /// Which corners one triangle has, where that is better than what collapses leave.
    three: Option<Three>,
}

/// A number of triangles that a leaf takes well.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Kept {
    /// How many it keeps.
    pub triangles: usize,
    /// Of the pixels that show the leaf before or after, the share that show only one of
    /// them, over views from all around the crown.
    pub loss: f64,
}

/// What leaves of a kind have in common: triangles, cut-out, and which corners meet.
type Kind = (usize, Option<u32>, Vec<u32>);

impl Shapes {
    /// Of the leaves of a foliage, on the threads of the current rayon pool.
    pub fn of(foliage: &Foliage) -> Self {
        let cards = Cards::of(foliage);
        let leaves: Vec<LeafId> = (0..foliage.leaves().len())
            .map(LeafId::from_index)
            .collect();
        let kind = |leaf: &LeafId| {
            let triangles = foliage.triangles_of(*leaf);
            // Leaves may be alike but for how many triangles show all of their texture.
            let least = cards.triangles_of(*leaf).map_or(0, <[_]>::len) as u32;
            let mut meeting = leaf_mesh::vertices(triangles).unwrap_or_default();
            meeting.push(least);
            (triangles.len(), foliage.leaf(*leaf).cutout(), meeting)
        };
        let kind_of_leaf: Vec<Kind> = leaves.par_iter().map(kind).collect();
        let mut numbers: FxHashMap<&Kind, u32> = FxHashMap::default();
        let mut members: Vec<Vec<LeafId>> = Vec::new();
        let number = |(kind, leaf): (_, &LeafId)| {
            let number = *numbers.entry(kind).or_insert_with(|| {
                members.push(Vec::new());
                members.len() as u32 - 1
            });
            members[number as usize].push(*leaf);
            number
        };
        let kind_of: Vec<u32> = kind_of_leaf.iter().zip(&leaves).map(number).collect();
        let triangles = |leaves: &[LeafId]| foliage.triangles_of(leaves[0]).len();
        let mut by_size: Vec<usize> = (0..members.len()).collect();
        by_size.sort_by_key(|&k| std::cmp::Reverse(triangles(&members[k]) * members[k].len()));
        by_size.retain(|&k| (2..=MOST_TRIANGLES).contains(&triangles(&members[k])));
        by_size.truncate(MOST_KINDS);
        let stage = foliage.bounding_sphere().map(|sphere| Stage {
            foliage,
            cards: &cards,
            views: ViewSet::dodecahedron(sphere),
            radius: sphere.radius,
        });
        let mut kinds: Vec<OfKind> = members
            .iter()
            .map(|leaves| not_looked_at(least(foliage, &cards, leaves[0]), triangles(leaves)))
            .collect();
        if let Some(stage) = &stage {
            let looked_at = by_size.par_iter().map(|&k| (k, stage.of_kind(&members[k])));
            for (k, of_kind) in looked_at.collect::<Vec<_>>() {
                kinds[k] = of_kind;
            }
        }
        Self {
            cards,
            kind_of,
            kinds,
        }
    }

    /// Numbers of triangles that a leaf takes well, the fewest first, all of its own the
    /// last: each triangle more is worth less than the one before.
    ///
    /// # Panics
    /// If there is no such leaf.
    pub fn kept(&self, leaf: LeafId) -> &[Kept] {
        &self.of_leaf(leaf).kept
    }

    /// All numbers of triangles that a leaf can keep, the fewest first.
    pub(super) fn all(&self, leaf: LeafId) -> &[Kept] {
        &self.of_leaf(leaf).all
    }

    fn of_leaf(&self, leaf: LeafId) -> &OfKind {
        &self.kinds[self.kind_of[leaf.index()] as usize]
    }

    /// Whether these are the triangles that show all of a leaf.
    pub(super) fn shows_all(&self, leaf: LeafId, made: &NewLeaf) -> bool {
        self.cards.triangles_of(leaf) == Some(&made.triangles)
    }

    /// What takes the place of a leaf that may keep so many triangles, if anything does.
    pub(super) fn coarser(
        &self,
        foliage: &Foliage,
        leaf: LeafId,
        at_most: usize,
    ) -> Option<NewLeaf> {
        let three = self.of_leaf(leaf).three;
        coarser(foliage, &self.cards, leaf, at_most, three)
    }
}

fn coarser(
    foliage: &Foliage,
    cards: &Cards,
    leaf: LeafId,
    at_most: usize,
    three: Option<Three>,
) -> Option<NewLeaf> {
    if foliage.triangles_of(leaf).len() <= at_most {
        return None;
    }
    match cards.triangles_of(leaf) {
        Some(triangles) if triangles.len() <= at_most => {
            return Some(NewLeaf {
                donor: leaf,
                triangles: triangles.to_vec(),
            });
        }
        _ => (),
    }
    let three = three.filter(|_| at_most == 1);
    three
        .and_then(|three| triangle::flat(foliage, leaf, three))
        .or_else(|| collapsed(foliage, leaf, at_most))
}

fn least(foliage: &Foliage, cards: &Cards, leaf: LeafId) -> usize {
    let least = match (foliage.leaf(leaf).cutout(), cards.triangles_of(leaf)) {
        (Some(_), Some(triangles)) => triangles.len(),
        (Some(_), None) => LEAST_WITH_CUTOUT,
        (None, _) => 1,
    };
    least.min(foliage.triangles_of(leaf).len())
}

/// A surface of n triangles in the place of a smooth one is off by about one part in n.
fn not_looked_at(least: usize, all: usize) -> OfKind {
    let kept = (least..=all).map(|triangles| Kept {
        triangles,
        loss: 1.0 / triangles as f64 - 1.0 / all as f64,
    });
    let kept: Vec<Kept> = kept.collect();
    OfKind {
        all: kept.clone(),
        kept,
        three: None,
    }
}

/// Where leaves are looked at.
struct Stage<'a> {
    foliage: &'a Foliage,
    cards: &'a Cards,
    views: ViewSet,
    radius: f64,
}

/// A leaf, and the pixels that it shows.
struct Sitter {
    leaf: LeafId,
    pixels: Vec<u32>,
}

impl Stage<'_> {
    fn of_kind(&self, leaves: &[LeafId]) -> OfKind {
        let foliage = self.foliage;
        let all = foliage.triangles_of(leaves[0]).len();
        let least = least(foliage, self.cards, leaves[0]);
        let count = (8 * LEAVES_A_KIND / all).clamp(LEAVES_AT_LEAST, LEAVES_A_KIND);
        let stride = leaves.len().div_ceil(count);
        let sample: Vec<LeafId> = leaves.iter().copied().step_by(stride).collect();
        let area: f64 = sample.iter().map(|l| foliage.leaf(*l).area()).sum();
        let size = (area / sample.len() as f64).sqrt();
        let fine = MOST_PIXELS_A_LEAF * 2.0 * self.radius / (CROWN_SHARE * size);
        // Of all leaves at one point there is no such number.
        let resolution = (fine.clamp(1.0, MOST_RESOLUTION) as u32).max(1);
        let mut fragments = LeafFragments::new(resolution);
        let sitters = sample.into_iter().map(|leaf| Sitter {
            leaf,
            pixels: self.pixels(&mut fragments, leaf, foliage.triangles_of(leaf)),
        });
        let sitters: Vec<Sitter> = sitters.collect();
        // Nothing if one of them keeps more.
        let mut loss = |triangles: usize, three: Option<Three>, sitters: &[Sitter]| {
            let (mut in_both, mut in_any) = (0, 0);
            for Sitter { leaf, pixels } in sitters {
                let made = coarser(foliage, self.cards, *leaf, triangles, three)?;
                if made.triangles.len() > triangles {
                    return None;
                }
                let after = made.triangles_in(foliage, 1.0);
                let after = self.pixels(&mut fragments, *leaf, &after);
                let common = common(pixels, &after);
                in_both += common;
                in_any += pixels.len() + after.len() - common;
            }
            let shared = in_both as f64 / in_any.max(1) as f64;
            Some(if in_any == 0 { 0.0 } else { 1.0 - shared })
        };
        let mut kept: Vec<Kept> = (least..all)
            .filter_map(|triangles| {
                let loss = loss(triangles, None, &sitters)?;
                Some(Kept { triangles, loss })
            })
            .collect();
        let mut three = None;
        if let Some(one) = kept.first_mut()
            && one.triangles == 1
            && self.cards.triangles_of(leaves[0]).is_none()
        {
            let some = &sitters[..sitters.len().min(LEAVES_AT_LEAST)];
            let candidates = triangle::candidates(foliage, leaves[0]).into_iter();
            let mut tried: Vec<(f64, Three)> = candidates
                .filter_map(|three| Some((loss(1, Some(three), some)?, three)))
                .collect();
            tried.sort_by(|a, b| a.0.total_cmp(&b.0));
            tried.truncate(FINALISTS);
            let finals = tried.iter();
            let finals =
                finals.filter_map(|(_, three)| Some((loss(1, Some(*three), &sitters)?, *three)));
            if let Some((with, best)) = finals.min_by(|a, b| a.0.total_cmp(&b.0))
                && with < CLEARLY_LESS * one.loss
            {
                one.loss = with;
                three = Some(best);
            }
        }
        kept.push(Kept {
            triangles: all,
            loss: 0.0,
        });
        OfKind {
            kept: convex(&kept),
            all: kept,
            three,
        }
    }

    /// What triangles of a leaf show.
    fn pixels(
        &self,
        fragments: &mut LeafFragments,
        of: LeafId,
        triangles: &[LeafTriangle],
    ) -> Vec<u32> {
        let cutout = self.foliage.leaf(of).cutout();
        let mask = cutout.map(|number| self.foliage.cutouts()[number as usize].clone());
        let mut alone = Foliage::new(mask.into_iter().collect());
        let Ok(leaf) = alone.push_leaf(triangles, cutout.map(|_| 0)) else {
            return Vec::new();
        };
        let found = fragments.of(&alone, leaf, 1.0, self.views.views());
        found.iter().map(|(pixel, _)| *pixel).collect()
    }
}

/// How many are in both of two ordered lists.
fn common(a: &[u32], b: &[u32]) -> usize {
    a.iter()
        .filter(|pixel| b.binary_search(pixel).is_ok())
        .count()
}

/// Those of which each triangle more is worth less than the one before.
pub(super) fn convex(all: &[Kept]) -> Vec<Kept> {
    let slope = |a: &Kept, b: &Kept| (a.loss - b.loss) / (b.triangles - a.triangles) as f64;
    let mut kept: Vec<Kept> = Vec::new();
    for &next in all {
        while let [.., before, last] = &kept[..]
            && slope(before, last) <= slope(last, &next)
        {
            kept.pop();
        }
        kept.push(next);
    }
    kept
}
