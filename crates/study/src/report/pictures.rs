//! The section of pictures: one at a time beside its original, and contact sheets.

use std::collections::BTreeSet;
use std::fmt::Write as _;

use super::super::Row;
use super::Page;
use crate::chart::escaped;
use crate::format::{duration, percent};

impl Page<'_> {
    pub(crate) fn image(&self, path: &str, text: &str) -> String {
        let kind = match path.ends_with(".png") {
            true => "png",
            false => "jpeg",
        };
        match self.images.get(path) {
            Some(data) => format!(
                "<img alt=\"{}\" src=\"data:image/{kind};base64,{data}\">",
                escaped(text)
            ),
            None => String::new(),
        }
    }

    pub(crate) fn trees(&self, html: &mut String) {
        let plain: Vec<&Row> = (self.rows.iter())
            .filter(|row| row.change.is_empty())
            .collect();
        if plain.is_empty() {
            return;
        }
        *html += "<h2>Pictures</h2>\n<p>Differences are FLIP errors of the pictures, from black (none) through purple and orange to pale yellow.</p>\n";
        for tree in self.trees_of() {
            self.tree(html, tree, &plain);
        }
    }

    fn tree(&self, html: &mut String, tree: &str, plain: &[&Row]) {
        let rows: Vec<&&Row> = plain.iter().filter(|row| row.tree == tree).collect();
        let here: BTreeSet<String> = rows.iter().map(|row| row.label()).collect();
        let labels: Vec<String> = self
            .labels()
            .into_iter()
            .filter(|l| here.contains(l))
            .collect();
        let Some(first) = rows.first() else {
            return;
        };
        let original = self.image(
            &first.identity().original_picture(),
            &format!("{tree}, original"),
        );
        let options: String = labels
            .iter()
            .enumerate()
            .map(|(k, label)| format!("<option value=\"{k}\">{}</option>", escaped(label)))
            .collect();
        let names: Vec<String> = self.levels.iter().map(|l| percent(*l)).collect();
        let _ = write!(
            html,
            "<section class=\"tree\">\n<h3>{0}</h3>\n<div class=\"controls\"><label>method <select>{options}</select></label><label>leaves <input type=\"range\" min=\"0\" max=\"{1}\" value=\"0\" data-names=\"{2}\"> <output></output></label></div>\n<div class=\"pair\"><figure>{original}<figcaption>original</figcaption></figure><figure class=\"shown\"><img alt=\"the chosen level\"><figcaption></figcaption></figure><figure class=\"differs\"><img alt=\"its difference from the original\"><figcaption>difference</figcaption></figure></div>\n<details><summary>All methods and levels</summary><div class=\"wide\"><table class=\"sheet\"><tbody>\n",
            escaped(tree),
            self.levels.len().saturating_sub(1),
            names.join("|")
        );
        for (k, label) in labels.iter().enumerate() {
            *html += "<tr>";
            for (l, level) in self.levels.iter().enumerate() {
                let at_level = |r: &&&&Row| r.level == *level && r.label() == *label;
                let Some(row) = rows.iter().find(at_level) else {
                    *html += "<td></td>";
                    continue;
                };
                let what = format!("{tree}, {label}, {}", percent(*level));
                let _ = write!(
                    html,
                    "<td data-method=\"{k}\" data-level=\"{l}\"><figure>{}{}<figcaption>{}</figcaption></figure></td>",
                    self.image(&row.picture, &what),
                    self.image(&row.difference, &format!("{what}, difference")),
                    escaped(&caption(row))
                );
            }
            *html += "</tr>\n";
        }
        *html += "</tbody></table></div></details>\n</section>\n";
    }
}

/// The caption of a row's picture.
pub(crate) fn caption(row: &Row) -> String {
    let value = |key: &str| {
        row.values
            .get(key)
            .copied()
            .flatten()
            .unwrap_or(f64::INFINITY)
    };
    format!(
        "{}, {}: {} leaves, VMI error {:.1} %, IoU {:.3}, {}",
        row.label(),
        percent(row.level),
        row.leaves_final,
        value("vmi_error_percent"),
        value("silhouette_iou"),
        duration(row.seconds)
    )
}
