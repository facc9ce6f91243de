//! The report of a study: one HTML page that needs no other file.

mod branch_metrics;
mod distances;
mod failures;
mod means;
mod overview;
mod paper;
mod pictures;
mod stability;
mod walk;
mod whole;

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;

use super::{COLUMNS, FailureCase, Paper, Row, held_out};
use crate::better_rivals::{beaten_as_drawn, lost_cases, note_of_counts, note_of_lost};
use crate::chart::escaped;
use crate::complete_cases::{note_of, take_out_partial};
use crate::dominance::{WHAT_IS_COUNTED, dominance};
use crate::fairness;
use crate::format::{number, percent, trees};
use crate::recommend::{WHAT_IS_LISTED, recommend};
use crate::short_names::ShortNames;
use crate::table::Table;

/// A picture that rows name: its path from the study's folder, and its bytes as JPEG, or PNG as its name says.
pub type Picture = (String, Vec<u8>);

/// What the report and the README of a study are made of.
#[derive(Clone, Copy, Debug)]
pub struct Study<'a> {
    /// The rows, in the order of running.
    pub rows: &'a [Row],
    /// Scenes made for failures; those that did not run are left out.
    pub failure_cases: &'a [FailureCase],
    /// The paper to stand beside the rows; figures without rows are left out.
    pub paper: Option<&'a Paper>,
}

impl Study<'_> {
    /// Rows of trees that are neither scenes made for failures nor stand for a
    /// paper's models, of what ran on all of these: their means can be compared.
    pub fn given_rows(&self) -> Vec<Row> {
        self.given_and_partial().0
    }

    /// The given rows, and the labels of the cases that were left out because they are incomplete.
    pub(crate) fn given_and_partial(&self) -> (Vec<Row>, BTreeSet<String>) {
        let figures = self.paper.map_or(&[][..], |paper| &paper.figures);
        let mut rows = self.plain_rows();
        rows.retain(|row| !figures.iter().any(|figure| figure.tree == row.tree));
        let partial = take_out_partial(&mut rows);
        (rows, partial)
    }

    /// Rows of leaves, of trees that are no scenes made for failures.
    pub(crate) fn plain_rows(&self) -> Vec<Row> {
        let is_plain = |row: &&Row| {
            row.is_of_leaves() && !self.failure_cases.iter().any(|t| t.tree == row.tree)
        };
        self.rows.iter().filter(is_plain).cloned().collect()
    }
}

/// The report of a study: a summary, charts, pictures, tables and how to get
/// every figure again. Needs nothing from a network. Pictures that are missing are
/// left out.
pub fn report(study: &Study<'_>, pictures: &[Picture]) -> String {
    let images: BTreeMap<&str, String> = pictures
        .iter()
        .map(|(path, bytes)| (path.as_str(), STANDARD.encode(bytes)))
        .collect();
    let (mut plain, (mut given, partial)) = (study.plain_rows(), study.given_and_partial());
    let names = ShortNames::of(&plain);
    for rows in [&mut plain, &mut given] {
        names.shorten(rows);
    }
    let page = Page {
        rows: &plain,
        given: &given,
        study,
        images,
        levels: levels(&plain),
    };
    let mut html = format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; style-src 'unsafe-inline'; script-src 'unsafe-inline'; img-src data:\">\n<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<link rel=\"icon\" href=\"data:,\">\n<title>Foliage simplification study</title>\n<style>\n{}</style>\n</head>\n<body>\n<h1>Foliage simplification study</h1>\n",
        include_str!("page.css")
    );
    page.subject(&mut html);
    page.overview(&mut html);
    page.which_to_take(&mut html);
    if let Some(note) = note_of(&partial) {
        let _ = writeln!(html, "<p>{}</p>", escaped(&note));
    }
    if !names.list().body.is_empty() {
        section(&mut html, "Short names", |html| {
            *html +=
                "<p>Names of settings on this page, and the words that tables of rows have.</p>\n";
            *html += &names.list().prose_html();
        });
    }
    page.trees(&mut html);
    if !given.is_empty() {
        section(&mut html, "Every level in figures", |html| page.means(html));
        section(&mut html, "Time against each metric", |html| {
            page.charts(html)
        });
        page.who_is_beaten(&mut html);
    }
    page.stability(&mut html);
    page.whole(&mut html);
    page.distances(&mut html);
    page.walk(&mut html);
    page.branch_metrics(&mut html);
    page.fairness(&mut html);
    page.failures(&mut html);
    page.paper(&mut html);
    if !plain.is_empty() {
        section(&mut html, "Who judged, and each set of views", |html| {
            page.who_judged(html);
            page.per_set(html);
        });
    }
    page.provenance(&mut html);
    let _ = write!(
        html,
        "<script>\n{}</script>\n</body>\n</html>\n",
        include_str!("page.js")
    );
    html
}

/// Begins a section with its title and a paragraph that says what is compared.
fn begin_section(html: &mut String, title: &str, what_is_compared: &str) {
    let what = escaped(what_is_compared);
    let _ = writeln!(html, "<h2>{title}</h2>\n<p>{what}</p>");
}

/// Adds tables, each under its title.
fn write_tables(html: &mut String, tables: Vec<(String, Table)>) {
    for (title, table) in tables {
        let _ = write!(html, "<h3>{}</h3>\n{}", escaped(&title), table.html());
    }
}

/// What is for who asks for it: closed until then.
fn section(html: &mut String, title: &str, fill: impl FnOnce(&mut String)) {
    let _ = writeln!(
        html,
        "<details class=\"section\"><summary><h2>{title}</h2></summary>"
    );
    fill(html);
    *html += "</details>\n";
}

/// The levels of rows, most leaves first.
fn levels(rows: &[Row]) -> Vec<f64> {
    let mut levels: Vec<f64> = rows.iter().map(|row| row.level).collect();
    levels.sort_by(|a, b| b.total_cmp(a));
    levels.dedup();
    levels
}

/// The trees of rows in the order of running.
fn trees_of(rows: &[Row]) -> Vec<&str> {
    let mut trees: Vec<&str> = Vec::new();
    for row in rows {
        if !trees.contains(&row.tree.as_str()) {
            trees.push(&row.tree);
        }
    }
    trees
}

struct Page<'a> {
    /// Rows of trees that are no scenes made for failures.
    rows: &'a [Row],
    /// Rows whose means can be compared: see [`Study::given_rows`].
    given: &'a [Row],
    study: &'a Study<'a>,
    /// Pictures in Base64, by path.
    images: BTreeMap<&'a str, String>,
    levels: Vec<f64>,
}

impl Page<'_> {
    fn trees_of(&self) -> Vec<&str> {
        trees_of(self.rows)
    }

    /// The labels of rows of unchanged trees.
    fn labels(&self) -> Vec<String> {
        let mut labels = Vec::new();
        let plain = self.rows.iter().filter(|row| row.change.is_empty());
        for label in plain.map(Row::label) {
            if !labels.contains(&label) {
                labels.push(label);
            }
        }
        labels
    }

    /// Above all figures: what was studied, and who judged it, in a line.
    fn subject(&self, html: &mut String) {
        let rows = self.study.rows;
        if rows.is_empty() {
            return;
        }
        let names = trees_of(rows);
        let _ = writeln!(
            html,
            "<p>{}: {}. Judged from views that no method was made for{}.</p>",
            trees(names.len()),
            escaped(&names.join(", ")),
            match held_out::note_of(rows) {
                Some(_) => ", but for those that say so",
                None => "",
            }
        );
    }

    fn which_to_take(&self, html: &mut String) {
        if let Some(table) = recommend(self.given) {
            let table = table.prose_html();
            let _ = writeln!(
                html,
                "<h2>Which to take for the time that you have</h2>\n<p>{WHAT_IS_LISTED}</p>\n{table}"
            );
        }
    }

    /// Above all figures: which views they are from, and which methods knew them.
    fn who_judged(&self, html: &mut String) {
        let rows = self.study.rows;
        if rows.is_empty() {
            return;
        }
        let _ = writeln!(html, "<p>{}</p>", escaped(&held_out::who_judged(rows)));
        if let Some(note) = held_out::note_of(rows) {
            let _ = writeln!(html, "<p><strong>{}</strong></p>", escaped(&note));
        }
    }

    fn who_is_beaten(&self, html: &mut String) {
        // Scenes made for failures count too.
        let rows = self.study.rows;
        let as_drawn = [
            beaten_as_drawn(rows).map(|table| (note_of_counts(&table), table)),
            lost_cases(rows).map(|table| (note_of_lost(&table), table)),
        ];
        let counted = dominance(self.given);
        if counted.is_none() && as_drawn[0].is_none() {
            return;
        }
        section(html, "Who is beaten", |html| {
            if let Some(table) = counted {
                let _ = write!(html, "<p>{WHAT_IS_COUNTED}</p>\n{}", table.html());
            }
            for (note, table) in as_drawn.iter().flatten() {
                let _ = write!(html, "<p>{note}</p>\n{}", table.prose_html());
            }
        });
    }

    fn fairness(&self, html: &mut String) {
        if let Some(table) = fairness::table(self.study.rows) {
            begin_section(html, fairness::TITLE, fairness::WHAT_IS_COMPARED);
            *html += &table.html();
        }
    }

    fn per_set(&self, html: &mut String) {
        for tree in self.trees_of() {
            let _ = write!(
                html,
                "<details><summary>{}</summary>\n<div class=\"wide\"><table><thead><tr><th>method</th><th>leaves</th><th>set</th>",
                escaped(tree)
            );
            for column in COLUMNS.iter() {
                let _ = write!(html, "<th>{}</th>", column.title);
            }
            *html += "</tr></thead><tbody>\n";
            for row in self
                .rows
                .iter()
                .filter(|row| row.tree == tree && row.change.is_empty())
            {
                let sets = match row.rigs.is_empty() {
                    true => std::slice::from_ref(&row.values),
                    false => &row.rigs[..],
                };
                for (values, view) in sets.iter().zip(1..) {
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
            let all: BTreeSet<String> = self.study.rows.iter().map(what).collect();
            escaped(&all.into_iter().collect::<Vec<_>>().join("; "))
        };
        let _ = write!(
            html,
            "<p>secateur {}, commit {}, on {}; leaves drawn by: {}.</p>\n<p>Pictures for SSIM and FLIP are 256 x 256 of four samples a pixel, from the judging views.</p>\n<details><summary>Commands</summary><pre>",
            of(|row| row.version.clone()),
            of(|row| row.commit.clone()),
            of(|row| row.machine.clone()),
            of(|row| row.adapter.clone().unwrap_or_else(|| row.engine.clone()))
        );
        let mut commands: Vec<&str> = self.study.rows.iter().map(|r| r.command.as_str()).collect();
        // Frames of a walk are all of one command.
        commands.dedup();
        for command in commands {
            *html += &escaped(command);
            html.push('\n');
        }
        *html += "</pre></details>\n";
    }
}

#[cfg(test)]
mod tests;
