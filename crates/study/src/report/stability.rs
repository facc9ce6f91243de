//! The section on stability: how far results spread over seeds and perturbations.

use std::collections::BTreeMap;
use std::fmt::Write as _;

use super::super::{COLUMNS, Row, groups, overlap, spread};
use super::Page;
use super::pictures::caption;
use crate::chart::escaped;
use crate::format::{number, percent};

/// The metric that decides which run was the worst.
const MEASURE: &str = "vmi_error_percent";

impl Page<'_> {
    pub(crate) fn stability(&self, html: &mut String) {
        let groups = groups(self.rows);
        if groups.is_empty() {
            return;
        }
        *html += "<h2>Stability</h2>\n<p>Mean and standard deviation over seeds and over changes that should not matter, the worst of them in brackets. Shared leaves: mean overlap (Jaccard) of the original leaves left with those of the method's first run, and the least.</p>\n<div class=\"wide\"><table><thead><tr><th>tree</th><th>method</th><th>leaves</th><th>runs</th><th>shared leaves</th>";
        for column in COLUMNS.iter() {
            let _ = write!(html, "<th>{}</th>", column.title);
        }
        *html += "</tr></thead><tbody>\n";
        for ((tree, method, setting, level), rows) in &groups {
            let shared = overlap(rows).map_or(String::new(), |(mean, least)| {
                format!("{mean:.3} ({least:.3})")
            });
            let _ = write!(
                html,
                "<tr><td>{}</td><td>{} {}</td><td>{}</td><td>{}</td><td>{shared}</td>",
                escaped(tree),
                escaped(method),
                escaped(setting),
                percent(*level as f64 / 1e6),
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
        self.worst_cases(html, groups.values());
    }

    /// For each tree, method and setting: the run that a change made worst,
    /// beside the one without.
    fn worst_cases<'r>(&self, html: &mut String, groups: impl Iterator<Item = &'r Vec<&'r Row>>) {
        let mut worst: BTreeMap<[&str; 3], (f64, &Row, &Row)> = BTreeMap::new();
        for rows in groups {
            let (first, others) = (rows[0], &rows[1..]);
            for row in others {
                let rise = error_of(row) - error_of(first);
                let key = [&first.tree, &first.method, &first.setting].map(String::as_str);
                if worst.get(&key).is_none_or(|(most, ..)| rise > *most) {
                    worst.insert(key, (rise, first, row));
                }
            }
        }
        *html += "<h3>Worst cases</h3>\n<p>Of each method on each tree, the run whose VMI error rose most against its first run, whatever the level.</p>\n";
        for (_, first, row) in worst.values() {
            *html += "<div class=\"pair\">";
            for (row, is_worst) in [(first, false), (row, true)] {
                let what = if is_worst { "worst" } else { "first" };
                let text = format!("{}: {}, {what} run", row.tree, row.label());
                let _ = write!(
                    html,
                    "<figure>{}<figcaption>{} {}</figcaption></figure>",
                    self.image(&row.picture, &text),
                    escaped(&format!("{}, {what} run:", row.tree)),
                    escaped(&caption(row))
                );
            }
            *html += "</div>\n";
        }
    }
}

fn error_of(row: &Row) -> f64 {
    let error = row.values.get(MEASURE).copied().flatten();
    error.unwrap_or(f64::INFINITY)
}
