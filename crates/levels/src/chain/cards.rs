//! Cards that take the place of a chain's coarsest meshes.

use secateur_simplify::Observer;

use super::card_cutoffs::Covering;
use super::error::ChainError;
use super::impostors::PlacedImpostor;
use super::level::ImpostorLevel;
use super::level_choice::MOST_OF_BEFORE;
use super::level_surfaces::{LevelSurfaces, retextured};
use super::look::LevelPicture;
use super::maker::{Made, Maker};
use super::placed::Placed;
use super::textures::{Client, end_of};
use crate::impostor::fewest_cards::{self, Found, Search};
use crate::impostor::{Impostor, poll};

impl Maker<'_> {
    /// Cards from the first of these heights on at which some are within the difference, there and at all that
    /// follow, save a third of the triangles of the mesh there and have no more than the lightest; and fewer of
    /// them from each that follows where that saves a third again. Their normals have half as many texels a side where
    /// these do as well.
    pub(super) fn cards(
        &self,
        placed: &[Placed],
        heights: &[f64],
        client: &Client<'_>,
        observer: &mut Observer<'_>,
    ) -> Result<Vec<PlacedImpostor>, ChainError> {
        let mut all: Vec<PlacedImpostor> = Vec::new();
        let lightest = self.triangles_beside(placed.last().map(|mesh| &mesh.made)) as f64;
        let mut before: Option<usize> = None;
        let mut search = Search::new(&self.look.original.surfaces);
        // Beside the plant stands a mesh, if there is more than one place.
        let near = usize::from(self.heights().len() > 1);
        for (k, height) in heights.iter().enumerate().skip(near) {
            poll(observer)?;
            if !search.has_room(*height) {
                continue;
            }
            let most_triangles = match before {
                Some(cards) => MOST_OF_BEFORE * cards as f64,
                None => {
                    let there = self.triangles_beside(drawn_at(placed, *height));
                    lightest.min(MOST_OF_BEFORE * there as f64)
                }
            };
            let most = (most_triangles / 2.0) as usize;
            let covering = Covering::new(client, [*height, end_of(*height, None)]);
            let finish = |made| covering.of(made);
            let seen = self.seen(*height);
            let found = search.fewest(&seen, most, finish, observer)?;
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
            before = Some(found.impostor.surface.triangles.len());
            all.push(self.beside_mesh(placed, found, *height, observer)?);
        }
        Ok(all)
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
        client: &Client<'_>,
        observer: &mut Observer<'_>,
    ) -> Result<Option<PlacedImpostor>, ChainError> {
        let covering = Covering::new(client, [height, end_of(height, None)]);
        let finish = |made| covering.of(made);
        let mut search = Search::new(&self.look.original.surfaces);
        let (seen, most) = (self.seen(height), fewest_cards::most());
        let fewest = search.fewest(&seen, most, finish, observer)?;
        let found = match fewest {
            Some(fewest) => Some(fewest),
            None => search.finished(most, &seen, f64::INFINITY, finish, observer)?,
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
        let mesh = drawn_at(placed, height);
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
fn drawn_at(placed: &[Placed], height: f64) -> Option<&Made> {
    let has_begun = |mesh: &&Placed| mesh.begins() >= height;
    placed.iter().rev().find(has_begun).map(|mesh| &mesh.made)
}
