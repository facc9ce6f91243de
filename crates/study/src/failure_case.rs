//! Scenes that are made for one failure each, and the verdict of the rows on each.

use super::{COLUMNS, Row};
use crate::format::{number_of, percent};
use crate::table::Table;

/// A scene that is made for one failure; rows know it as a tree.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FailureCase {
    /// The scene's name, as in [`Row::tree`].
    pub tree: String,
    /// The heading in reports: "Leaves below a pixel".
    pub title: String,
    /// What it is made of, and what should go wrong, in a sentence or two.
    pub about: String,
    /// The case that should fail, as [`Row::label`].
    pub suspect: String,
}

const CLEARLY_LESS_ERROR: f64 = 0.1;
const CLEARLY_MORE_IOU: f64 = 0.01;

/// What reports say that verdicts mean by better: see [`Found::beats`].
pub(crate) const WHAT_IS_BETTER: &str = "Small scenes, each made for one failure. Better is what has a tenth less VMI error or a hundredth more silhouette IoU, and is not as much worse in the other of the two.";

/// VMI error and silhouette IoU decide: neither says enough alone.
#[derive(Clone, Copy, Debug)]
struct JudgedRow<'r> {
    row: &'r Row,
    vmi_error_percent: f64,
    silhouette_iou: f64,
}

impl<'r> JudgedRow<'r> {
    fn of(row: &'r Row) -> Self {
        let value = |key: &str| row.values.get(key).copied().flatten();
        Self {
            row,
            vmi_error_percent: value("vmi_error_percent").unwrap_or(f64::INFINITY),
            silhouette_iou: value("silhouette_iou").unwrap_or(0.0),
        }
    }

    /// Clearly better in one measure, and not clearly worse in the other.
    fn beats(&self, other: &Self) -> bool {
        let is_better = |a: &Self, b: &Self| {
            a.vmi_error_percent < (1.0 - CLEARLY_LESS_ERROR) * b.vmi_error_percent
                || a.silhouette_iou > b.silhouette_iou + CLEARLY_MORE_IOU
        };
        is_better(self, other) && !is_better(other, self)
    }

    fn in_words(&self) -> String {
        let label = self.row.label();
        let (error, iou) = (self.vmi_error_percent, self.silhouette_iou);
        format!("{label} (VMI error {error:.1} %, IoU {iou:.3})")
    }
}

/// What the coarsest level of a scene's rows says, and the rows that say it:
/// the suspect's, then the best that beats it with the same method, then the
/// best of other methods that beats both.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Verdict<'r> {
    pub(crate) text: String,
    pub(crate) rows: Vec<&'r Row>,
}

impl FailureCase {
    fn rows<'r>(&self, rows: &'r [Row]) -> Vec<&'r Row> {
        rows.iter().filter(|row| row.tree == self.tree).collect()
    }

    /// The verdict at the coarsest level; nothing if the suspect did not run there.
    pub(crate) fn verdict<'r>(&self, rows: &'r [Row]) -> Option<Verdict<'r>> {
        let rows = self.rows(rows);
        let level = rows.iter().map(|row| row.level).min_by(f64::total_cmp)?;
        let found: Vec<JudgedRow> = (rows.iter().filter(|row| row.level == level))
            .map(|row| JudgedRow::of(row))
            .collect();
        let suspect = found.iter().find(|f| f.row.label() == self.suspect)?;
        let best_that_beats = |rival: &JudgedRow, is_own: bool| {
            let better = found
                .iter()
                .filter(|f| (f.row.method == suspect.row.method) == is_own && f.beats(rival));
            better
                .min_by(|a, b| a.vmi_error_percent.total_cmp(&b.vmi_error_percent))
                .copied()
        };
        let own = best_that_beats(suspect, true);
        let other = best_that_beats(own.as_ref().unwrap_or(suspect), false);
        let method = &suspect.row.method;
        let at = format!("At {} of the leaves", percent(level));
        let failing = suspect.in_words();
        let mut text = match (&own, &other) {
            (None, None) => {
                format!("{at} nothing tried here is better than {failing}.")
            }
            (Some(own), _) => {
                let default = match own.row.variant().as_str() {
                    "" => ", which is the default",
                    _ => "",
                };
                let better = own.in_words();
                format!("{at} {better} is better than {failing}: use that{default}.")
            }
            (None, Some(_)) => {
                format!("{at} no option of {method} tried here is better than {failing}.")
            }
        };
        if let Some(other) = &other {
            let still = if own.is_some() {
                "still better"
            } else {
                "better"
            };
            text += &format!(" {} is {still}.", other.in_words());
        }
        let rows = [Some(*suspect), own, other].into_iter().flatten();
        Some(Verdict {
            text,
            rows: rows.map(|f| f.row).collect(),
        })
    }

    /// All rows of the scene as a table.
    pub(crate) fn table(&self, rows: &[Row]) -> Table {
        let mut head = vec!["method", "leaves"];
        head.extend(COLUMNS.iter().map(|c| c.title));
        head.push("largest leaf, times its area");
        let mut table = Table::new(&head);
        for row in self.rows(rows) {
            let mut cells = vec![row.label(), percent(row.level)];
            cells.extend(COLUMNS.iter().map(|c| number_of(row, c)));
            let scale = row.max_area_scale;
            cells.push(scale.map_or(String::new(), |s| format!("{s:.1}")));
            table.push(cells);
        }
        table
    }
}

/// A line for each scene that ran: what it is, and what to do about it.
pub(crate) fn overview(failure_cases: &[FailureCase], rows: &[Row]) -> Option<Table> {
    let mut table = Table::new(&["scene", "what it is", "what to do about it"]);
    for failure_case in failure_cases {
        if let Some(verdict) = failure_case.verdict(rows) {
            table.push(vec![
                failure_case.title.clone(),
                failure_case.about.clone(),
                verdict.text,
            ]);
        }
    }
    (!table.body.is_empty()).then_some(table)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rows::tests::row;

    fn judged(method: &str, setting: &str, error: f64, iou: f64) -> Row {
        let mut row = row(method, 0.1, 1.0, error);
        row.setting = setting.into();
        row.values.insert("silhouette_iou".into(), Some(iou));
        row
    }

    fn said(rows: &[Row]) -> (String, Vec<String>) {
        let failure_case = FailureCase {
            tree: "oak".into(),
            title: "t".into(),
            about: "a".into(),
            suspect: "vds resolution 64".into(),
        };
        let verdict = failure_case.verdict(rows).unwrap();
        let labels = verdict.rows.iter().map(|row| row.label()).collect();
        (verdict.text, labels)
    }

    #[test]
    fn a_verdict_names_what_beats_the_suspect_in_both_measures() {
        let mut rows = vec![
            judged("vds", "resolution 64", 20.0, 0.5),
            // Less error, but a worse silhouette.
            judged("fsa", "", 10.0, 0.4),
        ];
        let (text, labels) = said(&rows);
        assert!(
            text.contains("nothing tried here is better than vds resolution 64"),
            "{text}"
        );
        assert_eq!(labels, ["vds resolution 64"]);

        rows.push(judged("vds", "", 12.0, 0.5));
        let (text, labels) = said(&rows);
        assert!(
            text.contains("vds (VMI error 12.0 %, IoU 0.500) is better than vds resolution 64"),
            "{text}"
        );
        assert!(text.ends_with("which is the default."), "{text}");
        assert_eq!(labels, ["vds resolution 64", "vds"]);

        rows.push(judged("stochastic", "", 11.9, 0.7));
        let (text, labels) = said(&rows);
        assert!(text.ends_with("stochastic (VMI error 11.9 %, IoU 0.700) is still better."));
        assert_eq!(labels.len(), 3);

        rows.remove(2);
        let (text, _) = said(&rows);
        assert!(
            text.contains("no option of vds tried here is better"),
            "{text}"
        );
    }

    #[test]
    fn a_scene_that_did_not_run_is_left_out() {
        let failure_case = FailureCase {
            tree: "scene".into(),
            title: String::new(),
            about: String::new(),
            suspect: "vds".into(),
        };
        assert_eq!(failure_case.verdict(&[judged("vds", "", 1.0, 1.0)]), None);
        assert_eq!(overview(&[failure_case], &[]), None);
    }
}
