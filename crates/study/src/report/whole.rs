//! The section of whole plants: tables, and pictures of every level.

use std::fmt::Write as _;

use super::{Page, Row, begin_section, trees_of, write_tables};
use crate::chart::escaped;
use crate::format::percent;
use crate::whole::{WHAT_IS_COMPARED, tables};

impl Page<'_> {
    pub(super) fn whole(&self, html: &mut String) {
        let rows = self.study.rows;
        let tables = tables(rows);
        if tables.is_empty() {
            return;
        }
        begin_section(html, "Whole plants", WHAT_IS_COMPARED);
        write_tables(html, tables);
        for tree in trees_of(rows) {
            let of_tree = rows.iter().filter(|row| row.tree == tree);
            let of_tree: Vec<&Row> = of_tree.filter(|row| row.whole.is_some()).collect();
            self.whole_tree(html, tree, &of_tree);
        }
    }

    fn whole_tree(&self, html: &mut String, tree: &str, rows: &[&Row]) {
        let Some(first) = rows.first() else {
            return;
        };
        let original = first.identity().original_picture();
        let _ = write!(
            html,
            "<details><summary>{}, pictures</summary><div class=\"wide\"><table class=\"sheet\"><tbody>\n<tr><td><figure>{}<figcaption>original</figcaption></figure></td></tr>\n",
            escaped(tree),
            self.image(&original, &format!("{tree}, original"))
        );
        let mut levels: Vec<f64> = rows.iter().map(|row| row.level).collect();
        levels.sort_by(|a, b| b.total_cmp(a));
        levels.dedup();
        for level in levels {
            *html += "<tr>";
            for row in rows.iter().filter(|row| row.level == level) {
                let what = format!("{tree}, {}, {}", row.label(), percent(level));
                let caption = format!(
                    "{}, {}: {} triangles",
                    row.label(),
                    percent(level),
                    row.triangles_final
                );
                let _ = write!(
                    html,
                    "<td><figure>{}{}<figcaption>{}</figcaption></figure></td>",
                    self.image(&row.picture, &what),
                    self.image(&row.difference, &format!("{what}, difference")),
                    escaped(&caption)
                );
            }
            *html += "</tr>\n";
        }
        *html += "</tbody></table></div></details>\n";
    }
}
