//! What a study found, as Markdown: nothing in it but what rows say.

use std::collections::BTreeSet;
use std::fmt::Write as _;

use super::{COLUMNS, Row, Study, held_out, summarise, triangle_levels};
use crate::better_rivals::{beaten_as_drawn, lost_cases, note_of_counts, note_of_lost};
use crate::branch_metrics;
use crate::complete_cases::note_of;
use crate::distances;
use crate::dominance::{WHAT_IS_COUNTED, dominance};
use crate::failure_case::{WHAT_IS_BETTER, overview};
use crate::fairness;
use crate::format::{duration, memory, number, percent, trees};
use crate::published::beside;
use crate::recommend::{WHAT_IS_LISTED, recommend};
use crate::stability::{WHAT_IS_SPREAD, by_change, by_method, by_tree};
use crate::table::{Table, markdown_escaped};
use crate::walk;
use crate::whole::{WHAT_IS_COMPARED, tables};

/// The study of [`report`](super::report()) without pictures: what ran on
/// what, means of every method and level, what fails where, the paper's figures.
/// Equal rows give equal text.
pub fn readme(study: &Study<'_>) -> String {
    let mut text = "# A study of foliage simplification\n\nWritten by `secateur study --redraw` from `rows.jsonl`; do not edit.\n\n".to_owned();
    let each = |what: fn(&Row) -> String| {
        let all: BTreeSet<String> = study.rows.iter().map(what).collect();
        markdown_escaped(&all.into_iter().collect::<Vec<_>>().join("; "))
    };
    let names: BTreeSet<&String> = study.rows.iter().map(|r| &r.tree).collect();
    let _ = write!(
        text,
        "- {} rows of {}: {}\n- machine: {}\n- secateur {}, commit {}\n- leaves drawn by: {}\n- every row has the command that gives it again; this text and the charts need the rows alone\n\n",
        study.rows.len(),
        trees(names.len()),
        each(|r| format!("{} ({} leaves)", r.tree, r.leaves_original)),
        each(|r| r.machine.clone()),
        each(|r| r.version.clone()),
        each(|r| r.commit.clone()),
        each(|r| r.adapter.clone().unwrap_or_else(|| r.engine.clone())),
    );
    let _ = writeln!(text, "{}\n", held_out::who_judged(study.rows));
    if let Some(note) = held_out::note_of(study.rows) {
        let _ = writeln!(text, "**{note}**\n");
    }
    let plain = study.plain_rows();
    let (given, partial) = study.given_and_partial();
    if let Some(table) = recommend(&given) {
        let table = table.markdown();
        let _ = writeln!(text, "## Which to take\n\n{WHAT_IS_LISTED}\n\n{table}");
    }
    means(&mut text, &given);
    if let Some(note) = note_of(&partial) {
        let _ = writeln!(text, "{note}\n");
    }
    if let Some(note) = triangle_levels::note_of(study.rows) {
        let _ = writeln!(text, "{note}\n");
    }
    who_is_beaten(&mut text, &given);
    beaten_where_drawn(&mut text, study.rows);
    stability(&mut text, &plain);
    whole(&mut text, study.rows);
    at_distances(&mut text, study.rows);
    walk(&mut text, study.rows);
    if let Some(table) = branch_metrics::table(study.rows) {
        let (what, table) = (branch_metrics::WHAT_IS_COMPARED, table.markdown());
        let _ = writeln!(text, "## Metrics of branches\n\n{what}\n\n{table}");
    }
    if let Some(table) = fairness::table(study.rows) {
        let (what, table) = (fairness::WHAT_IS_COMPARED, table.markdown());
        let _ = writeln!(text, "## {}\n\n{what}\n\n{table}", fairness::TITLE);
    }
    if let Some(table) = overview(study.failure_cases, study.rows) {
        let _ = write!(
            text,
            "## Where methods fail\n\n{WHAT_IS_BETTER}\n\n{}\n",
            table.markdown()
        );
    }
    if let Some(paper) = study.paper {
        let tables = beside(paper, &plain);
        if !tables.is_empty() {
            let _ = writeln!(text, "## Beside the paper's figures\n\n{}\n", paper.about);
        }
        for (title, table) in tables {
            let _ = writeln!(text, "### {title}\n\n{}", table.markdown());
        }
    }
    text
}

fn means(text: &mut String, plain: &[Row]) {
    let unchanged: Vec<&Row> = plain.iter().filter(|r| r.change.is_empty()).collect();
    let mut levels: Vec<f64> = unchanged.iter().map(|row| row.level).collect();
    levels.sort_by(|a, b| b.total_cmp(a));
    levels.dedup();
    for level in levels {
        let rows: Vec<&Row> = (unchanged.iter().copied())
            .filter(|row| row.level == level)
            .collect();
        let mut head = vec!["method", "trees and seeds", "time", "memory"];
        head.extend(COLUMNS.iter().map(|c| c.title));
        head.insert(5, "worst");
        let mut table = Table::new(&head);
        let columns: Vec<_> = COLUMNS.iter().map(|c| (c, summarise(&rows, c))).collect();
        let Some((_, points)) = columns.first() else {
            continue;
        };
        for (k, point) in points.iter().enumerate() {
            let mut cells = vec![
                point.shown(),
                point.rows.to_string(),
                duration(point.seconds),
                memory(point.peak_rss_bytes),
            ];
            cells.extend(columns.iter().map(|(c, points)| number(points[k].mean, c)));
            let (of_error, points) = &columns[0];
            cells.insert(5, number(points[k].mean_of_worst, of_error));
            table.push(cells);
        }
        let _ = writeln!(
            text,
            "## {} of the leaves: means, of times geometric ones\n\n{}",
            percent(level),
            table.markdown()
        );
    }
}

fn who_is_beaten(text: &mut String, given: &[Row]) {
    if let Some(table) = dominance(given) {
        let table = table.markdown();
        let _ = writeln!(text, "## Who is beaten\n\n{WHAT_IS_COUNTED}\n\n{table}");
    }
}

fn beaten_where_drawn(text: &mut String, rows: &[Row]) {
    if let Some(table) = beaten_as_drawn(rows) {
        let (what, table) = (note_of_counts(&table), table.markdown());
        let _ = writeln!(text, "## Who is beaten as drawn\n\n{what}\n\n{table}");
    }
    if let Some(table) = lost_cases(rows) {
        let _ = writeln!(text, "{}\n\n{}", note_of_lost(&table), table.markdown());
    }
}

fn whole(text: &mut String, rows: &[Row]) {
    let tables = tables(rows);
    if !tables.is_empty() {
        let _ = writeln!(text, "## Whole plants\n\n{WHAT_IS_COMPARED}\n");
    }
    for (title, table) in tables {
        let _ = writeln!(text, "### {title}\n\n{}", table.markdown());
    }
}

fn at_distances(text: &mut String, rows: &[Row]) {
    let tables = distances::tables(rows);
    if !tables.is_empty() {
        let what = distances::WHAT_IS_COMPARED;
        let _ = writeln!(text, "## At the distances of a walk\n\n{what}\n");
    }
    for (title, table) in tables {
        let _ = writeln!(text, "### {title}\n\n{}", table.markdown());
    }
}

fn walk(text: &mut String, rows: &[Row]) {
    let tables = walk::tables(rows);
    if !tables.is_empty() {
        let what = walk::WHAT_IS_COMPARED;
        let _ = writeln!(text, "## A walk through woods\n\n{what}\n");
    }
    for (title, table) in tables {
        let _ = writeln!(text, "### {title}\n\n{}", table.markdown());
    }
}

fn stability(text: &mut String, plain: &[Row]) {
    let tables = [by_method(plain), by_change(plain)];
    if tables.iter().any(Option::is_some) {
        let _ = writeln!(text, "## Stability\n\n{WHAT_IS_SPREAD}\n");
    }
    for table in tables.into_iter().flatten() {
        let _ = writeln!(text, "{}", table.markdown());
    }
    if let Some(table) = by_tree(plain) {
        let _ = writeln!(
            text,
            "## Stability of each tree: mean ± deviation (worst)\n\n{}",
            table.markdown()
        );
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rows::tests::row;

    #[test]
    fn a_readme_says_what_rows_say_and_nothing_of_absent_parts() {
        let mut rows = vec![row("vds", 0.5, 2.0, 1.25), row("fsa", 0.5, 1.0, 9.0)];
        let study = |rows: &[Row]| {
            readme(&Study {
                rows,
                failure_cases: &[],
                paper: None,
            })
        };
        let text = study(&rows);
        assert!(
            text.contains("- 2 rows of 1 tree: oak (100 leaves)"),
            "{text}"
        );
        assert!(
            text.contains("| vds | 1 | 2.00 s | 50 MiB | 1.25 |"),
            "{text}"
        );
        for absent in ["Stability", "methods fail", "paper"] {
            assert!(!text.contains(absent), "{absent}");
        }
        rows.push(Row {
            change: "jitter".into(),
            ..row("vds", 0.5, 2.0, 3.25)
        });
        let text = study(&rows);
        // 1.25 and 3.25: the mean is 2.25, the deviation sqrt(2).
        assert!(text.contains("2.25 ± 1.41 (3.25)"), "{text}");
        assert!(
            text.contains("| vds | 1 | 2.00 s"),
            "changed trees are no means"
        );
    }
}
