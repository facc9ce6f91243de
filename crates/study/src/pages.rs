//! Tables of pages that people write, filled from rows: `<!-- rows KIND FOLDER -->` up to
//! `<!-- end of rows -->`, where FOLDER holds the `rows.jsonl` of a study.

use std::fmt::Write as _;
use std::path::Path;

use crate::as_options::as_options;
use crate::better_rivals::{beaten_as_drawn, lost_cases};
use crate::columns::column;
use crate::distances;
use crate::format::percent;
use crate::fsa_time::fsa_time;
use crate::paper::paper;
use crate::published::{beside, nearest};
use crate::report::Study;
use crate::stability;
use crate::table::Table;
use crate::{Error, Point, Row, current_rows, fairness, lead, row_file, summarise, tree_itself};

const BEGIN: &str = "<!-- rows ";
const END: &str = "<!-- end of rows -->";

/// What pages compare: the default, what explains it, and the other methods, fitted too.
const COMPARED: [&str; 13] = [
    "vds triangles",
    "vds triangles fit=none",
    "vds triangles preset information",
    "vds",
    "vds preset information",
    "meshopt preserve-area fit=coverage",
    "meshopt preserve-area",
    "meshopt dilate-borders fit=coverage",
    "meshopt dilate-borders",
    "fsa corners furthest fit=coverage",
    "fsa corners furthest",
    "stochastic fit=coverage",
    "stochastic",
];

/// What a page's head compares at a tenth.
const AT_A_TENTH: [&str; 6] = [
    "vds triangles",
    "vds triangles preset information",
    "meshopt preserve-area fit=coverage",
    "meshopt preserve-area",
    "fsa corners furthest",
    "stochastic",
];

/// What trades time for accuracy: views that drive, their resolution and field of view, and fits.
const DRIVEN: [&str; 21] = [
    "vds triangles views dodecahedron",
    "vds triangles views 60",
    "vds fit=none",
    "vds",
    "vds field-of-view tight",
    "vds views turning",
    "vds preset information views 6",
    "vds preset information views 8",
    "vds preset information views 12",
    "vds preset information views vnc",
    "vds preset information views dodecahedron",
    "vds preset information views 32",
    "vds preset information views 60",
    "vds preset information",
    "vds preset information resolution 64",
    "vds preset information resolution 128",
    "vds preset information resolution 256",
    "vds preset information resolution 512",
    "vds preset information resolution 1024",
    "vds preset information field-of-view tight resolution 160",
    "vds preset information field-of-view tight resolution 256",
];

/// A page with its tables filled anew from the rows of the folders that they name, which are
/// paths from `root`. The same rows give the same page.
///
/// # Errors
/// [`Error`] if a table has no end, is of no kind that is known, or the rows have nothing for it.
pub fn fill_tables(page: &str, root: &Path) -> Result<String, Error> {
    filled(page, &|folder| {
        Ok(current_rows(row_file::read(&root.join(folder))?))
    })
}

fn filled(page: &str, rows_of: &dyn Fn(&str) -> Result<Vec<Row>, Error>) -> Result<String, Error> {
    let mut filled = String::new();
    let mut rest = page;
    while let Some(begin) = rest.find(BEGIN) {
        let head_end = rest[begin..].find("-->").map(|at| begin + at + 3);
        let end = head_end.and_then(|head| Some((head, head + rest[head..].find(END)?)));
        let Some((head_end, end)) = end else {
            let head = rest[begin..].lines().next().unwrap_or("");
            return refused(format!(
                "the table of {head} has no end: `{END}` is missing"
            ));
        };
        let asked = rest[begin + BEGIN.len()..head_end - 3].trim();
        let (kind, folder) = asked.split_once(' ').unwrap_or((asked, ""));
        let Some(table) = table(kind, &rows_of(folder)?)? else {
            return refused(format!(
                "the rows of {folder} have nothing for a table of {kind}"
            ));
        };
        let _ = write!(filled, "{}\n{table}", &rest[..head_end]);
        rest = &rest[end..];
    }
    Ok(filled + rest)
}

fn refused<T>(reason: String) -> Result<T, Error> {
    Err(Error::Refused(reason))
}

/// The Markdown of a kind of table; nothing where the rows have none.
fn table(kind: &str, rows: &[Row]) -> Result<Option<String>, Error> {
    let given = Study {
        rows,
        failure_cases: &crate::scenes::failure_cases(),
        paper: Some(&paper()),
    };
    let given = given.given_rows();
    let found = match kind {
        "means" => means(&given, &COMPARED, &[0.5, 0.25, 0.1]),
        "tenth" => means(&given, &AT_A_TENTH, &[0.1]),
        "driving" => means(&given, &DRIVEN, &[0.25, 0.1]),
        "fsa-time" => fsa_time(&given),
        "beaten" => beaten_as_drawn(rows).map(typed),
        "lost" => match (beaten_as_drawn(rows), lost_cases(rows)) {
            (Some(_), None) => return Ok(Some("None.\n".to_owned())),
            (_, lost) => lost.map(typed),
        },
        "flicker-of-methods" => tree_itself::flicker_of_methods(rows).map(typed),
        "lead" => lead::lead(rows).map(typed),
        "fairness" => fairness::table(rows).map(typed),
        "paper" => beside(&paper(), rows)
            .into_iter()
            .next()
            .map(|(_, t)| typed(t)),
        "nearest" => nearest(&paper(), rows).map(typed),
        "stability" => stability::by_method(&given).map(typed),
        "walks" => distances::walks(rows),
        "subject" => return Ok(subject(rows)),
        _ => {
            return refused(format!(
                "{kind} is no kind of table: there are means, tenth, driving, fsa-time, beaten, lost, flicker-of-methods, lead, fairness, subject, paper, nearest, stability and walks"
            ));
        }
    };
    Ok(found.map(|table| table.markdown()))
}

/// What was studied, on what, by which program: a sentence.
fn subject(rows: &[Row]) -> Option<String> {
    let each = |what: fn(&Row) -> &str| {
        let mut all: Vec<&str> = rows.iter().map(what).collect();
        all.sort_unstable();
        all.dedup();
        all.join(", ")
    };
    rows.first()?;
    let trees = each(|row| &row.tree).replace(", ", "`, `");
    Some(format!(
        "{} rows of `{trees}`; commit {}, {}.\n",
        rows.len(),
        each(|row| &row.commit),
        each(|row| &row.machine)
    ))
}

/// Labels in their cells as one types them.
fn typed(mut table: Table) -> Table {
    for cells in &mut table.body {
        for cell in cells.iter_mut() {
            if ["vds", "fsa", "stochastic", "meshopt", "chain", "merge"]
                .contains(&cell.split(' ').next().unwrap_or(""))
            {
                *cell = format!("`{}`", as_options(cell));
            }
        }
    }
    table
}

/// Means over trees of the methods named, a line for each and each level.
fn means(rows: &[Row], labels: &[&str], levels: &[f64]) -> Option<Table> {
    let several = levels.len() > 1;
    let mut head = vec![
        "method",
        "FLIP",
        "IoU",
        "coverage",
        "VMI error, worst set",
        "FLIP as drawn, 512 and 128 px",
        "time",
    ];
    if several {
        head.insert(0, "level");
    }
    let over_frames = ["flip_over_frames_128", "truth_iou_over_frames_128"].map(column);
    let has_frames = (rows.iter()).any(|row| over_frames[0].value_of(row).is_finite());
    if has_frames {
        head.insert(head.len() - 1, "FLIP and IoU over frames, 128 px");
    }
    let mut table = Table::new(&head);
    for level in levels {
        let there: Vec<&Row> = (rows.iter())
            .filter(|row| row.level == *level && row.change.is_empty())
            .collect();
        let mut is_first = true;
        for label in labels {
            let own: Vec<&Row> = (there.iter().copied())
                .filter(|row| row.label() == **label)
                .collect();
            if own.is_empty() {
                continue;
            }
            let mean = |key: &str| -> Option<Point> { summarise(&own, column(key)).pop() };
            let value = |key: &str| mean(key).map_or(f64::NAN, |point| point.mean);
            let error = mean("vmi_error_percent")?;
            let drawn = ["flip_as_drawn_512", "flip_as_drawn_128"].map(value);
            let mut cells = vec![
                format!("`{}`", as_options(label)),
                format!("{:.4}", value("flip_mean")),
                format!("{:.3}", value("silhouette_iou")),
                format!("{:.2}", value("coverage_ratio")),
                format!("{:.1} %, {:.1} %", error.mean, error.mean_of_worst),
                match drawn.iter().all(|value| value.is_finite()) {
                    true => format!("{:.4}, {:.4}", drawn[0], drawn[1]),
                    false => String::new(),
                },
                seconds(error.seconds),
            ];
            if has_frames {
                let [flip, iou] = over_frames.map(|by| value(by.key));
                let cell = match flip.is_finite() && iou.is_finite() {
                    true => format!("{flip:.4}, {iou:.3}"),
                    false => String::new(),
                };
                cells.insert(cells.len() - 1, cell);
            }
            if several {
                let level = match is_first {
                    true => percent(*level),
                    false => String::new(),
                };
                cells.insert(0, level);
            }
            table.push(cells);
            is_first = false;
        }
    }
    (!table.body.is_empty()).then_some(table)
}

/// Two digits: "0.0012 s", "0.81 s", "12 s".
fn seconds(seconds: f64) -> String {
    let digits = (1.0 - seconds.max(1e-6).log10().floor()).max(0.0);
    format!("{seconds:.*} s", digits as usize)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rows::tests::row;

    fn rows() -> Vec<Row> {
        let vds = Row {
            setting: "triangles".into(),
            ..row("vds", 0.1, 1.25, 3.0)
        };
        vec![vds, row("stochastic", 0.1, 0.001, 9.0)]
    }

    fn fill(page: &str) -> Result<String, Error> {
        filled(page, &|folder| {
            assert_eq!(folder, "a/study");
            Ok(rows())
        })
    }

    #[test]
    fn tables_are_filled_and_the_words_around_them_stay() {
        let page = "before\n\n<!-- rows tenth a/study -->\nold\n<!-- end of rows -->\n\nafter\n";
        let filled = fill(page).unwrap();
        let line = "| `vds --triangles` | 0.5000 | 0.500 | 0.50 | 3.0 %, 3.0 % |  | 1.2 s |";
        assert!(filled.contains(line), "{filled}");
        assert!(filled.starts_with("before\n\n<!-- rows tenth a/study -->\n| method |"));
        assert!(filled.ends_with("0.0010 s |\n<!-- end of rows -->\n\nafter\n"));
        assert!(!filled.contains("old"));
        assert_eq!(fill(&filled).unwrap(), filled, "filled again");
        assert_eq!(fill("no table").unwrap(), "no table");
    }

    #[test]
    fn what_cannot_be_filled_is_said() {
        let endless = fill("<!-- rows tenth a/study -->\n| old |\n").unwrap_err();
        assert!(endless.to_string().contains("has no end"), "{endless}");
        let unknown = fill("<!-- rows odd a/study -->\n<!-- end of rows -->").unwrap_err();
        assert!(
            unknown.to_string().starts_with("odd is no kind"),
            "{unknown}"
        );
        let empty = fill("<!-- rows lost a/study -->\n<!-- end of rows -->").unwrap_err();
        assert!(empty.to_string().contains("a/study"), "{empty}");
    }

    #[test]
    fn times_have_two_digits() {
        let times = [0.00123, 0.0123, 0.81, 1.25, 12.4].map(seconds);
        assert_eq!(times, ["0.0012 s", "0.012 s", "0.81 s", "1.2 s", "12 s"]);
    }
}
