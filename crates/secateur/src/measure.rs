//! Judging by views that no simplifier sees.

use secateur_eval::{
    AsDrawnMeasurement, Difference, DifferenceJudge, JudgingViews, Measurement, PictureMeasurement,
    Pictures, ViewCount,
};
use secateur_gltf::Tree;
use secateur_model::{Foliage, Surface};

use secateur_simplify::sphere_of;

use crate::Error;

/// Measures a simplified foliage against its original from the held-out views:
/// four icosahedra about the original, 512 x 512, each by itself.
///
/// Leaf numbers need not correspond: both are drawn and counted on their own.
/// [`eval::measure`](secateur_eval::measure()) takes other views.
///
/// # Errors
/// [`Error`] if the original has no leaf or is out of range.
pub fn measure(original: &Foliage, simplified: &Foliage) -> Result<Measurement, Error> {
    measure_by(JudgingViews::HeldOut, original, simplified)
}

/// [`measure`] from views of one's choice.
///
/// # Errors
/// As [`measure`].
pub fn measure_by(
    views: JudgingViews,
    original: &Foliage,
    simplified: &Foliage,
) -> Result<Measurement, Error> {
    sphere_of(original)?;
    let judging = views.about(original)?;
    Ok(secateur_eval::measure(original, simplified, &judging)?)
}

/// Measures what a simplified tree looks like against its original, wood
/// included, in shaded pictures from the same held-out views.
///
/// # Errors
/// [`Error`] if the original has no leaf or is out of range, or a tree has too
/// much in it to be drawn.
pub fn measure_pictures(original: &Tree, simplified: &Tree) -> Result<PictureMeasurement, Error> {
    measure_pictures_by(JudgingViews::HeldOut, original, simplified)
}

/// [`measure_pictures`] from views of one's choice.
///
/// # Errors
/// As [`measure_pictures`].
pub fn measure_pictures_by(
    views: JudgingViews,
    original: &Tree,
    simplified: &Tree,
) -> Result<PictureMeasurement, Error> {
    sphere_of(original.foliage())?;
    let judging = views.about(original.foliage())?;
    let pictures = |tree: &Tree| -> Result<Pictures, Error> {
        Ok(Pictures::of(&surfaces(tree)?, &judging.rigs))
    };
    Ok(pictures(original)?.measure(&pictures(simplified)?))
}

/// Measures what a client draws of a simplified tree, in pictures of `width_px` x `width_px` pixels
/// from the first of the held-out sets of views: with mip maps, the alpha test at each pixel's middle, and back
/// faces culled; and in the mean of frames, which takes most of the time. The truth is the original with many
/// samples a pixel and without mip maps.
///
/// # Errors
/// As [`measure_pictures`].
///
/// # Panics
/// If `width_px` is 0.
pub fn measure_as_drawn(
    original: &Tree,
    simplified: &Tree,
    width_px: u32,
) -> Result<AsDrawnMeasurement, Error> {
    sphere_of(original.foliage())?;
    let judging = JudgingViews::HeldOut.about(original.foliage())?;
    let [original, simplified] = [surfaces(original)?, surfaces(simplified)?];
    let views = &judging.rigs[0];
    Ok(secateur_eval::measure_as_drawn(
        &original,
        &simplified,
        views,
        width_px,
    ))
}

/// How far a simplified tree looks from its original where the screen shows the original's largest extent as so many
/// pixels: the [`Difference`] that levels of detail are chosen by.
///
/// # Errors
/// [`Error`] if what is drawn of either can't be read.
pub fn difference_at(
    original: &Tree,
    simplified: &Tree,
    pixels_high: f64,
) -> Result<Difference, Error> {
    let judge = difference_judge(original)?;
    Ok(judge.difference(&surfaces(simplified)?, pixels_high, ViewCount::All))
}

/// What judges [`difference_at`] any number of heights and levels.
///
/// # Errors
/// [`Error`] if what is drawn of the original can't be read.
pub fn difference_judge(original: &Tree) -> Result<DifferenceJudge, Error> {
    let drawn = original.surfaces()?;
    let is_wood: Vec<bool> = drawn.iter().map(|(_, is_foliage)| !is_foliage).collect();
    let surfaces = drawn.into_iter().map(|(surface, _)| surface).collect();
    Ok(DifferenceJudge::new(surfaces, &is_wood))
}

/// All that is drawn of a tree, wood included.
fn surfaces(tree: &Tree) -> Result<Vec<Surface>, Error> {
    let surfaces = tree.surfaces()?.into_iter().map(|(surface, _)| surface);
    Ok(surfaces.collect())
}
