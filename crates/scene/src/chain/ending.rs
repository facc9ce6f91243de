//! How a chain ends: what switches show, and the textures of its levels.

use secateur_eval::Pictures;

use super::error::ChainError;
use super::level::ChainLevel;
use super::level_surfaces::LevelSurfaces;
use super::maker::Maker;
use super::texture_bytes::{bytes_of, texture_bytes};
use super::textures::{Chosen, Client, end_of};
use crate::impostor::Impostor;
use crate::impostor::judge::Judge;

/// What of a level a picture is drawn of.
pub(super) enum Pictured {
    Mesh(LevelSurfaces),
    Impostor(Impostor),
}

impl Pictured {
    fn pictures(&self, judge: &Judge) -> Pictures {
        match self {
            Self::Mesh(level) => judge.of_surfaces(&level.surfaces),
            Self::Impostor(impostor) => judge.of_impostor(impostor),
        }
    }
}

impl Maker<'_> {
    /// The levels with what switching to each shows, but for those that show more than is wanted.
    pub(super) fn without_pops(
        &self,
        levels: Vec<(Pictured, ChainLevel)>,
        notes: &mut Vec<String>,
    ) -> Result<Vec<(Pictured, ChainLevel)>, ChainError> {
        let mut kept: Vec<(Pictured, ChainLevel)> = Vec::new();
        for (pictured, mut level) in levels {
            if let Some((before, _)) = kept.last() {
                let screen = self.options.screen;
                let judge = self.look.judge_of_switches(screen, level.pixels_high);
                let pop = judge.largest_flip(&before.pictures(&judge), &pictured.pictures(&judge));
                if self.options.max_pop.is_some_and(|most| pop > most) {
                    notes.push(format!(
                        "a level of {} triangles is left out: to switch to it at {:.0} pixels would show a FLIP of {pop:.3}",
                        level.triangles(),
                        level.pixels_high
                    ));
                    continue;
                }
                level.pop_flip = Some(pop);
            }
            kept.push((pictured, level));
        }
        Ok(kept)
    }

    /// The levels with textures for where they are seen.
    pub(super) fn with_textures(
        &self,
        levels: Vec<(Pictured, ChainLevel)>,
        client: &Client<'_>,
    ) -> Result<Vec<ChainLevel>, ChainError> {
        let items = self.tree.items();
        let begins: Vec<f64> = levels.iter().map(|(_, level)| level.pixels_high).collect();
        let mut finished = Vec::new();
        for (number, (pictured, mut level)) in levels.into_iter().enumerate() {
            let begin = level.pixels_high;
            let range = [begin, end_of(begin, begins.get(number + 1).copied())];
            match pictured {
                Pictured::Mesh(drawn) => {
                    let wanted = self.options.textures;
                    let Chosen { textures, as_drawn } =
                        client.choose(&drawn, range, wanted, number == 0);
                    level.texture_bytes =
                        texture_bytes(items.document(), &drawn.materials, &textures);
                    level.textures = textures;
                    level.as_drawn = Some(as_drawn);
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
