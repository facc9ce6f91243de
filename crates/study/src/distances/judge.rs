//! How far what is drawn of a plant looks from it at a distance.

use std::path::Path;

use secateur_eval::pictures::share_of_tight_frame;
use secateur_eval::{MeasureError, Pictures};
use secateur_gltf::WholeTree;
use secateur_levels::impostor::Impostor;
use secateur_levels::impostor::judge::{Judge, best_crossed};
use secateur_model::{BoundingSphere, Surface};
use secateur_raster::{View, ViewSet};
use secateur_runtime::Screen;

use crate::judge::{PictureFile, camera, opaque, portrait};
use crate::subject::Subject;
use crate::{Error, Host, Identity};

/// From how many of the views that judge a plant is looked at: of the held-out ones those from which `lods`
/// judges its levels.
const VIEWS: usize = 6;

/// The most pixels a side that pictures have.
const MOST_PICTURE_PX: f64 = 1024.0;

/// The original of a plant.
pub(super) struct DistanceJudge {
    surfaces: Vec<Surface>,
    directions: ViewSet,
    sphere: BoundingSphere,
    /// By what FLIP over a picture is multiplied to be that over the frame of `measure`.
    frame_share: f64,
    /// Height of the plant in metres.
    height: f64,
}

impl DistanceJudge {
    /// Draws the original's picture for reports.
    pub(super) fn new(
        subject: &Subject,
        tree: &WholeTree,
        identity: &Identity,
        folder: &Path,
        host: &dyn Host,
    ) -> Result<Self, Error> {
        let items = tree.items();
        let surfaces = items.surfaces()?.into_iter();
        let surfaces: Vec<Surface> = surfaces.map(|(surface, _)| surface).collect();
        let judging = subject.judged_by.about(items.foliage())?;
        let views: Vec<View> = (judging.rigs.iter())
            .flat_map(|set| set.views().iter().copied())
            .collect();
        let step = (views.len() / VIEWS).max(1);
        let corners = items.foliage().triangles().iter().flat_map(|t| t.corners);
        let (low, high) = corners.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), c| {
            (low.min(c.y), high.max(c.y))
        });
        crate::files::make_folder(&folder.join("pictures"))?;
        let picture = portrait(&surfaces, &camera(&surfaces));
        let file = PictureFile::picture(identity.original_picture());
        file.write(opaque(&picture), folder, host)?;
        let sphere = (items.foliage().bounding_sphere()).ok_or(MeasureError::NoFoliage)?;
        let of_leaves = tree.leaves().bounding_sphere().unwrap_or(sphere);
        Ok(Self {
            directions: ViewSet::new(views.into_iter().step_by(step).collect()),
            frame_share: share_of_tight_frame(sphere, of_leaves),
            sphere,
            height: high - low,
            surfaces,
        })
    }

    /// What judges at a distance.
    pub(super) fn at(&self, distance_m: f64) -> Place<'_> {
        let screen = Screen::default();
        let pixels_high = screen.pixels_high(self.height, distance_m);
        let (directions, sphere) = (&self.directions, self.sphere);
        let judge = Judge::new(directions, sphere, self.height, screen, pixels_high);
        let judge = judge.with_frame_share(self.frame_share);
        let judge = judge.in_pictures_of_at_most(MOST_PICTURE_PX);
        Place {
            original: judge.of_mesh(&self.surfaces),
            original_beside_impostor: judge.of_surfaces(&self.surfaces),
            surfaces: &self.surfaces,
            judge,
            distance_m,
            pixels_high,
        }
    }
}

/// A distance, and the original as it is seen from there.
pub(super) struct Place<'a> {
    pub(super) distance_m: f64,
    pub(super) pixels_high: f64,
    surfaces: &'a [Surface],
    judge: Judge,
    original: Pictures,
    original_beside_impostor: Pictures,
}

impl Place<'_> {
    /// FLIP of each view of a mesh.
    pub(super) fn flips(&self, surfaces: &[Surface]) -> Vec<f64> {
        let pictures = self.judge.of_mesh(surfaces);
        self.judge.flips(&self.original, &pictures)
    }

    /// FLIP of each view of a mesh as impostors are judged.
    pub(super) fn flips_beside_impostor(&self, surfaces: &[Surface]) -> Vec<f64> {
        let pictures = self.judge.of_surfaces(surfaces);
        self.judge.flips(&self.original_beside_impostor, &pictures)
    }

    /// The crossed planes that look most like the plant, and FLIP of each view of them; none of a plant
    /// of which nothing can be seen.
    pub(super) fn crossed(&self) -> Option<(Impostor, Vec<f64>)> {
        let (judge, height) = (&self.judge, self.pixels_high);
        let original = &self.original_beside_impostor;
        let figure = |made: &Impostor| judge.flip(original, &judge.of_impostor(made));
        let (impostor, _) = best_crossed(self.surfaces, height, figure)?;
        let flips = judge.flips(original, &judge.of_impostor(&impostor));
        Some((impostor, flips))
    }
}
