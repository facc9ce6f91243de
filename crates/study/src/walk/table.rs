//! Rows of a walk as a table.

use super::WalkFrame;
use crate::Row;
use crate::table::Table;

/// What stands above the table.
pub(crate) const WHAT_IS_COMPARED: &str = "Woods of oaks and palmettos along a path of 24 m, after L-plants. 48 frames go ahead, half a metre each; in 12 more the camera turns half way round. Levels begin at 8, 16, 24 and 32 m for all, as ranges are the user's there. The two schemes say which share of the sticks each level loses; the branch chain of Hybrid has as large shares of the leaves left as the first. With the panorama, oaks beyond the last range from everywhere on the path are one picture of full geometry behind the rest. Alone they are the last level. Triangles are of plants in view, the mean over frames. FLIP is of frames 180 pixels high against full geometry. A step is FLIP between neighbouring frames. Of those with a switch the one farthest beyond full geometry's is shown, and beside it full geometry's there, which is of the camera alone. A pop is FLIP of a frame against itself with the levels of the frame before. L-plants says that its first scheme was 15 to 20 % faster and popped slightly worse.";

/// The frames of one case.
struct OfCase<'r> {
    label: String,
    frames: Vec<(&'r Row, WalkFrame)>,
}

/// The cases, in the order of running.
fn cases(rows: &[Row]) -> Vec<OfCase<'_>> {
    let mut cases: Vec<OfCase<'_>> = Vec::new();
    for row in rows {
        let Some(frame) = row.walk else {
            continue;
        };
        let label = row.label();
        let label = label.split(" frame ").next().unwrap_or_default().to_owned();
        match cases.iter_mut().find(|case| case.label == label) {
            Some(case) => case.frames.push((row, frame)),
            None => cases.push(OfCase {
                label,
                frames: vec![(row, frame)],
            }),
        }
    }
    cases
}

fn mean(values: impl Iterator<Item = f64>) -> f64 {
    let (sum, count) = values.fold((0.0, 0.0), |(sum, count), v| (sum + v, count + 1.0));
    sum / count
}

/// A title and the table, if there are rows of a walk.
pub(crate) fn tables(rows: &[Row]) -> Vec<(String, Table)> {
    let mut table = Table::new(&[
        "levels",
        "frames",
        "triangles ahead",
        "of full geometry",
        "triangles turning",
        "FLIP ahead",
        "FLIP turning",
        "worst FLIP",
        "largest step at a switch",
        "full geometry's there",
        "mean pop",
        "largest pop",
    ]);
    for case in cases(rows) {
        table.push(line(&case));
    }
    match table.body.is_empty() {
        true => Vec::new(),
        false => vec![("Frames of the walk".to_owned(), table)],
    }
}

fn line(case: &OfCase<'_>) -> Vec<String> {
    let flip = |row: &Row| {
        let value = row.values.get("flip_mean").copied().flatten();
        value.unwrap_or(f64::NAN)
    };
    let part = |is_turn: bool| {
        case.frames
            .iter()
            .filter(move |(_, f)| f.is_turn == is_turn)
    };
    let triangles = |is_turn| mean(part(is_turn).map(|(row, _)| row.triangles_final as f64));
    let flips = |is_turn| mean(part(is_turn).map(|(row, _)| flip(row)));
    let full = mean(part(false).map(|(_, f)| f.triangles_original as f64));
    let worst = case
        .frames
        .iter()
        .map(|(row, _)| flip(row))
        .fold(0.0, f64::max);
    let steps = case.frames.iter().filter(|(_, frame)| frame.switches > 0);
    let steps = steps.filter_map(|(_, frame)| Some([frame.step?, frame.step_original?]));
    let beyond = |[own, full]: &[f64; 2]| own - full;
    let largest = steps.max_by(|a, b| beyond(a).total_cmp(&beyond(b)));
    let pops = || case.frames.iter().filter_map(|(_, frame)| frame.pop);
    // A study that was stopped may have no frame of a kind.
    let written = |value: f64, digits: usize| match value.is_finite() {
        true => format!("{value:.digits$}"),
        false => String::new(),
    };
    let shown = |value| written(value, 4);
    let [own, of_full] = largest.unwrap_or([f64::NAN; 2]);
    vec![
        case.label.clone(),
        case.frames.len().to_string(),
        written(triangles(false), 0),
        format!("{:.1} %", 100.0 * triangles(false) / full),
        written(triangles(true), 0),
        shown(flips(false)),
        shown(flips(true)),
        shown(worst),
        shown(own),
        shown(of_full),
        shown(mean(pops())),
        shown(pops().fold(f64::NAN, f64::max)),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rows::tests::row;

    fn frame(number: u32, triangles: u64, flip: f64, steps: [f64; 2], pop: Option<f64>) -> Row {
        let mut row = row("merge", 1.0, 1.0, 1.0);
        row.setting = format!("25-25-25-25 frame {number:02}");
        row.triangles_final = triangles;
        row.values = [("flip_mean".to_owned(), Some(flip))].into();
        row.walk = Some(WalkFrame {
            frame: number,
            is_turn: number == 3,
            has_panorama: false,
            triangles_original: 100,
            switches: u64::from(pop.is_some()),
            step: (number > 0).then_some(steps[0]),
            step_original: (number > 0).then_some(steps[1]),
            pop,
        });
        row
    }

    /// Ahead 40, 20 and 30 of 100 triangles; the step of .5 is of moving alone, that of .4 is .3 beyond.
    #[test]
    fn a_case_has_a_line_over_its_frames() {
        let rows = [
            frame(0, 40, 0.1, [0.0; 2], None),
            frame(1, 20, 0.3, [0.5, 0.4], Some(0.2)),
            frame(2, 30, 0.2, [0.4, 0.1], Some(0.1)),
            frame(3, 12, 0.4, [0.9, 0.2], None),
            row("vds", 0.5, 1.0, 1.0),
        ];
        let tables = tables(&rows);
        let expected = [
            "merge 25-25-25-25",
            "4",
            "30",
            "30.0 %",
            "12",
            "0.2000",
            "0.4000",
            "0.4000",
            "0.4000",
            "0.1000",
            "0.1500",
            "0.2000",
        ];
        assert_eq!(tables[0].1.body, [expected]);
        assert!(super::tables(&rows[4..]).is_empty());
    }
}
