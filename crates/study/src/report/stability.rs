//! The section on stability: how far results spread over seeds and perturbations.

use std::collections::BTreeMap;
use std::fmt::Write as _;

use super::super::{Row, groups};
use super::Page;
use super::pictures::caption;
use crate::chart::escaped;
use crate::stability::{WHAT_IS_SPREAD, by_change, by_method, by_tree};

/// The metric that decides which run was the worst.
const MEASURE: &str = "vmi_error_percent";

impl Page<'_> {
    pub(crate) fn stability(&self, html: &mut String) {
        let groups = groups(self.rows);
        if groups.is_empty() {
            return;
        }
        let tables = [
            by_method(self.rows),
            by_change(self.rows),
            by_tree(self.rows),
        ];
        let _ = writeln!(
            html,
            "<h2>Stability</h2>\n<p>{WHAT_IS_SPREAD} Of single trees the worst run's own value is in brackets.</p>"
        );
        tables
            .iter()
            .flatten()
            .for_each(|table| *html += &table.html());
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
