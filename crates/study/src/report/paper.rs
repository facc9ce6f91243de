//! The section that compares a paper's figures with the rows.

use std::fmt::Write as _;

use super::Page;
use crate::chart::escaped;
use crate::published::beside;

impl Page<'_> {
    pub(crate) fn paper(&self, html: &mut String) {
        let Some(paper) = self.study.paper else {
            return;
        };
        let tables = beside(paper, &self.study.plain_rows());
        if tables.is_empty() {
            return;
        }
        let _ = writeln!(
            html,
            "<h2>Beside the paper's figures</h2>\n<p>{}</p>",
            escaped(&paper.about)
        );
        for (title, table) in &tables {
            let _ = write!(
                html,
                "<details open><summary>{}</summary>\n{}</details>\n",
                escaped(title),
                table.html()
            );
        }
    }
}
