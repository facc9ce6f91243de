//! The time of VDS over that of FSA as published, tree by tree.

use crate::format::{duration, percent};
use crate::table::Table;
use crate::{Case, Row};

/// The time of one method to a level of a tree.
fn seconds(rows: &[Row], tree: &str, level: f64, case: &Case) -> Option<f64> {
    let is_it = |row: &&Row| row.tree == tree && row.level == level && row.label() == case.label();
    rows.iter().find(is_it).map(|row| row.seconds)
}

/// For each tree and level the seconds of the default by leaves, those of FSA, and their ratio;
/// nothing where no tree has both.
pub(crate) fn fsa_time(rows: &[Row]) -> Option<Table> {
    let (vds, fsa) = (crate::named_cases::look(), crate::named_cases::fsa());
    let mut levels: Vec<f64> = rows.iter().map(|row| row.level).collect();
    levels.sort_by(|a, b| b.total_cmp(a));
    levels.dedup();
    let mut trees: Vec<(u64, &str)> = rows
        .iter()
        .map(|row| (row.leaves_original, row.tree.as_str()))
        .collect();
    trees.sort_unstable();
    trees.dedup();
    let shares: Vec<String> = levels.iter().map(|level| percent(*level)).collect();
    let head = ["tree", "leaves"].into_iter();
    let head: Vec<&str> = head.chain(shares.iter().map(String::as_str)).collect();
    let mut table = Table::new(&head);
    for (leaves, tree) in trees {
        let cell = |level: &f64| {
            let [ours, theirs] = [&vds, &fsa].map(|case| seconds(rows, tree, *level, case));
            let (ours, theirs) = (ours?, theirs?);
            let ratio = ours / theirs;
            Some(format!(
                "{} / {} = {ratio:.2}",
                duration(ours),
                duration(theirs)
            ))
        };
        let cells: Vec<Option<String>> = levels.iter().map(cell).collect();
        if cells.iter().all(Option::is_none) {
            continue;
        }
        let first = [tree.to_owned(), leaves.to_string()].into_iter();
        let cells = cells.into_iter().map(Option::unwrap_or_default);
        table.push(first.chain(cells).collect());
    }
    (!table.body.is_empty()).then_some(table)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rows::tests::row;

    #[test]
    fn times_stand_over_each_other_where_a_tree_has_both() {
        let fsa = |level: f64, seconds: f64| Row {
            setting: "corners furthest".into(),
            ..row("fsa", level, seconds, 9.0)
        };
        let rows = [
            row("vds", 0.1, 1.5, 3.0),
            fsa(0.1, 2.0),
            row("vds", 0.5, 0.25, 3.0),
            Row {
                tree: "lonely".into(),
                ..row("vds", 0.5, 0.25, 3.0)
            },
        ];
        let table = fsa_time(&rows).unwrap();
        assert_eq!(table.head[2..], ["50 %", "10 %"]);
        assert_eq!(table.body.len(), 1, "{table:?}");
        assert_eq!(table.body[0][2..], ["", "1.50 s / 2.00 s = 0.75"]);
        assert_eq!(fsa_time(&rows[3..]), None);
    }
}
