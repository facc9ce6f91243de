//! Everything that is drawn from the rows alone.

use std::fs;
use std::path::{Path, PathBuf};

use secateur_eval::study::{
    COLUMNS, Picture, Row, Study, chart, readme, report, summarise, to_csv,
};

use super::super::failure::Failure;
use super::super::output;
use super::{paper, scenes};

/// What was written.
pub(super) struct Drawn {
    pub(super) report: PathBuf,
    pub(super) csv: PathBuf,
    pub(super) charts: Vec<PathBuf>,
}

/// Writes charts, report and CSV anew.
///
/// # Errors
/// [`Failure`] if there is no row, or a file can't be written.
pub(super) fn draw(folder: &Path, rows: &[Row]) -> Result<Drawn, Failure> {
    if rows.is_empty() {
        return Err(Failure(format!(
            "{}: there are no rows to draw",
            folder.display()
        )));
    }
    let csv = folder.join("rows.csv");
    output::write_file(&csv, to_csv(rows).as_bytes())?;
    let trials = scenes::trials();
    let paper = paper::paper();
    let study = Study {
        rows,
        trials: &trials,
        paper: Some(&paper),
    };
    let given = study.given_rows();
    let given: Vec<&Row> = given.iter().collect();
    let charts = write_charts(&folder.join("charts"), &given)?;
    output::write_file(&folder.join("README.md"), readme(&study).as_bytes())?;
    let path = folder.join("report.html");
    output::write_file(&path, report(&study, &pictures(folder, rows)).as_bytes())?;
    Ok(Drawn {
        report: path,
        csv,
        charts,
    })
}

fn write_charts(folder: &Path, rows: &[&Row]) -> Result<Vec<PathBuf>, Failure> {
    output::make_folder(folder)?;
    let mut levels: Vec<f64> = rows.iter().map(|row| row.level).collect();
    levels.sort_by(f64::total_cmp);
    levels.dedup();
    let mut written = Vec::new();
    for level in levels {
        let at: Vec<&Row> = rows
            .iter()
            .copied()
            .filter(|row| row.level == level)
            .collect();
        let percent = (1e4 * level).round() / 100.0;
        for column in COLUMNS.iter() {
            let title = format!("{} at {percent} % of the leaves", column.title);
            let svg = chart(&summarise(&at, column), column, &title);
            let path = folder.join(format!("{}-{percent}.svg", column.key));
            output::write_file(&path, svg.as_bytes())?;
            written.push(path);
        }
    }
    Ok(written)
}

/// Pictures that are gone are left out.
fn pictures(folder: &Path, rows: &[Row]) -> Vec<Picture> {
    let originals = rows
        .iter()
        .map(|r| format!("pictures/{}-original.jpg", r.tree));
    let own = rows.iter().flat_map(|r| [&r.picture, &r.difference]);
    let mut paths: Vec<String> = own.cloned().collect();
    paths.extend(originals);
    paths.sort();
    paths.dedup();
    // Only what a study wrote: rows can come from elsewhere.
    let is_own = |path: &String| {
        let name = path.strip_prefix("pictures/");
        name.is_some_and(|name| !name.contains(['/', '\\']) && name.ends_with(".jpg"))
    };
    let read = |path: String| Some((path.clone(), fs::read(folder.join(&path)).ok()?));
    paths.into_iter().filter(is_own).filter_map(read).collect()
}
