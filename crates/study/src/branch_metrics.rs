//! The four metrics of branches beside each other, as a table: which of them chooses the better chain.
//!
//! Lluch et al. (Hybrid), section 4.1.1.

use crate::columns::{CROWN_HEIGHT_COLUMN, DIFFERENCE_COLUMN, column};
use crate::format::{number, percent};
use crate::named_cases::by_metrics;
use crate::rows::millionths;
use crate::table::Table;
use crate::{Case, Column, Row};

/// What stands above the table.
pub(crate) const WHAT_IS_COMPARED: &str = "Leaves left by the branch chain, with branches in the order of each metric of Hybrid, section 4.1; wood stays. Values are means over trees on which all four ran, and beside the difference stands its worst. Crown height is from the lowest to the highest corner of a leaf. Hybrid prefers the branching length.";

/// A metric's name, as `--branch-metric` has it.
fn metric_of(case: &Case) -> String {
    let setting = case.setting();
    let name = setting.strip_prefix("branch-metric ");
    name.unwrap_or("branching-length").to_owned()
}

/// The row of a case on a tree at a level, unless it is older; of several the last counts.
fn row_of<'r>(rows: &'r [Row], case: &Case, tree: &str, level: u64) -> Option<&'r Row> {
    let is_it = |row: &&Row| {
        row.is_of_leaves()
            && CROWN_HEIGHT_COLUMN.value_of(row).is_finite()
            && row.change.is_empty()
            && row.label() == case.label()
            && row.tree == tree
            && millionths(row.level) == level
    };
    rows.iter().rev().find(is_it)
}

/// A line for each level and metric, most leaves first; nothing if no tree has all four.
pub(crate) fn table(rows: &[Row]) -> Option<Table> {
    let cases = by_metrics();
    let values: [&Column; 4] = [
        &DIFFERENCE_COLUMN,
        column("silhouette_iou"),
        &CROWN_HEIGHT_COLUMN,
        column("vmi_error_percent"),
    ];
    let mut head = vec!["left", "metric", "trees"];
    head.extend(values.map(|value| value.title));
    head.insert(4, "worst");
    let mut table = Table::new(&head);
    let (mut trees, mut levels): (Vec<&str>, Vec<u64>) = (Vec::new(), Vec::new());
    for row in rows.iter().filter(|row| row.method == cases[0].method()) {
        trees.push(&row.tree);
        levels.push(millionths(row.level));
    }
    trees.sort_unstable();
    trees.dedup();
    levels.sort_unstable();
    levels.dedup();
    for level in levels.into_iter().rev() {
        let of_case = |case, tree: &&str| row_of(rows, case, tree, level);
        let has_all = |tree: &&&str| cases.iter().all(|case| of_case(case, tree).is_some());
        let complete: Vec<&&str> = trees.iter().filter(has_all).collect();
        if complete.is_empty() {
            continue;
        }
        for case in &cases {
            let rows = complete.iter().filter_map(|tree| of_case(case, tree));
            let rows: Vec<&Row> = rows.collect();
            let all = |column: &Column| rows.iter().map(|row| column.value_of(row)).collect();
            let mut cells = vec![
                percent(level as f64 / 1e6),
                metric_of(case),
                rows.len().to_string(),
            ];
            cells.extend(values.map(|value| {
                let all: Vec<f64> = all(value);
                number(all.iter().sum::<f64>() / all.len() as f64, value)
            }));
            let worst = all(values[0]).into_iter().fold(0.0, f64::max);
            cells.insert(4, number(worst, values[0]));
            table.push(cells);
        }
    }
    (!table.body.is_empty()).then_some(table)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rows::tests::row;

    fn of(case: &Case, tree: &str, difference: f64) -> Row {
        let mut row = row(case.method(), 0.25, 1.0, 8.0);
        row.setting = case.setting();
        row.tree = tree.to_owned();
        row.values
            .insert(DIFFERENCE_COLUMN.key.into(), Some(difference));
        row.values
            .insert(CROWN_HEIGHT_COLUMN.key.into(), Some(0.75));
        row
    }

    /// An elm lacks one metric, so that only the oak and the ash count.
    #[test]
    fn metrics_are_means_over_trees_that_have_all() {
        let cases = by_metrics();
        let mut rows = Vec::new();
        for (k, case) in cases.iter().enumerate() {
            rows.push(of(case, "oak", 0.25 * k as f64));
            rows.push(of(case, "ash", 0.5));
            if k > 0 {
                rows.push(of(case, "elm", 9.0));
            }
        }
        let lines = table(&rows).unwrap().body;
        let names: Vec<&str> = lines.iter().map(|line| line[1].as_str()).collect();
        let expected = [
            "branching-length",
            "children",
            "descendants",
            "longest-path",
        ];
        assert_eq!(names, expected);
        let expected = [
            "25 %",
            "longest-path",
            "2",
            "0.6250",
            "0.7500",
            "0.5000",
            "0.7500",
            "8.00",
        ];
        assert_eq!(lines[3], expected);
        rows.retain(|row| row.tree == "elm");
        assert_eq!(table(&rows), None);
    }
}
