//! In how many cases a method that is not VDS does better than VDS, and in which: as a client
//! draws, near by and far off, and in VMI error.

use crate::columns::column;
use crate::format::{number, percent};
use crate::row_fit::RowFit;
use crate::table::Table;
use crate::{Column, Row, Values};

/// What reports say that the cells of [`beaten_as_drawn`] count.
const WHAT_IS_COUNTED: &str = "On how many trees some method that is not VDS is better / how many of these without a fit of its sizes; FLIP and outlines of pictures as a client draws them (mip maps, one sample a pixel, back faces culled), 512 and 128 pixels wide (over frames: the mean of 16 frames of one sample at another place in each pixel, as temporal anti-aliasing shows it), against what the original truly shows (IoU with the truth: parts of pixels counted; rows of before are held against the original as the same client draws it, which may have faded itself), and VMI error. However small the difference is.";

/// What they say of its lines of [`THE_TREE_ITSELF`].
const WHAT_THE_TREE_COUNTS: &str = "Lines of the tree itself: on how many trees such a method at this level is nearer to the truth than the tree with all its leaves, as it is or read without mip maps. That is known in single frames only, so the other cells are empty.";

/// What reports say that the lines of [`lost_cases`] are.
const WHAT_IS_LISTED: &str = "The cases that the default under a budget of triangles loses as drawn, each with the best of the other methods.";

/// What they say of its columns of the tree itself.
const WHAT_THE_TREE_SHOWS: &str = "Beside them what the tree itself shows in such a picture, as it is and read without mip maps, and in which of the two it loses to that method as well.";

/// What tables call a tree with all its leaves.
const THE_TREE_ITSELF: &str = "the tree itself";
const WITHOUT_MIPS: &str = "the tree itself without mip maps";

/// The setting whose lost cases are listed: the default under a budget of triangles.
pub(crate) const LISTED: &str = "vds triangles";

/// By what rows are judged: outlines by the truth where all rows have that, else by what a client
/// shows of the original; over frames where all rows have that; VMI error last.
pub(crate) fn judged(rows: &[Row]) -> Vec<&'static Column> {
    let by_truth = ["truth_iou_as_drawn_512", "truth_iou_as_drawn_128"];
    let by_client = ["iou_as_drawn_512", "iou_as_drawn_128"];
    let has = |row: &Row, key: &str| column(key).value_of(row).is_finite();
    let have_all = |key: &str| {
        let mut drawn = rows.iter().filter(|row| has(row, by_client[0])).peekable();
        drawn.peek().is_some() && drawn.all(|row| has(row, key))
    };
    let [near, far] = match have_all(by_truth[0]) {
        true => by_truth,
        false => by_client,
    };
    let mut judged = vec!["flip_as_drawn_512", near, "flip_as_drawn_128", far];
    let over_frames = [
        "flip_over_frames_512",
        "truth_iou_over_frames_512",
        "flip_over_frames_128",
        "truth_iou_over_frames_128",
    ];
    judged.extend(over_frames.into_iter().filter(|key| have_all(key)));
    judged.push("vmi_error_percent");
    judged.into_iter().map(column).collect()
}

fn is_vds(row: &Row) -> bool {
    row.method.starts_with("vds")
}

fn is_unfitted(row: &Row) -> bool {
    match row.fit() {
        RowFit::Unsaid | RowFit::None => true,
        RowFit::Fitted => false,
    }
}

/// The rows that are compared: of leaves of trees as they are, judged as drawn too, by views that
/// did not drive them.
pub(crate) fn compared<'r>(rows: &'r [Row], judged: &[&Column]) -> Vec<&'r Row> {
    let is_compared = |row: &&Row| {
        row.is_of_leaves()
            && row.change.is_empty()
            && !row.is_driven_by_judging_views
            && judged.iter().all(|c| c.value_of(row).is_finite())
    };
    rows.iter().filter(is_compared).collect()
}

/// Other methods on the same tree at the same level.
pub(crate) fn rivals<'r>(own: &Row, rows: &[&'r Row]) -> Vec<&'r Row> {
    let is_rival = |row: &Row| !is_vds(row) && row.tree == own.tree && row.level == own.level;
    let rivals = rows.iter().copied().filter(|row| is_rival(row));
    rivals.collect()
}

/// Rows that are better in a metric.
fn better<'r>(own: &Row, rows: &[&'r Row], by: &Column) -> Vec<&'r Row> {
    let mut rivals = rivals(own, rows);
    rivals.retain(|rival| by.is_better(rival, own));
    rivals
}

/// A line of the table: rows of one level that are counted together.
struct Counted {
    label: String,
    level: f64,
    rows: Vec<Row>,
}

/// The settings of VDS at each level, in the order of their first rows, the trees themselves behind the
/// default of a level.
fn counted(rows: &[&Row]) -> Vec<Counted> {
    let mut all: Vec<Counted> = Vec::new();
    for first in rows.iter().filter(|row| is_vds(row)) {
        let (label, level) = (first.label(), first.level);
        if (all.iter()).any(|known| known.label == label && known.level == level) {
            continue;
        }
        let own = rows
            .iter()
            .filter(|row| row.label() == label && row.level == level)
            .filter(|own| (rows.iter()).any(|row| !is_vds(row) && row.tree == own.tree));
        let own: Vec<Row> = own.copied().cloned().collect();
        let shown = match label == LISTED {
            true => trees_themselves(&own).into(),
            false => Vec::new(),
        };
        all.push(Counted {
            label,
            level,
            rows: own,
        });
        let shown = shown.into_iter().filter(|counted| !counted.rows.is_empty());
        all.extend(shown);
    }
    all
}

/// What the trees of rows of one level show of themselves, as if it were what these rows show: as they are,
/// and without mip maps.
fn trees_themselves(rows: &[Row]) -> [Counted; 2] {
    let shown = |label: &str, values: fn(&Row) -> &Values| Counted {
        label: label.to_owned(),
        level: rows.first().map_or(0.0, |row| row.level),
        rows: (rows.iter())
            .filter(|row| !values(row).is_empty())
            .map(|row| Row {
                values: values(row).clone(),
                ..row.clone()
            })
            .collect(),
    };
    [
        shown(THE_TREE_ITSELF, |row| &row.original),
        shown(WITHOUT_MIPS, |row| &row.original_without_mips),
    ]
}

/// What reports say of a table of [`beaten_as_drawn`].
pub(crate) fn note_of_counts(table: &Table) -> String {
    let has_trees = table.body.iter().any(|cells| cells[0] == THE_TREE_ITSELF);
    noted([WHAT_IS_COUNTED, WHAT_THE_TREE_COUNTS], has_trees)
}

/// What reports say of a table of [`lost_cases`].
pub(crate) fn note_of_lost(table: &Table) -> String {
    let has_trees = table.head.iter().any(|name| name == THE_TREE_ITSELF);
    noted([WHAT_IS_LISTED, WHAT_THE_TREE_SHOWS], has_trees)
}

/// The second sentences where the table has trees themselves.
fn noted([always, of_trees]: [&str; 2], has_trees: bool) -> String {
    match has_trees {
        true => format!("{always} {of_trees}"),
        false => always.to_owned(),
    }
}

/// A line for each setting of VDS and level; nothing if no row was judged as drawn, or there is
/// no other method.
pub(crate) fn beaten_as_drawn(rows: &[Row]) -> Option<Table> {
    let judged = judged(rows);
    let rows = compared(rows, &judged);
    if !rows.iter().any(|row| is_vds(row)) || rows.iter().all(|row| is_vds(row)) {
        return None;
    }
    let mut head = vec!["method", "left", "trees"];
    let titles = judged.iter().map(|by| by.title.replace(" as drawn", ""));
    let titles: Vec<String> = titles.collect();
    head.extend(titles.iter().map(String::as_str));
    head.push("mostly by");
    let mut table = Table::new(&head);
    for own in counted(&rows) {
        let mut winners: Vec<(String, usize)> = Vec::new();
        let mut cells = vec![own.label, percent(own.level), own.rows.len().to_string()];
        for by in &judged {
            // Of trees themselves only some metrics are known.
            if !own.rows.iter().any(|row| by.value_of(row).is_finite()) {
                cells.push(String::new());
                continue;
            }
            let (mut lost, mut lost_to_unfitted) = (0, 0);
            for row in &own.rows {
                let better = better(row, &rows, by);
                lost += usize::from(!better.is_empty());
                lost_to_unfitted += usize::from(better.iter().any(|row| is_unfitted(row)));
                for label in better.iter().map(|row| row.label()) {
                    match winners.iter_mut().find(|(known, _)| *known == label) {
                        Some((_, count)) => *count += 1,
                        None => winners.push((label, 1)),
                    }
                }
            }
            cells.push(format!("{lost} / {lost_to_unfitted}"));
        }
        winners.sort_by(|(_, a), (_, b)| b.cmp(a));
        let most = winners.into_iter().next();
        cells.push(most.map_or(String::new(), |(label, _)| label));
        table.push(cells);
    }
    Some(table)
}

/// The cases that the default loses as a client draws, a line each: the best of the others.
/// Nothing if the rows have none.
pub(crate) fn lost_cases(rows: &[Row]) -> Option<Table> {
    let judged = judged(rows);
    let rows = compared(rows, &judged);
    let listed = || rows.iter().filter(|row| row.label() == LISTED);
    let mut head = vec!["tree", "left", "metric", LISTED, "better", "its value"];
    // Rows of before do not know what the tree itself shows.
    let knows_original = listed().any(|row| !row.original.is_empty());
    if knows_original {
        head.extend([
            THE_TREE_ITSELF,
            "without mip maps",
            "the tree loses this too",
        ]);
    }
    let mut table = Table::new(&head);
    for own in listed() {
        for by in &judged[..judged.len() - 1] {
            let badness = |row: &Row| by.direction.badness(by.value_of(row));
            let better = better(own, &rows, by);
            let best = (better.iter()).min_by(|a, b| badness(a).total_cmp(&badness(b)));
            if let Some(best) = best {
                let mut cells = vec![
                    own.tree.clone(),
                    percent(own.level),
                    by.title.replace(" as drawn", ""),
                    number(by.value_of(own), by),
                    best.label(),
                    number(by.value_of(best), by),
                ];
                if knows_original {
                    let shown = [&own.original, &own.original_without_mips];
                    let values = shown.map(|shown| by.value_in(shown));
                    let text = |value: Option<f64>| value.map(|value| number(value, by));
                    cells.extend(values.map(|value| text(value).unwrap_or_default()));
                    let loses = values.map(|value| {
                        value.map(|value| by.direction.badness(value) > badness(best))
                    });
                    let told = match loses {
                        [Some(true), Some(true)] => "either way",
                        [Some(true), _] => "as it is",
                        [_, Some(true)] => "without mip maps",
                        [None, None] => "",
                        _ => "no",
                    };
                    cells.push(told.to_owned());
                }
                table.push(cells);
            }
        }
    }
    (!table.body.is_empty()).then_some(table)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::DRAWN_COLUMNS;
    use crate::rows::tests::row;

    fn of(label: [&str; 2], tree: &str, flip: f64, iou: f64, error: f64) -> Row {
        let mut row = Row {
            setting: label[1].into(),
            tree: tree.into(),
            ..row(label[0], 0.1, 1.0, error)
        };
        for column in DRAWN_COLUMNS {
            // In large pictures frames are judged only where that was asked for.
            if column.key.contains("over_frames_512") {
                continue;
            }
            let value = match column.key.split('_').next() {
                // Over frames all are alike.
                _ if column.key.contains("frames") => 0.5,
                Some("flip") => flip,
                // Against what a client shows of the original all are alike.
                Some("iou") => 0.5,
                _ => iou,
            };
            row.values.insert(column.key.into(), Some(value));
        }
        row
    }

    /// On the oak a fitted rival has the lower FLIP and an unfitted one the better outline; on the
    /// elm nothing is better, a draw is no loss, and another setting of VDS is no rival.
    #[test]
    fn lost_cases_are_counted_with_and_without_fits() {
        let mut rows = vec![
            of(["vds", "triangles"], "oak", 0.02, 0.9, 3.0),
            of(["vds", "triangles"], "elm", 0.02, 0.9, 3.0),
            of(["vds", "preset information"], "elm", 0.01, 0.95, 1.0),
            of(["fsa", "fit=coverage"], "oak", 0.01, 0.8, 4.0),
            of(["fsa", "fit=coverage"], "elm", 0.02, 0.9, 4.0),
            of(["stochastic", ""], "oak", 0.03, 0.95, 9.0),
            of(["stochastic", ""], "elm", 0.03, 0.85, 9.0),
        ];
        let table = beaten_as_drawn(&rows).unwrap();
        let expected = [
            [
                "vds triangles",
                "10 %",
                "2",
                "1 / 0",
                "1 / 1",
                "1 / 0",
                "1 / 1",
                "0 / 0",
                "0 / 0",
                "0 / 0",
                "fsa fit=coverage",
            ],
            [
                "vds preset information",
                "10 %",
                "1",
                "0 / 0",
                "0 / 0",
                "0 / 0",
                "0 / 0",
                "0 / 0",
                "0 / 0",
                "0 / 0",
                "",
            ],
        ];
        assert_eq!(table.body, expected);
        let lost = lost_cases(&rows).unwrap();
        assert_eq!(lost.body.len(), 4, "FLIP and IoU at two widths");
        assert_eq!(lost.body[0][3..], ["0.0200", "fsa fit=coverage", "0.0100"]);
        assert_eq!(lost.body[1][4..], ["stochastic", "0.9500"]);
        // Of older rows without the truth the other overlap counts.
        let mut older = rows.clone();
        older[6].values.remove("truth_iou_as_drawn_512");
        let table = beaten_as_drawn(&older).unwrap();
        assert_eq!(table.body[0][3..7], ["1 / 0", "0 / 0", "1 / 0", "0 / 0"]);
        assert!(table.head[4].starts_with("IoU at 512"), "{}", table.head[4]);
        // Over frames rows are compared where all have that.
        let mut fewer = rows.clone();
        fewer[0]
            .values
            .insert("flip_over_frames_128".into(), Some(0.6));
        assert_eq!(beaten_as_drawn(&fewer).unwrap().body[0][7], "1 / 1");
        let lost = lost_cases(&fewer).unwrap();
        assert_eq!(lost.body.len(), 5);
        assert_eq!(lost.body[4][2], "FLIP at 128 px over frames");
        fewer[1].values.remove("flip_over_frames_128");
        let table = beaten_as_drawn(&fewer).unwrap();
        assert_eq!(table.head[7], "IoU with the truth at 128 px over frames");
        let mut more = rows.clone();
        for (flip, row) in [0.3, 0.2, 0.4, 0.4, 0.4, 0.4, 0.1]
            .into_iter()
            .zip(&mut more)
        {
            let frames = [("flip", flip), ("truth_iou", 0.9)];
            let keyed =
                frames.map(|(what, value)| (format!("{what}_over_frames_512"), Some(value)));
            row.values.extend(keyed);
        }
        let table = beaten_as_drawn(&more).unwrap();
        assert_eq!(table.head[7], "FLIP at 512 px over frames");
        assert_eq!(table.body[0][7..9], ["1 / 1", "0 / 0"]);
        // Rows that nobody judged as drawn are not compared.
        rows[3].values.remove("flip_as_drawn_128");
        let table = beaten_as_drawn(&rows).unwrap();
        assert_eq!(table.body[0][3], "0 / 0");
        assert_eq!(beaten_as_drawn(&rows[..3]), None);
    }

    /// What the oak shows of itself 128 pixels wide; the elm knows nothing of itself.
    fn with_the_tree_itself() -> Vec<Row> {
        let shown = |flip: f64, iou: f64| -> Values {
            [
                ("flip_as_drawn_128".to_owned(), Some(flip)),
                ("truth_iou_as_drawn_128".to_owned(), Some(iou)),
            ]
            .into()
        };
        let mut rows = vec![
            of(["vds", "triangles"], "oak", 0.02, 0.7, 3.0),
            of(["vds", "triangles"], "elm", 0.02, 0.7, 3.0),
            of(["fsa", "fit=coverage"], "oak", 0.03, 0.8, 4.0),
            of(["fsa", "fit=coverage"], "elm", 0.03, 0.8, 4.0),
        ];
        rows[0].original = shown(0.04, 0.8);
        rows[0].original_without_mips = shown(0.03, 0.79);
        rows
    }

    #[test]
    fn lost_cases_tell_whether_the_tree_itself_loses_them_too() {
        let mut rows = with_the_tree_itself();
        let told = |rows: &[Row]| {
            let table = lost_cases(rows).unwrap();
            let is_it = |cells: &&Vec<String>| cells[0] == "oak" && cells[2].contains("128");
            table.body.iter().find(is_it).unwrap()[6..].to_vec()
        };
        assert_eq!(told(&rows), ["0.8000", "0.7900", "without mip maps"]);
        let key = "truth_iou_as_drawn_128";
        rows[0].original.insert(key.into(), Some(0.75));
        assert_eq!(told(&rows)[2], "either way");
        let without = &mut rows[0].original_without_mips;
        without.insert(key.into(), Some(0.8));
        assert_eq!(told(&rows)[2], "as it is", "a draw is no loss");
        rows[0].original.insert(key.into(), Some(0.9));
        assert_eq!(told(&rows)[2], "no");
        let table = lost_cases(&rows).unwrap();
        let elm = table.body.last().unwrap();
        assert_eq!(
            (elm[0].as_str(), &elm[6..]),
            ("elm", &["", "", ""].map(String::from)[..])
        );
        assert!(note_of_lost(&table).ends_with(WHAT_THE_TREE_SHOWS));
        rows[0].original.clear();
        let older = lost_cases(&rows).unwrap();
        assert_eq!(older.head.len(), 6, "{:?}", older.head);
        assert_eq!(note_of_lost(&older), WHAT_IS_LISTED);
    }

    #[test]
    fn trees_themselves_are_counted_behind_the_default() {
        let mut rows = with_the_tree_itself();
        let table = beaten_as_drawn(&rows).unwrap();
        let counts = |line: usize| [&table.body[line][..3], &table.body[line][5..7]].concat();
        let expected = [
            ["vds triangles", "10 %", "2", "0 / 0", "2 / 0"],
            [THE_TREE_ITSELF, "10 %", "1", "1 / 0", "0 / 0"],
            [WITHOUT_MIPS, "10 %", "1", "0 / 0", "1 / 0"],
        ];
        for (line, expected) in expected.iter().enumerate() {
            assert_eq!(counts(line), expected, "{table:?}");
        }
        // Nothing is known of them in larger pictures and over frames.
        assert_eq!(table.body[1][3], "");
        assert_eq!(table.body[1].last().unwrap(), "fsa fit=coverage");
        assert!(note_of_counts(&table).ends_with(WHAT_THE_TREE_COUNTS));
        rows[0].original.clear();
        rows[0].original_without_mips.clear();
        let older = beaten_as_drawn(&rows).unwrap();
        assert_eq!(older.body.len(), 1);
        assert_eq!(note_of_counts(&older), WHAT_IS_COUNTED);
    }
}
