//! Means of every level, in a table and as charts of time against each metric.

use std::fmt::Write as _;

use super::super::{COLUMNS, Column, Point, Row, summarise};
use super::{Page, levels};
use crate::chart::{chart, escaped};
use crate::format::{duration, memory, number, overlap_of, percent};
use crate::triangle_levels::is_of_triangles;
use secateur_eval::measure::Direction;

/// What levels are shares of, and what else that means.
const SHARES: [(&str, &str); 2] = [
    ("leaves", ""),
    (
        "triangles",
        "Levels are shares of the triangles here; as leaves get coarser, more of them may be left.",
    ),
];

impl Page<'_> {
    /// Rows at a level, those of shares of leaves and those of shares of triangles.
    fn by_shares(&self, level: f64) -> [Vec<&Row>; 2] {
        let at_level = self.given.iter().filter(|row| row.level == level);
        let (of_triangles, of_leaves) = at_level.partition(|row| {
            let same = |other: &&Row| other.label() == row.label();
            self.given.iter().filter(same).any(is_of_triangles)
        });
        [of_leaves, of_triangles]
    }

    pub(super) fn means(&self, html: &mut String) {
        *html += "<p>The best of each column is marked; in small the mean of the worst set of views. Times are geometric means of the method alone. Memory is the most that the process held meanwhile, the tree and what judges it included. Shared leaves: how many of the leaves left are also left by the method's first setting (Jaccard).</p>\n<dl class=\"terms\">";
        for column in COLUMNS.iter() {
            let _ = writeln!(
                html,
                "<dt>{}</dt><dd>{}; {}.</dd>",
                column.title,
                meaning(column.key),
                column.better()
            );
        }
        *html += "</dl>\n";
        for level in levels(self.given) {
            for (rows, (what, note)) in self.by_shares(level).iter().zip(SHARES) {
                if !rows.is_empty() {
                    let _ = writeln!(html, "<h3>{} of the {what}</h3>", percent(level));
                    if !note.is_empty() {
                        let _ = writeln!(html, "<p>{note}</p>");
                    }
                    means_table(html, rows);
                }
            }
        }
    }

    pub(super) fn charts(&self, html: &mut String) {
        *html += "<p>A mark is a method with a setting, its time and its value means over the trees; a line leads from it to the mean of the worst set of views. What nothing beats in both is joined by the dashed line.</p>\n";
        for level in levels(self.given) {
            for (rows, (what, _)) in self.by_shares(level).iter().zip(SHARES) {
                if rows.is_empty() {
                    continue;
                }
                let left = format!("{} of the {what}", percent(level));
                let _ = write!(html, "<h3>{left}</h3>\n<div class=\"charts\">\n");
                for column in COLUMNS.iter() {
                    let title = format!("{} at {left}", column.title);
                    *html += &chart(&summarise(rows, column), column, &title);
                }
                *html += "</div>\n";
            }
        }
    }
}

/// What a metric tells, for who has never heard of it.
fn meaning(key: &str) -> &'static str {
    match key {
        "vmi_error_percent" => {
            "how far the viewpoint mutual information, what pictures from many views tell of single leaves, is from the original's"
        }
        "silhouette_iou" => "the overlap of the crown's outlines over what either covers",
        "precision" => "the share of the pixels covered that the original covers too",
        "recall" => "the share of the original's pixels that are still covered",
        "coverage_ratio" => {
            "pixels covered over those of the original: above 1 a crown is too dense"
        }
        "ssim" => "structural similarity of pictures",
        "flip_mean" => {
            "the difference that an eye notices when it flips between two pictures, in the mean of their pixels"
        }
        _ => "see the guide",
    }
}

fn means_table(html: &mut String, rows: &[&Row]) {
    let by_column: Vec<Vec<Point>> = COLUMNS
        .iter()
        .map(|column| summarise(rows, column))
        .collect();
    let Some(first) = by_column.first() else {
        return;
    };
    *html += "<div class=\"wide\"><table><thead><tr><th>method</th><th>time</th><th>memory</th><th>shared leaves</th>";
    for column in COLUMNS.iter() {
        let unit = if column.unit.is_empty() {
            String::new()
        } else {
            format!(" in {}", column.unit)
        };
        let _ = write!(
            html,
            "<th title=\"{}\">{}{unit}</th>",
            column.better(),
            column.title
        );
    }
    *html += "</tr></thead><tbody>\n";
    for (k, point) in first.iter().enumerate() {
        let _ = write!(
            html,
            "<tr><td>{}</td><td>{}</td><td>{}</td><td>{}</td>",
            escaped(&point.shown()),
            duration(point.seconds),
            memory(point.peak_rss_bytes),
            overlap_of(point.kept_overlap)
        );
        for (column, points) in COLUMNS.iter().zip(&by_column) {
            let class = if is_best(points, k, column) {
                " class=\"best\""
            } else {
                ""
            };
            let point = &points[k];
            let [mean, beside, worst] =
                [point.mean, point.mean_of_worst, point.worst].map(|value| number(value, column));
            let _ = write!(
                html,
                "<td{class} title=\"worst of any tree {worst}\">{mean} <small>{beside}</small></td>",
            );
        }
        *html += "</tr>\n";
    }
    *html += "</tbody></table></div>\n";
}

fn is_best(points: &[Point], index: usize, column: &Column) -> bool {
    let badness = |p: &Point| match column.direction {
        Direction::NearerToOne => (p.mean - 1.0).abs(),
        direction => direction.badness(p.mean),
    };
    let own = badness(&points[index]);
    own.is_finite() && points.iter().all(|p| badness(p) >= own)
}
