//! A level, judged: its row and its picture.

use std::io::Cursor;
use std::path::{Path, PathBuf};

use image::codecs::jpeg::JpegEncoder;
use image::{DynamicImage, ImageEncoder};
use secateur::eval::measure::Scores;
use secateur::eval::pictures::{PictureScores, Pictures};
use secateur::eval::study::{Row, Values};
use secateur::eval::{Camera, Judging, RenderOptions, framing, measure_lod, render};
use secateur::{Document, Lod, Surface, Tree, sphere_of};

use super::super::failure::Failure;
use super::super::{machine, output};
use super::plan::Case;

const PICTURE_WIDTH: u32 = 280;
const PICTURE_HEIGHT: u32 = 320;
const JPEG_QUALITY: u8 = 85;

/// A level that a method reached.
pub(super) struct Ran {
    pub(super) level: f64,
    pub(super) lod: Lod,
    /// Of the method alone.
    pub(super) seconds: f64,
    /// 0 for methods that see no pixels.
    pub(super) resolution: u32,
    pub(super) engine: String,
    pub(super) adapter: Option<String>,
}

/// What results of one tree are held against.
pub(super) struct Judge<'a> {
    name: &'a str,
    path: &'a Path,
    tree: &'a Tree,
    folder: &'a Path,
    judging: Judging,
    pictures: Pictures,
    camera: Camera,
}

impl<'a> Judge<'a> {
    /// Draws the original, and writes its picture.
    pub(super) fn new(
        name: &'a str,
        path: &'a Path,
        tree: &'a Tree,
        folder: &'a Path,
    ) -> Result<Self, Failure> {
        sphere_of(tree.foliage()).map_err(Failure::about(path))?;
        let judging = Judging::held_out(tree.foliage()).map_err(secateur::Error::from)?;
        let surfaces: Vec<Surface> = tree.surfaces()?.into_iter().map(|(s, _)| s).collect();
        let judge = Self {
            name,
            path,
            tree,
            folder,
            pictures: Pictures::of(&surfaces, &judging.views),
            camera: framing(
                &surfaces,
                f64::from(PICTURE_WIDTH) / f64::from(PICTURE_HEIGHT),
            ),
            judging,
        };
        output::make_folder(&folder.join("pictures"))?;
        judge.write_picture(&surfaces, &format!("pictures/{name}-original.jpg"))?;
        Ok(judge)
    }

    /// The row of a level, its picture written.
    pub(super) fn row(&self, case: &Case, seed: Option<u64>, ran: &Ran) -> Result<Row, Failure> {
        let foliage = self.tree.foliage();
        let measured =
            measure_lod(foliage, &ran.lod, &self.judging).map_err(secateur::Error::from)?;
        let surfaces = self.surfaces(&ran.lod)?;
        let pictured = self
            .pictures
            .measure(&Pictures::of(&surfaces, &self.judging.views));
        let joined = |counted: &Scores, pictured: &PictureScores| {
            let finite = |value: f64| value.is_finite().then_some(value);
            let counted = counted.iter().map(|(m, v)| (m.key.to_owned(), finite(v)));
            let pictured = pictured.iter().map(|(m, v)| (m.key.to_owned(), finite(v)));
            counted.chain(pictured).collect::<Values>()
        };
        let left = ran.lod.foliage(foliage);
        let mut row = Row {
            tree: self.name.to_owned(),
            method: case.method.clone(),
            setting: case.setting(),
            change: case.perturbation.name(),
            seed: seed.unwrap_or(0),
            level: ran.level,
            leaves_original: foliage.leaves().len() as u64,
            leaves_final: left.leaves().len() as u64,
            triangles_final: left.triangles().len() as u64,
            seconds: ran.seconds,
            resolution: ran.resolution,
            values: joined(&measured.overall, &pictured.overall),
            worst: joined(&measured.worst, &pictured.worst),
            per_view: (measured.per_view.iter().zip(&pictured.per_view))
                .map(|(counted, pictured)| joined(counted, pictured))
                .collect(),
            engine: ran.engine.clone(),
            adapter: ran.adapter.clone(),
            version: env!("CARGO_PKG_VERSION").to_owned(),
            commit: machine::commit().unwrap_or("unknown").to_owned(),
            machine: machine::name(),
            command: case.command(self.path, ran.level, seed),
            picture: String::new(),
        };
        row.picture = picture_path(&row);
        self.write_picture(&surfaces, &row.picture)?;
        Ok(row)
    }

    fn surfaces(&self, lod: &Lod) -> Result<Vec<Surface>, Failure> {
        let bytes = self.tree.lod_to_bytes(lod)?;
        let folder = self.path.parent().filter(|p| !p.as_os_str().is_empty());
        let folder = folder.unwrap_or(Path::new("."));
        let name = self.path.display().to_string();
        let document = Document::from_bytes(&name, bytes, Some(folder))?;
        // No leaf may be left to select.
        let surfaces = document.surfaces(&[])?;
        Ok(surfaces.into_iter().map(|(surface, _)| surface).collect())
    }

    fn write_picture(&self, surfaces: &[Surface], path: &str) -> Result<(), Failure> {
        // Shadows would cost more than all of the judging.
        let options = RenderOptions {
            shadows: false,
            ..RenderOptions::panel(PICTURE_WIDTH, PICTURE_HEIGHT)
        };
        let picture = DynamicImage::from(render(surfaces, &self.camera, &options)).to_rgb8();
        let mut bytes = Cursor::new(Vec::new());
        JpegEncoder::new_with_quality(&mut bytes, JPEG_QUALITY)
            .write_image(
                picture.as_raw(),
                picture.width(),
                picture.height(),
                image::ExtendedColorType::Rgb8,
            )
            .map_err(|e| Failure(format!("the picture cannot be encoded: {e}")))?;
        let path: PathBuf = self.folder.join(path);
        output::write_file(&path, &bytes.into_inner())
    }
}

/// A file name of all that tells the row apart.
fn picture_path(row: &Row) -> String {
    let slug = |text: &str| {
        let plain = |c: char| {
            if c.is_ascii_alphanumeric() || c == '.' {
                c
            } else {
                '-'
            }
        };
        text.chars().map(plain).collect::<String>()
    };
    format!(
        "pictures/{}-{}-{}-{}.jpg",
        row.tree,
        slug(&row.label()),
        row.seed,
        row.level
    )
}
