//! Two plants side by side, judged from views that no simplifier sees.

use std::fmt;

use secateur_eval::measure::{RigMeasurement, Scores};
use secateur_eval::pictures::{PictureRigMeasurement, PictureScores};
use secateur_eval::{
    AsDrawnMeasurement, Difference, DifferenceJudge, JudgingViews, Measurement, PictureMeasurement,
    Pictures, ViewCount,
};
use secateur_gltf::{Document, Selector, Tree};
use secateur_model::Surface;
use secateur_simplify::whole::WoodMode;
use secateur_simplify::{Alpha, Sides, as_seen, sphere_of};
use serde::{Deserialize, Serialize};

use crate::{Error, LevelWarning, Plant};

/// How two plants are judged. The usual views are four sets of 12, none near a view that drives.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default)]
pub struct JudgeOptions {
    /// From where [`Judged::figures`] are taken.
    pub views: JudgingViews,
    /// Whether holes of leaf textures count in figures of leaves.
    pub alpha: Alpha,
    /// From which sides leaves are seen in figures of leaves.
    pub sides: Sides,
}

/// Judges another file of a plant: a level of it, made by whatever program. What its parts are, leaves or wood, the
/// plant says by the names of materials and nodes.
///
/// # Errors
/// [`Error`] if what is drawn of either can't be read, or the plant has no leaf and no wood.
pub fn judge(plant: &Plant, other: &Plant) -> Result<Judged, Error> {
    let other = other.tree().document().clone();
    judge_document(plant, other, &JudgeOptions::default())
}

/// As [`judge`], with options, of a file in which leaves need not be found.
///
/// # Errors
/// As [`judge`].
pub fn judge_document(
    plant: &Plant,
    other: Document,
    options: &JudgeOptions,
) -> Result<Judged, Error> {
    let plant = match plant.leaves().leaves() {
        // All of a plant without leaves is judged as its pieces are.
        [] => {
            let document = plant.tree().document().clone();
            Plant::of_decided(document, &[Selector::All], WoodMode::Ignore)?
        }
        _ => plant.clone(),
    };
    let original = plant.tree();
    let selectors = original.document().selectors();
    let other = other.with_roles_of(original).into_tree(selectors)?;
    sphere_of(plant.leaves())?;
    Ok(Judged {
        difference: difference_judge(original)?,
        shown: surfaces(&other)?,
        plant,
        other,
        options: *options,
    })
}

/// A plant and another file of it, to be compared.
#[derive(Debug)]
pub struct Judged {
    plant: Plant,
    other: Tree,
    options: JudgeOptions,
    difference: DifferenceJudge,
    /// All that is drawn of the other.
    shown: Vec<Surface>,
}

impl Judged {
    /// The plant whose leaves and wood are taken as they are: as it was opened, or all of it as leaves where it has none.
    pub fn plant(&self) -> &Plant {
        &self.plant
    }

    /// The other file, with the leaves and the wood of the plant.
    pub fn other(&self) -> &Tree {
        &self.other
    }

    /// How far the other looks from the plant where the screen shows the plant's largest extent as so many pixels, 8 to
    /// 100,000: the [`Difference`] that levels are chosen by.
    pub fn difference_at(&self, pixels_high: f64) -> Difference {
        let all = ViewCount::All;
        self.difference.difference(&self.shown, pixels_high, all)
    }

    /// How far the other looks from the plant at each of these heights, and the largest of them; see
    /// [`difference_at`](Self::difference_at).
    pub fn differences_at(&self, pixels_high: &[f64]) -> Differences {
        let at = |pixels_high: &f64| DifferenceAt {
            pixels_high: *pixels_high,
            seen: self.difference_at(*pixels_high),
        };
        let differences: Vec<DifferenceAt> = pixels_high.iter().map(at).collect();
        let worst = |of: fn(&Difference) -> f64| {
            let all = differences.iter().map(|at| of(&at.seen));
            all.fold(0.0, f64::max)
        };
        Differences {
            difference: worst(|seen| seen.difference),
            block_coverage: worst(|seen| seen.block_coverage),
            differences,
        }
    }

    /// The figures of `secateur measure`: of leaves counted in images, and of shaded pictures of all. Takes seconds.
    ///
    /// # Errors
    /// [`Error`] if what is drawn of the plant can't be read any more.
    pub fn figures(&self) -> Result<Figures, Error> {
        let JudgeOptions {
            views,
            alpha,
            sides,
        } = self.options;
        let leaves = [self.plant.leaves(), self.other.foliage()];
        let [before, after] = leaves.map(|leaves| as_seen(leaves, alpha, sides));
        let judging = views.about(&before)?;
        let counted = secateur_eval::measure(&before, &after, &judging)?;
        let judging = views.about(leaves[0])?;
        let original = Pictures::of(&surfaces(self.plant.tree())?, &judging.rigs);
        let pictured = original.measure(&Pictures::of(&self.shown, &judging.rigs));
        Ok(Figures::of(&counted, &pictured))
    }

    /// What a client draws of the other, in pictures of `width_px` x `width_px` pixels from the first of the held-out
    /// sets of views: with mip maps, the alpha test at each pixel's middle, and back faces culled; and in the mean of
    /// frames, which takes most of the time. The truth is the plant with many samples a pixel and without mip maps.
    ///
    /// # Errors
    /// As [`figures`](Self::figures).
    ///
    /// # Panics
    /// If `width_px` is 0.
    pub fn as_drawn(&self, width_px: u32) -> Result<AsDrawnMeasurement, Error> {
        let judging = JudgingViews::HeldOut.about(self.plant.leaves())?;
        let original = surfaces(self.plant.tree())?;
        let views = &judging.rigs[0];
        Ok(secateur_eval::measure_as_drawn(
            &original,
            &self.shown,
            views,
            width_px,
        ))
    }

    /// What has to be said of the other, where it differs so much: that it looks like another plant, or lies elsewhere.
    pub fn warnings(&self, seen: &Differences) -> Vec<String> {
        let looks = LevelWarning::of_difference(seen.difference).map(|warning| warning.to_string());
        let lies = self.misplaced().map(|misplaced| misplaced.to_string());
        looks.into_iter().chain(lies).collect()
    }

    /// How the other lies beside the plant, if it is more than a fifth of the plant's largest extent off, or so much
    /// larger or smaller: then it is another plant.
    pub fn misplaced(&self) -> Option<Misplaced> {
        let of_other = self.other.inspection().extents;
        let (before, after) = (self.plant.inspection().extents?, of_other?);
        let size =
            |[low, high]: [[f64; 3]; 2]| (0..3).map(|k| high[k] - low[k]).fold(0.0, f64::max);
        let middle = |[low, high]: [[f64; 3]; 2], k: usize| 0.5 * (low[k] + high[k]);
        let moved = (0..3).map(|k| (middle(after, k) - middle(before, k)).abs());
        let found = Misplaced {
            size: size(before),
            other_size: size(after),
            moved: moved.fold(0.0, f64::max),
        };
        let most = Misplaced::MOST * found.size;
        let is_misplaced = (found.other_size - found.size).abs() > most || found.moved > most;
        is_misplaced.then_some(found)
    }
}

/// The differences that people see at some heights on the screen.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
pub struct Differences {
    /// The largest difference at the heights asked for.
    pub difference: f64,
    /// The largest `block_coverage` at these heights.
    pub block_coverage: f64,
    /// The difference at each height.
    pub differences: Vec<DifferenceAt>,
}

/// The difference that people see at a height on the screen.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
pub struct DifferenceAt {
    /// How many pixels high the screen shows the plant.
    pub pixels_high: f64,
    /// The difference there.
    #[serde(flatten)]
    pub seen: Difference,
}

/// Two files that do not hold the same plant. Prints as a sentence.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Misplaced {
    /// The largest extent of the plant along an axis, in world units.
    pub size: f64,
    /// The size of the other.
    pub other_size: f64,
    /// How far the middle of the other is off, along the axis where it is farthest.
    pub moved: f64,
}

impl Misplaced {
    /// Above which share of the plant's largest extent it is no matter of coarser leaves.
    const MOST: f64 = 0.2;
}

impl fmt::Display for Misplaced {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            size,
            other_size,
            moved,
        } = self;
        write!(
            f,
            "the two files do not hold the same plant: the original is {size:.3} units large, the other {other_size:.3}, and its middle is {moved:.3} units off"
        )
    }
}

/// The figures of leaves and of pictures: the mean over the sets of views, and what it is of.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
pub struct Figures {
    /// The mean over the sets of views.
    #[serde(flatten)]
    pub overall: AllScores,
    /// The worst set's value of each metric; of one set alone its worst view's.
    pub worst: AllScores,
    /// Of each view alone, set by set.
    pub per_view: Vec<AllScores>,
    /// How many views were judged, of all sets.
    pub views: usize,
    /// Width and height of images in pixels.
    pub resolution: u32,
    /// Each set by itself.
    pub rigs: Vec<SetFigures>,
}

/// The figures by one set of views.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
pub struct SetFigures {
    /// The mean over its views.
    #[serde(flatten)]
    pub overall: AllScores,
    /// The worst view's value of each metric.
    pub worst: AllScores,
    /// Of each view alone.
    pub per_view: Vec<AllScores>,
}

/// Metrics of leaves and of pictures, by their keys.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
pub struct AllScores {
    #[serde(flatten)]
    counted: Scores,
    #[serde(flatten)]
    pictured: PictureScores,
}

impl AllScores {
    /// The value of a metric by its key, such as `vmi_error_percent` or `flip_mean`; none where there is no such metric.
    pub fn get(&self, key: &str) -> Option<f64> {
        self.counted.get(key).or_else(|| self.pictured.get(key))
    }

    fn of((counted, pictured): (&Scores, &PictureScores)) -> Self {
        Self {
            counted: counted.clone(),
            pictured: pictured.clone(),
        }
    }

    fn of_all(counted: &[Scores], pictured: &[PictureScores]) -> Vec<Self> {
        counted.iter().zip(pictured).map(Self::of).collect()
    }
}

impl Figures {
    fn of(counted: &Measurement, pictured: &PictureMeasurement) -> Self {
        let sets = counted.rigs.iter().zip(&pictured.rigs);
        let set = |(counted, pictured): (&RigMeasurement, &PictureRigMeasurement)| SetFigures {
            overall: AllScores::of((&counted.overall, &pictured.overall)),
            worst: AllScores::of((&counted.worst, &pictured.worst)),
            per_view: AllScores::of_all(&counted.per_view, &pictured.per_view),
        };
        Self {
            overall: AllScores::of((&counted.overall, &pictured.overall)),
            worst: AllScores::of((&counted.worst, &pictured.worst)),
            per_view: AllScores::of_all(&counted.per_view, &pictured.per_view),
            views: counted.views,
            resolution: counted.resolution,
            rigs: sets.map(set).collect(),
        }
    }
}

/// What judges any number of heights and levels against a plant.
pub(crate) fn difference_judge(original: &Tree) -> Result<DifferenceJudge, Error> {
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
