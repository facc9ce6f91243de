//! Wood with fewer triangles: pieces get coarser, and pieces go.
//!
//! A piece of wood is a connected part, mostly the tube of a branch; where it has forks, what is between
//! them is a part of its own, and treated as a piece. Each has a row of levels: as it is, what collapses of
//! edges leave of half its triangles, of a quarter and so on, tubes of few sides and rings, flat strips,
//! and nothing. What a level loses is the part of the piece's visible pixels that it shows no longer or
//! elsewhere. Triangles of a budget go one piece and level at a time
//! to where they save the most pixels each, those of leaves counted in that would hang in the air.
//! Thin parts of a level are then widened to the area that they had.
//! A piece is left only if the one that it grows on is, at a level that still meets it.

mod bearing;
mod charts;
mod crown;
mod distance;
mod evenly;
mod flattened;
mod forks;
mod fullness;
mod gaps;
mod hanging;
mod holds;
mod last_forms;
mod levels;
mod loss;
mod nearest;
mod order;
mod parts;
mod rings;
mod spend;
mod standing;
mod support;
mod thickness;
mod welded;
mod widening;

use std::sync::Arc;

use rustc_hash::FxHashMap;
use secateur_model::{Foliage, LeafId, Lod, NewCorner, NewLeaf};
use secateur_raster::ViewSet;

use bearing::{Bearing, Borne, Needs, needs};
pub(crate) use crown::crown_and_rest;
pub(crate) use flattened::sides_apart;
pub(crate) use gaps::SortedWood;
pub use gaps::{hanging_on, leaf_gaps, leaf_wood_gaps, wood_gaps};
pub use holds::{FoundHolds, found_holds};
use levels::{Level, collapsed, collapsed_to, joints, last_levels, levels};
use loss::Judges;
pub use nearest::{Nearest, nearest};
pub use parts::Parts;
pub use spend::WoodBudget;
use standing::{Carrier, carriers};
pub use support::supports;
use widening::Widening;

/// A plant's wood, ready for any number of budgets.
#[derive(Clone, Debug)]
pub struct Wood {
    parts: Parts,
    /// By part.
    pieces: Vec<Piece>,
    widening: Widening,
    /// Whether thin wood is widened for thin wood that is gone.
    makes_up: bool,
    /// What carries the crown to the ground, what carries most first.
    carriers: Vec<Carrier>,
    leaf_gap: f64,
    /// Parts that no level has any more; empty where all may be left.
    gone: Arc<[bool]>,
}

/// The level of each part that is left: 0 for the part as it is, else one more than an index of its levels.
#[derive(Clone, Debug)]
pub struct Chosen(Vec<Option<usize>>);

impl Chosen {
    /// By part whether nothing of it is left.
    pub fn gone(&self) -> Vec<bool> {
        self.0.iter().map(Option::is_none).collect()
    }
}

#[derive(Clone, Debug)]
struct Piece {
    /// The piece that it grows on.
    support: Option<usize>,
    /// By its own level, how coarse that one may be; nothing by levels that meet none of its.
    needs: Needs,
    /// Leaves that hang on it.
    bears: Vec<Borne>,
    /// Pixels that the views show of it.
    seen_px: f64,
    triangles: usize,
    /// Whether it carries a part of the crown to the ground: then no level may end half way.
    carries: bool,
    /// Ever coarser, each losing more than the one before, but for the coarsest that stands.
    levels: Vec<Level>,
}

impl Wood {
    /// Makes the levels of all parts: what collapses by their geometry leave, judged by what the views
    /// show of it. `seen_px`: how many pixels of all views each part owns; `resolution`: pixels along a
    /// side of a view.
    ///
    /// # Panics
    /// If there is not one number for each part; or if the resolution is out of range.
    pub fn by_geometry(parts: Parts, seen_px: &[f64], views: &ViewSet, resolution: u32) -> Self {
        let is_joint = joints(&parts);
        let collapsed = collapsed(&parts, &is_joint);
        let judges = Judges { views, resolution };
        let levels = levels(&parts, collapsed, &is_joint, judges);
        Self::of_levels(parts, seen_px, levels)
    }

    fn of_levels(parts: Parts, seen_px: &[f64], levels: Vec<Vec<Level>>) -> Self {
        let widening = Widening::of(&parts, &joints(&parts));
        let wood = parts.foliage();
        assert_eq!(seen_px.len(), wood.leaves().len());
        let all: Vec<&[Level]> = levels.iter().map(Vec::as_slice).collect();
        let mut needs = needs(&parts, &all);
        let pieces = levels.into_iter().zip(seen_px).enumerate();
        let piece = |(index, (levels, &seen_px)): (usize, (Vec<Level>, &f64))| {
            let (support, needs) = needs[index].take().unzip();
            Piece {
                support,
                needs: needs.unwrap_or_default(),
                bears: Vec::new(),
                seen_px,
                triangles: wood.triangles_of(LeafId::from_index(index)).len(),
                carries: false,
                levels,
            }
        };
        let pieces = pieces.map(piece).collect();
        Self {
            parts,
            pieces,
            widening,
            makes_up: false,
            carriers: Vec::new(),
            leaf_gap: f64::INFINITY,
            gone: Arc::new([]),
        }
    }

    /// The wood with these leaves on it, so that it may be chosen to bear some of them, so that what
    /// carries many of them to the ground stays, and so that thin wood makes up for thin wood that is gone unless some
    /// leaf is cut out: then alpha cutoffs do. `seen_px`: how many pixels the views show of each leaf.
    ///
    /// # Panics
    /// If there is not one number for each leaf.
    pub fn with_leaves(mut self, leaves: &Foliage, seen_px: &[f64]) -> Self {
        let levels: Vec<&[Level]> = self.pieces.iter().map(|p| &p.levels[..]).collect();
        let Bearing {
            of_pieces,
            nearest,
            largest_gap,
        } = bearing::bearing(self.parts.foliage(), &levels, leaves);
        for (piece, bears) in self.pieces.iter_mut().zip(of_pieces) {
            piece.bears = bears;
        }
        self.leaf_gap = largest_gap;
        let is_cut_out = leaves.leaves().iter().any(|leaf| leaf.cutout().is_some());
        self.makes_up = !is_cut_out;
        self.widening.is_bare = leaves.leaves().is_empty();
        self.carriers = carriers(&self.parts, &self.pieces, &nearest, seen_px);
        for carrier in &self.carriers {
            let piece = &mut self.pieces[carrier.piece];
            piece.carries = true;
            let part = LeafId::from_index(carrier.piece);
            piece.levels.extend(last_levels(self.parts.foliage(), part));
        }
        self
    }

    /// The wood without these parts at any level; `gone` says so by part, and is empty where none is.
    pub fn without(mut self, gone: Arc<[bool]>) -> Self {
        self.gone = gone;
        self
    }

    fn is_gone(&self, part: usize) -> bool {
        self.gone.get(part).is_some_and(|gone| *gone)
    }

    /// The largest distance of a leaf from the wood, in world units; infinite where no leaves are known.
    pub fn leaf_gap(&self) -> f64 {
        self.leaf_gap
    }

    /// Triangles of all pieces as they are.
    pub fn triangle_count(&self) -> usize {
        let pieces = (0..self.parts.piece_count()).map(LeafId::from_index);
        pieces
            .map(|piece| self.parts.triangles_of_piece(piece))
            .sum()
    }

    /// The wood with at most this many triangles, and the pixels that it loses.
    pub fn within(&self, triangles_at_most: usize) -> (Lod, f64) {
        self.bearing(&[], WoodBudget::all(triangles_at_most))
    }

    /// [`Self::within`], where leaves that it bears save pixels too. `hanging_px`: what each leaf of
    /// [`Self::with_leaves`] loses if nothing bears it; those at the end may be left out.
    pub fn bearing(&self, hanging_px: &[f64], budget: WoodBudget) -> (Lod, f64) {
        let chosen = self.chosen(hanging_px, budget);
        let pieces = self.pieces.iter().zip(&chosen.0);
        let lost = pieces.map(|(piece, level)| piece.lost_px(*level)).sum();
        (self.lod(&chosen), lost)
    }

    /// The levels of [`Self::bearing`].
    pub fn chosen(&self, hanging_px: &[f64], budget: WoodBudget) -> Chosen {
        if budget.triangles >= self.triangle_count() && !self.gone.contains(&true) {
            return Chosen(vec![Some(0); self.pieces.len()]);
        }
        Chosen(self.choose(hanging_px, budget, 0.0))
    }

    /// What is left of each piece.
    pub fn lod(&self, chosen: &Chosen) -> Lod {
        self.lod_with(&chosen.0, &FxHashMap::default())
    }

    /// How many of the pieces that carry the crown to the ground are gone, and how many there are.
    pub fn carriers_gone(&self, chosen: &Chosen) -> [usize; 2] {
        let is_gone = |carrier: &&Carrier| chosen.0[carrier.piece].is_none();
        let gone = self.carriers.iter().filter(is_gone).count();
        [gone, self.carriers.len()]
    }

    /// [`Self::lod`] with up to `more` triangles more, where pieces have levels in between: those that lose the most
    /// pixels get finer first.
    pub fn refined(&self, chosen: &Chosen, more: usize) -> Lod {
        let chosen = &chosen.0;
        let lost_px = |part: &usize| self.pieces[*part].lost_px(chosen[*part]);
        let can_grow = |part: &usize| {
            let support = self.pieces[*part].support;
            chosen[*part] != Some(0)
                && !self.is_gone(*part)
                && support.is_none_or(|support| chosen[support].is_some())
        };
        let mut parts: Vec<usize> = (0..chosen.len()).filter(can_grow).collect();
        parts.sort_by(|a, b| lost_px(b).total_cmp(&lost_px(a)).then(a.cmp(b)));
        let is_joint = joints(&self.parts);
        let mut left = more;
        let mut finer: FxHashMap<usize, Vec<[u32; 3]>> = FxHashMap::default();
        for part in parts {
            let now = self.pieces[part].count(chosen[part]);
            let at_most = (now + left).min(self.pieces[part].triangles.saturating_sub(1));
            if at_most <= now {
                continue;
            }
            let (wood, piece) = (self.parts.foliage(), LeafId::from_index(part));
            if let Some(level) = collapsed_to(wood, piece, &is_joint, now + 1..=at_most) {
                left -= level.len() - now;
                finer.insert(part, level);
            }
        }
        self.lod_with(chosen, &finer)
    }

    /// How many triangles carry the crown to the ground or save at least `px_a_triangle` pixels each, the
    /// worthiest first. `hanging_px` as for [`Self::bearing`].
    pub fn worth(&self, hanging_px: &[f64], px_a_triangle: f64, budget: WoodBudget) -> usize {
        let chosen = self.choose(hanging_px, budget, px_a_triangle);
        let pieces = self.pieces.iter().zip(chosen);
        pieces.map(|(piece, level)| piece.count(level)).sum()
    }

    /// The level of each piece that is left: 0 for the piece as it is, else one more than an index
    /// of its levels. Triangles that save fewer pixels each than asked for are not spent, but on what
    /// carries the crown.
    fn choose(
        &self,
        hanging_px: &[f64],
        budget: WoodBudget,
        least_px_a_triangle: f64,
    ) -> Vec<Option<usize>> {
        let mut chosen: Vec<Option<usize>> = vec![None; self.pieces.len()];
        self.spend(hanging_px, budget, least_px_a_triangle, |offer, _| {
            chosen[offer.piece] = Some(offer.level);
        });
        chosen
    }

    /// What is left of each piece: all of it where all its parts are as they are. Thin parts are as wide as they were.
    /// `finer`: by part, a level to be taken instead.
    fn lod_with(&self, chosen: &[Option<usize>], finer: &FxHashMap<usize, Vec<[u32; 3]>>) -> Lod {
        let seen_px = |part: usize| self.pieces[part].seen_px;
        let for_others = match self.makes_up {
            true => self
                .widening
                .for_others(seen_px, |part| chosen[part].is_some()),
            false => 1.0,
        };
        let widened = |part: usize, level: &[[u32; 3]]| {
            self.widening.made(&self.parts, part, level, for_others)
        };
        let mut lod = Lod::original(self.parts.piece_count());
        for piece in (0..self.parts.piece_count()).map(LeafId::from_index) {
            let parts = self.parts.of_piece(piece);
            if parts.clone().all(|part| chosen[part] == Some(0)) {
                continue;
            }
            lod.remove(piece);
            let is_left = |part: usize| chosen[part].is_some() || finer.contains_key(&part);
            if parts.clone().any(is_left) {
                lod.make(self.made(piece, chosen, finer, widened));
            }
        }
        lod
    }

    /// What is left of a piece of which a part is left, as a leaf of the wood. `made` is what triangles of a
    /// part become.
    fn made(
        &self,
        piece: LeafId,
        chosen: &[Option<usize>],
        finer: &FxHashMap<usize, Vec<[u32; 3]>>,
        made: impl Fn(usize, &[[u32; 3]]) -> Vec<[NewCorner; 3]>,
    ) -> NewLeaf {
        let mut triangles = Vec::new();
        for part in self.parts.of_piece(piece) {
            if let Some(level) = finer.get(&part) {
                triangles.extend(made(part, level));
                continue;
            }
            match chosen[part] {
                None => {}
                Some(0) => triangles.extend(self.parts.whole(part)),
                Some(level) => {
                    let level = &self.pieces[part].levels[level - 1].triangles;
                    triangles.extend(made(part, level));
                }
            }
        }
        NewLeaf {
            donor: piece,
            triangles,
        }
    }
}

impl Piece {
    /// Triangles at a level; 0 is the piece as it is.
    fn count(&self, level: Option<usize>) -> usize {
        match level {
            None => 0,
            Some(0) => self.triangles,
            Some(level) => self.levels[level - 1].triangles.len(),
        }
    }

    /// Whether a level is only for what carries the crown, where nothing else fits.
    fn is_last_form(&self, level: usize) -> bool {
        level > 0 && self.levels[level - 1].is_last_form
    }

    /// Pixels lost at a level, all where nothing is left.
    fn lost_px(&self, level: Option<usize>) -> f64 {
        level.map_or(self.seen_px, |level| self.loss(level))
    }

    /// Pixels lost at a level.
    fn loss(&self, level: usize) -> f64 {
        match level {
            0 => 0.0,
            level => self.seen_px * self.levels[level - 1].loss,
        }
    }
}

#[cfg(test)]
mod tests;
