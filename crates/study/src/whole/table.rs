//! Rows of whole plants as tables.

use std::collections::BTreeMap;

use super::WholeCase;
use crate::format::{duration, percent};
use crate::rows::millionths;
use crate::table::Table;
use crate::{Row, WholeCounts};

/// What stands above the tables.
pub(crate) const WHAT_IS_COMPARED: &str = "Levels are shares of all triangles, wood and leaves; FLIP, SSIM and the overlap of outlines (IoU) are of the whole plant. `wood auto` is `simplify --triangles` as it is by default, `wood keep` leaves the wood as it was and has no line where the wood alone is more than the level. gltfpack (`-si R -sa`) mostly leaves fewer triangles than the share that it is asked for, so of up to eight shares the one counts that comes nearest to the level from below; where it has more than the level, it gets no lower.";

fn value(row: &Row, key: &str) -> Option<f64> {
    row.values.get(key).copied().flatten()
}

fn worst(row: &Row, key: &str) -> Option<f64> {
    row.worst.get(key).copied().flatten()
}

/// A title and a table for each level, most triangles first.
pub(crate) fn tables(rows: &[Row]) -> Vec<(String, Table)> {
    let whole: Vec<(&Row, WholeCounts)> = rows.iter().filter_map(|r| Some((r, r.whole?))).collect();
    let mut by_level: BTreeMap<u64, Vec<(&Row, WholeCounts)>> = BTreeMap::new();
    for of_row in whole {
        let level = millionths(of_row.0.level);
        by_level.entry(level).or_default().push(of_row);
    }
    let of_level = |(level, rows): (u64, Vec<(&Row, WholeCounts)>)| {
        let level = percent(level as f64 / 1e6);
        (format!("{level} of all triangles"), table(&rows))
    };
    by_level.into_iter().rev().map(of_level).collect()
}

fn table(rows: &[(&Row, WholeCounts)]) -> Table {
    let mut table = Table::new(&[
        "tree",
        "triangles",
        "method",
        "left",
        "of them wood",
        "FLIP",
        "worst set",
        "times gltfpack's",
        "SSIM",
        "outline IoU",
        "time",
    ]);
    let shown = |value: Option<f64>| value.map_or(String::new(), |v| format!("{v:.4}"));
    for (row, counts) in rows {
        let [gltfpack, _] = WholeCase::Gltfpack.method_and_setting();
        let beside = (rows.iter()).find(|(r, _)| r.tree == row.tree && r.method == gltfpack);
        let flip = value(row, "flip_mean");
        let ratio = match beside {
            Some((other, _)) if row.method != gltfpack => {
                Some(flip.unwrap_or(f64::NAN) / value(other, "flip_mean").unwrap_or(f64::NAN))
            }
            _ => None,
        };
        let wood = counts.wood_triangles_final;
        table.push(vec![
            row.tree.clone(),
            counts.triangles_original.to_string(),
            row.label(),
            row.triangles_final.to_string(),
            wood.map_or(String::new(), |count| count.to_string()),
            shown(flip),
            shown(worst(row, "flip_mean")),
            ratio.map_or(String::new(), |r| format!("{r:.2}")),
            shown(value(row, "ssim")),
            shown(value(row, "silhouette_iou")),
            duration(row.seconds),
        ]);
    }
    table
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rows::tests::row;

    fn of(case: WholeCase, level: f64, flip: f64) -> Row {
        let [method, setting] = case.method_and_setting();
        let mut row = row(method, level, 1.0, 1.0);
        row.setting = setting.into();
        row.values.insert("flip_mean".into(), Some(flip));
        row.whole = Some(WholeCounts {
            triangles_original: 70,
            wood_triangles_final: None,
        });
        row
    }

    #[test]
    fn whole_plants_stand_beside_gltfpack_level_by_level() {
        let rows = [
            of(WholeCase::Auto, 0.1, 0.02),
            of(WholeCase::Gltfpack, 0.1, 0.08),
            of(WholeCase::Auto, 0.5, 0.01),
            row("vds", 0.1, 1.0, 1.0),
        ];
        let tables = tables(&rows);
        let titles: Vec<&str> = tables.iter().map(|(title, _)| title.as_str()).collect();
        assert_eq!(titles, ["50 % of all triangles", "10 % of all triangles"]);
        let lines = &tables[1].1.body;
        assert_eq!(lines.len(), 2, "rows of leaves alone are elsewhere");
        assert_eq!(lines[0][2], "vds wood auto");
        assert_eq!(lines[0][7], "0.25");
        assert_eq!(lines[1][7], "");
        assert_eq!(tables[0].1.body[0][7], "", "gltfpack did not run");
    }
}
