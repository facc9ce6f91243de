//! The impostors that a chain ends in.

use std::ops::RangeInclusive;
use std::slice::from_ref;

use secateur_eval::{Difference, ViewCount};
use secateur_model::{NamedOption, Note};
use secateur_simplify::Observer;

use super::card_cutoffs::Covering;
use super::cards::CardSearch;
use super::error::ChainError;
use super::height_search::MOST_OF_BEFORE;
use super::level::{ChainLevel, ImpostorLevel, Shape};
use super::level_choice::{in_pixels, no_level};
use super::level_report::{LevelKind, LevelReport};
use super::look::LevelPicture;
use super::maker::{Made, Maker};
use super::options::{HEIGHTS_PX, Wanted};
use super::placed::Placed;
use super::textures::{Client, Textures, end_of};
use crate::impostor::crossed::Planes;
use crate::impostor::fewest_cards::Seen;
use crate::impostor::judge::best_crossed;
use crate::impostor::{Choice, Impostor, poll};

/// Two crossed planes that are this many times what is wanted are given up: to bake more of them takes as long as to
/// make a level.
const HOPELESS: f64 = 2.0;

/// How much of a plant, of what there is, a client shows with an impostor that nobody asked for by name.
const COVERS: RangeInclusive<f64> = 0.8..=1.25;

fn no_impostor(place: &str, of_planes: f64, triangles: usize, of_mesh: f64) -> Note {
    let note = format!(
        "no impostor at {place}: crossed planes have a difference of {of_planes:.3} there, the mesh of {triangles} triangles {of_mesh:.3}"
    );
    note.into()
}

/// An impostor, and where it stands.
#[derive(Clone)]
pub(super) struct PlacedImpostor {
    pub(super) level: ImpostorLevel,
    /// Height on the screen where it begins, in pixels.
    pub(super) begins_px: f64,
    /// How far it looks from the plant there.
    pub(super) difference: Difference,
}

impl Maker<'_> {
    /// The impostors that a chain ends in, from which height on, and their FLIP there.
    pub(super) fn impostors(
        &self,
        (placed, far): (&[Placed], Vec<PlacedImpostor>),
        search: &mut CardSearch<'_>,
        client: &Client<'_>,
        notes: &mut Vec<Note>,
        observer: &mut Observer<'_>,
    ) -> Result<Vec<PlacedImpostor>, ChainError> {
        let choice = self.options.chosen_impostor();
        if choice == Choice::None {
            return Ok(Vec::new());
        }
        // Where heights are asked for, the last of them; else where the last level is half as high.
        let mut places = self.heights();
        let last = places.pop().unwrap_or_else(|| {
            let before = placed.last().map_or(HEIGHTS_PX[0], Placed::begins);
            (before / 2.0, in_pixels(before / 2.0))
        });
        if choice == Choice::Cards {
            let cards = self.demanded_cards(placed, last.0, search, client, observer)?;
            self.note_beyond(&last.1, cards.iter(), notes);
            return Ok(cards.into_iter().collect());
        }
        let mut found = Vec::new();
        let mut own_notes = Vec::new();
        let most_bytes = search.bytes_left;
        let of_last = self.impostor(placed, &last, most_bytes, client, &mut own_notes, observer)?;
        if let Some(planes) = &of_last {
            let bytes = planes.level.impostor.texture_bytes();
            search.bytes_left = search.bytes_left.saturating_sub(bytes);
        }
        // Levels for large heights are for any distance, and nearer to the plant than cards can be.
        if choice == Choice::Auto && matches!(self.options.wanted, Wanted::Distances(_)) {
            if of_last.is_none() {
                places.push(last.clone());
            }
            let heights: Vec<f64> = places.iter().map(|(height, _)| *height).collect();
            // Beside the plant stands a mesh, if there is more than one place.
            let near = usize::from(self.heights().len() > 1);
            let far = far.first().map_or(0.0, |far| far.begins_px);
            let count = heights.iter().filter(|height| **height > far).count();
            let before = near.min(count)..count;
            let at = (&heights[..], before);
            found.extend(self.cards((placed, true), at, &[], search, client, observer)?);
        }
        for cards in far {
            let is_last = of_last.is_some() && cards.begins_px <= last.0;
            let of_cards = self.cost_of_impostor(&cards.level.impostor);
            let pays = found.last().is_none_or(|before: &PlacedImpostor| {
                of_cards <= MOST_OF_BEFORE * self.cost_of_impostor(&before.level.impostor)
            });
            if pays && !is_last {
                found.push(cards);
            }
        }
        // Where crossed planes are none, cards may be.
        if found.is_empty() {
            notes.append(&mut own_notes);
        }
        self.note_beyond(&last.1, of_last.iter(), notes);
        found.extend(of_last);
        Ok(found)
    }

    /// Says of impostors that were asked for by name where they differ by more than levels may.
    fn note_beyond<'i>(
        &self,
        place: &str,
        found: impl Iterator<Item = &'i PlacedImpostor>,
        notes: &mut Vec<Note>,
    ) {
        let limits = self.look.limits;
        for impostor in found.filter(|one| one.difference.over(limits) > 1.0) {
            let note = Note::from(format!(
                "the impostor at {place} has a difference of {:.3} and a block coverage of {:.2}, beyond ",
                impostor.difference.difference, impostor.difference.block_coverage,
            ));
            notes.push(
                note.naming(NamedOption::MaxDifference(Some(limits.difference)))
                    .then(": it stands there as ")
                    .naming(NamedOption::Impostor)
                    .then(" asks for it"),
            );
        }
    }

    /// Takes back notes of places where an impostor stands in the end, and adds those of places for which a mesh
    /// was made in vain.
    pub(super) fn note_impostors(&self, found: &[PlacedImpostor], notes: &mut Vec<Note>) {
        for (height, place) in self.heights() {
            // The last that has begun there.
            let begun = found.iter().rfind(|impostor| impostor.begins_px >= height);
            let Some(impostor) = begun else {
                continue;
            };
            notes.retain(|note| !note.starts_with(&no_level(&place)));
            if impostor.begins_px > height {
                let note = format!(
                    "{} the impostor of {} triangles before is enough",
                    no_level(&place),
                    impostor.level.impostor.surface.triangles.len()
                );
                notes.push(note.into());
            }
        }
    }

    /// Crossed planes or octahedral views from a place on.
    fn impostor(
        &self,
        placed: &[Placed],
        (height, place): &(f64, String),
        most_bytes: u64,
        client: &Client<'_>,
        notes: &mut Vec<Note>,
        observer: &mut Observer<'_>,
    ) -> Result<Option<PlacedImpostor>, ChainError> {
        let (choice, height) = (self.options.chosen_impostor(), *height);
        let mesh = placed.last();
        let mesh_triangles = self.triangles_beside(mesh.map(|mesh| &mesh.made));
        poll(observer)?;
        let seen = self.seen(height);
        if choice == Choice::Auto
            && let Some(of_planes) = self.hopeless(&seen, height)
        {
            let of_mesh = mesh.map_or(0.0, |mesh| mesh.difference.difference);
            notes.push(no_impostor(place, of_planes, mesh_triangles, of_mesh));
            return Ok(None);
        }
        poll(observer)?;
        let range = [height, end_of(height, None)];
        let Some(impostor) = self.baked(&seen, range, client) else {
            return Ok(None);
        };
        let difference = seen.difference(&impostor);
        let triangles = impostor.surface.triangles.len();
        let is_light = !self.is_more_than(&impostor, mesh)
            && self.cost_of_impostor(&impostor) < self.cost_beside(mesh);
        let does = is_light && difference.over(self.look.limits_of_impostors(height)) <= 1.0;
        let mut same_cost = None;
        if triangles < mesh_triangles
            && (does || choice != Choice::Auto)
            && let Some(equal) = self.level_if_any(triangles, observer)?
        {
            let of_equal = self.difference_beside_impostor(Some(&equal), height);
            same_cost = Some((equal.triangles() as u64, of_equal));
        }
        let level = ImpostorLevel {
            impostor,
            mesh_triangles: mesh_triangles as u64,
            mesh_difference: self.difference_beside_impostor(mesh.map(|mesh| &mesh.made), height),
            same_cost,
        };
        if choice == Choice::Auto {
            let of_planes = difference.difference;
            let refused = match does {
                true => self.refused(&level, of_planes, (place, range), (most_bytes, client)),
                false => {
                    let of_mesh = level.mesh_difference;
                    Some(no_impostor(place, of_planes, mesh_triangles, of_mesh))
                }
            };
            if let Some(note) = refused {
                notes.push(note);
                return Ok(None);
            }
        }
        Ok(Some(PlacedImpostor {
            level,
            begins_px: height,
            difference,
        }))
    }

    /// Crossed planes or octahedral views for a range of heights on the screen in pixels.
    fn baked(&self, seen: &Seen<'_>, range: [f64; 2], client: &Client<'_>) -> Option<Impostor> {
        let original = &self.look.original.surfaces;
        let baked_px = self.look.of_height(range[0]);
        let crossed = || {
            let figure = |made: &Impostor| seen.difference(made).difference;
            best_crossed(original, baked_px, figure).map(|(made, _)| made)
        };
        match self.options.chosen_impostor() {
            Choice::Octahedral => Impostor::octahedral(original, baked_px),
            Choice::Auto => crossed().map(|made| Covering::new(client, range).of(made)),
            Choice::None | Choice::Crossed | Choice::Cards => crossed(),
        }
    }

    /// Why crossed planes that are light and near enough do not stand at a place, if nobody asked for them.
    fn refused(
        &self,
        level: &ImpostorLevel,
        of_planes: f64,
        (place, range): (&str, [f64; 2]),
        (most_bytes, client): (u64, &Client<'_>),
    ) -> Option<Note> {
        let impostor = &level.impostor;
        if let Some((triangles, of_equal)) = level.same_cost
            && of_equal < of_planes
        {
            let note = format!(
                "no impostor at {place}: crossed planes have a difference of {of_planes:.3} there, a mesh of as many triangles ({triangles}) {of_equal:.3}"
            );
            return Some(note.into());
        }
        if impostor.texture_bytes() > most_bytes {
            let note = Note::from(format!(
                "no impostor at {place}: crossed planes take {} KiB of textures on the GPU there, more than ",
                impostor.texture_bytes() >> 10
            ));
            let note = note.naming(NamedOption::ImpostorTextures);
            return Some(note.then(" lets them"));
        }
        let shown = client.as_drawn(from_ref(&impostor.surface), range);
        let covers = shown.begin.coverage_over_truth;
        let note = format!(
            "no impostor at {place}: a client would show {covers:.2} times what there is of the plant"
        );
        (!COVERS.contains(&covers)).then(|| note.into())
    }

    /// From few views the difference of the fewest crossed planes, if they are so far from the plant there that more of
    /// them will not do.
    fn hopeless(&self, seen: &Seen<'_>, height: f64) -> Option<f64> {
        let original = &self.look.original.surfaces;
        let fewest = Impostor::crossed(original, Planes::ALL[0], self.look.of_height(height))?;
        let found = seen.at_a_glance(&fewest);
        (found.over(self.look.limits_of_impostors(height)) > HOPELESS).then_some(found.difference)
    }

    /// The triangles of a mesh, or of the plant itself where no mesh stands.
    pub(super) fn triangles_beside(&self, mesh: Option<&Made>) -> usize {
        mesh.map_or(self.all, Made::triangles)
    }

    /// How far a mesh looks from the plant by the judge of impostors: not at all where the plant itself stands.
    pub(super) fn difference_beside_impostor(&self, mesh: Option<&Made>, height: f64) -> f64 {
        let Some(mesh) = mesh else {
            return 0.0;
        };
        let judge = self.look.judge_of_impostors();
        let surfaces = &mesh.drawn.level.surfaces;
        judge
            .difference(surfaces, height, ViewCount::All)
            .difference
    }

    /// What cards and planes are held against where the screen shows the plant at this height.
    pub(super) fn seen(&self, height: f64) -> Seen<'_> {
        let limits = self.look.limits_of_impostors(height);
        Seen::new(self.look.judge_of_impostors(), height, limits)
    }

    /// An impostor as a level of the chain, seen over a range of heights.
    pub(super) fn finished_impostor(
        &self,
        impostor: PlacedImpostor,
        range: [f64; 2],
        client: &Client<'_>,
    ) -> (LevelPicture, ChainLevel) {
        let PlacedImpostor {
            level,
            begins_px,
            difference,
        } = impostor;
        let picture = LevelPicture::Impostor(level.impostor.clone());
        let surface = &level.impostor.surface;
        let as_drawn = (!level.impostor.needs_sampler())
            .then(|| client.as_drawn(std::slice::from_ref(surface), range));
        let report = LevelReport {
            kind: LevelKind::Impostor,
            triangles: surface.triangles.len() as u64,
            texture_bytes: level.impostor.texture_bytes(),
            distance: self.distance_m(begins_px),
            pixels_high: begins_px,
            difference,
            flip_mean: self
                .look
                .flip_mean(&picture, (begins_px, self.options.screen)),
            leaf_textures: Textures::Keep,
            as_drawn,
            impostor: Some(level.report()),
            ..LevelReport::default()
        };
        let level = ChainLevel {
            shape: Shape::Impostor(Box::new(level)),
            report,
            shadow: 0,
            order: None,
            textures: Vec::new(),
            morph: None,
        };
        (picture, level)
    }
}
