//! Loss curves: what a leaf of each kind loses with fewer triangles.

use rayon::prelude::*;
use rustc_hash::FxHashMap;
use secateur_model::{Foliage, LeafId, LeafTriangle, NewLeaf};
use secateur_raster::ViewSet;
use secateur_raster::cpu::LeafFragments;

use super::triangle::{self, CornerTriple};
use super::{Cards, Sheets, by_position, collapsed, instances, leaf_mesh};

/// Width and height in pixels of the largest images in which leaves are drawn: the judge's.
const MAX_RESOLUTION_PX: f64 = 512.0;

/// Images are no larger than it takes to show the root of a leaf's area as this many pixels.
const MAX_LEAF_PX: f64 = 16.0;

/// Number of leaves of a kind that are drawn, if they have 8 triangles; fewer if they have more.
const SAMPLES_PER_KIND: usize = 64;

/// Least number of leaves of a kind that are drawn. This many try every triple of corners.
const MIN_SAMPLES: usize = 8;

/// Share of an image's width that the crown takes, 0 to 1.
const CROWN_SHARE: f64 = 0.57;

/// Number of the best triples of corners that all drawn leaves try.
const FINALISTS: usize = 4;

/// A triple of corners replaces collapses only if it loses less than this share of what they
/// lose. Losses are those of single leaves, so a small gain may be none for the crown.
const CLEARLY_LESS: f64 = 0.9;

/// Number of kinds that are drawn: those whose leaves have the most triangles together.
const MAX_KINDS: usize = 64;

/// Leaves of more triangles are not drawn; their losses are estimated.
const MAX_TRIANGLES: usize = 128;

/// Least number of triangles of a leaf with a cut-out whose texture no single triangle shows.
const MIN_WITH_CUTOUT: usize = 2;

/// What leaves lose with fewer triangles, by kind. Leaves of one kind have the same number of
/// triangles, which meet at the same corners, and the same cut-out.
#[derive(Debug)]
pub struct LossCurves {
    cards: Cards,
    sheets: Sheets,
    kind_of: Vec<u32>,
    kinds: Vec<KindCurve>,
    /// How many pixels views show of each leaf; nothing where it is not known.
    seen_px: Option<Vec<f64>>,
    /// The first leaf of each kind whose leaves are instances of one mesh.
    first_of_shape: Vec<Option<LeafId>>,
}

#[derive(Clone, Debug)]
struct KindCurve {
    /// All numbers of triangles that the leaf can have, the fewest first.
    points: Vec<LossPoint>,
    /// The lower convex hull of `points`: each further triangle is worth less than the last.
    hull: Vec<LossPoint>,
    /// The corners of the one triangle that is better than what collapses leave, if any is; of a
    /// sheet those whose plane it lies in.
    three: Option<CornerTriple>,
}

/// A number of triangles, and what a leaf loses if it has no more.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LossPoint {
    /// Number of triangles that the leaf keeps.
    pub triangles: usize,
    /// Of the pixels that show the leaf before or after, the share that show only one of the two,
    /// 0 to 1, over 20 views from all around the crown.
    pub loss: f64,
}

/// What leaves of one kind share: number of triangles, cut-out, shape, and which corners meet.
type Kind = (usize, Option<u32>, Option<u32>, Vec<u32>);

impl LossCurves {
    /// Draws samples of each kind of leaf, on the threads of the current rayon pool.
    pub fn of(foliage: &Foliage) -> Self {
        let cards = Cards::of(foliage);
        let sheets = Sheets::of(foliage, &cards);
        let leaves: Vec<LeafId> = (0..foliage.leaves().len())
            .map(LeafId::from_index)
            .collect();
        let kind = |leaf: &LeafId| {
            let triangles = foliage.triangles_of(*leaf);
            // Leaves may be alike but for how many triangles show all of their texture.
            let least = cards.triangles_of(*leaf).map_or(0, <[_]>::len) as u32;
            let mut meeting = leaf_mesh::vertices(triangles).unwrap_or_default();
            meeting.push(least);
            meeting.push(sheets.has(*leaf).into());
            let own = foliage.leaf(*leaf);
            (triangles.len(), own.cutout(), own.shape(), meeting)
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
        by_size.retain(|&k| (2..=MAX_TRIANGLES).contains(&triangles(&members[k])));
        by_size.truncate(MAX_KINDS);
        let stage = foliage.bounding_sphere().map(|sphere| CrownViews {
            foliage,
            cards: &cards,
            sheets: &sheets,
            views: ViewSet::dodecahedron(sphere),
            radius: sphere.radius,
        });
        let mut kinds: Vec<KindCurve> = members
            .iter()
            .map(|leaves| estimated_curve(least(foliage, &cards, leaves[0]), triangles(leaves)))
            .collect();
        if let Some(stage) = &stage {
            let looked_at = by_size
                .par_iter()
                .map(|&k| (k, stage.kind_curve(&members[k])));
            for (k, kind_curve) in looked_at.collect::<Vec<_>>() {
                kinds[k] = kind_curve;
            }
        }
        let first_of_shape = members
            .iter()
            .map(|leaves| Some(leaves[0]).filter(|&first| foliage.leaf(first).shape().is_some()));
        Self {
            first_of_shape: first_of_shape.collect(),
            seen_px: None,
            cards,
            sheets,
            kind_of,
            kinds,
        }
    }

    /// Leaves that hide each other: views show this many pixels of each.
    ///
    /// # Panics
    /// If there is not one number for each leaf.
    pub fn seen(self, seen_px: Vec<f64>) -> Self {
        assert_eq!(seen_px.len(), self.kind_of.len(), "a number for each leaf");
        Self {
            seen_px: Some(seen_px),
            ..self
        }
    }

    /// What a leaf has to lose: pixels that views show of it, or its area where that is not known.
    ///
    /// # Panics
    /// If there is no such leaf.
    pub fn weight(&self, foliage: &Foliage, leaf: LeafId) -> f64 {
        match &self.seen_px {
            Some(seen_px) => seen_px[leaf.index()],
            None => foliage.leaf(leaf).area(),
        }
    }

    /// Whether a budget may count a leaf for none: what is seen of it is known, and it is no instance.
    pub(super) fn may_go(&self, leaf: LeafId) -> bool {
        self.seen_px.is_some() && self.first_of_shape(leaf).is_none()
    }

    /// The lower convex hull of a leaf's losses, the fewest triangles first and all of its own
    /// last: each further triangle is worth less than the last.
    ///
    /// # Panics
    /// If there is no such leaf.
    pub fn hull(&self, leaf: LeafId) -> &[LossPoint] {
        &self.curve_of(leaf).hull
    }

    /// A leaf's losses for all numbers of triangles, the fewest first.
    pub(super) fn points(&self, leaf: LeafId) -> &[LossPoint] {
        &self.curve_of(leaf).points
    }

    fn curve_of(&self, leaf: LeafId) -> &KindCurve {
        &self.kinds[self.kind_of[leaf.index()] as usize]
    }

    /// Whether a new leaf shows all that the original leaf's texture shows.
    pub(super) fn shows_all(&self, leaf: LeafId, made: &NewLeaf) -> bool {
        self.cards.triangles_of(leaf) == Some(&made.triangles)
    }

    /// The leaf that replaces one which may keep `at_most` triangles; none if it stays as it is.
    pub(super) fn coarser(
        &self,
        foliage: &Foliage,
        leaf: LeafId,
        at_most: usize,
    ) -> Option<NewLeaf> {
        let three = self.curve_of(leaf).three;
        let made = |leaf| coarser(foliage, &self.cards, &self.sheets, leaf, at_most, three);
        match self.first_of_shape(leaf) {
            Some(first) if first != leaf => {
                let like = instances::as_instance(foliage, &made(first)?, leaf);
                like.or_else(|| made(leaf))
            }
            Some(_) | None => made(leaf),
        }
    }

    /// The first of the leaves that are instances of the same mesh as this; none where it is no instance.
    pub(super) fn first_of_shape(&self, leaf: LeafId) -> Option<LeafId> {
        self.first_of_shape[self.kind_of[leaf.index()] as usize]
    }
}

fn coarser(
    foliage: &Foliage,
    cards: &Cards,
    sheets: &Sheets,
    leaf: LeafId,
    at_most: usize,
    three: Option<CornerTriple>,
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
    match three.filter(|_| at_most == 1) {
        // A fold may be too sharp for the plane in single leaves of a kind; they keep their texture.
        Some(plane) if sheets.has(leaf) => sheets
            .flat(foliage, leaf, plane)
            .or_else(|| collapsed(foliage, leaf, MIN_WITH_CUTOUT)),
        Some(three) => {
            triangle::flat(foliage, leaf, three).or_else(|| collapsed(foliage, leaf, at_most))
        }
        None => {
            let made = collapsed(foliage, leaf, at_most);
            let is_large = foliage.triangles_of(leaf).len() > MAX_TRIANGLES;
            let is_near = |made: &NewLeaf| made.triangles.len() <= at_most + at_most / 8;
            match is_large && !made.as_ref().is_some_and(is_near) {
                // What is large is not to go whole.
                true => by_position::within(foliage, leaf, at_most),
                false => made,
            }
        }
    }
}

fn least(foliage: &Foliage, cards: &Cards, leaf: LeafId) -> usize {
    let least = match (foliage.leaf(leaf).cutout(), cards.triangles_of(leaf)) {
        (Some(_), Some(triangles)) => triangles.len(),
        (Some(_), None) => MIN_WITH_CUTOUT,
        (None, _) => 1,
    };
    least.min(foliage.triangles_of(leaf).len())
}

/// For kinds that are not drawn: n triangles in place of a smooth surface are off by about 1/n.
fn estimated_curve(least: usize, all: usize) -> KindCurve {
    let points = (least..=all).map(|triangles| LossPoint {
        triangles,
        loss: 1.0 / triangles as f64 - 1.0 / all as f64,
    });
    let points: Vec<LossPoint> = points.collect();
    KindCurve {
        hull: points.clone(),
        points,
        three: None,
    }
}

/// The views of the crown in which single leaves are drawn.
struct CrownViews<'a> {
    foliage: &'a Foliage,
    cards: &'a Cards,
    sheets: &'a Sheets,
    views: ViewSet,
    radius: f64,
}

/// A drawn leaf, and the pixels that show it alone, in order.
struct SampleLeaf {
    leaf: LeafId,
    pixels: Vec<u32>,
}

impl CrownViews<'_> {
    fn kind_curve(&self, leaves: &[LeafId]) -> KindCurve {
        let foliage = self.foliage;
        let all = foliage.triangles_of(leaves[0]).len();
        let least = least(foliage, self.cards, leaves[0]);
        let mut samples = Samples::of(self, leaves);
        let mut points: Vec<LossPoint> = (least..all)
            .filter_map(|triangles| {
                let loss = samples.loss(triangles, None, usize::MAX)?;
                Some(LossPoint { triangles, loss })
            })
            .collect();
        let mut three = None;
        match points.first_mut() {
            _ if self.sheets.has(leaves[0]) => {
                let candidates = triangle::candidates(foliage, leaves[0]);
                if let Some((loss, best)) = samples.best_of(candidates) {
                    points.insert(0, LossPoint { triangles: 1, loss });
                    three = Some(best);
                }
            }
            Some(one) if one.triangles == 1 && self.cards.triangles_of(leaves[0]).is_none() => {
                let candidates = triangle::candidates(foliage, leaves[0]);
                if let Some((with, best)) = samples.best_of(candidates)
                    && with < CLEARLY_LESS * one.loss
                {
                    one.loss = with;
                    three = Some(best);
                }
            }
            _ => (),
        }
        points.push(LossPoint {
            triangles: all,
            loss: 0.0,
        });
        KindCurve {
            hull: lower_hull(&points),
            points,
            three,
        }
    }

    /// The pixels that show these triangles of a leaf, in order.
    fn pixels(
        &self,
        fragments: &mut LeafFragments,
        of: LeafId,
        triangles: &[LeafTriangle],
    ) -> Vec<u32> {
        let original = self.foliage.leaf(of);
        let cutout = original.cutout();
        let mask = cutout.map(|number| self.foliage.cutouts()[number as usize].clone());
        let mut alone = Foliage::new(mask.into_iter().collect());
        let pushed = alone.push_leaf_facing(triangles, cutout.map(|_| 0), original.facing());
        let Ok(leaf) = pushed else {
            return Vec::new();
        };
        let found = fragments.of(&alone, leaf, 1.0, self.views.views());
        found.iter().map(|(pixel, _)| *pixel).collect()
    }
}

/// Leaves of one kind that are drawn to tell what the kind loses.
struct Samples<'a> {
    crown: &'a CrownViews<'a>,
    fragments: LeafFragments,
    leaves: Vec<SampleLeaf>,
}

impl<'a> Samples<'a> {
    /// Some of these leaves, spread over them.
    fn of(crown: &'a CrownViews<'a>, leaves: &[LeafId]) -> Self {
        let foliage = crown.foliage;
        let all = foliage.triangles_of(leaves[0]).len();
        let count = (8 * SAMPLES_PER_KIND / all).clamp(MIN_SAMPLES, SAMPLES_PER_KIND);
        let stride = leaves.len().div_ceil(count);
        let sample: Vec<LeafId> = leaves.iter().copied().step_by(stride).collect();
        let area: f64 = sample.iter().map(|l| foliage.leaf(*l).area()).sum();
        let size = (area / sample.len() as f64).sqrt();
        let fine = MAX_LEAF_PX * 2.0 * crown.radius / (CROWN_SHARE * size);
        // A crown that is a single point gives no finite number.
        let resolution = (fine.clamp(1.0, MAX_RESOLUTION_PX) as u32).max(1);
        let mut fragments = LeafFragments::new(resolution);
        let drawn = sample.into_iter().map(|leaf| SampleLeaf {
            leaf,
            pixels: crown.pixels(&mut fragments, leaf, foliage.triangles_of(leaf)),
        });
        Self {
            leaves: drawn.collect(),
            crown,
            fragments,
        }
    }

    /// Of the pixels that the first `count` sampled leaves cover as they are or with this number of triangles each, the
    /// share that they do not cover both ways; none if one of them has no form of so few.
    fn loss(&mut self, triangles: usize, three: Option<CornerTriple>, count: usize) -> Option<f64> {
        let crown = self.crown;
        let foliage = crown.foliage;
        let (mut in_both, mut in_any) = (0, 0);
        for SampleLeaf { leaf, pixels } in self.leaves.iter().take(count) {
            let made = coarser(foliage, crown.cards, crown.sheets, *leaf, triangles, three)?;
            if made.triangles.len() > triangles {
                return None;
            }
            let after = made.triangles_in(foliage, 1.0);
            let after = crown.pixels(&mut self.fragments, *leaf, &after);
            let common = common(pixels, &after);
            in_both += common;
            in_any += pixels.len() + after.len() - common;
        }
        let shared = in_both as f64 / in_any.max(1) as f64;
        Some(if in_any == 0 { 0.0 } else { 1.0 - shared })
    }

    /// The three corners that lose least as one triangle, and what they lose: the best of few leaves compete by all.
    fn best_of(&mut self, candidates: Vec<CornerTriple>) -> Option<(f64, CornerTriple)> {
        let mut tried: Vec<(f64, CornerTriple)> = (candidates.into_iter())
            .filter_map(|three| Some((self.loss(1, Some(three), MIN_SAMPLES)?, three)))
            .collect();
        tried.sort_by(|a, b| a.0.total_cmp(&b.0));
        tried.truncate(FINALISTS);
        let finals = tried.iter();
        let finals =
            finals.filter_map(|(_, three)| Some((self.loss(1, Some(*three), usize::MAX)?, *three)));
        finals.min_by(|a, b| a.0.total_cmp(&b.0))
    }
}

/// Number of pixels that two ordered lists share.
fn common(a: &[u32], b: &[u32]) -> usize {
    a.iter()
        .filter(|pixel| b.binary_search(pixel).is_ok())
        .count()
}

/// The lower convex hull of points in order of their triangles.
pub(super) fn lower_hull(all: &[LossPoint]) -> Vec<LossPoint> {
    let slope =
        |a: &LossPoint, b: &LossPoint| (a.loss - b.loss) / (b.triangles - a.triangles) as f64;
    let mut hull: Vec<LossPoint> = Vec::new();
    for &next in all {
        while let [.., before, last] = &hull[..]
            && slope(before, last) <= slope(last, &next)
        {
            hull.pop();
        }
        hull.push(next);
    }
    hull
}
