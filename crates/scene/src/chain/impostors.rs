//! The impostors that a chain ends in.

use secateur_simplify::Observer;

use super::error::ChainError;
use super::level::{ChainLevel, ImpostorLevel, Shape};
use super::maker::{Made, Maker};
use super::options::Wanted;
use super::textures::Client;
use super::which::{Placed, no_level};
use crate::impostor::crossed::Planes;
use crate::impostor::judge::{Judge, best_crossed};
use crate::impostor::{Choice, Impostor, poll};

/// Two crossed planes whose FLIP is this many times what is wanted are given up: to bake more of them
/// takes as long as to make a level.
const HOPELESS: f64 = 2.0;

fn no_impostor(place: &str, flip: f64, triangles: usize, of_mesh: f64) -> String {
    format!(
        "no impostor at {place}: crossed planes have a FLIP of {flip:.3} there, the mesh of {triangles} triangles {of_mesh:.3}"
    )
}

/// An impostor, at which height it begins, and its FLIP there.
pub(super) type PlacedImpostor = (ImpostorLevel, f64, f64);

impl Maker<'_> {
    /// The impostors that a chain ends in, from which height on, and their FLIP there.
    pub(super) fn impostors(
        &self,
        made: &[Placed],
        client: &Client<'_>,
        notes: &mut Vec<String>,
        observer: &mut Observer<'_>,
    ) -> Result<Vec<PlacedImpostor>, ChainError> {
        let choice = self.options.impostor;
        let Some((_, begins, _)) = made.last().filter(|_| choice != Choice::None) else {
            return Ok(Vec::new());
        };
        // Where heights are asked for, the last of them; else where the last level is half as high.
        let mut places = self.heights();
        let last = places.pop().unwrap_or_else(|| {
            let height = begins / 2.0;
            (height, format!("{height} pixels"))
        });
        if choice == Choice::Cards {
            let cards = self.demanded_cards(made, last.0, client, observer)?;
            return Ok(cards.into_iter().collect());
        }
        let mut found = Vec::new();
        let mut own_notes = Vec::new();
        let of_last = self.impostor(made, &last, &mut own_notes, observer)?;
        // Levels for heights are for any distance, and nearer to the plant than cards can be.
        if choice == Choice::Auto && matches!(self.options.wanted, Wanted::Distances(_)) {
            if of_last.is_none() {
                places.push(last);
            }
            let heights: Vec<f64> = places.iter().map(|(height, _)| *height).collect();
            found.extend(self.cards(made, &heights, client, observer)?);
        }
        // Where crossed planes are none, cards may be.
        if found.is_empty() {
            notes.append(&mut own_notes);
        }
        found.extend(of_last);
        Ok(found)
    }

    /// Takes back notes of places where an impostor stands in the end, and adds those of places for which a mesh
    /// was made in vain.
    pub(super) fn note_impostors(&self, found: &[PlacedImpostor], notes: &mut Vec<String>) {
        for (height, place) in self.heights() {
            // The last that has begun there.
            let begun = found.iter().rfind(|(_, begins, _)| *begins >= height);
            let Some((level, begins, _)) = begun else {
                continue;
            };
            notes.retain(|note| !note.starts_with(&no_level(&place)));
            if *begins > height {
                notes.push(format!(
                    "{} the impostor of {} triangles before is enough",
                    no_level(&place),
                    level.impostor.surface.triangles.len()
                ));
            }
        }
    }

    /// Crossed planes or octahedral views from a place on.
    fn impostor(
        &self,
        made: &[Placed],
        (height, place): &(f64, String),
        notes: &mut Vec<String>,
        observer: &mut Observer<'_>,
    ) -> Result<Option<PlacedImpostor>, ChainError> {
        let (choice, height) = (self.options.impostor, *height);
        let Some((mesh, ..)) = made.last() else {
            return Ok(None);
        };
        poll(observer)?;
        let judge = self.look.judge(self.options.screen, height);
        if choice == Choice::Auto
            && let Some([flip, of_mesh]) = self.hopeless(mesh, &judge, height)
        {
            notes.push(no_impostor(place, flip, mesh.triangles(), of_mesh));
            return Ok(None);
        }
        poll(observer)?;
        let original = judge.of_surfaces(&self.look.original);
        let of_mesh = judge.flip(&original, &judge.of_surfaces(&mesh.drawn.level.surfaces));
        let found = match choice {
            Choice::Octahedral => Impostor::octahedral(&self.look.original, height).map(|made| {
                let flip = judge.flip(&original, &judge.of_impostor(&made));
                (made, flip)
            }),
            _ => best_crossed(&self.look.original, &original, &judge, height),
        };
        let Some((impostor, flip)) = found else {
            return Ok(None);
        };
        let triangles = impostor.surface.triangles.len();
        let is_lighter = triangles < mesh.triangles();
        let is_near = flip <= self.options.max_flip || flip <= of_mesh;
        let mut same_cost = None;
        if is_lighter
            && (is_near || choice != Choice::Auto)
            && let Some(equal) = self.level_if_any(triangles, observer)?
        {
            let pictures = judge.of_surfaces(&equal.drawn.level.surfaces);
            same_cost = Some((equal.triangles() as u64, judge.flip(&original, &pictures)));
        }
        if let Some((triangles, of_equal)) = same_cost
            && choice == Choice::Auto
            && of_equal < flip
        {
            notes.push(format!(
                "no impostor at {place}: crossed planes have a FLIP of {flip:.3} there, a mesh of as many triangles ({triangles}) {of_equal:.3}"
            ));
            return Ok(None);
        }
        if choice == Choice::Auto && !(is_lighter && is_near) {
            notes.push(no_impostor(place, flip, mesh.triangles(), of_mesh));
            return Ok(None);
        }
        let level = ImpostorLevel {
            impostor,
            mesh_triangles: mesh.triangles() as u64,
            mesh_flip_mean: of_mesh,
            same_cost,
        };
        Ok(Some((level, height, flip)))
    }

    /// In one view the FLIP of the fewest crossed planes and of a mesh, if the planes are so far from the
    /// plant there that more of them will not do.
    fn hopeless(&self, mesh: &Made, judge: &Judge, height: f64) -> Option<[f64; 2]> {
        let fewest = Impostor::crossed(&self.look.original, Planes::ALL[0], height)?;
        let judge = judge.from_one();
        let original = judge.of_surfaces(&self.look.original);
        let of_fewest = judge.flip(&original, &judge.of_impostor(&fewest));
        let of_mesh = judge.flip(&original, &judge.of_surfaces(&mesh.drawn.level.surfaces));
        let most = HOPELESS * of_mesh.max(self.options.max_flip);
        (of_fewest > most).then_some([of_fewest, of_mesh])
    }

    pub(super) fn finished_impostor(
        &self,
        level: ImpostorLevel,
        height: f64,
        flip_mean: f64,
    ) -> ChainLevel {
        ChainLevel {
            shape: Shape::Impostor(Box::new(level)),
            leaves: 0,
            foliage_triangles: 0,
            wood_triangles: 0,
            distance: self.options.screen.distance(self.look.height, height),
            pixels_high: height,
            screen_coverage: 0.0,
            flip_mean,
            pop_flip: None,
            shadow: 0,
            silhouette_iou: None,
            vmi_error_percent: None,
            order_sha256: None,
            view_count: None,
            order: None,
            textures: Vec::new(),
            keeps_textures: true,
            texture_bytes: 0,
            as_drawn: None,
        }
    }
}
