//! The section "Where methods fail".

use std::fmt::Write as _;

use super::Page;
use super::pictures::caption;
use crate::chart::escaped;
use crate::failure_case::{WHAT_IS_BETTER, overview};

impl Page<'_> {
    /// An overview of all scenes, then each with its verdict, pictures and rows.
    pub(crate) fn failures(&self, html: &mut String) {
        let rows = self.study.rows;
        let Some(table) = overview(self.study.failure_cases, rows) else {
            return;
        };
        let _ = write!(
            html,
            "<h2>Where methods fail</h2>\n<p>{WHAT_IS_BETTER}</p>\n<div class=\"prose\">"
        );
        *html += &table.html();
        *html += "</div>\n";
        for failure_case in self.study.failure_cases {
            let Some(verdict) = failure_case.verdict(rows) else {
                continue;
            };
            let original = self.image(
                &verdict.rows[0].identity().original_picture(),
                &format!("{}, original", failure_case.title),
            );
            let _ = write!(
                html,
                "<h3>{}</h3>\n<p>{} {}</p>\n<div class=\"pair\"><figure>{original}<figcaption>original</figcaption></figure>",
                escaped(&failure_case.title),
                escaped(&failure_case.about),
                escaped(&verdict.text)
            );
            for row in &verdict.rows {
                let what = format!("{}, {}", failure_case.title, row.label());
                let _ = write!(
                    html,
                    "<figure>{}{}<figcaption>{}; below, the difference</figcaption></figure>",
                    self.image(&row.picture, &what),
                    self.image(&row.difference, &format!("{what}, difference")),
                    escaped(&caption(row))
                );
            }
            *html += "</div>\n<details><summary>All methods and levels</summary>\n";
            *html += &failure_case.table(rows).html();
            *html += "</details>\n";
        }
    }
}
