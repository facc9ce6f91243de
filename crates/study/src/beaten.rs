//! In how many cases a method that is not VDS does better than VDS, and in which: as a client
//! draws, near by and far off, and in VMI error.

use crate::columns::column;
use crate::format::{number, percent};
use crate::table::Table;
use crate::{Column, Row, Values};

/// What reports say that the cells of [`beaten_as_drawn`] count.
pub(crate) const WHAT_IS_COUNTED: &str = "On how many trees some method that is not VDS is better / how many of these without a fit of its sizes; FLIP and outlines of pictures as a client draws them (mip maps, one sample a pixel, back faces culled), 512 and 128 pixels wide (over frames: the mean of 16 frames of one sample at another place in each pixel, as temporal anti-aliasing shows it), against what the original truly shows (IoU with the truth: parts of pixels counted; rows of before are held against the original as the same client draws it, which may have faded itself), and VMI error. However small the difference is.";

/// What reports say that the lines of [`lost_cases`] are.
pub(crate) const WHAT_IS_LISTED: &str = "The cases that the default under a budget of triangles loses as drawn, each with the best of the other methods. Beside it what the tree itself shows in such a picture, as it is and read without mip maps; and whether it would lose too: whether some of these other methods is better than it in FLIP or outline of a single frame, at 512 or at 128 pixels.";

/// The setting whose lost cases are listed: the default under a budget of triangles.
pub(crate) const LISTED: &str = "vds triangles";

/// By what rows are judged: outlines by the truth where all rows have that, else by what a client
/// shows of the original; over frames where all rows have that; VMI error last.
fn judged(rows: &[Row]) -> Vec<&'static Column> {
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
    !row.setting.contains("fit=")
}

/// The rows that are compared: of leaves of trees as they are, judged as drawn too, by views that
/// did not drive them.
fn compared<'r>(rows: &'r [Row], judged: &[&Column]) -> Vec<&'r Row> {
    let is_compared = |row: &&Row| {
        row.is_of_leaves()
            && row.change.is_empty()
            && !row.is_driven_by_judging_views
            && judged.iter().all(|c| c.value_of(row).is_finite())
    };
    rows.iter().filter(is_compared).collect()
}

/// Other methods on the same tree at the same level.
fn rivals<'r>(own: &Row, rows: &[&'r Row]) -> Vec<&'r Row> {
    let is_rival = |row: &Row| !is_vds(row) && row.tree == own.tree && row.level == own.level;
    let rivals = rows.iter().copied().filter(|row| is_rival(row));
    rivals.collect()
}

/// Those of them that are better in a metric.
fn better<'r>(own: &Row, rows: &[&'r Row], by: &Column) -> Vec<&'r Row> {
    let mut rivals = rivals(own, rows);
    rivals.retain(|rival| by.is_better(rival, own));
    rivals
}

/// Whether the tree itself would lose against the rivals of one of its levels, in some metric of
/// single frames: as it is, and read without mip maps. Nothing where the row does not know.
fn would_lose(own: &Row, rows: &[&Row], judged: &[&Column]) -> Option<[bool; 2]> {
    let rivals = rivals(own, rows);
    let loses = |shown: &Values| {
        let in_frames = (judged.iter()).filter_map(|by| Some((by, by.value_in(shown)?)));
        let mut in_frames = in_frames.peekable();
        in_frames.peek()?;
        let is_better = |by: &Column, value, rival: &&Row| {
            by.direction.badness(by.value_of(rival)) < by.direction.badness(value)
        };
        Some(in_frames.any(|(by, value)| rivals.iter().any(|rival| is_better(by, value, rival))))
    };
    Some([loses(&own.original)?, loses(&own.original_without_mips)?])
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
    let mut seen: Vec<(String, f64)> = Vec::new();
    for first in rows.iter().filter(|row| is_vds(row)) {
        let key = (first.label(), first.level);
        if seen.contains(&key) {
            continue;
        }
        let own = rows
            .iter()
            .filter(|row| (row.label(), row.level) == key)
            .filter(|own| (rows.iter()).any(|row| !is_vds(row) && row.tree == own.tree));
        let own: Vec<&Row> = own.copied().collect();
        let mut winners: Vec<(String, usize)> = Vec::new();
        let mut cells = vec![key.0.clone(), percent(key.1), own.len().to_string()];
        for by in &judged {
            let (mut lost, mut lost_to_unfitted) = (0, 0);
            for row in &own {
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
        seen.push(key);
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
            "the tree itself",
            "without mip maps",
            "would the tree lose too?",
        ]);
    }
    let mut table = Table::new(&head);
    for own in listed() {
        let tree_loses = match would_lose(own, &rows, &judged) {
            Some([true, true]) => "yes, either way",
            Some([true, false]) => "as it is",
            Some([false, true]) => "without mip maps",
            Some([false, false]) => "no",
            None => "",
        };
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
                    let value = |shown| by.value_in(shown).map(|value| number(value, by));
                    cells.extend(shown.map(|shown| value(shown).unwrap_or_default()));
                    cells.push(tree_loses.to_owned());
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

    /// A rival is better than what the tree shows without mip maps, and none than what it shows with
    /// them; the elm knows nothing of itself.
    #[test]
    fn lost_cases_tell_whether_the_tree_itself_would_lose() {
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
            of(["fsa", ""], "oak", 0.03, 0.8, 4.0),
            of(["fsa", ""], "elm", 0.03, 0.8, 4.0),
        ];
        let without = lost_cases(&rows).unwrap();
        assert_eq!(without.head.len(), 6, "{:?}", without.head);
        rows[0].original = shown(0.03, 0.8);
        rows[0].original_without_mips = shown(0.02, 0.79);
        let told = |rows: &[Row]| {
            let table = lost_cases(rows).unwrap();
            let line = table.body.iter().find(|cells| cells[2].contains("128"));
            line.unwrap()[6..].to_vec()
        };
        assert_eq!(told(&rows), ["0.8000", "0.7900", "without mip maps"]);
        let elm = lost_cases(&rows).unwrap().body.pop().unwrap();
        assert_eq!(elm[0], "elm");
        assert_eq!(elm[6..], ["", "", ""]);
        rows[0].original = shown(0.04, 0.8);
        assert_eq!(told(&rows)[2], "yes, either way");
        rows[0].original_without_mips = shown(0.02, 0.8);
        assert_eq!(told(&rows)[2], "as it is");
        rows[0].original = shown(0.03, 0.9);
        assert_eq!(told(&rows)[2], "no");
    }
}
