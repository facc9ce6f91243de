//! Judges a level of a whole plant by pictures: its row.

use std::path::Path;

use image::RgbaImage;
use secateur_eval::measure::SILHOUETTE_IOU;
use secateur_eval::pictures::{PictureScores, WholePictures, flip_map};
use secateur_eval::{Camera, Judging};
use secateur_gltf::WholeTree;
use secateur_model::Surface;

use super::{PlantOutcome, WholeCounts, WholeJob, count};
use crate::judge::{self, PictureFile, file_name, opaque, portrait};
use crate::subject::Subject;
use crate::{Error, Host, Identity, Row, Values};

/// The original, drawn once, that all levels are compared with.
pub(super) struct PlantJudge<'a> {
    identity: &'a Identity,
    folder: &'a Path,
    host: &'a dyn Host,
    judging: Judging,
    pictures: WholePictures,
    camera: Camera,
    portrait: RgbaImage,
    leaves_original: u64,
    pub(super) triangles_original: u64,
}

impl<'a> PlantJudge<'a> {
    pub(super) fn new(
        subject: &Subject,
        tree: &WholeTree,
        identity: &'a Identity,
        folder: &'a Path,
        host: &'a dyn Host,
    ) -> Result<Self, Error> {
        let judging = subject.judged_by.about(tree.leaves())?;
        let surfaces = tree.items().surfaces()?.into_iter();
        let surfaces: Vec<Surface> = surfaces.map(|(surface, _)| surface).collect();
        let camera = judge::camera(&surfaces);
        let judge = Self {
            identity,
            folder,
            host,
            pictures: WholePictures::of(&surfaces, &judging.rigs),
            portrait: portrait(&surfaces, &camera),
            camera,
            judging,
            leaves_original: tree.leaves().leaves().len() as u64,
            triangles_original: count(&surfaces),
        };
        crate::files::make_folder(&folder.join("pictures"))?;
        let original = PictureFile::picture(identity.original_picture());
        original.write(opaque(&judge.portrait), folder, host)?;
        Ok(judge)
    }

    /// Measures a level, writes its pictures and returns its row.
    pub(super) fn row(&self, job: WholeJob, made: &PlantOutcome) -> Result<Row, Error> {
        let drawn = WholePictures::of(&made.surfaces, &self.judging.rigs);
        let measured = self.pictures.measure(&drawn);
        let ious = &measured.outline_iou;
        let joined = |pictured: &PictureScores, iou: f64| -> Values {
            let pictured = pictured.iter().map(|(m, v)| (m.key, v));
            let all = pictured.chain([(SILHOUETTE_IOU.key, iou)]);
            all.map(|(key, value)| (key.to_owned(), value.is_finite().then_some(value)))
                .collect()
        };
        let mean = ious.iter().sum::<f64>() / ious.len() as f64;
        let least = ious.iter().copied().fold(f64::INFINITY, f64::min);
        let rigs = measured.pictures.rigs.iter().zip(ious);
        let [method, setting] = job.case.method_and_setting().map(str::to_owned);
        let label = format!("whole {method} {setting}");
        let name = file_name(&self.identity.file_stem(), &label, 0, job.level);
        let files = [
            PictureFile::picture(format!("pictures/{name}.jpg")),
            PictureFile::difference(format!("pictures/{name}-difference.jpg")),
        ];
        let picture = portrait(&made.surfaces, &self.camera);
        let difference = flip_map(&self.portrait, &picture);
        files[0].write(opaque(&picture), self.folder, self.host)?;
        files[1].write(difference, self.folder, self.host)?;
        let [picture, difference] = files.map(|file| file.path);
        Ok(Row {
            method,
            setting,
            level: job.level,
            leaves_original: self.leaves_original,
            leaves_final: made.leaves_final,
            triangles_final: made.triangles(),
            whole: Some(WholeCounts {
                triangles_original: self.triangles_original,
                wood_triangles_final: made.wood_triangles_final,
            }),
            seconds: made.seconds,
            peak_rss_bytes: made.peak_rss_bytes,
            resolution: made.resolution,
            values: joined(&measured.pictures.overall, mean),
            worst: joined(&measured.pictures.worst, least),
            rigs: rigs.map(|(rig, iou)| joined(&rig.overall, *iou)).collect(),
            engine: made.engine.clone(),
            adapter: made.adapter.clone(),
            command: judge::in_folder(&made.command, self.folder),
            picture,
            difference,
            ..Row::blank(self.identity, self.host.provenance())
        })
    }
}
