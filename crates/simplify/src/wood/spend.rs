//! How triangles are shared out among the pieces of the wood.
//!
//! A triangle goes where it saves the most pixels: those that the piece shows, and those of leaves
//! that would hang in the air without it. A piece that shows little may be worth its triangles for
//! twigs that can only come after it. What an offer is worth falls while others bear the same
//! leaves, so the best one is looked at again before it is taken.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use super::Wood;

/// How many pieces, each growing on the one before, are looked at for what the first is worth.
const MOST_DEEP: usize = 4;

/// The next thing that triangles can be spent on: a piece, at a level.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Offer {
    px_a_triangle: f64,
    pub(super) piece: usize,
    /// 0 for the piece as it is, else one more than an index of its levels.
    pub(super) level: usize,
}

impl Eq for Offer {}

impl Ord for Offer {
    fn cmp(&self, other: &Self) -> std::cmp::Ordering {
        let by_gain = self.px_a_triangle.total_cmp(&other.px_a_triangle);
        by_gain.then_with(|| Reverse(self.piece).cmp(&Reverse(other.piece)))
    }
}

impl PartialOrd for Offer {
    fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
        Some(self.cmp(other))
    }
}

/// Pixels that are saved, and triangles that it takes.
#[derive(Clone, Copy, Debug)]
struct Worth {
    px: f64,
    triangles: usize,
}

impl Worth {
    fn px_a_triangle(self) -> f64 {
        self.px / self.triangles as f64
    }

    fn and(self, other: Self) -> Self {
        Self {
            px: self.px + other.px,
            triangles: self.triangles + other.triangles,
        }
    }
}

/// What carries the crown to the ground takes at most this share of a plant's triangles, whatever it shows; the
/// first piece, without which nothing stands, may take more. Other values were not tried.
const MOST_STANDING: f64 = 0.25;

struct Spending<'a> {
    wood: &'a Wood,
    /// By piece, those that grow on it.
    growing: Vec<Vec<usize>>,
    chosen: Vec<Option<usize>>,
    /// What leaves lose that nothing bears, in pixels; 0 once something does.
    hanging_px: Vec<f64>,
    left: usize,
}

/// How many triangles wood may have.
#[derive(Clone, Copy, Debug)]
pub struct WoodBudget {
    /// The most triangles of all wood together.
    pub triangles: usize,
    /// The most of these triangles that go to pieces which carry the crown to the ground, whatever pixels
    /// they save. The piece that carries the most may exceed this.
    pub standing: usize,
    /// The most of the piece that carries the most, even where it exceeds `triangles`.
    pub first: usize,
}

impl WoodBudget {
    /// The budget of a plant that may have `of_plant` triangles, of which wood may have `of_wood`.
    pub fn of_plant(of_wood: usize, of_plant: usize) -> Self {
        Self {
            triangles: of_wood,
            standing: (MOST_STANDING * of_plant as f64) as usize,
            // Something is to hang on it.
            first: of_plant.saturating_sub(1),
        }
    }

    /// A budget of which all may go to pieces that carry the crown to the ground.
    pub fn all(triangles: usize) -> Self {
        Self {
            triangles,
            standing: triangles,
            first: triangles,
        }
    }
}

impl Wood {
    /// Takes first what carries the crown to the ground, as far as the budget has triangles for that;
    /// then offers, the best first, while there are triangles left. Says of each which level its
    /// piece had before. Triangles that each save fewer pixels than `least_px_a_triangle` are not
    /// spent, but on what carries the crown.
    pub(super) fn spend(
        &self,
        hanging_px: &[f64],
        budget: WoodBudget,
        least_px_a_triangle: f64,
        mut take: impl FnMut(Offer, Option<usize>),
    ) {
        let mut growing: Vec<Vec<usize>> = vec![Vec::new(); self.pieces.len()];
        for (index, piece) in self.pieces.iter().enumerate() {
            if let Some(support) = piece.support {
                growing[support].push(index);
            }
        }
        let mut spending = Spending {
            wood: self,
            growing,
            chosen: vec![None; self.pieces.len()],
            hanging_px: hanging_px.to_vec(),
            left: budget.triangles,
        };
        let mut is_queued = vec![false; self.pieces.len()];
        let mut queue = BinaryHeap::new();
        spending.stand(budget, &mut take);
        for (piece, is_queued) in is_queued.iter_mut().enumerate() {
            if let Some(offer) = spending.offer(piece) {
                *is_queued = true;
                queue.push(offer);
            }
        }
        while let Some(known) = queue.pop() {
            let piece = known.piece;
            is_queued[piece] = false;
            let Some(now) = spending.offer(piece) else {
                continue;
            };
            if queue.peek().is_some_and(|next| *next > now) {
                is_queued[piece] = true;
                queue.push(now);
                continue;
            }
            if now.px_a_triangle < least_px_a_triangle {
                break;
            }
            take(now, spending.take(now));
            let changed = std::iter::once(&piece).chain(&spending.growing[piece]);
            for &piece in changed {
                if !is_queued[piece]
                    && let Some(offer) = spending.offer(piece)
                {
                    is_queued[piece] = true;
                    queue.push(offer);
                }
            }
        }
    }
}

impl Spending<'_> {
    /// Takes what carries the crown, what carries most first, each at the coarsest level that stands, or in
    /// the finest of its last forms that fits.
    fn stand(&mut self, budget: WoodBudget, take: &mut impl FnMut(Offer, Option<usize>)) {
        let mut spent = 0;
        let wood = self.wood;
        for carrier in &wood.carriers {
            let piece = &wood.pieces[carrier.piece];
            let is_off = |support: usize| self.chosen[support].is_none();
            if wood.is_gone(carrier.piece) || piece.support.is_some_and(is_off) {
                continue;
            }
            let last = (1..=piece.levels.len()).filter(|level| piece.is_last_form(*level));
            let mut forms = std::iter::once(carrier.level).chain(last);
            let most_standing = match spent {
                0 => self.left,
                spent => self.left.min(budget.standing.saturating_sub(spent)),
            };
            let fits = |level: &usize| {
                let most = match spent == 0 && piece.is_last_form(*level) {
                    true => budget.first,
                    false => most_standing,
                };
                piece.count(Some(*level)) <= most
            };
            if let Some(level) = forms.find(fits) {
                let offer = Offer {
                    px_a_triangle: f64::INFINITY,
                    piece: carrier.piece,
                    level,
                };
                let count = piece.count(Some(level));
                self.left = self.left.max(count);
                take(offer, self.take(offer));
                spent += count;
            }
        }
    }

    /// Takes an offer; the level that its piece had before.
    fn take(&mut self, offer: Offer) -> Option<usize> {
        let piece = &self.wood.pieces[offer.piece];
        let before = self.chosen[offer.piece].replace(offer.level);
        self.left -= piece.count(Some(offer.level)) - piece.count(before);
        for borne in &piece.bears {
            if borne.coarsest as usize >= offer.level
                && let Some(px) = self.hanging_px.get_mut(borne.leaf as usize)
            {
                *px = 0.0;
            }
        }
        before
    }

    /// The best that can be done for a piece, if what it grows on is there and the triangles suffice.
    fn offer(&self, piece: usize) -> Option<Offer> {
        let support = self.wood.pieces[piece].support;
        if support.is_some_and(|support| self.chosen[support].is_none()) {
            return None;
        }
        let (level, own) = self.best(piece)?;
        let worth = match self.chosen[piece] {
            None => self.with_what_grows_on_it(piece, own, MOST_DEEP),
            Some(_) => own,
        };
        Some(Offer {
            px_a_triangle: worth.px_a_triangle(),
            piece,
            level,
        })
    }

    /// The finer level of a piece that saves the most pixels a triangle, where what it grows on is
    /// fine enough or not yet there.
    fn best(&self, index: usize) -> Option<(usize, Worth)> {
        if self.wood.is_gone(index) {
            return None;
        }
        let piece = &self.wood.pieces[index];
        let now = self.chosen[index];
        let finer = 0..now.unwrap_or(piece.levels.len() + 1);
        let lost_now = now.map_or(piece.seen_px, |level| piece.loss(level));
        // By the coarsest level that bears them, pixels of leaves that nothing bears.
        let mut hanging_px = vec![0.0; finer.len()];
        for borne in &piece.bears {
            let coarsest = borne.coarsest as usize;
            let px = self.hanging_px.get(borne.leaf as usize);
            if let (Some(sum), Some(px)) = (hanging_px.get_mut(coarsest), px) {
                *sum += px;
            }
        }
        let support = piece.support.and_then(|support| self.chosen[support]);
        let fits = |level: usize| {
            let coarsest = match piece.support {
                Some(_) => piece.needs[level],
                None => return true,
            };
            coarsest.is_some_and(|coarsest| support.is_none_or(|now| now <= coarsest as usize))
        };
        let reaches = |level: usize| level == 0 || piece.levels[level - 1].reaches;
        let mut borne_px = 0.0;
        let mut best: Option<(usize, Worth)> = None;
        for level in finer.rev() {
            borne_px += hanging_px[level];
            let worth = Worth {
                px: lost_now - piece.loss(level) + borne_px,
                // A last form may have more than a level that does not stand.
                triangles: piece.count(Some(level)).saturating_sub(piece.count(now)),
            };
            let is_better =
                |(_, known): &(usize, Worth)| worth.px_a_triangle() > known.px_a_triangle();
            let is_more = (1..=self.left).contains(&worth.triangles);
            let can_be = is_more
                && !piece.is_last_form(level)
                && fits(level)
                && (!piece.carries || reaches(level));
            if can_be && best.as_ref().is_none_or(is_better) {
                best = Some((level, worth));
            }
        }
        best
    }

    /// What a piece is worth a triangle with the best of what grows on it: these come only after it.
    fn with_what_grows_on_it(&self, piece: usize, own: Worth, deep: usize) -> Worth {
        let Some(deeper) = deep.checked_sub(1) else {
            return own;
        };
        let growing = self.growing[piece].iter();
        let mut others: Vec<Worth> = growing
            .filter_map(|&child| {
                let (_, own) = self.best(child)?;
                Some(self.with_what_grows_on_it(child, own, deeper))
            })
            .collect();
        others.sort_by(|a, b| b.px_a_triangle().total_cmp(&a.px_a_triangle()));
        others.into_iter().fold(own, |sum, other| {
            match other.px_a_triangle() > sum.px_a_triangle() {
                true => sum.and(other),
                false => sum,
            }
        })
    }
}
