//! The section of what is drawn at the distances of a walk: charts and tables.

use std::fmt::Write as _;

use super::Page;
use crate::chart::escaped;
use crate::distances::{WHAT_IS_COMPARED, charts, tables};

impl Page<'_> {
    pub(super) fn distances(&self, html: &mut String) {
        let rows = self.study.rows;
        let tables = tables(rows);
        if tables.is_empty() {
            return;
        }
        let _ = writeln!(
            html,
            "<h2>At the distances of a walk</h2>\n<p>{}</p>",
            escaped(WHAT_IS_COMPARED)
        );
        *html += "<div class=\"charts\">\n";
        for (_, svg) in charts(rows) {
            *html += &svg;
        }
        *html += "</div>\n";
        for (title, table) in tables {
            let _ = write!(html, "<h3>{}</h3>\n{}", escaped(&title), table.html());
        }
    }
}
