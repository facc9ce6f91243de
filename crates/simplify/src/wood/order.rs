//! All levels of the wood as one removal order of its pieces.

use rustc_hash::FxHashMap;
use secateur_model::{LeafId, NewLeaf, RemovalOrder, Step};

use super::{Wood, WoodBudget};

/// A piece of several parts is made anew once this share of its triangles is gone since it was made last, so that
/// all steps together hold a few times as many triangles as the piece.
const LEAST_GONE: f64 = 0.125;

impl Wood {
    /// The order in which pieces get coarser and go when the budget shrinks triangle by triangle: the
    /// reverse of how a growing budget is spent. Each step takes one piece away or puts a coarser one
    /// in its place; of pieces that have forks a step takes several levels of their parts together.
    /// Pieces are named as leaves of the foliage that the wood was made from, in their order. After all
    /// steps nothing is left.
    pub fn order(&self) -> RemovalOrder {
        let mut spent = Vec::new();
        self.spend(&[], WoodBudget::all(usize::MAX), 0.0, |offer, before| {
            spent.push((offer.piece, before));
        });
        let pieces = (0..self.parts.piece_count()).map(LeafId::from_index);
        let mut order = RemovalOrder::new(pieces.len() as u32);
        // By part the level that it has; nothing where it is gone.
        let mut levels: Vec<Option<usize>> = vec![Some(0); self.pieces.len()];
        // By piece its name, and how many triangles it has.
        let mut shown: Vec<(LeafId, usize)> = pieces
            .map(|piece| (piece, self.parts.triangles_of_piece(piece)))
            .collect();
        for (part, coarser) in spent.into_iter().rev() {
            levels[part] = coarser;
            let piece = self.parts.piece_of(part);
            let of_piece = self.parts.of_piece(piece);
            let counts = of_piece
                .clone()
                .map(|part| self.pieces[part].count(levels[part]));
            let left: usize = counts.sum();
            let (name, before) = shown[piece.index()];
            let most = (1.0 - LEAST_GONE) * before as f64;
            if of_piece.len() > 1 && left > 0 && left as f64 > most {
                continue;
            }
            shown[piece.index()] = (LeafId::from_index(order.name_count()), left);
            let made: Option<NewLeaf> = (left > 0).then(|| {
                let made = |part: usize, level: &[[u32; 3]]| self.parts.made(part, level);
                self.made(piece, &levels, &FxHashMap::default(), made)
            });
            order.push_step(Step {
                removed: &[name],
                grown: &[],
                made: made.as_slice(),
                survivors_area_scale: 1.0,
            });
        }
        order
    }
}
