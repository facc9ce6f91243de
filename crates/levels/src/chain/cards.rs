//! Cards that take the place of a chain's coarsest meshes.

use std::ops::Range;

use secateur_simplify::Observer;

use super::card_cutoffs::Covering;
use super::cost::LevelParts;
use super::error::ChainError;
use super::height_search::MOST_OF_BEFORE;
use super::impostors::PlacedImpostor;
use super::level::ImpostorLevel;
use super::level_surfaces::{LevelSurfaces, retextured};
use super::look::LevelPicture;
use super::maker::Maker;
use super::options::LEAST_BOUND_BYTES;
use super::placed::Placed;
use super::stage_clock::ChainStage;
use super::texture_bytes::texture_bytes;
use super::textures::{Client, end_of};
use crate::impostor::fewest_cards::{self, Found, Search};
use crate::impostor::{Impostor, poll};

/// Where a plant is no higher than this, in pixels, nobody sees of what it is made: cards may stand for it in any chain.
pub(super) const FAR_PX: f64 = 100.0;

/// The search for cards of a chain, and what their pictures may still take.
pub(super) struct CardSearch<'a> {
    cards: Search<'a>,
    /// On the GPU, in bytes.
    pub(super) bytes_left: u64,
}

impl<'a> CardSearch<'a> {
    pub(super) fn new(maker: &'a Maker<'_>) -> Self {
        let bytes_left = maker.impostor_bytes();
        Self {
            cards: Search::new(&maker.look.original.surfaces, bytes_left),
            bytes_left,
        }
    }
}

impl Maker<'_> {
    /// Bytes that the textures of all impostors may take on the GPU.
    pub(super) fn impostor_bytes(&self) -> u64 {
        let own = || {
            let document = self.tree.items().document();
            texture_bytes(document, &self.look.original.materials, &[])
        };
        let wanted = self.options.impostor_texture_bytes;
        wanted.unwrap_or_else(|| own().max(LEAST_BOUND_BYTES))
    }

    /// The cost of a mesh, or of the plant itself where no mesh stands.
    pub(super) fn cost_beside(&self, mesh: Option<&Placed>) -> f64 {
        let level = mesh.map_or(&self.look.original, |mesh| &mesh.made.drawn.level);
        let triangles = self.triangles_beside(mesh.map(|mesh| &mesh.made));
        let textures = self.texture_bytes_beside(mesh);
        let parts = LevelParts::before_writing(triangles, level.draws(), textures);
        self.options.cost.cost(parts)
    }

    /// Bytes of the textures of a mesh, or of the plant itself, on the GPU.
    fn texture_bytes_beside(&self, mesh: Option<&Placed>) -> u64 {
        let (level, own) = match mesh {
            Some(mesh) => (&mesh.made.drawn.level, &mesh.chosen.textures[..]),
            None => (&self.look.original, &[][..]),
        };
        texture_bytes(self.tree.items().document(), &level.materials, own)
    }

    /// Whether an impostor has more triangles than a mesh, or the plant itself, and saves no textures: all that it could
    /// save is draws.
    pub(super) fn is_more_than(&self, impostor: &Impostor, mesh: Option<&Placed>) -> bool {
        let triangles = impostor.surface.triangles.len();
        triangles > self.triangles_beside(mesh.map(|mesh| &mesh.made))
            && impostor.texture_bytes() >= self.texture_bytes_beside(mesh)
    }

    /// The cost of an impostor.
    pub(super) fn cost_of_impostor(&self, impostor: &Impostor) -> f64 {
        let triangles = impostor.surface.triangles.len();
        let parts = LevelParts::before_writing(triangles, 1, impostor.texture_bytes());
        self.options.cost.cost(parts)
    }

    /// The most triangles that an impostor of this cost can have: those of one whose pictures cost nothing.
    fn triangles_for(&self, cost: f64) -> f64 {
        let cost_of = |triangles: usize| {
            let parts = LevelParts::before_writing(triangles, 1, 0);
            self.options.cost.cost(parts)
        };
        let [of_none, of_many] = [0, 1 << 20].map(cost_of);
        let of_one = (of_many - of_none) / f64::from(1 << 20);
        match of_one > 0.0 {
            true => ((cost - of_none) / of_one).max(0.0),
            false => f64::INFINITY,
        }
    }

    /// Cards from the first of some of these heights on at which some are within the difference, there and at all that
    /// follow, cost less than a mesh that begins there and a third less than one that goes on, save triangles or textures,
    /// and cost no more than the lightest; and fewer of them from each that follows where that saves a third again. Their
    /// normals have half as many texels a side where these do as well. Where the plant is far, they have no more triangles
    /// than it covers pixels, unless what is drawn there without them has more: cards before, or, if `is_sought` says that
    /// there is no other, a mesh.
    pub(super) fn cards(
        &self,
        (placed, is_sought): (&[Placed], bool),
        (heights, places): (&[f64], Range<usize>),
        before: &[PlacedImpostor],
        search: &mut CardSearch<'_>,
        client: &Client<'_>,
        observer: &mut Observer<'_>,
    ) -> Result<Vec<PlacedImpostor>, ChainError> {
        let mut all = before.to_vec();
        let lightest = self.cost_beside(placed.last());
        for k in places {
            poll(observer)?;
            let height = &heights[k];
            search.cards.bound(search.bytes_left);
            let seen = self.seen(*height);
            if !search.cards.has_room(&seen) {
                continue;
            }
            let beside = drawn_at(placed, *height);
            let begins_here = beside.is_some_and(|mesh| mesh.begins() == *height);
            let most_cost = match all.last() {
                Some(cards) => MOST_OF_BEFORE * self.cost_of_impostor(&cards.level.impostor),
                // They stand in the place of that mesh, and follow the one before.
                None if begins_here => {
                    let nearer = placed.iter().rev().find(|mesh| mesh.begins() > *height);
                    lightest.min(MOST_OF_BEFORE * self.cost_beside(nearer))
                }
                None => lightest.min(MOST_OF_BEFORE * self.cost_beside(beside)),
            };
            let mut most_triangles = self.triangles_for(most_cost);
            if self.texture_bytes_beside(beside) == 0 {
                let of_mesh = self.triangles_beside(beside.map(|mesh| &mesh.made));
                most_triangles = most_triangles.min(of_mesh as f64);
            }
            if *height <= FAR_PX {
                let without = match all.last() {
                    Some(cards) => cards.level.impostor.surface.triangles.len(),
                    None if is_sought => self.triangles_beside(beside.map(|mesh| &mesh.made)),
                    None => 0,
                };
                let covered = self.look.covered_px(*height);
                most_triangles = most_triangles.min(covered.max(without as f64));
            }
            let most = (most_triangles / 2.0) as usize;
            let covering = Covering::new(client, [*height, end_of(*height, None)]);
            let finish = |made| covering.of(made);
            let found = search.cards.fewest(&seen, most, finish, observer)?;
            let Some(found) = found else {
                continue;
            };
            let mut does = |found: &Found| -> Result<bool, ChainError> {
                poll(observer)?;
                Ok(self.hides_switch(placed, &all, &found.impostor, *height)
                    && self.is_within(&found.impostor, &heights[k + 1..], observer)?)
            };
            if !does(&found)? {
                continue;
            }
            let found = match seen.with_half_normals(&found) {
                Some(half) if seen.is_within(&half.impostor) && does(&half)? => half,
                _ => found,
            };
            let costs_more = self.cost_of_impostor(&found.impostor) > most_cost;
            if costs_more || self.is_more_than(&found.impostor, beside) {
                continue;
            }
            let bytes = found.impostor.texture_bytes();
            search.bytes_left = search.bytes_left.saturating_sub(bytes);
            all.push(self.beside_mesh(placed, found, *height, observer)?);
        }
        Ok(all.split_off(before.len()))
    }

    /// [`Self::cards`] from this one of the heights on, and fewer from those that follow; none if none do there.
    pub(super) fn far_cards(
        &self,
        placed: (&[Placed], bool),
        (heights, place): (&[f64], usize),
        search: &mut CardSearch<'_>,
        client: &Client<'_>,
        observer: &mut Observer<'_>,
    ) -> Result<Vec<PlacedImpostor>, ChainError> {
        self.look.clock.time(ChainStage::Impostors, || {
            let first = (heights, place..place + 1);
            let mut all = self.cards(placed, first, &[], search, client, observer)?;
            if !all.is_empty() {
                let others = (heights, place + 1..heights.len());
                all.extend(self.cards(placed, others, &all, search, client, observer)?);
            }
            Ok(all)
        })
    }

    /// Whether an impostor is within the difference at all of these heights.
    fn is_within(
        &self,
        impostor: &Impostor,
        heights: &[f64],
        observer: &mut Observer<'_>,
    ) -> Result<bool, ChainError> {
        for height in heights {
            poll(observer)?;
            if !self.seen(*height).is_within(impostor) {
                return Ok(false);
            }
        }
        Ok(true)
    }

    /// Whether a switch to cards shows no more than it may.
    fn hides_switch(
        &self,
        placed: &[Placed],
        before: &[PlacedImpostor],
        cards: &Impostor,
        height: f64,
    ) -> bool {
        let Some(most) = self.options.max_pop else {
            return true;
        };
        let nearer = placed.iter().rev().find(|mesh| mesh.begins() > height);
        let before = match (before.last(), nearer) {
            (Some(before), _) => LevelPicture::Impostor(before.level.impostor.clone()),
            (None, Some(mesh)) => LevelPicture::Mesh(LevelSurfaces {
                surfaces: retextured(&mesh.made.drawn.level, &mesh.chosen.textures),
                materials: Vec::new(),
            }),
            (None, None) => return true,
        };
        let after = LevelPicture::Impostor(cards.clone());
        self.look.difference_of_switch(&before, &after, height) <= most
    }

    /// Cards from this height on, whatever they look like beside a mesh: as few as are within the difference, or
    /// the largest number that is ever tried where no number is.
    pub(super) fn demanded_cards(
        &self,
        placed: &[Placed],
        height: f64,
        search: &mut CardSearch<'_>,
        client: &Client<'_>,
        observer: &mut Observer<'_>,
    ) -> Result<Option<PlacedImpostor>, ChainError> {
        let covering = Covering::new(client, [height, end_of(height, None)]);
        let finish = |made| covering.of(made);
        let search = &mut search.cards;
        let (seen, most) = (self.seen(height), fewest_cards::most());
        let mut fewest = search.fewest(&seen, most, finish, observer)?;
        if fewest.is_none() {
            // Cards that are asked for stand there whatever their pictures take.
            search.bound(u64::MAX);
            fewest = search.fewest(&seen, most, finish, observer)?;
        }
        let found = match fewest {
            Some(fewest) => Some(fewest),
            None => {
                let texels = seen.texels_up_to(f64::INFINITY);
                search.finished(most, &seen, texels, finish, observer)?
            }
        };
        let Some(found) = found else {
            return Ok(None);
        };
        poll(observer)?;
        let limits = self.look.limits;
        let most_over = found.difference.over(limits).max(1.0);
        let hides = |found: &Found| self.hides_switch(placed, &[], &found.impostor, height);
        let half = seen.with_half_normals(&found);
        let half = half.filter(|half| {
            half.difference.over(limits) <= most_over && (hides(half) || !hides(&found))
        });
        let found = half.unwrap_or(found);
        Ok(Some(self.beside_mesh(placed, found, height, observer)?))
    }

    /// Cards beside the mesh that would be drawn there.
    fn beside_mesh(
        &self,
        placed: &[Placed],
        found: Found,
        height: f64,
        observer: &mut Observer<'_>,
    ) -> Result<PlacedImpostor, ChainError> {
        let mesh = drawn_at(placed, height).map(|mesh| &mesh.made);
        poll(observer)?;
        let triangles = found.impostor.surface.triangles.len();
        let mut same_cost = None;
        if triangles < self.triangles_beside(mesh)
            && let Some(equal) = self.level_if_any(triangles, observer)?
        {
            let of_equal = self.difference_beside_impostor(Some(&equal), height);
            same_cost = Some((equal.triangles() as u64, of_equal));
        }
        let level = ImpostorLevel {
            mesh_triangles: self.triangles_beside(mesh) as u64,
            mesh_difference: self.difference_beside_impostor(mesh, height),
            impostor: found.impostor,
            same_cost,
        };
        Ok(PlacedImpostor {
            level,
            begins_px: height,
            difference: found.difference,
        })
    }
}

/// The mesh that is drawn where the screen shows the plant at this height; none where that is the plant itself.
fn drawn_at(placed: &[Placed], height: f64) -> Option<&Placed> {
    let has_begun = |mesh: &&Placed| mesh.begins() >= height;
    placed.iter().rev().find(has_begun)
}
