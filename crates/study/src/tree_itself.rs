//! What a client shows of trees as they are, beside what it shows of their levels: how much of a level's
//! error and of its flicker the tree has itself.

use crate::beaten::LISTED;
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
    /// Those of each tree whose rows know what the tree itself shows.
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

    fn original(&self) -> &'r Values {
        &self.rows[0].original
    }

    fn original_without_mips(&self) -> &'r Values {
        &self.rows[0].original_without_mips
    }

    /// A value of each level, with commas between them.
    fn each(&self, key: &str) -> Option<String> {
        let of = |row: &&Row| cell(&row.values, key);
        Some((self.rows.iter().map(of).collect::<Option<Vec<_>>>()?).join(", "))
    }
}

/// A value in two to three digits.
fn cell(values: &Values, key: &str) -> Option<String> {
    let value = column(key).value_in(values)?;
    Some(match key.starts_with("flip") {
        true => format!("{value:.3}"),
        false => format!("{value:.2}"),
    })
}

/// The levels of all trees: "50, 25, 10 %". Nothing where trees have different ones.
fn shares(all: &[Levels<'_>]) -> Option<String> {
    let of = |levels: &Levels<'_>| -> Vec<String> {
        let shares = levels.rows.iter().map(|row| percent(row.level));
        shares.map(|share| share.replace(" %", "")).collect()
    };
    let first = of(all.first()?);
    let are_alike = all.iter().all(|levels| of(levels) == first);
    are_alike.then(|| format!("{} %", first.join(", ")))
}

/// Single frames of 128 pixels: of each tree coverage, overlap with the truth and FLIP as it is and without
/// mip maps, and overlap and FLIP of its levels.
pub(crate) fn in_a_frame(rows: &[Row]) -> Option<Table> {
    let all = Levels::of_all(rows);
    let shares = shares(&all)?;
    let ours = format!("`vds --triangles` at {shares}: IoU");
    let mut table = Table::new(&[
        "tree",
        "as it is: coverage, IoU, FLIP",
        "without mip maps: IoU, FLIP",
        &ours,
        "FLIP",
    ]);
    let [iou, flip] = ["truth_iou_as_drawn_128", "flip_as_drawn_128"];
    for levels in &all {
        let of = |values: &Values, keys: &[&str]| -> Option<String> {
            Some(
                (keys
                    .iter()
                    .map(|key| cell(values, key))
                    .collect::<Option<Vec<_>>>()?)
                .join(", "),
            )
        };
        table.push(vec![
            levels.tree.to_owned(),
            of(levels.original(), &["coverage_as_drawn_128", iou, flip])?,
            of(levels.original_without_mips(), &[iou, flip])?,
            levels.each(iou)?,
            levels.each(flip)?,
        ]);
    }
    Some(table)
}

/// How much each tree flickers as it is, without mip maps, and at its levels; in pictures of 512 and of
/// 128 pixels.
pub(crate) fn flicker(rows: &[Row]) -> Option<Table> {
    let all = Levels::of_all(rows);
    let shares = shares(&all)?;
    let ours = ["512", "128"].map(|px| format!("`vds --triangles` at {shares}, {px} px"));
    let mut table = Table::new(&[
        "tree",
        "as it is, 512 and 128 px",
        "without mip maps",
        &ours[0],
        &ours[1],
    ]);
    let keys = ["flicker_over_frames_512", "flicker_over_frames_128"];
    for levels in &all {
        let both = |values: &Values| -> Option<String> {
            let [near, far] = keys.map(|key| cell(values, key));
            Some(format!("{}, {}", near?, far?))
        };
        table.push(vec![
            levels.tree.to_owned(),
            both(levels.original())?,
            both(levels.original_without_mips())?,
            levels.each(keys[0])?,
            levels.each(keys[1])?,
        ]);
    }
    Some(table)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::DRAWN_COLUMNS;
    use crate::rows::tests::row;

    /// A row of the oak all of whose values as drawn are one number, the tree's own twice and thrice
    /// that.
    fn of(level: f64, value: f64) -> Row {
        let all = |value: f64| -> Values {
            let keys = DRAWN_COLUMNS.map(|column| column.key.to_owned());
            keys.into_iter().map(|key| (key, Some(value))).collect()
        };
        Row {
            setting: "triangles".into(),
            values: all(value),
            original: all(0.2),
            original_without_mips: all(0.3),
            ..row("vds", level, 1.0, 2.0)
        }
    }

    #[test]
    fn levels_stand_beside_their_tree_finest_first() {
        let rivals = Row {
            setting: String::new(),
            ..of(0.5, 0.9)
        };
        let rows = [of(0.1, 0.1), of(0.5, 0.5), rivals];
        let table = in_a_frame(&rows).unwrap();
        assert_eq!(table.head[3], "`vds --triangles` at 50, 10 %: IoU");
        let expected = [
            "oak",
            "0.20, 0.20, 0.200",
            "0.30, 0.300",
            "0.50, 0.10",
            "0.500, 0.100",
        ];
        assert_eq!(table.body, [expected]);
        let table = flicker(&rows).unwrap();
        let expected = [
            "oak",
            "0.20, 0.20",
            "0.30, 0.30",
            "0.50, 0.10",
            "0.50, 0.10",
        ];
        assert_eq!(table.body, [expected]);
    }

    #[test]
    fn rows_that_know_nothing_of_their_tree_have_no_such_table() {
        let mut older = of(0.1, 0.1);
        older.original_without_mips.clear();
        assert_eq!(in_a_frame(&[older.clone()]), None);
        assert_eq!(flicker(&[older]), None);
        let mut elm = of(0.25, 0.1);
        elm.tree = "elm".into();
        assert_eq!(flicker(&[of(0.1, 0.1), elm]), None, "levels differ");
    }
}
