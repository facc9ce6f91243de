//! How much trees flicker as they are, beside their levels.

use crate::better_rivals::LISTED;
use crate::columns::column;
use crate::table::Table;
use crate::{Row, Values};

const FLICKER: [&str; 2] = ["flicker_over_frames_512", "flicker_over_frames_128"];

/// How much trees themselves and the levels of each method flicker, means over trees and levels. Nothing
/// where some row does not know it.
pub(crate) fn flicker_of_methods(rows: &[Row]) -> Option<Table> {
    let mut table = Table::new(&["method", "512 px", "128 px"]);
    let mut push = |name: String, values: &[&Values]| {
        let mean = |key: &str| -> Option<String> {
            let all = values.iter().map(|values| column(key).value_in(values));
            let all: Vec<f64> = all.collect::<Option<_>>()?;
            Some(format!("{:.2}", all.iter().sum::<f64>() / all.len() as f64))
        };
        let [near, far] = FLICKER.map(mean);
        table.push(vec![name, near?, far?]);
        Some(())
    };
    let knows_tree = |row: &&Row| row.label() == LISTED && !row.original_without_mips.is_empty();
    let listed: Vec<&Row> = rows.iter().filter(knows_tree).collect();
    if listed.is_empty() {
        return None;
    }
    let as_it_is: fn(&Row) -> &Values = |row| &row.original;
    let without_mips: fn(&Row) -> &Values = |row| &row.original_without_mips;
    for (name, shown) in [
        ("the trees as they are", as_it_is),
        ("the trees without mip maps", without_mips),
    ] {
        push(
            name.to_owned(),
            &listed.iter().map(|row| shown(row)).collect::<Vec<_>>(),
        )?;
    }
    let mut labels: Vec<String> = rows.iter().map(Row::label).collect();
    labels.sort_unstable();
    labels.dedup();
    for label in labels {
        let own = rows.iter().filter(|row| row.label() == label);
        push(
            label.clone(),
            &own.map(|row| &row.values).collect::<Vec<_>>(),
        )?;
    }
    Some(table)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::DRAWN_COLUMNS;
    use crate::rows::tests::row;

    /// The values of [`DRAWN_COLUMNS`] are this one and a hundredth more for each column.
    fn from(first: f64) -> Values {
        let keys = DRAWN_COLUMNS.iter().enumerate();
        keys.map(|(place, column)| (column.key.to_owned(), Some(first + 0.01 * place as f64)))
            .collect()
    }

    /// Of the oak 0.2 and more as it is, 0.4 and more without mip maps.
    fn of(level: f64, first: f64) -> Row {
        Row {
            setting: "triangles".into(),
            values: from(first),
            original: from(0.2),
            original_without_mips: from(0.4),
            ..row("vds", level, 1.0, 2.0)
        }
    }

    #[test]
    fn methods_flicker_in_the_mean() {
        let rival = Row {
            method: "fsa".into(),
            setting: String::new(),
            ..of(0.1, 0.9)
        };
        let rows = [of(0.1, 0.1), of(0.5, 0.3), rival];
        let table = flicker_of_methods(&rows).unwrap();
        let expected = [
            ["the trees as they are", "0.27", "0.35"],
            ["the trees without mip maps", "0.47", "0.55"],
            ["fsa", "0.97", "1.05"],
            ["vds triangles", "0.27", "0.35"],
        ];
        assert_eq!(table.body, expected);
        let mut fewer = rows.to_vec();
        fewer[2].values.remove("flicker_over_frames_512");
        assert_eq!(flicker_of_methods(&fewer), None, "means of other cases");
        assert_eq!(flicker_of_methods(&rows[2..]), None);
    }
}
