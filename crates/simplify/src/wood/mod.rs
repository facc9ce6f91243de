//! Wood with fewer triangles: pieces get coarser, and pieces go.
//!
//! A piece of wood is a connected part, mostly the tube of a branch. Each has a row of levels:
//! as it is, what collapses of edges leave of half its triangles, of a quarter and so on, and
//! nothing. What a level loses is the part of the piece's visible pixels that it shows no longer
//! or elsewhere: its distance from the surface that was, over the piece's thickness, times those
//! pixels. Triangles of a budget go one piece and level at a time to where they save the most
//! pixels each. A piece is left only if the one that it grows on is.

mod gaps;
mod levels;
mod nearest;
mod order;
mod support;
mod thickness;
mod vmi;

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use rayon::prelude::*;
use secateur_model::{CornerRef, Foliage, LeafId, Lod, NewCorner, NewLeaf, Place};
use secateur_raster::{Rasteriser, ViewSet};

use crate::Error;
pub use gaps::{leaf_gaps, wood_gaps};
use levels::{Level, joints, levels};
pub use support::supports;

/// A plant's wood, ready for any number of budgets.
#[derive(Clone, Debug)]
pub struct Wood {
    pieces: Vec<Piece>,
}

#[derive(Clone, Debug)]
struct Piece {
    /// The piece that it grows on.
    support: Option<usize>,
    /// Pixels that the views show of it.
    seen_px: f64,
    triangles: usize,
    /// Ever coarser, each losing more a triangle saved than the one before.
    levels: Vec<Level>,
}

/// The next thing that triangles can be spent on: a piece, at a level.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Offer {
    px_a_triangle: f64,
    piece: usize,
    /// 0 for the piece as it is, else one more than an index of its levels.
    level: usize,
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

impl Wood {
    /// Makes the levels of all pieces by their geometry. `seen_px`: how many pixels of all views each
    /// piece owns.
    ///
    /// # Panics
    /// If there is not one number for each piece.
    pub fn new(wood: &Foliage, seen_px: &[f64]) -> Self {
        let pieces = (0..wood.leaves().len()).into_par_iter();
        let is_joint = joints(wood);
        let levels = pieces.map(|index| levels(wood, LeafId::from_index(index), &is_joint));
        Self::of_levels(wood, seen_px, levels.collect())
    }

    /// Makes the levels of all pieces by half-edge collapses that change the mutual information of
    /// the views least, each triangle an item of its own.
    ///
    /// Takes time in proportion to the triangles, times the views and the pixels that a triangle has
    /// in them.
    ///
    /// # Errors
    /// [`Error::Gpu`] if the rasteriser fails.
    ///
    /// # Panics
    /// As [`Self::new`]; or if the resolution is out of range.
    pub fn by_information(
        wood: &Foliage,
        seen_px: &[f64],
        views: &ViewSet,
        resolution: u32,
        rasteriser: &dyn Rasteriser,
    ) -> Result<Self, Error> {
        let levels = vmi::levels(wood, views, resolution, rasteriser)?;
        Ok(Self::of_levels(wood, seen_px, levels))
    }

    fn of_levels(wood: &Foliage, seen_px: &[f64], levels: Vec<Vec<Level>>) -> Self {
        assert_eq!(seen_px.len(), wood.leaves().len());
        let supports = supports(wood);
        let pieces = levels.into_iter().zip(seen_px).enumerate();
        let piece = |(index, (levels, &seen_px)): (usize, (Vec<Level>, &f64))| Piece {
            support: supports[index],
            seen_px,
            triangles: wood.triangles_of(LeafId::from_index(index)).len(),
            levels,
        };
        Self {
            pieces: pieces.map(piece).collect(),
        }
    }

    /// Triangles of all pieces as they are.
    pub fn triangle_count(&self) -> usize {
        self.pieces.iter().map(|piece| piece.triangles).sum()
    }

    /// The wood with at most this many triangles, and the pixels that it loses.
    pub fn within(&self, triangles_at_most: usize) -> (Lod, f64) {
        if triangles_at_most >= self.triangle_count() {
            return (Lod::original(self.pieces.len()), 0.0);
        }
        let chosen = self.choose(triangles_at_most, 0.0);
        let lost = self
            .pieces
            .iter()
            .zip(&chosen)
            .map(|(piece, level)| match level {
                None => piece.seen_px,
                Some(level) => piece.loss(*level),
            });
        (self.lod(&chosen), lost.sum())
    }

    /// How many triangles save at least `px_a_triangle` pixels each, the worthiest first; at most
    /// `triangles_at_most`.
    pub fn worth(&self, px_a_triangle: f64, triangles_at_most: usize) -> usize {
        let chosen = self.choose(triangles_at_most, px_a_triangle);
        let pieces = self.pieces.iter().zip(chosen);
        pieces.map(|(piece, level)| piece.count(level)).sum()
    }

    /// The level of each piece that is left: 0 for the piece as it is, else one more than an index
    /// of its levels. Triangles that save fewer pixels each than asked for are not spent.
    fn choose(&self, triangles_at_most: usize, least_px_a_triangle: f64) -> Vec<Option<usize>> {
        let mut chosen: Vec<Option<usize>> = vec![None; self.pieces.len()];
        self.spend(triangles_at_most, least_px_a_triangle, |offer, _| {
            chosen[offer.piece] = Some(offer.level);
        });
        chosen
    }

    /// Takes offers, the best first, and says of each which level its piece had before.
    fn spend(
        &self,
        triangles_at_most: usize,
        least_px_a_triangle: f64,
        mut take: impl FnMut(Offer, Option<usize>),
    ) {
        let mut children: Vec<Vec<usize>> = vec![Vec::new(); self.pieces.len()];
        let mut offers = BinaryHeap::new();
        for (index, piece) in self.pieces.iter().enumerate() {
            match piece.support {
                Some(support) => children[support].push(index),
                None => offers.extend(piece.offer(index, None)),
            }
        }
        let mut chosen: Vec<Option<usize>> = vec![None; self.pieces.len()];
        let mut left = triangles_at_most;
        while let Some(offer) = offers.pop() {
            if offer.px_a_triangle < least_px_a_triangle {
                break;
            }
            let piece = &self.pieces[offer.piece];
            let before = chosen[offer.piece];
            let more = piece.count(Some(offer.level)) - piece.count(before);
            if more > left {
                continue;
            }
            left -= more;
            chosen[offer.piece] = Some(offer.level);
            take(offer, before);
            offers.extend(piece.offer(offer.piece, Some(offer.level)));
            if before.is_none() {
                let grows_here = &children[offer.piece];
                offers.extend(
                    grows_here
                        .iter()
                        .filter_map(|&c| self.pieces[c].offer(c, None)),
                );
            }
        }
    }

    fn lod(&self, chosen: &[Option<usize>]) -> Lod {
        let mut lod = Lod::original(self.pieces.len());
        for (index, (piece, level)) in self.pieces.iter().zip(chosen).enumerate() {
            let name = LeafId::from_index(index);
            let coarser = match level {
                Some(level) if *level == 0 => continue,
                Some(level) => Some(&piece.levels[*level - 1]),
                None => None,
            };
            lod.remove(name);
            if let Some(coarser) = coarser {
                lod.make(new_piece(name, &coarser.triangles));
            }
        }
        lod
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

    /// Pixels lost at a level.
    fn loss(&self, level: usize) -> f64 {
        match level {
            0 => 0.0,
            level => self.seen_px * self.levels[level - 1].loss,
        }
    }

    /// The finer level that saves the most pixels a triangle.
    fn offer(&self, piece: usize, now: Option<usize>) -> Option<Offer> {
        let finer = 0..now.unwrap_or(self.levels.len() + 1);
        let lost_now = now.map_or(self.seen_px, |level| self.loss(level));
        let offer = |level| {
            let more = self.count(Some(level)) - self.count(now);
            Offer {
                px_a_triangle: (lost_now - self.loss(level)) / more as f64,
                piece,
                level,
            }
        };
        finer.map(offer).max()
    }
}

fn new_piece(piece: LeafId, triangles: &[[u32; 3]]) -> NewLeaf {
    let at = |corner| NewCorner {
        place: Place::Of(CornerRef {
            leaf: piece,
            corner,
        }),
        like: corner,
    };
    NewLeaf {
        donor: piece,
        triangles: triangles.iter().map(|t| t.map(at)).collect(),
    }
}

#[cfg(test)]
mod tests;
