//! Judges a level of a tree against the original: makes its row and its pictures.

use std::io::Cursor;
use std::path::Path;

use image::codecs::jpeg::JpegEncoder;
use image::{DynamicImage, ImageEncoder, RgbImage, RgbaImage};
use secateur_eval::measure::Scores;
use secateur_eval::pictures::{PictureScores, Pictures, flip_map};
use secateur_eval::{
    AsDrawn, AsDrawnMeasurement, Camera, DifferenceJudge, JudgingViews, Original, RenderOptions,
    ViewCount, framing, render,
};
use secateur_gltf::{Cutoffs, Detail, Document, Tree};
use secateur_levels::chain::filled_charts;
use secateur_levels::{ChosenCutoffs, choose_cutoffs, dilated_textures, material_changes};
use secateur_model::{Foliage, Lod, Surface};
use secateur_simplify::sphere_of;

use crate::columns::{
    CROWN_HEIGHT_COLUMN, DIFFERENCE_COLUMN, DIFFERENCE_PX, DRAWN_WIDTHS_PX, values_as_drawn,
    values_of_original,
};
use crate::files::make_folder;
use crate::job::StudyRun;
use crate::scenes::views_from;
use crate::shell;
use crate::subject::Subject;
use crate::survivor_bits::SurvivorBits;
use crate::timed::Ran;
use crate::{Case, Error, Host, Identity, JudgedLeaves, Row, StudyOptions, Values};

/// Large enough that a reader sees single leaves.
const PICTURE_WIDTH: u32 = 420;
const PICTURE_HEIGHT: u32 = 480;
const JPEG_QUALITY: u8 = 80;
/// Lower than that of pictures: differences are smooth.
const DIFFERENCE_QUALITY: u8 = 60;

/// The original of a tree, drawn once, that all its levels are compared with.
pub(crate) struct LevelJudge<'a> {
    identity: &'a Identity,
    path: &'a Path,
    tree: &'a Tree,
    folder: &'a Path,
    host: &'a dyn Host,
    original: Original<'a>,
    pictures: Pictures,
    difference: DifferenceJudge,
    /// For each of [`DRAWN_WIDTHS_PX`]; none where a paper's views judge.
    drawn: Vec<AsDrawn>,
    camera: Camera,
    portrait: RgbaImage,
}

impl<'a> LevelJudge<'a> {
    /// Draws the original, and writes its picture; `counted` is the tree's foliage as it is judged.
    pub(crate) fn new(
        subject: &'a Subject,
        tree: &'a Tree,
        counted: &'a Foliage,
        identity: &'a Identity,
        options: &'a StudyOptions,
        host: &'a dyn Host,
    ) -> Result<Self, Error> {
        let path = subject.path.as_path();
        let folder = options.folder.as_path();
        let sphere = sphere_of(tree.foliage())?;
        let mut judging = subject.judged_by.about(tree.foliage())?;
        if let Some(radii) = subject.judged_from_radii {
            let moved = judging
                .rigs
                .iter()
                .map(|rig| views_from(rig, sphere, radii));
            judging.rigs = moved.collect();
        }
        let drawn = tree.surfaces()?;
        let is_wood: Vec<bool> = drawn.iter().map(|(_, is_foliage)| !is_foliage).collect();
        let surfaces: Vec<Surface> = drawn.into_iter().map(|(surface, _)| surface).collect();
        let camera = camera(&surfaces);
        let as_drawn = |width_px| {
            let drawn = AsDrawn::new(&surfaces, &judging.rigs[0], width_px);
            match width_px <= options.frames_up_to_px {
                true => drawn.over_frames(&surfaces),
                false => drawn,
            }
        };
        let drawn = match subject.judged_by {
            JudgingViews::HeldOut => DRAWN_WIDTHS_PX.map(as_drawn).into(),
            JudgingViews::Icosahedron => Vec::new(),
        };
        let judge = Self {
            identity,
            path,
            tree,
            folder,
            host,
            pictures: Pictures::of(&surfaces, &judging.rigs),
            drawn,
            portrait: portrait(&surfaces, &camera),
            camera,
            difference: DifferenceJudge::new(surfaces, &is_wood),
            original: Original::new(counted, judging)?,
        };
        for subfolder in ["pictures", "kept"] {
            make_folder(&folder.join(subfolder))?;
        }
        let original = PictureFile::picture(identity.original_picture());
        original.write(opaque(&judge.portrait), folder, host)?;
        Ok(judge)
    }

    /// Measures a level, writes its pictures and returns its row.
    pub(crate) fn row(&self, run: StudyRun<'_>, ran: &Ran) -> Result<Row, Error> {
        let StudyRun { case, seed, .. } = run;
        let foliage = self.tree.foliage();
        let measured = match self.identity.judged_leaves {
            JudgedLeaves::AsInFile => self.original.measure_lod(&ran.lod),
            // What was made of a leaf is as solid as the leaf.
            solid @ JudgedLeaves::Solid => {
                let left = ran.lod.foliage(foliage);
                self.original.measure(&solid.of(&left))
            }
        };
        let surfaces = self.surfaces(case, ran)?;
        let judging = self.original.judging();
        let pictured = self
            .pictures
            .measure(&Pictures::of(&surfaces, &judging.rigs));
        let centre = sphere_of(foliage)?.centre;
        let judges_too = |set| judging.views_that_judge(set, centre) > 0;
        let (kept_overlap, overlap_with) = self.overlap(run, ran)?;
        let left = ran.lod.foliage(foliage);
        let mut row = Row {
            method: case.method().to_owned(),
            setting: case.setting(),
            change: case.perturbation().name(),
            seed: seed.unwrap_or(0),
            level: ran.level,
            level_of: case.level_of(),
            is_driven_by_judging_views: ran.driving.iter().any(judges_too),
            leaves_original: foliage.leaves().len() as u64,
            leaves_final: left.leaves().len() as u64,
            triangles_final: left.triangles().len() as u64,
            seconds: ran.seconds,
            peak_rss_bytes: ran.peak_rss_bytes,
            resolution: ran.resolution,
            kept_overlap,
            overlap_with,
            max_area_scale: Some(ran.max_area_scale),
            values: joined(&measured.overall, &pictured.overall),
            worst: joined(&measured.worst, &pictured.worst),
            rigs: (measured.rigs.iter().zip(&pictured.rigs))
                .map(|(counted, pictured)| joined(&counted.overall, &pictured.overall))
                .collect(),
            engine: ran.engine.clone(),
            adapter: ran.adapter.clone(),
            command: in_folder(&case.command(self.path, ran.level, seed), self.folder),
            ..Row::blank(self.identity, self.host.provenance())
        };
        let height_px = f64::from(DIFFERENCE_PX);
        let looks = (self.difference).difference(&surfaces, height_px, ViewCount::All);
        let key = DIFFERENCE_COLUMN.key.to_owned();
        row.values.insert(key, Some(looks.difference));
        let kept = crown_height(&left) / crown_height(foliage);
        let kept = Some(kept).filter(|kept| kept.is_finite());
        row.values.insert(CROWN_HEIGHT_COLUMN.key.to_owned(), kept);
        let drawn = self.drawn.iter().map(|drawn| drawn.measure(&surfaces));
        let drawn: Vec<AsDrawnMeasurement> = drawn.collect();
        row.values.extend(drawn.iter().flat_map(values_as_drawn));
        [row.original, row.original_without_mips] = values_of_original(&drawn);
        self.write_pictures(&mut row, &surfaces)?;
        Ok(row)
    }

    /// Writes the picture of a level, and that of its difference from the tree, and notes in its row where they are.
    fn write_pictures(&self, row: &mut Row, surfaces: &[Surface]) -> Result<(), Error> {
        let name = file_name(
            &self.identity.file_stem(),
            &row.label(),
            row.seed,
            row.level,
        );
        let files = [
            PictureFile::picture(format!("pictures/{name}.jpg")),
            PictureFile::difference(format!("pictures/{name}-difference.jpg")),
        ];
        let picture = portrait(surfaces, &self.camera);
        let difference = flip_map(&self.portrait, &picture);
        files[0].write(opaque(&picture), self.folder, self.host)?;
        files[1].write(difference, self.folder, self.host)?;
        [row.picture, row.difference] = files.map(|file| file.path);
        Ok(())
    }

    /// What is drawn of a level.
    fn surfaces(&self, case: &Case, ran: &Ran) -> Result<Vec<Surface>, Error> {
        let cutoffs = match case.material_change() {
            Some(change) => {
                let chosen = choose_cutoffs(self.tree, &ran.lod, change)?;
                with_material_changes(self.tree, &ran.lod, chosen)?
            }
            None => Cutoffs::default(),
        };
        surfaces_of(self.tree, self.path, &ran.lod, &cutoffs)
    }

    /// The overlap of a level's survivors with those of the reference run, and the label of that
    /// run. The survivors of the reference run itself are written to a file, for later runs.
    fn overlap(&self, run: StudyRun<'_>, ran: &Ran) -> Result<(Option<f64>, String), Error> {
        let label = run.reference.label();
        let name = file_name(&self.identity.file_stem(), &label, 0, ran.level);
        let path = self.folder.join(format!("kept/{name}.bits"));
        let own = SurvivorBits::of(&ran.lod);
        if run.is_reference() {
            own.write(self.host, &path)?;
            return Ok((None, String::new()));
        }
        let overlap = SurvivorBits::read(&path).and_then(|other| own.overlap(&other));
        let label = overlap.map_or(String::new(), |_| label);
        Ok((overlap, label))
    }
}

/// From the lowest to the highest corner of leaves, in world units; minus infinity where there are none.
fn crown_height(leaves: &Foliage) -> f64 {
    let heights = leaves
        .triangles()
        .iter()
        .flat_map(|t| t.corners.map(|c| c.y));
    let [low, high] = heights.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], y| {
        [low.min(y), high.max(y)]
    });
    high - low
}

/// A command with paths as they are seen from the study's folder, which lies elsewhere on
/// other machines. Of a file elsewhere that is given from the root on only the name stays: rows tell no
/// folders of the machine, and a tree is known by its hash.
pub(crate) fn in_folder(command: &str, folder: &Path) -> String {
    let folder = format!("{}/", folder.display());
    shell::with_words(command, |word| match word.strip_prefix(&folder) {
        Some(rest) => Some(rest.to_owned()),
        None if Path::new(word).is_absolute() => {
            let name = Path::new(word).file_name()?;
            name.to_str().map(str::to_owned)
        }
        None => None,
    })
}

/// What was chosen for materials of a level, joined with the colours of what is near in clear texels and beside charts,
/// as `simplify` does.
pub(crate) fn with_material_changes(
    tree: &Tree,
    lod: &Lod,
    chosen: Option<ChosenCutoffs>,
) -> Result<Cutoffs, Error> {
    if *lod == Lod::original(tree.foliage().leaves().len()) {
        return Ok(material_changes(chosen.as_ref(), &[]));
    }
    let level = tree.lod_document(lod)?.drawn_as_one(Detail::Color)?;
    let mut dilated = dilated_textures(tree)?;
    dilated.extend(filled_charts(
        tree.document(),
        &tree.drawn(Detail::Color)?,
        &level,
    ));
    Ok(material_changes(chosen.as_ref(), &dilated))
}

/// All that is drawn of a level of the tree in this file, with these alpha cutoffs.
pub(crate) fn surfaces_of(
    tree: &Tree,
    path: &Path,
    lod: &Lod,
    cutoffs: &Cutoffs,
) -> Result<Vec<Surface>, Error> {
    let bytes = tree.lod_to_bytes_with(lod, cutoffs)?;
    let name = path.display().to_string();
    // As `Document::open` does: where the file itself is, not a link to it.
    let place = path.canonicalize();
    let place = place.as_deref().unwrap_or(path);
    let folder = place.parent().filter(|p| !p.as_os_str().is_empty());
    let folder = folder.unwrap_or(Path::new("."));
    let memory = tree.document().memory();
    let document = Document::from_bytes_within(&name, bytes, Some(folder), memory)?;
    // No leaf may be left to select.
    let surfaces = document.surfaces(&[])?;
    Ok(surfaces.into_iter().map(|(surface, _)| surface).collect())
}

/// A file of a picture in a study's folder.
pub(crate) struct PictureFile {
    /// From the study's folder.
    pub(crate) path: String,
    quality: u8,
}

impl PictureFile {
    pub(crate) fn picture(path: String) -> Self {
        Self {
            path,
            quality: JPEG_QUALITY,
        }
    }

    pub(crate) fn difference(path: String) -> Self {
        Self {
            path,
            quality: DIFFERENCE_QUALITY,
        }
    }

    pub(crate) fn write(
        &self,
        picture: RgbImage,
        folder: &Path,
        host: &dyn Host,
    ) -> Result<(), Error> {
        let mut bytes = Cursor::new(Vec::new());
        JpegEncoder::new_with_quality(&mut bytes, self.quality)
            .write_image(
                picture.as_raw(),
                picture.width(),
                picture.height(),
                image::ExtendedColorType::Rgb8,
            )
            .map_err(|e| Error::Refused(format!("the picture cannot be encoded: {e}")))?;
        let path = folder.join(&self.path);
        let bytes = bytes.into_inner();
        host.write_file(&path, &bytes).map_err(Error::Refused)
    }
}

/// The camera of all portraits of a tree.
pub(crate) fn camera(surfaces: &[Surface]) -> Camera {
    let aspect = f64::from(PICTURE_WIDTH) / f64::from(PICTURE_HEIGHT);
    framing(surfaces, aspect)
}

pub(crate) fn portrait(surfaces: &[Surface], camera: &Camera) -> RgbaImage {
    // Shadows would cost more than all of the judging.
    let options = RenderOptions {
        shadows: false,
        ..RenderOptions::panel(PICTURE_WIDTH, PICTURE_HEIGHT)
    };
    render(surfaces, camera, &options)
}

pub(crate) fn opaque(picture: &RgbaImage) -> RgbImage {
    DynamicImage::from(picture.clone()).to_rgb8()
}

/// A file name of all that tells a row apart; `stem` stands for the tree and the program.
pub(crate) fn file_name(stem: &str, label: &str, seed: u64, level: f64) -> String {
    let plain = |c: char| match c.is_ascii_alphanumeric() || c == '.' {
        true => c,
        false => '-',
    };
    let label: String = label.chars().map(plain).collect();
    format!("{stem}-{label}-{seed}-{level}")
}

/// Scores of leaves and of pictures by their keys; those that are not finite have no value.
fn joined(counted: &Scores, pictured: &PictureScores) -> Values {
    let finite = |value: f64| value.is_finite().then_some(value);
    let counted = counted.iter().map(|(m, v)| (m.key.to_owned(), finite(v)));
    let pictured = pictured.iter().map(|(m, v)| (m.key.to_owned(), finite(v)));
    counted.chain(pictured).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn commands_tell_no_folders_of_the_machine() {
        let root = std::env::temp_dir();
        let [folder, tree] = ["s", "trees/oak.glb"].map(|path| root.join(path));
        let command = format!(
            "secateur simplify {} -o out.glb --views {}/v.json --order ../a.json",
            tree.display(),
            folder.display()
        );
        assert_eq!(
            in_folder(&command, &folder),
            "secateur simplify oak.glb -o out.glb --views v.json --order ../a.json"
        );
    }
}
