//! `secateur measure`.

use std::path::Path;
use std::time::Instant;

use secateur::{AsDrawnMeasurement, Measurement, PictureMeasurement, Tree};
use serde_json::json;

use super::args;
use super::failure::Failure;
use super::names::text;
use super::print::Printed;
use super::summary::grouped;
use super::{interrupt, output, record};

/// Compares two trees from the held-out views.
pub(crate) fn run(args: &args::Measure) -> Result<Printed, Failure> {
    let start = Instant::now();
    if let Some(report) = &args.report {
        output::check_file(report, &[&args.original, &args.simplified])?;
    }
    let open = |path: &Path, memory| Tree::open_within(path, &args.foliage.foliage, memory);
    let original = open(&args.original, args.memory.memory)?;
    let simplified = open(&args.simplified, original.memory_left())?;
    let outputs: Vec<&Path> = args.report.as_deref().into_iter().collect();
    for tree in [&original, &simplified] {
        output::check_spares(tree.document(), &outputs)?;
    }
    interrupt::check()?;
    let (alpha, sides) = (args.alpha.into(), secateur::Sides::from(args.sides));
    let foliages =
        [&original, &simplified].map(|tree| secateur::as_seen(tree.foliage(), alpha, sides));
    let measured =
        secateur::measure(&foliages[0], &foliages[1]).map_err(Failure::about(&args.original))?;
    interrupt::check()?;
    let pictured = secateur::measure_pictures(&original, &simplified)
        .map_err(Failure::about(&args.original))?;
    let drawn = match args.as_drawn {
        Some(width_px) => {
            let drawn = secateur::measure_as_drawn(&original, &simplified, width_px);
            Some(drawn.map_err(Failure::about(&args.original))?)
        }
        None => None,
    };
    let total = start.elapsed().as_secs_f64();
    let about = json!({
        "original": args.original.display().to_string(),
        "simplified": args.simplified.display().to_string(),
        "leaves": {
            "original": foliages[0].leaves().len(),
            "simplified": foliages[1].leaves().len(),
        },
        "triangles": {
            "original": original.triangle_count(),
            "simplified": simplified.triangle_count(),
        },
        "as_drawn": drawn,
        "alpha": text(args.alpha),
        "sides": text(args.sides),
        "seconds": record::seconds(&[], total),
        "run": record::provenance("measure"),
    });
    let metrics = record::merged(json!(measured), json!(pictured));
    let record = record::joined(metrics, about);
    record::write(args.report.as_deref(), &record)?;
    let counts = [&original, &simplified].map(|tree| tree.foliage().leaves().len() as u64);
    Ok(Printed::single(
        pretty(&measured, &pictured, drawn.as_ref(), args, counts),
        record,
    ))
}

fn pretty(
    measured: &Measurement,
    pictured: &PictureMeasurement,
    drawn: Option<&AsDrawnMeasurement>,
    args: &args::Measure,
    leaves: [u64; 2],
) -> String {
    let picture = |key: &str| format!("{:.4}", pictured.overall.get(key).unwrap_or(f64::NAN));
    let row = |name: &str, value: String, what: &str| {
        vec![format!("{name:<14}  {value:>10}"), what.to_owned()]
    };
    let [before, after] = leaves.map(grouped);
    let views = measured.views;
    let side = measured.resolution;
    let mut rows = vec![
        row("leaves", after, &format!("of {before}")),
        row(
            "VMI error",
            format!("{:.2} %", measured.vmi_error_percent()),
            "information lost, less is better",
        ),
        row(
            "silhouette IoU",
            format!("{:.4}", measured.silhouette_iou()),
            "overlap of the outlines, 1 is best",
        ),
        row(
            "precision",
            format!("{:.4}", measured.precision()),
            "pixels of the result that the original has too",
        ),
        row(
            "recall",
            format!("{:.4}", measured.recall()),
            "pixels of the original that the result still has",
        ),
        row(
            "coverage",
            format!("{:.4}", measured.coverage_ratio()),
            "pixels of the result over those of the original",
        ),
        row(
            "SSIM",
            picture("ssim"),
            "likeness of shaded pictures, 1 is best",
        ),
        row(
            "FLIP",
            picture("flip_mean"),
            "visible difference of shaded pictures, 0 is best",
        ),
    ];
    if let Some(drawn) = drawn {
        let at = format!("as clients draw it {} pixels wide", drawn.width_px);
        rows.extend([
            row(
                "drawn coverage",
                format!("{:.4}", drawn.coverage_over_truth),
                &format!(
                    "{at}, over the original's true coverage; the original itself: {:.4}",
                    drawn.original_coverage_over_truth
                ),
            ),
            row(
                "specks",
                format!("{:.1}", drawn.specks_per_view),
                &format!(
                    "islands of up to 3 pixels in a view {at}; the original: {:.1}",
                    drawn.original_specks_per_view
                ),
            ),
            row(
                "drawn FLIP",
                format!("{:.4}", drawn.flip_mean),
                &format!(
                    "visible difference {at} from the truth; the original: {:.4}",
                    drawn.original_flip_mean
                ),
            ),
        ]);
    }
    // Explanations to the left, unlike numbers.
    let lines: String = rows
        .iter()
        .map(|cells| format!("  {}   {}\n", cells[0], cells[1]))
        .collect();
    format!(
        "{} against {}, from {views} views of {side} x {side} pixels\n{lines}",
        args.simplified.display(),
        args.original.display(),
    )
}
