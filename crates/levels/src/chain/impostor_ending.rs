//! How a chain ends: the meshes before the first impostor, the impostors, and what switches show.

use secateur_model::Note;
use secateur_simplify::{Observer, Progress};

use super::error::ChainError;
use super::impostors::PlacedImpostor;
use super::level::{ChainLevel, Shape};
use super::look::LevelPicture;
use super::maker::Maker;
use super::placed::Placed;
use super::textures::{Client, end_of};

/// A level, and what represents it in pictures.
type Pictured = (LevelPicture, ChainLevel);

/// Levels that are left out, and why, a sentence each.
type LeftOut = Vec<(ChainLevel, Note)>;

impl Maker<'_> {
    /// The meshes from before the first impostor and the impostors, with what switching to each shows, but for those
    /// that show more than is wanted. Where an impostor goes for that, the meshes in whose place it stood are back.
    pub(super) fn ending(
        &self,
        placed: Vec<Placed>,
        mut impostors: Vec<PlacedImpostor>,
        client: &Client<'_>,
        notes: &mut Vec<Note>,
        observer: &mut Observer<'_>,
    ) -> Result<Vec<ChainLevel>, ChainError> {
        let mut of_switches = Vec::new();
        loop {
            let levels = self.levels(placed.clone(), &impostors, client)?;
            let (kept, left_out) = self.without_pops(levels, observer)?;
            let is_impostor = |level: &ChainLevel| matches!(level.shape, Shape::Impostor(_));
            // What comes after it may be kept beside a mesh in its place, or left out.
            let first = left_out.iter().find(|(level, _)| is_impostor(level));
            if let Some((level, why)) = first {
                of_switches.push(why.clone());
                impostors.retain(|impostor| impostor.begins_px != level.pixels_high);
                continue;
            }
            self.note_impostors(&impostors, notes);
            notes.append(&mut of_switches);
            notes.extend(left_out.into_iter().map(|(_, why)| why));
            return Ok(kept);
        }
    }

    /// The meshes from before the first impostor, and the impostors.
    fn levels(
        &self,
        mut placed: Vec<Placed>,
        impostors: &[PlacedImpostor],
        client: &Client<'_>,
    ) -> Result<Vec<Pictured>, ChainError> {
        let followed_at = impostors.first().map(|impostor| impostor.begins_px);
        if let Some(height) = followed_at {
            placed.retain(|mesh| mesh.begins() > height);
        }
        let mut ends: Vec<Option<f64>> = placed.iter().skip(1).map(|p| Some(p.begins())).collect();
        ends.push(followed_at);
        let mut levels = Vec::new();
        for (k, (mesh, next)) in placed.into_iter().zip(ends).enumerate() {
            let end = end_of(mesh.begins(), next);
            let mesh = self.placed_down_to(mesh, end, k == 0, client)?;
            levels.push(self.finished(mesh)?);
        }
        for (k, impostor) in impostors.iter().enumerate() {
            let next = impostors.get(k + 1).map(|impostor| impostor.begins_px);
            let range = [impostor.begins_px, end_of(impostor.begins_px, next)];
            levels.push(self.finished_impostor(impostor.clone(), range, client));
        }
        Ok(levels)
    }

    /// The levels with what switching to each shows, and those that show more than is wanted.
    fn without_pops(
        &self,
        levels: Vec<Pictured>,
        observer: &mut Observer<'_>,
    ) -> Result<(Vec<ChainLevel>, LeftOut), ChainError> {
        let mut kept: Vec<Pictured> = Vec::new();
        let mut left_out = LeftOut::new();
        for (picture, mut level) in levels {
            Progress::Finish.tell(observer)?;
            level.pop = match kept.last() {
                Some((before, _)) => {
                    let look = &self.look;
                    Some(look.difference_of_switch(before, &picture, level.pixels_high))
                }
                // Before it stands the plant itself.
                None if self.options.original => Some(level.difference.difference),
                None => None,
            };
            if let (Some(pop), Some(most)) = (level.pop, self.options.max_pop)
                && pop > most
            {
                let why = format!(
                    "a level of {} triangles is left out: to switch to it at {:.0} pixels would show a difference of {pop:.3}",
                    level.triangles, level.pixels_high
                );
                left_out.push((level, why.into()));
                continue;
            }
            kept.push((picture, level));
        }
        Ok((kept.into_iter().map(|(_, level)| level).collect(), left_out))
    }
}
