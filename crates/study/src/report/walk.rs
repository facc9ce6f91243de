//! The section of a walk: its table, and some of its frames.

use std::fmt::Write as _;

use super::{Page, begin_section, write_tables};
use crate::walk::{WHAT_IS_COMPARED, tables};

impl Page<'_> {
    pub(super) fn walk(&self, html: &mut String) {
        let rows = self.study.rows;
        let tables = tables(rows);
        if tables.is_empty() {
            return;
        }
        begin_section(html, "A walk through woods", WHAT_IS_COMPARED);
        write_tables(html, tables);
        let frames = rows.iter().filter(|row| row.walk.is_some());
        let mut pictures: Vec<&str> = frames.map(|row| row.picture.as_str()).collect();
        pictures.retain(|path| !path.is_empty());
        pictures.dedup();
        for path in pictures {
            let image = self.image(path, &format!("{path}: full geometry and levels"));
            let _ = writeln!(html, "<div class=\"wide\">{image}</div>");
        }
    }
}
