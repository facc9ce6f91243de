//! Runs `secateur measure`: judges a simplified tree against its original.

use std::path::Path;
use std::time::Instant;

use schemars::JsonSchema;
use secateur::{
    AsDrawnMeasurement, Difference, GltfError, Measurement, PictureMeasurement, Problem, Selector,
    Tree,
};
use secateur_eval::ViewCount;
use secateur_eval::measure::{RigMeasurement, Scores, VMI_ERROR_PERCENT};
use secateur_eval::pictures::{PictureRigMeasurement, PictureScores};
use secateur_model::Surface;
use serde::Serialize;

use super::args;
use super::failure::Failure;
use super::names::text;
use super::print::Printed;
use super::record::Record;
use super::simplify::warn_all;
use super::summary::grouped;
use super::{interrupt, output, record, streams};

/// How a simplified tree compares with its original.
#[derive(Serialize, JsonSchema)]
pub(crate) struct MeasureRecord {
    #[serde(flatten)]
    measured: Metrics,
    /// The original's file.
    original: String,
    /// The simplified tree's file.
    simplified: String,
    leaves: OfBoth,
    /// Triangles of the whole plant.
    triangles: OfBoth,
    /// The largest difference at the heights asked for.
    difference: f64,
    /// The largest `block_coverage` at these heights.
    block_coverage: f64,
    differences: Vec<DifferenceAt>,
    /// What has to be said of the result, a sentence each.
    warnings: Vec<String>,
    /// What a client draws, if `--as-drawn` asks for it.
    as_drawn: Option<AsDrawnMeasurement>,
    alpha: String,
    sides: String,
    /// The views that judge, as `--views` spells them.
    judged_by: String,
}

/// The metrics of foliage and of pictures: the mean over the sets of views, and what it is of.
#[derive(Serialize, JsonSchema)]
struct Metrics {
    #[serde(flatten)]
    overall: AllScores,
    /// The worst set's value of each metric; of one set alone its worst view's.
    worst: AllScores,
    /// Of each view alone, set by set.
    per_view: Vec<AllScores>,
    /// How many views were judged, of all sets.
    views: usize,
    /// Width and height of images in pixels.
    resolution: u32,
    /// Each set by itself.
    rigs: Vec<SetMetrics>,
}

/// The metrics by one set of views.
#[derive(Serialize, JsonSchema)]
struct SetMetrics {
    #[serde(flatten)]
    overall: AllScores,
    /// The worst view's value of each metric.
    worst: AllScores,
    per_view: Vec<AllScores>,
}

/// Metrics of foliage and of pictures, by their keys.
#[derive(Serialize, JsonSchema)]
struct AllScores {
    #[serde(flatten)]
    counted: Scores,
    #[serde(flatten)]
    pictured: PictureScores,
}

/// A number of the original and of the simplified tree.
#[derive(Serialize, JsonSchema)]
struct OfBoth {
    original: u64,
    simplified: u64,
}

/// The difference that people see at a height on the screen.
#[derive(Serialize, JsonSchema)]
struct DifferenceAt {
    pixels_high: f64,
    #[serde(flatten)]
    seen: Difference,
}

impl Metrics {
    fn of(counted: &Measurement, pictured: &PictureMeasurement) -> Self {
        let sets = counted.rigs.iter().zip(&pictured.rigs);
        let set = |(counted, pictured): (&RigMeasurement, &PictureRigMeasurement)| SetMetrics {
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

impl AllScores {
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

/// Compares two trees from the held-out views.
pub(crate) fn run(args: &args::Measure) -> Result<Printed, Failure> {
    let start = Instant::now();
    if let Some(report) = &args.report {
        output::check_file(report, &[&args.original, &args.simplified])?;
    }
    let open = |path: &Path, memory| {
        let document = streams::document(path, memory)?;
        Ok::<_, Failure>(document.with_vertex_alpha(args.vertex_alpha.vertex_alpha))
    };
    let named = &args.foliage.foliage;
    let original = |selectors: &[Selector]| -> Result<Result<Tree, GltfError>, Failure> {
        Ok(open(&args.original, args.memory.memory)?.into_tree(selectors))
    };
    // Of a plant without leaves all is judged as its pieces are.
    let (original, named) = match original(named)? {
        Err(error) if matches!(error.problem(), Problem::NoFoliage { .. }) => {
            (original(&[Selector::All])??, &vec![Selector::All])
        }
        other => (other?, named),
    };
    let simplified = open(&args.simplified, original.memory_left())?;
    let simplified = simplified.with_roles_of(&original).into_tree(named)?;
    let outputs: Vec<&Path> = args.report.as_deref().into_iter().collect();
    for tree in [&original, &simplified] {
        output::check_spares(tree.document(), &outputs)?;
    }
    interrupt::check()?;
    let (alpha, sides) = (args.alpha, args.sides);
    let foliages =
        [&original, &simplified].map(|tree| secateur::as_seen(tree.foliage(), alpha, sides));
    let views = args.views;
    let measured = secateur::measure_by(views, &foliages[0], &foliages[1])
        .map_err(Failure::about(&args.original))?;
    interrupt::check()?;
    let pictured = secateur::measure_pictures_by(views, &original, &simplified)
        .map_err(Failure::about(&args.original))?;
    interrupt::check()?;
    let judge = secateur::difference_judge(&original).map_err(Failure::about(&args.original))?;
    let of_simplified = simplified.surfaces()?.into_iter();
    let of_simplified: Vec<Surface> = of_simplified.map(|(surface, _)| surface).collect();
    let at = |pixels_high: &f64| {
        let seen = judge.difference(&of_simplified, *pixels_high, ViewCount::All);
        (*pixels_high, seen)
    };
    let differences: Vec<(f64, Difference)> = args.pixels_high.iter().map(at).collect();
    let worst = |of: fn(&Difference) -> f64| {
        let all = differences.iter().map(|(_, seen)| of(seen));
        all.fold(0.0, f64::max)
    };
    let difference = worst(|seen| seen.difference);
    let mut warnings = warning_of(difference);
    warnings.extend(other_place(&original, &simplified));
    warn_all(&warnings);
    let drawn = match args.as_drawn {
        Some(width_px) => {
            let drawn = secateur::measure_as_drawn(&original, &simplified, width_px);
            Some(drawn.map_err(Failure::about(&args.original))?)
        }
        None => None,
    };
    let total = start.elapsed().as_secs_f64();
    let of_height = |(pixels_high, seen): &(f64, Difference)| DifferenceAt {
        pixels_high: *pixels_high,
        seen: *seen,
    };
    let record = MeasureRecord {
        measured: Metrics::of(&measured, &pictured),
        original: args.original.display().to_string(),
        simplified: args.simplified.display().to_string(),
        leaves: OfBoth {
            original: foliages[0].leaves().len() as u64,
            simplified: foliages[1].leaves().len() as u64,
        },
        triangles: OfBoth {
            original: original.triangle_count(),
            simplified: simplified.triangle_count(),
        },
        difference,
        block_coverage: worst(|seen| seen.block_coverage),
        differences: differences.iter().map(of_height).collect(),
        warnings,
        as_drawn: drawn,
        alpha: text(args.alpha),
        sides: text(args.sides),
        judged_by: text(args.views),
    };
    let record = Record::new("measure", record, &[], total).to_value();
    record::write(args.report.as_deref(), &record)?;
    let counts = [&original, &simplified].map(|tree| tree.foliage().leaves().len() as u64);
    Ok(Printed::single(
        pretty(
            &measured,
            (&pictured, &differences),
            drawn.as_ref(),
            args,
            counts,
        ),
        record,
    ))
}

/// A sentence where a result is not as large as its original, or not where that is: by more than a fifth of the
/// largest extent.
fn other_place(original: &Tree, simplified: &Tree) -> Option<String> {
    const MOST_OFF: f64 = 0.2;
    let boxes = [original, simplified].map(|tree| tree.inspection().extents);
    let [Some(before), Some(after)] = boxes else {
        return None;
    };
    let size = |[low, high]: [[f64; 3]; 2]| (0..3).map(|k| high[k] - low[k]).fold(0.0, f64::max);
    let middle = |[low, high]: [[f64; 3]; 2], k: usize| 0.5 * (low[k] + high[k]);
    let (own, other) = (size(before), size(after));
    let moved = (0..3).map(|k| (middle(after, k) - middle(before, k)).abs());
    let moved = moved.fold(0.0, f64::max);
    let is_off = (other - own).abs() > MOST_OFF * own || moved > MOST_OFF * own;
    is_off.then(|| {
        format!(
            "the two files do not hold the same plant: the original is {own:.3} units large, the other {other:.3}, and its middle is {moved:.3} units off"
        )
    })
}

/// A sentence where a result is another plant.
pub(crate) fn warning_of(difference: f64) -> Vec<String> {
    let is_another = difference > Difference::ANOTHER_PLANT;
    is_another
        .then(|| another_plant(difference))
        .into_iter()
        .collect()
}

/// That a result is another plant.
pub(crate) fn another_plant(difference: f64) -> String {
    let most = Difference::ANOTHER_PLANT;
    format!(
        "the result looks like another plant: its difference is {difference:.2}, where above {most} it is coarser than for backgrounds"
    )
}

/// Metrics of the summary: name, key, and what they say.
const METRICS: [(&str, &str, &str); 7] = [
    (
        "VMI error",
        "vmi_error_percent",
        "information lost, less is better",
    ),
    (
        "silhouette IoU",
        "silhouette_iou",
        "overlap of the outlines, 1 is best",
    ),
    (
        "precision",
        "precision",
        "pixels of the result that the original has too",
    ),
    (
        "recall",
        "recall",
        "pixels of the original that the result still has",
    ),
    (
        "coverage",
        "coverage_ratio",
        "pixels of the result over those of the original",
    ),
    ("SSIM", "ssim", "likeness of shaded pictures, 1 is best"),
    (
        "FLIP",
        "flip_mean",
        "visible difference of shaded pictures, 0 is best",
    ),
];

fn pretty(
    measured: &Measurement,
    (pictured, differences): (&PictureMeasurement, &[(f64, Difference)]),
    drawn: Option<&AsDrawnMeasurement>,
    args: &args::Measure,
    leaves: [u64; 2],
) -> String {
    let sets = measured.rigs.len();
    // The worst of several sets; of one, whose worst is a view, nothing.
    let line = |name: &str, [mean, worst]: [String; 2], what: &str| match sets {
        1 => format!("  {name:<14}  {mean:>10}   {what}\n"),
        _ => format!("  {name:<14}  {mean:>10}  {worst:>10}   {what}\n"),
    };
    let metric = |(name, key, what): (&str, &str, &str)| {
        let text = |(counted, pictured): (&Scores, &PictureScores)| match counted
            .get(key)
            .or(pictured.get(key))
            .unwrap_or(f64::NAN)
        {
            percent if key == VMI_ERROR_PERCENT.key => format!("{percent:.2} %"),
            value => format!("{value:.4}"),
        };
        let overall = text((&measured.overall, &pictured.overall));
        line(
            name,
            [overall, text((&measured.worst, &pictured.worst))],
            what,
        )
    };
    let [before, after] = leaves.map(grouped);
    let (each, side) = (measured.views / sets.max(1), measured.resolution);
    let views = match sets {
        1 => format!("{each} views of {side} x {side} pixels"),
        _ => format!("{sets} sets of {each} views of {side} x {side} pixels: mean and worst set"),
    };
    let mut lines = vec![line(
        "leaves",
        [after, String::new()],
        &format!("of {before}"),
    )];
    lines.extend(METRICS.map(metric));
    for (pixels_high, seen) in differences {
        let what = format!(
            "what people see {pixels_high} pixels high: up to .18 cannot be told, .28 is good, .5 is coarse; coverage of the worst block is {:.3} off",
            seen.block_coverage
        );
        lines.push(line(
            "difference",
            [format!("{:.4}", seen.difference), String::new()],
            &what,
        ));
    }
    if let Some(drawn) = drawn {
        let at = format!("as clients draw it {} pixels wide", drawn.width_px);
        let without = drawn.original_without_mips;
        let mut row = |name: &str, value: String, what: String| {
            lines.push(line(name, [value, String::new()], &what));
        };
        let original = |with: String, without: String| {
            format!("the original itself: {with}, without mip maps {without}")
        };
        let four = |value: f64| format!("{value:.4}");
        let one = |value: f64| format!("{value:.1}");
        row(
            "drawn coverage",
            four(drawn.coverage_over_truth),
            format!(
                "{at}, over the original's true coverage; {}",
                original(
                    four(drawn.original_coverage_over_truth),
                    four(without.coverage_over_truth)
                )
            ),
        );
        row(
            "drawn IoU",
            four(drawn.truth_iou),
            format!(
                "overlap {at} with what the original truly covers, 1 is best; {}",
                original(four(drawn.original_truth_iou), four(without.truth_iou))
            ),
        );
        if let (Some(own), Some(original)) = (drawn.over_frames, drawn.original_over_frames) {
            row(
                "IoU, frames",
                four(own.truth_iou),
                format!(
                    "the same in the mean of {} frames, as temporal anti-aliasing shows it; the original itself: {}",
                    own.frames,
                    four(original.truth_iou)
                ),
            );
        }
        row(
            "specks",
            one(drawn.specks_per_view),
            format!(
                "islands of up to 3 pixels in a view {at}; {}",
                original(
                    one(drawn.original_specks_per_view),
                    one(without.specks_per_view)
                )
            ),
        );
        row(
            "drawn FLIP",
            four(drawn.flip_mean),
            format!(
                "visible difference {at} from the truth; {}",
                original(four(drawn.original_flip_mean), four(without.flip_mean))
            ),
        );
        if let (Some(own), Some(original)) = (drawn.over_frames, drawn.original_over_frames) {
            row(
                "FLIP, frames",
                four(own.flip_mean),
                format!(
                    "the same in the mean of {} frames; the original itself: {}",
                    own.frames,
                    four(original.flip_mean)
                ),
            );
            row(
                "flicker",
                four(own.flicker),
                format!(
                    "pixels that one frame shows and another does not, over those truly covered; the original itself: {}, without mip maps {}",
                    four(original.flicker),
                    four(original.truth_flicker)
                ),
            );
        }
    }
    format!(
        "{} against {}, from {views}\n{}",
        args.simplified.display(),
        args.original.display(),
        lines.concat()
    )
}
