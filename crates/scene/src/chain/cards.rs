//! Cards that take the place of a chain's coarsest meshes.

use secateur_simplify::Observer;

use super::card_cutoffs::Covering;
use super::error::ChainError;
use super::impostors::PlacedImpostor;
use super::level::ImpostorLevel;
use super::maker::{Made, Maker};
use super::textures::{Client, end_of};
use super::which::{MOST_OF_BEFORE, Placed};
use crate::impostor::fewest_cards::{self, Found, Search, Seen};
use crate::impostor::{Impostor, poll};

impl Maker<'_> {
    /// Cards from the first of these heights on at which some are within the difference, there and at all that
    /// follow, save a third of the triangles of the mesh there and have no more than the lightest; and fewer of
    /// them from each that follows where that saves a third again. Their normals have half as many texels a side where
    /// these do as well.
    pub(super) fn cards(
        &self,
        made: &[Placed],
        heights: &[f64],
        client: &Client<'_>,
        observer: &mut Observer<'_>,
    ) -> Result<Vec<PlacedImpostor>, ChainError> {
        let mut placed: Vec<PlacedImpostor> = Vec::new();
        let Some((lightest, ..)) = made.last() else {
            return Ok(placed);
        };
        let lightest = lightest.triangles() as f64;
        let mut before: Option<usize> = None;
        let most_flip = self.options.max_flip;
        let mut search = Search::new(&self.look.original);
        // Beside the plant stands a mesh, if there is more than one place.
        let near = usize::from(self.heights().len() > 1);
        for (k, height) in heights.iter().enumerate().skip(near) {
            poll(observer)?;
            if !search.has_room(*height) {
                continue;
            }
            let most_triangles = match (before, drawn_at(made, *height)) {
                (Some(cards), _) => MOST_OF_BEFORE * cards as f64,
                (None, Some(mesh)) => lightest.min(MOST_OF_BEFORE * mesh.triangles() as f64),
                (None, None) => continue,
            };
            let most = (most_triangles / 2.0) as usize;
            let covering = Covering::new(client, [*height, end_of(*height, None)]);
            let finish = |made| covering.of(made);
            let seen = self.seen(*height);
            let found = search.fewest(&seen, most_flip, most, finish, observer)?;
            let Some(found) = found else {
                continue;
            };
            let mut does = |found: &Found| -> Result<bool, ChainError> {
                poll(observer)?;
                Ok(self.hides_switch(made, &placed, &found.impostor, *height)
                    && self.is_within(&found.impostor, &heights[k + 1..], observer)?)
            };
            if !does(&found)? {
                continue;
            }
            let found = match seen.with_half_normals(&found) {
                Some(half) if half.flip <= most_flip && does(&half)? => half,
                _ => found,
            };
            before = Some(found.impostor.surface.triangles.len());
            placed.extend(self.beside_mesh(made, found, *height, observer)?);
        }
        Ok(placed)
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
            if self.seen(*height).flip_at_its_size(impostor) > self.options.max_flip {
                return Ok(false);
            }
        }
        Ok(true)
    }

    /// Whether a switch to cards shows no more than it may.
    fn hides_switch(
        &self,
        made: &[Placed],
        placed: &[PlacedImpostor],
        cards: &Impostor,
        height: f64,
    ) -> bool {
        let Some(most) = self.options.max_pop else {
            return true;
        };
        let judge = self.look.judge_of_switches(self.options.screen, height);
        let nearer = made.iter().rev().find(|(_, begins, _)| *begins > height);
        let before = match (placed.last(), nearer) {
            (Some((before, ..)), _) => judge.of_impostor(&before.impostor),
            (None, Some((mesh, ..))) => judge.of_surfaces(&mesh.drawn.level.surfaces),
            (None, None) => return true,
        };
        judge.largest_flip(&before, &judge.of_impostor(cards)) <= most
    }

    /// Cards from this height on, whatever they look like beside a mesh: as few as are within the difference, or
    /// the largest number that is ever tried where no number is.
    pub(super) fn demanded_cards(
        &self,
        made: &[Placed],
        height: f64,
        client: &Client<'_>,
        observer: &mut Observer<'_>,
    ) -> Result<Option<PlacedImpostor>, ChainError> {
        let covering = Covering::new(client, [height, end_of(height, None)]);
        let finish = |made| covering.of(made);
        let mut search = Search::new(&self.look.original);
        let (seen, most) = (self.seen(height), fewest_cards::most());
        let fewest = search.fewest(&seen, self.options.max_flip, most, finish, observer)?;
        let found = match fewest {
            Some(fewest) => Some(fewest),
            None => search.finished(most, &seen, f64::INFINITY, finish, observer)?,
        };
        let Some(found) = found else {
            return Ok(None);
        };
        poll(observer)?;
        let most_flip = self.options.max_flip.max(found.flip);
        let hides = |found: &Found| self.hides_switch(made, &[], &found.impostor, height);
        let half = seen.with_half_normals(&found);
        let half = half.filter(|half| half.flip <= most_flip && (hides(half) || !hides(&found)));
        let found = half.unwrap_or(found);
        self.beside_mesh(made, found, height, observer)
    }

    /// Cards beside the mesh that would be drawn there.
    fn beside_mesh(
        &self,
        made: &[Placed],
        found: Found,
        height: f64,
        observer: &mut Observer<'_>,
    ) -> Result<Option<PlacedImpostor>, ChainError> {
        let Some(mesh) = drawn_at(made, height) else {
            return Ok(None);
        };
        poll(observer)?;
        let judge = self.look.judge(self.options.screen, height);
        let original = judge.of_surfaces(&self.look.original);
        let flip_of = |mesh: &Made| {
            let pictures = judge.of_surfaces(&mesh.drawn.level.surfaces);
            judge.flip(&original, &pictures)
        };
        let triangles = found.impostor.surface.triangles.len();
        let mut same_cost = None;
        if triangles < mesh.triangles()
            && let Some(equal) = self.level_if_any(triangles, observer)?
        {
            same_cost = Some((equal.triangles() as u64, flip_of(&equal)));
        }
        let level = ImpostorLevel {
            mesh_triangles: mesh.triangles() as u64,
            mesh_flip_mean: flip_of(mesh),
            impostor: found.impostor,
            same_cost,
        };
        Ok(Some((level, height, found.flip)))
    }

    fn seen(&self, height: f64) -> Seen {
        let judge = self.look.judge(self.options.screen, height);
        Seen::new(&self.look.original, judge, height)
    }
}

/// The mesh that is drawn where the screen shows the plant at this height.
fn drawn_at(made: &[Placed], height: f64) -> Option<&Made> {
    let has_begun = |(_, begins, _): &&Placed| *begins >= height;
    let placed = made.iter().rev().find(has_begun).or(made.first())?;
    Some(&placed.0)
}
