//! Plants without leaves that have a crown all the same: its solid pieces are simplified as leaves, what bears them as
//! wood.
//!
//! Pieces of wood lose the pixels that they no longer show. By that a crown of a ball outweighs its trunk, which goes
//! first. As a leaf the ball gets coarser, and the trunk stays below it.

use secateur_model::{Foliage, LeafId, Lod};
use secateur_raster::OpenEngine;

use super::{Budget, WholeLevel, WholePlant};
use crate::stage::Observer;
use crate::wood::crown_and_rest;
use crate::{Error, Options, Shared};

/// A plant's crown and the rest of it.
#[derive(Clone, Debug)]
pub(super) struct Crowned {
    plant: WholePlant<'static>,
    /// The pieces of the crown, and the others.
    names: [Vec<LeafId>; 2],
    piece_count: usize,
}

impl Crowned {
    /// Nothing where a plant of these pieces has no crown.
    pub(super) fn of(
        pieces: &Foliage,
        options: &Options,
        engine: &OpenEngine,
    ) -> Result<Option<Self>, Error> {
        let Some(names) = crown_and_rest(pieces) else {
            return Ok(None);
        };
        let [crown, rest] = names.each_ref().map(|names| pieces.only(names));
        let items = crown.followed_by(&rest)?;
        Ok(Some(Self {
            plant: WholePlant::within(&items, crown, rest, options, engine)?,
            names,
            piece_count: pieces.leaves().len(),
        }))
    }

    /// A level of all pieces, and the one that it was joined of.
    pub(super) fn level(
        &self,
        budget: Budget,
        options: &Options,
        engine: &OpenEngine,
        shared: Option<&mut Shared>,
        observer: &mut Observer<'_>,
    ) -> Result<(Lod, WholeLevel), Error> {
        let level = self
            .plant
            .level(budget, options, engine, shared, observer)?;
        let [crown, rest] = &self.names;
        let parts: [(&Lod, &[LeafId]); 2] = [(&level.leaves.lod, crown), (&level.wood, rest)];
        Ok((Lod::of_parts(self.piece_count, &parts), level))
    }
}
