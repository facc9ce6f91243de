//! The section of what is drawn at the distances of a walk: charts and tables.

use super::{Page, begin_section, write_tables};
use crate::distances::{WHAT_IS_COMPARED, charts, tables};

impl Page<'_> {
    pub(super) fn distances(&self, html: &mut String) {
        let rows = self.study.rows;
        let tables = tables(rows);
        if tables.is_empty() {
            return;
        }
        begin_section(html, "At the distances of a walk", WHAT_IS_COMPARED);
        *html += "<div class=\"charts\">\n";
        for (_, svg) in charts(rows) {
            *html += &svg;
        }
        *html += "</div>\n";
        write_tables(html, tables);
    }
}
