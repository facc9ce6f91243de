//! How far what is drawn of a plant looks from it at a distance.

use std::path::Path;

use secateur_eval::{Difference, DifferenceJudge, ViewCount};
use secateur_gltf::WholeTree;
use secateur_levels::impostor::Impostor;
use secateur_levels::impostor::judge::best_crossed;
use secateur_model::Surface;
use secateur_runtime::Screen;

use crate::judge::{PictureFile, camera, opaque, portrait};
use crate::{Error, Host, Identity};

/// The original of a plant.
pub(super) struct DistanceJudge {
    surfaces: Vec<Surface>,
    of_meshes: DifferenceJudge,
    /// With normals of double-sided leaves turned to the viewer.
    of_impostors: DifferenceJudge,
}

impl DistanceJudge {
    /// Draws the original's picture for reports.
    pub(super) fn new(
        tree: &WholeTree,
        identity: &Identity,
        folder: &Path,
        host: &dyn Host,
    ) -> Result<Self, Error> {
        let drawn = tree.items().surfaces()?;
        let is_wood: Vec<bool> = drawn.iter().map(|(_, is_foliage)| !is_foliage).collect();
        let surfaces: Vec<Surface> = drawn.into_iter().map(|(surface, _)| surface).collect();
        crate::files::make_folder(&folder.join("pictures"))?;
        let picture = portrait(&surfaces, &camera(&surfaces));
        let file = PictureFile::picture(identity.original_picture());
        file.write(opaque(&picture), folder, host)?;
        let judge = || DifferenceJudge::new(surfaces.clone(), &is_wood);
        Ok(Self {
            of_meshes: judge(),
            of_impostors: judge().with_turned_normals(),
            surfaces,
        })
    }

    /// What judges at a distance.
    pub(super) fn at(&self, distance_m: f64) -> Place<'_> {
        let size_m = self.of_meshes.size();
        Place {
            judge: self,
            distance_m,
            pixels_high: Screen::default().pixels_high(size_m, distance_m),
        }
    }
}

/// A distance, and the original as it is seen from there.
pub(super) struct Place<'a> {
    pub(super) distance_m: f64,
    pub(super) pixels_high: f64,
    judge: &'a DistanceJudge,
}

impl Place<'_> {
    /// How far a mesh looks from the plant.
    pub(super) fn difference(&self, surfaces: &[Surface]) -> Difference {
        let judge = &self.judge.of_meshes;
        judge.difference(surfaces, self.pixels_high, ViewCount::All)
    }

    /// As impostors are judged.
    pub(super) fn difference_beside_impostor(&self, surfaces: &[Surface]) -> Difference {
        let judge = &self.judge.of_impostors;
        judge.difference(surfaces, self.pixels_high, ViewCount::All)
    }

    /// The crossed planes that look most like the plant, and how far they look from it; none of a plant of which
    /// nothing can be seen.
    pub(super) fn crossed(&self) -> Option<(Impostor, Difference)> {
        let seen =
            |made: &Impostor| self.difference_beside_impostor(std::slice::from_ref(&made.surface));
        let figure = |made: &Impostor| seen(made).difference;
        let (impostor, _) = best_crossed(&self.judge.surfaces, self.pixels_high, figure)?;
        let difference = seen(&impostor);
        Some((impostor, difference))
    }
}
