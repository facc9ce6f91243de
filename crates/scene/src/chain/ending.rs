//! How a chain ends: what switches show, and the textures of its levels.

use secateur_eval::Pictures;
use secateur_simplify::{Observer, Progress};

use super::error::ChainError;
use super::impostors::PlacedImpostor;
use super::level::{ChainLevel, Shape};
use super::level_surfaces::LevelSurfaces;
use super::maker::Maker;
use super::texture_bytes::{bytes_of, texture_bytes};
use super::textures::{Client, end_of};
use super::which::Placed;
use crate::impostor::Impostor;
use crate::impostor::judge::Judge;

/// What of a level a picture is drawn of.
pub(super) enum Pictured {
    Mesh(LevelSurfaces),
    Impostor(Impostor),
}

impl Pictured {
    pub(super) fn pictures(&self, judge: &Judge) -> Pictures {
        match self {
            Self::Mesh(level) => judge.of_surfaces(&level.surfaces),
            Self::Impostor(impostor) => judge.of_impostor(impostor),
        }
    }
}

/// A level, and what of it a picture is drawn of.
pub(super) type Ended = (Pictured, ChainLevel);

/// Levels that are left out, and why, a sentence each.
type LeftOut = Vec<(ChainLevel, String)>;

impl Maker<'_> {
    /// The meshes from before the first impostor and the impostors, with what switching to each shows, but for those
    /// that show more than is wanted. Where an impostor goes for that, the meshes in whose place it stood are back.
    pub(super) fn ending(
        &self,
        mut made: Vec<Placed>,
        mut impostors: Vec<PlacedImpostor>,
        client: &Client<'_>,
        notes: &mut Vec<String>,
        observer: &mut Observer<'_>,
    ) -> Result<Vec<Ended>, ChainError> {
        let mut of_switches = Vec::new();
        loop {
            let is_bounded = self.options.max_pop.is_some() && !impostors.is_empty();
            let meshes = match is_bounded {
                true => made.clone(),
                false => std::mem::take(&mut made),
            };
            let levels = self.levels(meshes, &impostors, client, observer)?;
            let (kept, left_out) = self.without_pops(levels, observer)?;
            let is_impostor = |level: &ChainLevel| matches!(level.shape, Shape::Impostor(_));
            // What comes after it may be kept beside a mesh in its place, or left out.
            let first = left_out.iter().find(|(level, _)| is_impostor(level));
            if let Some((level, why)) = first {
                of_switches.push(why.clone());
                impostors.retain(|(_, begins, _)| *begins != level.pixels_high);
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
        mut made: Vec<Placed>,
        impostors: &[PlacedImpostor],
        client: &Client<'_>,
        observer: &mut Observer<'_>,
    ) -> Result<Vec<Ended>, ChainError> {
        let followed_at = impostors.first().map(|(_, height, _)| *height);
        if let Some(height) = followed_at {
            made.retain(|(_, begins, _)| *begins > height);
        }
        let mut levels = Vec::new();
        for (level, height, flip) in self.covering(made, followed_at, client, observer)? {
            Progress::Finish.tell(observer)?;
            let pictured = Pictured::Mesh(level.drawn.level.clone());
            levels.push((pictured, self.finished(level, height, flip)?));
        }
        for (level, height, flip) in impostors {
            let pictured = Pictured::Impostor(level.impostor.clone());
            let level = self.finished_impostor(level.clone(), *height, *flip);
            levels.push((pictured, level));
        }
        Ok(levels)
    }

    /// The levels with what switching to each shows, and those that show more than is wanted.
    fn without_pops(
        &self,
        levels: Vec<Ended>,
        observer: &mut Observer<'_>,
    ) -> Result<(Vec<Ended>, LeftOut), ChainError> {
        let mut kept: Vec<Ended> = Vec::new();
        let mut left_out = LeftOut::new();
        for (pictured, mut level) in levels {
            Progress::Finish.tell(observer)?;
            if let Some((before, _)) = kept.last() {
                let screen = self.options.screen;
                let judge = self.look.judge_of_switches(screen, level.pixels_high);
                let pop = judge.largest_flip(&before.pictures(&judge), &pictured.pictures(&judge));
                if self.options.max_pop.is_some_and(|most| pop > most) {
                    let why = format!(
                        "a level of {} triangles is left out: to switch to it at {:.0} pixels would show a FLIP of {pop:.3}",
                        level.triangles(),
                        level.pixels_high
                    );
                    left_out.push((level, why));
                    continue;
                }
                level.pop_flip = Some(pop);
            }
            kept.push((pictured, level));
        }
        Ok((kept, left_out))
    }

    /// The levels with textures for where they are seen.
    pub(super) fn with_textures(
        &self,
        levels: Vec<Ended>,
        client: &Client<'_>,
        observer: &mut Observer<'_>,
    ) -> Result<Vec<ChainLevel>, ChainError> {
        let items = self.tree.items();
        let begins: Vec<f64> = levels.iter().map(|(_, level)| level.pixels_high).collect();
        let mut finished = Vec::new();
        for (number, (pictured, mut level)) in levels.into_iter().enumerate() {
            Progress::Finish.tell(observer)?;
            let begin = level.pixels_high;
            let range = [begin, end_of(begin, begins.get(number + 1).copied())];
            match pictured {
                Pictured::Mesh(drawn) => {
                    let wanted = self.options.textures;
                    let chosen = client.choose(&drawn, range, wanted, number == 0);
                    level.texture_bytes =
                        texture_bytes(items.document(), &drawn.materials, &chosen.textures);
                    level.textures = chosen.textures;
                    level.keeps_textures = chosen.keeps_textures;
                    level.as_drawn = Some(chosen.as_drawn);
                }
                Pictured::Impostor(impostor) => {
                    let material = &impostor.surface.material;
                    let normals = material.finish.normal_map.as_ref();
                    let all = material
                        .texture
                        .iter()
                        .chain(normals.map(|map| &map.texture));
                    level.texture_bytes = all.map(|texture| bytes_of(texture)).sum();
                    if !impostor.needs_sampler() {
                        let surfaces = [impostor.surface];
                        level.as_drawn = Some(client.as_drawn(&surfaces, range));
                    }
                }
            }
            finished.push(level);
        }
        Ok(finished)
    }
}
