//! Where methods fail.

use std::fmt::Write as _;

use super::super::chart::escaped;
use super::super::trial::{WHAT_IS_BETTER, overview};
use super::Page;
use super::pictures::caption;

impl Page<'_> {
    /// What to do about each, then each scene with its pictures and figures.
    pub(super) fn failures(&self, html: &mut String) {
        let rows = self.study.rows;
        let Some(table) = overview(self.study.trials, rows) else {
            return;
        };
        let _ = write!(
            html,
            "<h2>Where methods fail</h2>\n<p>{WHAT_IS_BETTER}</p>\n<div class=\"prose\">"
        );
        *html += &table.html();
        *html += "</div>\n";
        for trial in self.study.trials {
            let Some(verdict) = trial.verdict(rows) else {
                continue;
            };
            let original = self.image(
                &format!("pictures/{}-original.jpg", trial.tree),
                &format!("{}, original", trial.title),
            );
            let _ = write!(
                html,
                "<h3>{}</h3>\n<p>{} {}</p>\n<div class=\"pair\"><figure>{original}<figcaption>original</figcaption></figure>",
                escaped(&trial.title),
                escaped(&trial.about),
                escaped(&verdict.text)
            );
            for row in &verdict.rows {
                let what = format!("{}, {}", trial.title, row.label());
                let _ = write!(
                    html,
                    "<figure>{}{}<figcaption>{}; below, the difference</figcaption></figure>",
                    self.image(&row.picture, &what),
                    self.image(&row.difference, &format!("{what}, difference")),
                    escaped(&caption(row))
                );
            }
            *html += "</div>\n<details><summary>All methods and levels</summary>\n";
            *html += &trial.table(rows).html();
            *html += "</details>\n";
        }
    }
}
