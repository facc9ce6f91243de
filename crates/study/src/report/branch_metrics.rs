//! The section of metrics of branches: one table.

use std::fmt::Write as _;

use super::Page;
use crate::branch_metrics::{WHAT_IS_COMPARED, table};
use crate::chart::escaped;

impl Page<'_> {
    pub(super) fn branch_metrics(&self, html: &mut String) {
        if let Some(table) = table(self.study.rows) {
            let (what, table) = (escaped(WHAT_IS_COMPARED), table.html());
            let _ = writeln!(html, "<h2>Metrics of branches</h2>\n<p>{what}</p>\n{table}");
        }
    }
}
