//! Runs `secateur measure`: judges a simplified tree against its original.

use std::path::Path;

use schemars::JsonSchema;
use secateur::{
    AllScores, AsDrawnMeasurement, DifferenceAt, Differences, Figures, JudgeOptions, Judged,
    Opening, Problem, Selector, WoodMode, judge_document,
};
use secateur_eval::measure::VMI_ERROR_PERCENT;
use serde::Serialize;

use super::advice::warn_all;
use super::args;
use super::failure::Failure;
use super::names::text;
use super::print::Printed;
use super::summary::grouped;
use super::work::Work;
use super::{interrupt, output, streams};

/// How a simplified tree compares with its original.
#[derive(Serialize, JsonSchema)]
pub(crate) struct MeasureRecord {
    #[serde(flatten)]
    figures: Figures,
    /// The original's file.
    original: String,
    /// The simplified tree's file.
    simplified: String,
    leaves: OfBoth,
    /// Triangles of the whole plant.
    triangles: OfBoth,
    #[serde(flatten)]
    differences: Differences,
    /// What has to be said of the result, a sentence each.
    warnings: Vec<String>,
    /// What a client draws, if `--as-drawn` asks for it.
    as_drawn: Option<AsDrawnMeasurement>,
    alpha: String,
    sides: String,
    /// The views that judge, as `--views` spells them.
    judged_by: String,
}

/// A number of the original and of the simplified tree.
#[derive(Serialize, JsonSchema)]
struct OfBoth {
    original: u64,
    simplified: u64,
}

/// Compares two trees from the held-out views.
pub(crate) fn run(args: &args::Measure) -> Result<Printed, Failure> {
    let work = Work::on("measure");
    if let Some(report) = &args.report {
        output::check_file(report, &[&args.original, &args.simplified])?;
    }
    let judged = judged(args)?;
    interrupt::check()?;
    let figures = judged.figures().map_err(Failure::about(&args.original))?;
    interrupt::check()?;
    let differences = judged.differences_at(&args.pixels_high);
    let warnings = judged.warnings(&differences);
    warn_all(&warnings);
    interrupt::check()?;
    let drawn = args.as_drawn.map(|width_px| judged.as_drawn(width_px));
    let drawn = drawn.transpose().map_err(Failure::about(&args.original))?;
    let (plant, other) = (judged.plant(), judged.other());
    let leaves = OfBoth {
        original: plant.leaves().leaves().len() as u64,
        simplified: other.foliage().leaves().len() as u64,
    };
    let pretty = pretty(
        &figures,
        &differences.differences,
        drawn.as_ref(),
        args,
        &leaves,
    );
    let record = MeasureRecord {
        figures,
        original: args.original.display().to_string(),
        simplified: args.simplified.display().to_string(),
        leaves,
        triangles: OfBoth {
            original: plant.triangle_count(),
            simplified: other.triangle_count(),
        },
        differences,
        warnings,
        as_drawn: drawn,
        alpha: text(args.alpha),
        sides: text(args.sides),
        judged_by: text(args.views),
    };
    let (record, _) = work.record(record);
    work.finish(args.report.as_deref(), &record)?;
    Ok(Printed::single(pretty, record))
}

/// Both trees, side by side.
fn judged(args: &args::Measure) -> Result<Judged, Failure> {
    let usual = args.plant.opening(WoodMode::Ignore);
    let original = match streams::opened(&args.original, &usual)? {
        Err(error) if matches!(error.problem(), Problem::NoFoliage { .. }) => {
            let foliage = vec![Selector::All];
            streams::plant(&args.original, &Opening { foliage, ..usual })?
        }
        other => other?,
    };
    let left = original.tree().memory_left();
    let simplified = streams::document(&args.simplified, left)?;
    let simplified = simplified.with_vertex_alpha(args.plant.vertex_alpha());
    let outputs: Vec<&Path> = args.report.as_deref().into_iter().collect();
    for document in [original.tree().document(), &simplified] {
        output::check_spares(document, &outputs)?;
    }
    let options = JudgeOptions {
        views: args.views,
        alpha: args.alpha,
        sides: args.sides,
    };
    judge_document(&original, simplified, &options).map_err(Failure::about(&args.original))
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
    figures: &Figures,
    differences: &[DifferenceAt],
    drawn: Option<&AsDrawnMeasurement>,
    args: &args::Measure,
    leaves: &OfBoth,
) -> String {
    let sets = figures.rigs.len();
    // The worst of several sets; of one, whose worst is a view, nothing.
    let line = |name: &str, [mean, worst]: [String; 2], what: &str| match sets {
        1 => format!("  {name:<14}  {mean:>10}   {what}\n"),
        _ => format!("  {name:<14}  {mean:>10}  {worst:>10}   {what}\n"),
    };
    let metric = |(name, key, what): (&str, &str, &str)| {
        let text = |scores: &AllScores| match scores.get(key).unwrap_or(f64::NAN) {
            percent if key == VMI_ERROR_PERCENT.key => format!("{percent:.2} %"),
            value => format!("{value:.4}"),
        };
        let values = [&figures.overall, &figures.worst].map(text);
        line(name, values, what)
    };
    let [before, after] = [leaves.original, leaves.simplified].map(grouped);
    let (each, side) = (figures.views / sets.max(1), figures.resolution);
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
    for DifferenceAt { pixels_high, seen } in differences {
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
    let drawn = drawn.map(of_clients).unwrap_or_default();
    lines.extend(
        drawn
            .into_iter()
            .map(|(name, value, what)| line(name, [value, String::new()], &what)),
    );
    format!(
        "{} against {}, from {views}\n{}",
        args.simplified.display(),
        args.original.display(),
        lines.concat()
    )
}

/// What a client draws: name, value, and what it says beside the original's own.
fn of_clients(drawn: &AsDrawnMeasurement) -> Vec<(&'static str, String, String)> {
    let at = format!("as clients draw it {} pixels wide", drawn.width_px);
    let without = drawn.original_without_mips;
    let four = |value: f64| format!("{value:.4}");
    let one = |value: f64| format!("{value:.1}");
    let original = |with: String, without: String| {
        format!("the original itself: {with}, without mip maps {without}")
    };
    let frames = drawn.over_frames.zip(drawn.original_over_frames);
    let mut rows = vec![
        (
            "drawn coverage",
            four(drawn.coverage_over_truth),
            format!(
                "{at}, over the original's true coverage; {}",
                original(
                    four(drawn.original_coverage_over_truth),
                    four(without.coverage_over_truth)
                )
            ),
        ),
        (
            "drawn IoU",
            four(drawn.truth_iou),
            format!(
                "overlap {at} with what the original truly covers, 1 is best; {}",
                original(four(drawn.original_truth_iou), four(without.truth_iou))
            ),
        ),
    ];
    rows.extend(frames.map(|(own, original)| {
        let what = format!(
            "the same in the mean of {} frames, as temporal anti-aliasing shows it; the original itself: {}",
            own.frames,
            four(original.truth_iou)
        );
        ("IoU, frames", four(own.truth_iou), what)
    }));
    rows.extend([
        (
            "specks",
            one(drawn.specks_per_view),
            format!(
                "islands of up to 3 pixels in a view {at}; {}",
                original(
                    one(drawn.original_specks_per_view),
                    one(without.specks_per_view)
                )
            ),
        ),
        (
            "drawn FLIP",
            four(drawn.flip_mean),
            format!(
                "visible difference {at} from the truth; {}",
                original(four(drawn.original_flip_mean), four(without.flip_mean))
            ),
        ),
    ]);
    if let Some((own, original)) = frames {
        let flip = format!(
            "the same in the mean of {} frames; the original itself: {}",
            own.frames,
            four(original.flip_mean)
        );
        let flicker = format!(
            "pixels that one frame shows and another does not, over those truly covered; the original itself: {}, without mip maps {}",
            four(original.flicker),
            four(original.truth_flicker)
        );
        rows.push(("FLIP, frames", four(own.flip_mean), flip));
        rows.push(("flicker", four(own.flicker), flicker));
    }
    rows
}
