//! What a client shows of trees as they are, beside what it shows of their levels: how much of a level's
//! error and of its flicker the tree has itself.

use crate::better_rivals::LISTED;
use crate::columns::column;
use crate::format::percent;
use crate::table::Table;
use crate::{Row, Values};

/// A tree, and the rows of its levels by the default under a budget of triangles, finest first.
struct Levels<'r> {
    tree: &'r str,
    rows: Vec<&'r Row>,
}

impl<'r> Levels<'r> {
    /// What is known of each tree whose rows know what the tree itself shows.
    fn of_all(rows: &'r [Row]) -> Vec<Self> {
        let mut all: Vec<Self> = Vec::new();
        let knows = |row: &&Row| row.label() == LISTED && !row.original_without_mips.is_empty();
        for row in rows.iter().filter(knows) {
            match all.iter_mut().find(|levels| levels.tree == row.tree) {
                Some(levels) => levels.rows.push(row),
                None => all.push(Self {
                    tree: &row.tree,
                    rows: vec![row],
                }),
            }
        }
        for levels in &mut all {
            levels.rows.sort_by(|a, b| b.level.total_cmp(&a.level));
        }
        all.sort_by_key(|levels| levels.tree);
        all
    }

    /// What the tree shows of itself, of the rows that know it, with commas between the values.
    fn of_tree(&self, shown: fn(&Row) -> &Values, keys: &[&str]) -> String {
        let cell_of = |key: &&str| {
            let cells = self.rows.iter().map(|row| cell(shown(row), key));
            { cells }
                .find(|cell| cell != MISSING)
                .unwrap_or(MISSING.to_owned())
        };
        keys.iter().map(cell_of).collect::<Vec<_>>().join(", ")
    }

    /// A value at each share, with commas between them.
    fn each(&self, key: &str, shares: &[f64]) -> String {
        let at = |share: &f64| {
            let row = self.rows.iter().find(|row| row.level == *share);
            row.map_or(MISSING.to_owned(), |row| cell(&row.values, key))
        };
        shares.iter().map(at).collect::<Vec<_>>().join(", ")
    }
}

const AS_IT_IS: fn(&Row) -> &Values = |row| &row.original;
const WITHOUT_MIPS: fn(&Row) -> &Values = |row| &row.original_without_mips;

/// What stands for a value that rows lack.
const MISSING: &str = "–";

/// A value in two to three digits.
fn cell(values: &Values, key: &str) -> String {
    match column(key).value_in(values) {
        Some(value) if key.starts_with("flip") => format!("{value:.3}"),
        Some(value) => format!("{value:.2}"),
        None => MISSING.to_owned(),
    }
}

/// The levels that some tree has, finest first, and their name: "50, 25, 10 %".
fn shares(all: &[Levels<'_>]) -> (Vec<f64>, String) {
    let rows = all.iter().flat_map(|levels| &levels.rows);
    let mut shares: Vec<f64> = rows.map(|row| row.level).collect();
    shares.sort_by(|a, b| b.total_cmp(a));
    shares.dedup();
    let names = shares.iter().map(|share| percent(*share).replace(" %", ""));
    let name = format!("{} %", names.collect::<Vec<_>>().join(", "));
    (shares, name)
}

/// A line for each tree; nothing where no row knows what its tree shows.
fn by_tree(
    rows: &[Row],
    head_for: impl Fn(&str) -> [String; 5],
    cells_of: impl Fn(&Levels<'_>, &[f64]) -> [String; 4],
) -> Option<Table> {
    let all = Levels::of_all(rows);
    let (shares, name) = shares(&all);
    let mut table = Table::new(&head_for(&name).each_ref().map(String::as_str));
    for levels in &all {
        let tree = [levels.tree.to_owned()].into_iter();
        table.push(tree.chain(cells_of(levels, &shares)).collect());
    }
    (!table.body.is_empty()).then_some(table)
}

/// Single frames of 128 pixels: of each tree coverage, overlap with the truth and FLIP as it is and without
/// mip maps, and overlap and FLIP of its levels.
pub(crate) fn in_a_frame(rows: &[Row]) -> Option<Table> {
    let [iou, flip] = ["truth_iou_as_drawn_128", "flip_as_drawn_128"];
    let head_for = |shares: &str| {
        [
            "tree".to_owned(),
            "as it is: coverage, IoU, FLIP".to_owned(),
            "without mip maps: IoU, FLIP".to_owned(),
            format!("`vds --triangles` at {shares}: IoU"),
            "FLIP".to_owned(),
        ]
    };
    by_tree(rows, head_for, |levels, shares| {
        [
            levels.of_tree(AS_IT_IS, &["coverage_as_drawn_128", iou, flip]),
            levels.of_tree(WITHOUT_MIPS, &[iou, flip]),
            levels.each(iou, shares),
            levels.each(flip, shares),
        ]
    })
}

const FLICKER: [&str; 2] = ["flicker_over_frames_512", "flicker_over_frames_128"];

/// How much each tree flickers as it is, without mip maps, and at its levels; in pictures of 512 and of
/// 128 pixels.
pub(crate) fn flicker(rows: &[Row]) -> Option<Table> {
    let head_for = |shares: &str| {
        [
            "tree".to_owned(),
            "as it is, 512 and 128 px".to_owned(),
            "without mip maps".to_owned(),
            format!("`vds --triangles` at {shares}, 512 px"),
            "128 px".to_owned(),
        ]
    };
    by_tree(rows, head_for, |levels, shares| {
        [
            levels.of_tree(AS_IT_IS, &FLICKER),
            levels.of_tree(WITHOUT_MIPS, &FLICKER),
            levels.each(FLICKER[0], shares),
            levels.each(FLICKER[1], shares),
        ]
    })
}

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
    let all = Levels::of_all(rows);
    let listed: Vec<&Row> = all.iter().flat_map(|levels| levels.rows.clone()).collect();
    if listed.is_empty() {
        return None;
    }
    for (name, shown) in [
        ("the trees as they are", AS_IT_IS),
        ("the trees without mip maps", WITHOUT_MIPS),
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

    /// By their keys: FLIP in a frame of 128 pixels is the ninth column, and so on.
    #[test]
    fn levels_stand_beside_their_tree_finest_first() {
        let rivals = Row {
            setting: String::new(),
            ..of(0.5, 0.9)
        };
        let elm = Row {
            tree: "elm".into(),
            ..of(0.5, 0.3)
        };
        let rows = [of(0.1, 0.6), of(0.5, 0.5), rivals, elm];
        let keys = DRAWN_COLUMNS.map(|column| column.key);
        assert_eq!(keys[7], "flicker_over_frames_512");
        assert_eq!(
            [keys[8], keys[9], keys[11], keys[15]],
            [
                "flip_as_drawn_128",
                "truth_iou_as_drawn_128",
                "coverage_as_drawn_128",
                "flicker_over_frames_128"
            ]
        );
        let table = in_a_frame(&rows).unwrap();
        assert_eq!(table.head[3], "`vds --triangles` at 50, 10 %: IoU");
        let trees = ["0.31, 0.29, 0.280", "0.49, 0.480"];
        let expected = [
            ["elm", trees[0], trees[1], "0.39, –", "0.380, –"],
            ["oak", trees[0], trees[1], "0.59, 0.69", "0.580, 0.680"],
        ];
        assert_eq!(table.body, expected);
        let table = flicker(&rows).unwrap();
        let trees = ["0.27, 0.35", "0.47, 0.55"];
        let expected = [
            ["elm", trees[0], trees[1], "0.37, –", "0.45, –"],
            ["oak", trees[0], trees[1], "0.57, 0.67", "0.65, 0.75"],
        ];
        assert_eq!(table.body, expected);
    }

    #[test]
    fn rows_that_know_nothing_of_their_tree_have_no_such_table() {
        let mut older = of(0.1, 0.1);
        older.original_without_mips.clear();
        assert_eq!(in_a_frame(&[older.clone()]), None);
        assert_eq!(flicker(&[older]), None);
        // What one row lacks is not left out of the others.
        let mut fewer = of(0.1, 0.1);
        fewer.values.remove("flicker_over_frames_512");
        let table = flicker(&[fewer.clone()]).unwrap();
        assert_eq!(table.body[0][3..], ["–", "0.25"]);
        // What the finest level does not know of its tree another does.
        fewer.level = 0.5;
        fewer.original.remove("flicker_over_frames_512");
        let table = flicker(&[fewer, of(0.1, 0.1)]).unwrap();
        assert_eq!(table.body[0][1], "0.27, 0.35");
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
