//! How far settings of VDS are from the best of the other methods, case by case: the default under a budget of
//! triangles by `measure` and as a client draws, and the information in VMI error.

use crate::Row;
use crate::better_rivals::{LISTED, compared, judged, rivals};
use crate::columns::column;
use crate::table::Table;
use secateur_eval::measure::Direction;

/// The setting whose VMI error stands beside that of rivals.
const INFORMATION: &str = "vds triangles preset information";

/// A line for each metric: in how many cases, a tree at a level each, a rival is better, and from where to where
/// the setting lies beside the best rival. Nothing where no case has rivals.
pub(crate) fn lead(rows: &[Row]) -> Option<Table> {
    let judged = judged(rows);
    let rows = compared(rows, &judged);
    let mut table = Table::new(&[
        "method",
        "metric",
        "cases",
        "a rival is better in",
        "beside the best rival",
    ]);
    let by_measure = ["flip_mean", "silhouette_iou"].map(column);
    // VMI error is last of those, and not drawn.
    let drawn = &judged[..judged.len() - 1];
    let by_measure = by_measure.map(|by| (format!("{} by measure", by.title), by));
    let drawn = drawn.iter().map(|by| (by.title.to_owned(), *by));
    for (title, by) in by_measure.into_iter().chain(drawn) {
        let value = |row: &Row| by.value_of(row);
        let cells = line(LISTED, title, &rows, by.direction, &value);
        table.body.extend(cells);
    }
    let error = column("vmi_error_percent");
    let title = error.title.to_owned();
    let of_all = |row: &Row| error.value_of(row);
    let lines = line(INFORMATION, title, &rows, error.direction, &of_all);
    table.body.extend(lines);
    let title = format!("{} from the turned sets", error.title);
    let lines = line(INFORMATION, title, &rows, error.direction, &turned_error);
    table.body.extend(lines);
    (!table.body.is_empty()).then_some(table)
}

/// VMI error in the mean of the judging sets but the first, which is the dual one; infinite where there are none.
fn turned_error(row: &Row) -> f64 {
    let error = column("vmi_error_percent");
    let turned = row.rigs.get(1..).unwrap_or_default();
    let values = turned.iter().map(|rig| error.value_in(rig));
    match values.collect::<Option<Vec<f64>>>() {
        Some(values) if !values.is_empty() => values.iter().sum::<f64>() / values.len() as f64,
        _ => f64::INFINITY,
    }
}

/// Of one setting and metric; of a metric of which less is better as a multiple of the best rival's value, of
/// others as the difference from it.
fn line(
    label: &str,
    title: String,
    rows: &[&Row],
    direction: Direction,
    value: &dyn Fn(&Row) -> f64,
) -> Option<Vec<String>> {
    let badness = |row: &Row| direction.badness(value(row));
    let is_judged = |row: &&Row| value(row).is_finite();
    let (mut cases, mut lost) = (0, 0);
    let (mut least, mut most) = (f64::INFINITY, f64::NEG_INFINITY);
    for own in rows
        .iter()
        .filter(|row| row.label() == label)
        .filter(|row| is_judged(row))
    {
        let rivals = rivals(own, rows).into_iter().filter(is_judged);
        let Some(best) = rivals.min_by(|a, b| badness(a).total_cmp(&badness(b))) else {
            continue;
        };
        cases += 1;
        lost += usize::from(badness(best) < badness(own));
        let beside = match direction {
            Direction::Lower => value(own) / value(best),
            _ => value(own) - value(best),
        };
        (least, most) = (least.min(beside), most.max(beside));
    }
    let beside = match direction {
        Direction::Lower => format!("{least:.3} to {most:.3} times as much"),
        _ => format!("{least:+.3} to {most:+.3}"),
    };
    let cells = [
        label.to_owned(),
        title,
        cases.to_string(),
        lost.to_string(),
        beside,
    ];
    (cases > 0).then(|| cells.into())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::DRAWN_COLUMNS;
    use crate::rows::tests::row;

    fn of(label: [&str; 2], tree: &str, flip: f64, iou: f64) -> Row {
        let mut row = Row {
            setting: label[1].into(),
            tree: tree.into(),
            ..row(label[0], 0.1, 1.0, 3.0)
        };
        for column in DRAWN_COLUMNS {
            let value = if column.key.starts_with("flip") {
                flip
            } else {
                iou
            };
            row.values.insert(column.key.into(), Some(value));
        }
        row
    }

    #[test]
    fn each_case_stands_beside_its_best_rival() {
        let rows = [
            of(["vds", "triangles"], "oak", 0.02, 0.9),
            of(["fsa", ""], "oak", 0.04, 0.7),
            of(["stochastic", ""], "oak", 0.05, 0.8),
            of(["vds", "triangles"], "elm", 0.03, 0.5),
            of(["fsa", ""], "elm", 0.025, 0.625),
            of(["vds", "triangles"], "lonely", 0.9, 0.1),
        ];
        let table = lead(&rows).unwrap();
        let line = |title: &str| table.body.iter().find(|cells| cells[1] == title).unwrap();
        let flip = line("FLIP at 512 px over frames");
        assert_eq!(flip[2..], ["2", "1", "0.500 to 1.200 times as much"]);
        let iou = line("IoU with the truth at 128 px as drawn");
        assert_eq!(iou[2..], ["2", "1", "-0.125 to +0.100"]);
        // All are alike by `measure`.
        assert_eq!(
            line("FLIP by measure")[2..],
            ["2", "0", "1.000 to 1.000 times as much"]
        );
        assert_eq!(table.body.len(), 10, "no VMI error of the default");
        assert_eq!(lead(&rows[5..]), None);
    }

    /// By the first set the rival is better, by the turned ones it is worse.
    #[test]
    fn information_is_judged_from_turned_sets_too() {
        let of_errors = |label: [&str; 2], errors: [f64; 3]| {
            let mut row = of(label, "oak", 0.1, 0.5);
            let set = |error| [("vmi_error_percent".to_owned(), Some(error))].into();
            row.rigs = errors.map(set).into();
            let mean = errors.iter().sum::<f64>() / 3.0;
            row.values.insert("vmi_error_percent".into(), Some(mean));
            row
        };
        let rows = [
            of_errors(["vds", "triangles preset information"], [9.0, 1.0, 2.0]),
            of_errors(["fsa", ""], [2.0, 1.0, 4.0]),
        ];
        let table = lead(&rows).unwrap();
        let counts = table.body.iter().map(|cells| &cells[3..]);
        let expected = [
            ["1", "1.714 to 1.714 times as much"],
            ["0", "0.600 to 0.600 times as much"],
        ];
        assert_eq!(counts.collect::<Vec<_>>(), expected);
    }
}
