//! On how many trees a method is dominated: another one is better in VMI error, in the outline, or
//! in both.

use super::{Row, held_out};
use crate::columns::column;
use crate::format::percent;
use crate::table::Table;

/// What reports say the cells of [`dominance`] count.
pub(crate) const WHAT_IS_COUNTED: &str = "On how many of the trees some other method is better in both VMI error and silhouette IoU / in at least one of them / in FLIP. VMI error alone can be had at the price of the outline, and the outline at the price of VMI error.";

/// A line for each method and setting, in the order of their first rows, counted over unchanged
/// trees; nothing if there is only one method.
pub(crate) fn dominance(rows: &[Row]) -> Option<Table> {
    let rows: Vec<&Row> = rows.iter().filter(|r| r.change.is_empty()).collect();
    let mut levels: Vec<f64> = rows.iter().map(|row| row.level).collect();
    levels.sort_by(|a, b| b.total_cmp(a));
    levels.dedup();
    let mut labels: Vec<String> = Vec::new();
    for label in rows.iter().map(|row| row.label()) {
        if !labels.contains(&label) {
            labels.push(label);
        }
    }
    if !rows.iter().any(|row| row.method != rows[0].method) {
        return None;
    }
    let mut head = vec!["method".to_owned()];
    head.extend(levels.iter().map(|level| percent(*level)));
    head.push("in both by".to_owned());
    let names: Vec<&str> = head.iter().map(String::as_str).collect();
    let mut table = Table::new(&names);
    for label in labels {
        let mut winners: Vec<String> = Vec::new();
        let is_own = |row: &&&Row| row.label() == label && row.is_driven_by_judging_views;
        let is_flattered = rows.iter().any(|row| is_own(&row));
        let mut cells = vec![held_out::shown(&label, is_flattered)];
        for level in &levels {
            let there = || rows.iter().filter(|row| row.level == *level);
            let (mut in_both, mut in_one, mut in_flip, mut cases) = (0, 0, 0, 0);
            for own in there().filter(|row| row.label() == label) {
                let rivals = there().filter(|r| r.tree == own.tree && r.method != own.method);
                let gains: Vec<_> = rivals.map(|rival| (rival, gains(rival, own))).collect();
                let better_in_both = gains.iter().filter(|(_, g)| *g == [true; 2]);
                let mut better_in_both = better_in_both.map(|(rival, _)| &rival.method).peekable();
                cases += 1;
                in_one += i32::from(gains.iter().any(|(_, g)| g.contains(&true)));
                in_both += i32::from(better_in_both.peek().is_some());
                in_flip += i32::from(
                    gains
                        .iter()
                        .any(|(rival, _)| column("flip_mean").is_better(rival, own)),
                );
                for winner in better_in_both {
                    if !winners.contains(winner) {
                        winners.push(winner.clone());
                    }
                }
            }
            cells.push(match cases {
                0 => String::new(),
                _ => format!("{in_both} / {in_one} / {in_flip} of {cases}"),
            });
        }
        cells.push(winners.join("; "));
        table.push(cells);
    }
    Some(table)
}

/// Whether another method is better on the same tree in both VMI error and silhouette IoU.
pub(crate) fn is_beaten(row: &Row, rows: &[&Row]) -> bool {
    let mut rivals = rows
        .iter()
        .filter(|r| r.tree == row.tree && r.method != row.method);
    rivals.any(|rival| gains(rival, row) == [true; 2])
}

/// In which of VMI error and silhouette IoU a row is better than another.
fn gains(row: &Row, than: &Row) -> [bool; 2] {
    ["vmi_error_percent", "silhouette_iou"].map(|key| column(key).is_better(row, than))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rows::tests::row;

    fn of(method: &str, tree: &str, error: f64, iou: f64) -> Row {
        let mut row = Row {
            tree: tree.into(),
            ..row(method, 0.5, 1.0, error)
        };
        row.values.insert("silhouette_iou".into(), Some(iou));
        row
    }

    #[test]
    fn only_other_methods_count_and_one_must_be_better_in_both() {
        let mut rows = vec![
            of("vds", "oak", 5.0, 0.8),
            of("fsa", "oak", 5.0, 0.9),
            of("sm", "oak", 4.0, 0.7),
            of("vds", "elm", 5.0, 0.8),
            of("fsa", "elm", 4.0, 0.9),
            of("sm", "elm", 9.0, 0.1),
        ];
        rows.push(Row {
            setting: "finer".into(),
            ..of("vds", "oak", 1.0, 1.0)
        });
        let table = dominance(&rows).unwrap();
        assert_eq!(table.head, ["method", "50 %", "in both by"]);
        // On the oak fsa has the better outline, sm less error, neither both;
        // its own finer setting is no rival.
        let expected = [
            ["vds", "1 / 2 / 0 of 2", "fsa"],
            ["fsa", "1 / 1 / 0 of 2", "vds"],
            ["sm", "2 / 2 / 0 of 2", "vds; fsa"],
            ["vds finer", "0 / 0 / 0 of 1", ""],
        ];
        assert_eq!(table.body, expected);
        // A changed tree is no case.
        rows.push(Row {
            change: "turned".into(),
            ..of("fsa", "oak", 0.0, 1.0)
        });
        assert_eq!(dominance(&rows).unwrap().body, expected);
        rows.retain(|row| row.method == "vds");
        assert_eq!(dominance(&rows), None);
        assert_eq!(dominance(&[]), None);
    }
}
