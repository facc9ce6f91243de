//! All levels of the wood as one removal order of its pieces.

use secateur_model::{LeafId, RemovalOrder, Step};

use super::{Wood, new_piece};

impl Wood {
    /// The order in which pieces get coarser and go when the budget shrinks triangle by triangle: the
    /// reverse of how a growing budget is spent. Each step takes one piece away or puts a coarser one
    /// in its place. Pieces are named as leaves of the foliage that the wood was made from, in their
    /// order. After all steps nothing is left.
    pub fn order(&self) -> RemovalOrder {
        let mut spent = Vec::new();
        self.spend(&[], (self.triangle_count(), 0.0), |offer, before| {
            spent.push((offer.piece, before));
        });
        let pieces = self.pieces.len();
        let mut order = RemovalOrder::new(pieces as u32);
        let mut names: Vec<LeafId> = (0..pieces).map(LeafId::from_index).collect();
        let mut made_count = 0;
        for (piece, coarser) in spent.into_iter().rev() {
            let made = coarser.map(|level| {
                let triangles = &self.pieces[piece].levels[level - 1].triangles;
                new_piece(LeafId::from_index(piece), triangles)
            });
            order.push_step(Step {
                removed: &[names[piece]],
                grown: &[],
                made: made.as_slice(),
                survivors_area_scale: 1.0,
            });
            if made.is_some() {
                names[piece] = LeafId::from_index(pieces + made_count);
                made_count += 1;
            }
        }
        order
    }
}
