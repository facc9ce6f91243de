//! What a person reads of a level.

use secateur::{Objective, Resolution, Simplified};

use super::super::args;
use super::super::machine;
use super::super::record::bytes_of;
use super::super::summary::{columns, counts_row, percent, share, size};
use super::materials_in_words;
use super::record::Simplifying;

fn fitted_to(objective: Objective) -> String {
    match objective {
        Objective::Information { outline_weight } => {
            format!("fitted to the original at the end, outlines with a weight of {outline_weight}")
        }
        Objective::Coverage => {
            "fitted at the end, so that each part of the crown is as dense as it was".to_owned()
        }
    }
}

/// Whether `measure` looks from elsewhere than what drove the run.
fn who_judges(run: &Simplifying<'_>) -> String {
    match run.views_that_judge {
        0 => "`secateur measure` judges by others".to_owned(),
        count => {
            format!("`secateur measure` judges by {count} of them too, which flatters the result")
        }
    }
}

/// What there is of the plant, and what is left.
fn table(run: &Simplifying<'_>) -> String {
    let figures = &run.record;
    let mut rows = vec![
        ["", "original", "result", ""].map(str::to_owned).to_vec(),
        counts_row("leaves", figures.leaves),
        counts_row("triangles", figures.triangles),
        counts_row("of leaves", figures.foliage_triangles),
        counts_row("of wood", figures.wood_triangles),
    ];
    if let Some(before) = bytes_of(run.input) {
        let after = run.written.bytes;
        let share = share(after, before);
        rows.push(vec!["file".to_owned(), size(before), size(after), share]);
    }
    columns(&rows)
}

/// The summary of a run.
pub(super) fn pretty(run: &Simplifying<'_>, args: &args::Simplify, seconds: f64) -> String {
    let result: &Simplified = &run.level.simplified;
    let (plant, figures) = (run.plant, &run.record);
    let mut text = format!("{} -> {}\n", run.input.display(), args.output.display());
    text += &table(run);
    let mut say = |name: &str, what: String| text += &format!("  {name:<9}  {what}\n");
    say(
        "method",
        format!(
            "{} on the {}",
            run.level.options.method.name(),
            result.adapter.as_deref().unwrap_or("CPU")
        ),
    );
    let has_leaves = !plant.leaves().leaves().is_empty();
    let (views, side) = (result.views.len(), result.resolution);
    if has_leaves {
        say("views", format!("{views} of {side} x {side} pixels"));
    }
    if let (Some(reason), true) = (&result.views_reason, views > 20) {
        say("", reason.clone());
    }
    if has_leaves && run.level.options.resolution == Resolution::Auto {
        say("", result.resolution_reason.clone());
    }
    if let (Some(objective), true) = (run.level.options.objective(), result.passes.sizes.is_some())
    {
        say("sizes", fitted_to(objective));
    }
    if let Some(chosen) = &figures.cutoffs {
        say("cutoffs", materials_in_words::cutoffs(chosen));
    }
    if let Some(chosen) = &figures.colors {
        say("colours", materials_in_words::colors(chosen));
    }
    if has_leaves && let Some(lost) = result.driving_error_percent() {
        say(
            "loss",
            format!(
                "VMI error {} on these views; {}",
                percent(lost),
                who_judges(run)
            ),
        );
    }
    if has_leaves {
        say(
            "growth",
            format!(
                "the largest leaf has {:.1} times its original area",
                result.passes.max_area_scale()
            ),
        );
    }
    let memory = machine::peak_rss_bytes().map(|bytes| format!(", {} of memory", size(bytes)));
    say(
        "cost",
        format!("{seconds:.2} s{}", memory.unwrap_or_default()),
    );
    if let Some(path) = result.audited_by {
        say("audit", format!("the {path} draws the same areas"));
    }
    for note in run.notes() {
        say("note", note);
    }
    text
}
