//! Writes everything that is drawn from rows alone: charts, report, README and CSV.

use std::fs;
use std::path::{Path, PathBuf};

use crate::distances;
use crate::files::{is_picture, make_folder};
use crate::{
    COLUMNS, Error, Host, Picture, Row, Study, chart, paper, readme, report, scenes, summarise,
    to_csv,
};

/// The files that were drawn.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct DrawnFiles {
    /// The number of rows that they show.
    pub rows: usize,
    /// The report, one HTML file.
    pub report: PathBuf,
    /// The rows as CSV.
    pub csv: PathBuf,
    /// A chart for each level and metric, and those of what is drawn at distances.
    pub charts: Vec<PathBuf>,
}

/// Writes charts, report and CSV anew.
///
/// # Errors
/// [`Error`] if there is no row, or a file can't be written.
pub(crate) fn draw(folder: &Path, rows: &[Row], host: &dyn Host) -> Result<DrawnFiles, Error> {
    let write = |path: &Path, bytes: &[u8]| host.write_file(path, bytes).map_err(Error::Refused);
    if rows.is_empty() {
        return Err(Error::Refused(format!(
            "{}: there are no rows to draw",
            folder.display()
        )));
    }
    let csv = folder.join("rows.csv");
    write(&csv, to_csv(rows).as_bytes())?;
    let failure_cases = scenes::failure_cases();
    let paper = paper::paper();
    let study = Study {
        rows,
        failure_cases: &failure_cases,
        paper: Some(&paper),
    };
    let given = study.given_rows();
    let given: Vec<&Row> = given.iter().collect();
    let folder_of_charts = folder.join("charts");
    let mut charts = write_charts(&folder_of_charts, &given, host)?;
    for (name, svg) in distances::charts(rows) {
        let path = folder_of_charts.join(name);
        write(&path, svg.as_bytes())?;
        charts.push(path);
    }
    write(&folder.join("README.md"), readme(&study).as_bytes())?;
    let path = folder.join("report.html");
    write(&path, report(&study, &pictures(folder, rows)).as_bytes())?;
    Ok(DrawnFiles {
        rows: rows.len(),
        report: path,
        csv,
        charts,
    })
}

fn write_charts(folder: &Path, rows: &[&Row], host: &dyn Host) -> Result<Vec<PathBuf>, Error> {
    make_folder(folder)?;
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
            host.write_file(&path, svg.as_bytes())
                .map_err(Error::Refused)?;
            written.push(path);
        }
    }
    Ok(written)
}

/// The pictures that rows name, as far as they are there.
fn pictures(folder: &Path, rows: &[Row]) -> Vec<Picture> {
    let originals = rows.iter().map(|r| r.identity().original_picture());
    let own = rows.iter().flat_map(|r| [&r.picture, &r.difference]);
    let mut paths: Vec<String> = own.cloned().collect();
    paths.extend(originals);
    paths.sort();
    paths.dedup();
    let read = |path: String| Some((path.clone(), fs::read(folder.join(&path)).ok()?));
    paths.retain(|path| is_picture(path));
    paths.into_iter().filter_map(read).collect()
}
