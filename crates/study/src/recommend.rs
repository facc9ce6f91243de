//! Which method to take for a level and a time that one has.

use super::{COLUMNS, Column, Point, Row, pareto, summarise};
use crate::format::{number, percent};
use crate::table::Table;

/// What reports say that the lines of [`recommend`] list.
pub(crate) const WHAT_IS_LISTED: &str = "What has the pictures most like the original's (least FLIP), the best outline (most overlap, silhouette IoU) and the least VMI error of all that takes no longer, in the mean; a time is left out where more of it buys nothing. Times are of this machine and these trees; where not to trust a method, the plans failures and stability tell.";

/// The shortest and the longest time that is listed, as powers of ten of a second.
const LEAST_TIME: i32 = -3;
const MOST_TIME: i32 = 5;

/// For each level and time limit the best method within it, over unchanged trees, where it is
/// better than within shorter limits; nothing if there is only one method. Methods that the
/// judging views drove are left out: they would be flattered.
pub(crate) fn recommend(rows: &[Row]) -> Option<Table> {
    let is_fair = |row: &&Row| row.change.is_empty() && !row.is_driven_by_judging_views;
    let rows: Vec<&Row> = rows.iter().filter(is_fair).collect();
    if !rows.iter().any(|row| row.method != rows[0].method) {
        return None;
    }
    let mut levels: Vec<f64> = rows.iter().map(|row| row.level).collect();
    levels.sort_by(|a, b| b.total_cmp(a));
    levels.dedup();
    let columns = ["flip_mean", "silhouette_iou", "vmi_error_percent"].map(|key| {
        let column = COLUMNS.iter().find(|column| column.key == key);
        column.expect("a metric")
    });
    let mut table = Table::new(&[
        "left",
        "in at most",
        "most alike: FLIP",
        "best outline: IoU",
        "least VMI error",
    ]);
    for level in levels {
        let there = rows.iter().copied().filter(|row| row.level == level);
        let there: Vec<&Row> = there.collect();
        let points = columns.map(|column| summarise(&there, column));
        let mut before = None;
        for power in LEAST_TIME..=MOST_TIME {
            let of = |k: usize| best_within(&points[k], columns[k], 10f64.powi(power));
            let best = [of(0), of(1), of(2)];
            if best.iter().all(Option::is_none) || before.as_ref() == Some(&best) {
                continue;
            }
            let mut line = vec![percent(level), time(power)];
            line.extend(best.clone().map(Option::unwrap_or_default));
            table.push(line);
            before = Some(best);
        }
    }
    Some(table)
}

fn best_within(points: &[Point], column: &Column, seconds: f64) -> Option<String> {
    let frontier = pareto(points, column);
    let best = frontier.iter().rfind(|point| point.seconds <= seconds)?;
    let unit = match column.unit {
        "" => String::new(),
        unit => format!(" {unit}"),
    };
    Some(format!(
        "{}: {}{unit}",
        best.label,
        number(best.mean, column)
    ))
}

fn time(power: i32) -> String {
    match power {
        ..0 => format!("{} ms", 10i32.pow((power + 3) as u32)),
        _ => format!("{} s", 10i32.pow(power as u32)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rows::tests::row;

    fn of(method: &str, level: f64, seconds: f64, error: f64, iou: f64) -> Row {
        let mut row = row(method, level, seconds, error);
        row.values.insert("silhouette_iou".into(), Some(iou));
        row
    }

    #[test]
    fn more_time_is_listed_where_it_buys_something() {
        let mut rows = vec![
            of("sm", 0.5, 0.0005, 9.0, 0.6),
            // Slower and no better in either.
            of("fsa", 0.5, 0.05, 20.0, 0.5),
            // Better outline alone.
            of("meshopt", 0.5, 0.005, 12.0, 0.7),
            of("vds", 0.5, 2.0, 1.0, 0.9),
            of("sm", 0.1, 0.02, 30.0, 0.4),
        ];
        let expected = [
            ["50 %", "1 ms", "sm: 0.5000", "sm: 0.6000", "sm: 9.00 %"],
            [
                "50 %",
                "10 ms",
                "sm: 0.5000",
                "meshopt: 0.7000",
                "sm: 9.00 %",
            ],
            ["50 %", "10 s", "sm: 0.5000", "vds: 0.9000", "vds: 1.00 %"],
            ["10 %", "100 ms", "sm: 0.5000", "sm: 0.4000", "sm: 30.00 %"],
        ];
        let table = recommend(&rows).unwrap();
        assert_eq!(
            table.head,
            [
                "left",
                "in at most",
                "most alike: FLIP",
                "best outline: IoU",
                "least VMI error"
            ]
        );
        assert_eq!(table.body, expected);
        rows.push(Row {
            setting: "views 12".into(),
            is_driven_by_judging_views: true,
            ..of("vds", 0.5, 1.5, 0.0, 1.0)
        });
        rows.push(Row {
            change: "turned".into(),
            ..of("sm", 0.5, 0.0005, 0.0, 1.0)
        });
        assert_eq!(recommend(&rows).unwrap().body, expected);
        rows.retain(|row| row.method == "vds");
        assert_eq!(recommend(&rows), None);
        assert_eq!(recommend(&[]), None);
    }
}
