//! One self-contained HTML page from rows and pictures.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;

use super::chart::{chart, escaped};
use super::{COLUMNS, Column, Point, Row, groups, spread, summarise};
use crate::measure::Direction;

/// A picture that rows name: its path, and its bytes as JPEG.
pub type Picture = (String, Vec<u8>);

/// The report of a study: a summary, charts, pictures, tables and how to get
/// every figure again. Needs nothing from a network; the picture of a tree's
/// original is at `pictures/TREE-original.jpg`. Pictures that are missing are
/// left out.
pub fn report(rows: &[Row], pictures: &[Picture]) -> String {
    let images: BTreeMap<&str, String> = pictures
        .iter()
        .map(|(path, bytes)| (path.as_str(), STANDARD.encode(bytes)))
        .collect();
    let page = Page {
        rows,
        images,
        levels: levels(rows),
    };
    let mut html = format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<link rel=\"icon\" href=\"data:,\">\n<title>Foliage simplification study</title>\n<style>\n{}</style>\n</head>\n<body>\n<h1>Foliage simplification study</h1>\n",
        include_str!("report.css")
    );
    page.summary(&mut html);
    page.charts(&mut html);
    page.stability(&mut html);
    page.trees(&mut html);
    page.per_view(&mut html);
    page.provenance(&mut html);
    let _ = write!(
        html,
        "<script>\n{}</script>\n</body>\n</html>\n",
        include_str!("report.js")
    );
    html
}

/// Levels, most leaves first.
fn levels(rows: &[Row]) -> Vec<f64> {
    let mut levels: Vec<f64> = rows.iter().map(|row| row.level).collect();
    levels.sort_by(|a, b| b.total_cmp(a));
    levels.dedup();
    levels
}

/// "10 %".
fn percent(level: f64) -> String {
    format!("{} %", (1e4 * level).round() / 100.0)
}

fn number(value: f64, column: &Column) -> String {
    match column.unit {
        _ if !value.is_finite() => "endless".to_owned(),
        "%" => format!("{value:.2}"),
        _ => format!("{value:.4}"),
    }
}

fn duration(seconds: f64) -> String {
    match seconds {
        s if s < 0.1 => format!("{:.2} ms", 1e3 * s),
        s => format!("{s:.2} s"),
    }
}

struct Page<'a> {
    rows: &'a [Row],
    /// Base64 by path.
    images: BTreeMap<&'a str, String>,
    levels: Vec<f64>,
}

impl Page<'_> {
    fn at(&self, level: f64) -> Vec<&Row> {
        self.rows.iter().filter(|r| r.level == level).collect()
    }

    fn trees_of(&self) -> Vec<&str> {
        let mut trees: Vec<&str> = Vec::new();
        for row in self.rows {
            if !trees.contains(&row.tree.as_str()) {
                trees.push(&row.tree);
            }
        }
        trees
    }

    fn labels(&self) -> Vec<String> {
        let mut labels = Vec::new();
        for label in self.rows.iter().map(Row::label) {
            if !labels.contains(&label) {
                labels.push(label);
            }
        }
        labels
    }

    fn summary(&self, html: &mut String) {
        let _ = write!(
            html,
            "<h2>Summary</h2>\n<p>Means over {} trees ({}) from views that drove no method; the best of each column is marked. Times are geometric means of the method alone.</p>\n",
            self.trees_of().len(),
            escaped(&self.trees_of().join(", "))
        );
        for &level in &self.levels {
            let rows = self.at(level);
            let by_column: Vec<Vec<Point>> = COLUMNS
                .iter()
                .map(|column| summarise(&rows, column))
                .collect();
            let Some(first) = by_column.first() else {
                continue;
            };
            let _ = write!(
                html,
                "<h3>{} of the leaves</h3>\n<div class=\"wide\"><table><thead><tr><th>method</th><th>time</th>",
                percent(level)
            );
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
                    "<tr><td>{}</td><td>{}</td>",
                    escaped(&point.label),
                    duration(point.seconds)
                );
                for (column, points) in COLUMNS.iter().zip(&by_column) {
                    let class = if is_best(points, k, column) {
                        " class=\"best\""
                    } else {
                        ""
                    };
                    let worst = number(points[k].worst, column);
                    let _ = write!(
                        html,
                        "<td{class} title=\"worst view {worst}\">{}</td>",
                        number(points[k].mean, column)
                    );
                }
                *html += "</tr>\n";
            }
            *html += "</tbody></table></div>\n";
        }
    }

    fn charts(&self, html: &mut String) {
        *html += "<h2>Time against error</h2>\n<p>A mark is a method with a setting, its time and its error means over the trees. What nothing beats in both is joined by the dashed line.</p>\n";
        for &level in &self.levels {
            let rows = self.at(level);
            let _ = write!(
                html,
                "<h3>{} of the leaves</h3>\n<div class=\"charts\">\n",
                percent(level)
            );
            for column in COLUMNS.iter() {
                let title = format!("{} at {} of the leaves", column.title, percent(level));
                *html += &chart(&summarise(&rows, column), column, &title);
            }
            *html += "</div>\n";
        }
    }

    fn stability(&self, html: &mut String) {
        let groups = groups(self.rows);
        if groups.is_empty() {
            return;
        }
        *html += "<h2>Stability</h2>\n<p>Mean and standard deviation over seeds and over changes that should not matter, the worst of them in brackets.</p>\n<div class=\"wide\"><table><thead><tr><th>tree</th><th>method</th><th>leaves</th><th>runs</th>";
        for column in COLUMNS.iter() {
            let _ = write!(html, "<th>{}</th>", column.title);
        }
        *html += "</tr></thead><tbody>\n";
        for ((tree, method, setting, level), rows) in &groups {
            let level = percent(*level as f64 / 1e6);
            let _ = write!(
                html,
                "<tr><td>{}</td><td>{} {}</td><td>{level}</td><td>{}</td>",
                escaped(tree),
                escaped(method),
                escaped(setting),
                rows.len()
            );
            for column in COLUMNS.iter() {
                let found = spread(rows, column);
                let [mean, deviation, worst] =
                    [found.mean, found.deviation, found.worst].map(|v| number(v, column));
                let _ = write!(html, "<td>{mean} ± {deviation} ({worst})</td>");
            }
            *html += "</tr>\n";
        }
        *html += "</tbody></table></div>\n";
    }

    fn image(&self, path: &str, text: &str) -> String {
        match self.images.get(path) {
            Some(data) => format!(
                "<img alt=\"{}\" src=\"data:image/jpeg;base64,{data}\">",
                escaped(text)
            ),
            None => String::new(),
        }
    }

    fn trees(&self, html: &mut String) {
        *html += "<h2>Pictures</h2>\n";
        let labels = self.labels();
        for tree in self.trees_of() {
            let original = self.image(
                &format!("pictures/{tree}-original.jpg"),
                &format!("{tree}, original"),
            );
            let options: String = labels
                .iter()
                .enumerate()
                .map(|(k, label)| format!("<option value=\"{k}\">{}</option>", escaped(label)))
                .collect();
            let names: Vec<String> = self.levels.iter().map(|l| percent(*l)).collect();
            let _ = write!(
                html,
                "<section class=\"tree\">\n<h3>{0}</h3>\n<div class=\"controls\"><label>method <select>{options}</select></label><label>leaves <input type=\"range\" min=\"0\" max=\"{1}\" value=\"0\" data-names=\"{2}\"> <output></output></label></div>\n<div class=\"pair\"><figure>{original}<figcaption>original</figcaption></figure><figure class=\"shown\"><img alt=\"the chosen level\" src=\"data:,\"><figcaption></figcaption></figure></div>\n<details><summary>All methods and levels</summary><div class=\"wide\"><table class=\"sheet\"><tbody>\n",
                escaped(tree),
                self.levels.len().saturating_sub(1),
                names.join("|")
            );
            for (k, label) in labels.iter().enumerate() {
                *html += "<tr>";
                for (l, level) in self.levels.iter().enumerate() {
                    let row = self
                        .rows
                        .iter()
                        .find(|r| r.tree == tree && r.level == *level && r.label() == *label);
                    let Some(row) = row else {
                        *html += "<td></td>";
                        continue;
                    };
                    let _ = write!(
                        html,
                        "<td data-method=\"{k}\" data-level=\"{l}\"><figure>{}<figcaption>{}</figcaption></figure></td>",
                        self.image(
                            &row.picture,
                            &format!("{tree}, {label}, {}", percent(*level))
                        ),
                        escaped(&caption(row))
                    );
                }
                *html += "</tr>\n";
            }
            *html += "</tbody></table></div></details>\n</section>\n";
        }
    }

    fn per_view(&self, html: &mut String) {
        *html += "<h2>Each view</h2>\n";
        for tree in self.trees_of() {
            let _ = write!(
                html,
                "<details><summary>{}</summary>\n<div class=\"wide\"><table><thead><tr><th>method</th><th>leaves</th><th>view</th>",
                escaped(tree)
            );
            for column in COLUMNS.iter() {
                let _ = write!(html, "<th>{}</th>", column.title);
            }
            *html += "</tr></thead><tbody>\n";
            for row in self.rows.iter().filter(|row| row.tree == tree) {
                for (values, view) in row.per_view.iter().zip(1..) {
                    let _ = write!(
                        html,
                        "<tr><td>{}</td><td>{}</td><td>{view}</td>",
                        escaped(&row.label()),
                        percent(row.level)
                    );
                    for column in COLUMNS.iter() {
                        let value = values.get(column.key).copied().flatten();
                        let _ = write!(
                            html,
                            "<td>{}</td>",
                            number(value.unwrap_or(f64::INFINITY), column)
                        );
                    }
                    *html += "</tr>\n";
                }
            }
            *html += "</tbody></table></div></details>\n";
        }
    }

    fn provenance(&self, html: &mut String) {
        *html += "<h2>How to get it again</h2>\n";
        let of = |what: fn(&Row) -> String| {
            let all: BTreeSet<String> = self.rows.iter().map(what).collect();
            escaped(&all.into_iter().collect::<Vec<_>>().join("; "))
        };
        let _ = write!(
            html,
            "<p>secateur {}, commit {}, on {}; leaves drawn by: {}.</p>\n<p>Views that judge: the 12 vertices of an icosahedron about the original, 512 x 512 for counts, 256 x 256 of four samples a pixel for shaded pictures.</p>\n<details><summary>Commands</summary><pre>",
            of(|row| row.version.clone()),
            of(|row| row.commit.clone()),
            of(|row| row.machine.clone()),
            of(|row| row.adapter.clone().unwrap_or_else(|| row.engine.clone()))
        );
        for row in self.rows {
            *html += &escaped(&row.command);
            html.push('\n');
        }
        *html += "</pre></details>\n";
    }
}

fn caption(row: &Row) -> String {
    let value = |key: &str| {
        row.values
            .get(key)
            .copied()
            .flatten()
            .unwrap_or(f64::INFINITY)
    };
    format!(
        "{}, {}: {} leaves, VMI error {:.1} %, IoU {:.3}, {}",
        row.label(),
        percent(row.level),
        row.leaves_final,
        value("vmi_error_percent"),
        value("silhouette_iou"),
        duration(row.seconds)
    )
}

fn is_best(points: &[Point], index: usize, column: &Column) -> bool {
    let badness = |p: &Point| match column.direction {
        Direction::NearerToOne => (p.mean - 1.0).abs(),
        direction => direction.badness(p.mean),
    };
    let own = badness(&points[index]);
    own.is_finite() && points.iter().all(|p| badness(p) >= own)
}

#[cfg(test)]
mod tests {
    use super::super::rows::tests::row;
    use super::*;

    #[test]
    fn a_report_has_every_level_and_method_and_asks_no_network() {
        let mut rows = vec![
            row("vds", 0.5, 2.0, 1.0),
            row("fsa", 0.5, 1.0, 9.0),
            row("vds", 0.01, 3.0, 2.0),
        ];
        rows[0].picture = "pictures/a.jpg".into();
        rows[1].tree = "<oak>".into();
        let pictures = [("pictures/a.jpg".to_owned(), vec![1, 2, 3])];
        let html = report(&rows, &pictures);
        for part in [
            "50 % of the leaves",
            "1 % of the leaves",
            "AQID",
            "&lt;oak&gt;",
            "class=\"best\"",
        ] {
            assert!(html.contains(part), "{part}");
        }
        assert_eq!(html.matches("<svg").count(), 2 * COLUMNS.len());
        // The name of SVG's own namespace is all that looks like an address.
        let addresses = html.matches("http").count();
        assert_eq!(
            addresses,
            html.matches("http://www.w3.org/2000/svg").count()
        );
        assert!(!html.contains("<oak>"));
    }

    #[test]
    fn nothing_is_a_report_too() {
        assert!(report(&[], &[]).ends_with("</html>\n"));
    }
}
