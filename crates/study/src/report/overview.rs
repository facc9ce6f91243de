//! What a reader sees first: what the result looks like, which method to take, one chart.

use std::fmt::Write as _;

use super::super::{Column, Point, Row, summarise};
use super::{Page, trees_of};
use crate::chart::{chart, escaped};
use crate::columns::column;
use crate::dominance::is_beaten;
use crate::format::{duration, number, percent, trees};

/// The level that a study is summed up at, where it has it: light enough to show what a method loses.
const LEVEL: f64 = 0.1;

impl Page<'_> {
    pub(super) fn overview(&self, html: &mut String) {
        let distance = |level: f64| (level.ln() - LEVEL.ln()).abs();
        let levels = super::levels(self.given);
        let Some(level) = (levels.into_iter()).min_by(|a, b| distance(*a).total_cmp(&distance(*b)))
        else {
            return;
        };
        let rows: Vec<&Row> = (self.given.iter())
            .filter(|row| row.level == level && is_fair(row))
            .collect();
        let (flip, vmi) = (column("flip_mean"), column("vmi_error_percent"));
        let by_look = summarise(&rows, flip);
        let Some(best) = best_of(&by_look, flip) else {
            return;
        };
        self.lead_pictures(html, level, best, &rows);
        let left = percent(level);
        let _ = writeln!(
            html,
            "<p class=\"advice\"><strong>For an artist:</strong> take <em>{}</em>. With {left} left its pictures differ least from the original's: FLIP, the difference that an eye notices when it flips between two pictures (0 none, 1 the most), is {} in the mean of {}, after {}{}.</p>",
            escaped(&best.label),
            number(best.mean, flip),
            trees(trees_of(self.given).len()),
            duration(best.seconds),
            next_best(&by_look, best, flip)
        );
        let by_error = summarise(&rows, vmi);
        if let Some(least) = best_of(&by_error, vmi) {
            let own: Vec<&&Row> = rows.iter().filter(|r| r.label() == least.label).collect();
            let beaten = own.iter().filter(|row| is_beaten(row, &rows)).count();
            let _ = writeln!(
                html,
                "<p class=\"advice\"><strong>For a researcher:</strong> <em>{}</em> keeps most of the viewpoint mutual information (VMI), what pictures from many views tell of single leaves: with {left} left its error is {} % ({} % from the worst set of views), after {}{}. Another method is better in both VMI error and the overlap of outlines (IoU) on {beaten} of {}.</p>",
                escaped(&least.label),
                number(least.mean, vmi),
                number(least.mean_of_worst, vmi),
                duration(least.seconds),
                next_best(&by_error, least, vmi),
                trees(own.len())
            );
        }
        let title = format!("FLIP with {left} left");
        let _ = writeln!(
            html,
            "<div class=\"lead-chart wide\">{}</div>",
            chart(&by_look, flip, &title)
        );
    }

    /// Original and best level side by side, of the tree where the method is neither at its best
    /// nor at its worst.
    fn lead_pictures(&self, html: &mut String, level: f64, best: &Point, rows: &[&Row]) {
        let mut own: Vec<&Row> = (rows.iter().copied())
            .filter(|row| row.label() == best.label && self.images.contains_key(&*row.picture))
            .collect();
        let flip = column("flip_mean");
        own.sort_by(|a, b| flip.value_of(a).total_cmp(&flip.value_of(b)));
        let Some(row) = own.get(own.len() / 2) else {
            return;
        };
        let original = self.image(
            &row.identity().original_picture(),
            &format!("{}, the original", row.tree),
        );
        let text = format!("{}, {} with {}", row.tree, best.label, percent(level));
        let _ = writeln!(
            html,
            "<div class=\"lead\"><figure>{original}<figcaption>{0}: original, {1} leaves</figcaption></figure><figure>{2}<figcaption>{3}: {4} leaves, {5} triangles</figcaption></figure></div>",
            escaped(&row.tree),
            row.leaves_original,
            self.image(&row.picture, &text),
            escaped(&best.label),
            row.leaves_final,
            row.triangles_final
        );
    }
}

fn is_fair(row: &Row) -> bool {
    row.change.is_empty() && !row.is_driven_by_judging_views
}

fn badness(point: &Point, column: &Column) -> f64 {
    column.direction.badness(point.mean)
}

fn best_of<'p>(points: &'p [Point], column: &Column) -> Option<&'p Point> {
    let finite = points.iter().filter(|point| point.mean.is_finite());
    finite.min_by(|a, b| badness(a, column).total_cmp(&badness(b, column)))
}

/// What the best of the other methods has, as the end of a sentence; nothing if there is no other.
fn next_best(points: &[Point], best: &Point, column: &Column) -> String {
    let others = points.iter().filter(|point| point.method != best.method);
    let others: Vec<Point> = others.cloned().collect();
    best_of(&others, column).map_or(String::new(), |next| {
        let unit = match column.unit {
            "" => String::new(),
            unit => format!(" {unit}"),
        };
        format!(
            "; the best of the other methods, {}, has {}{unit}",
            escaped(&next.label),
            number(next.mean, column)
        )
    })
}
