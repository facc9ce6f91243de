//! Raw rows: a run at a level, judged, with all that is needed to get it again.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::COLUMNS;

/// Values by the keys of [`COLUMNS`]; nothing where one is infinite.
pub type Values = BTreeMap<String, Option<f64>>;

/// One run at one level.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Row {
    /// The tree's name: its file name without ending.
    pub tree: String,
    /// The method's name.
    pub method: String,
    /// What is not the method's default, in words; empty for the default.
    pub setting: String,
    /// What of the tree or the views was changed a little to see whether it
    /// matters; empty for nothing.
    pub change: String,
    /// The seed of methods that draw lots.
    pub seed: u64,
    /// The share of leaves that was asked for.
    pub level: f64,
    /// Leaves of the original.
    pub leaves_original: u64,
    /// Leaves that are left.
    pub leaves_final: u64,
    /// Triangles of the leaves that are left.
    pub triangles_final: u64,
    /// Wall time of the method alone to this level.
    pub seconds: f64,
    /// The largest resident set of the process while the method ran to this
    /// level, where the system tells; the tree and what judges it included.
    #[serde(default)]
    pub peak_rss_bytes: Option<u64>,
    /// Image side in pixels that the method was driven at; 0 if it sees none.
    pub resolution: u32,
    /// Overlap (Jaccard: shared by both / in one of them) of the original leaves
    /// that are left with those of another run, 0 to 1.
    #[serde(default)]
    pub kept_overlap: Option<f64>,
    /// The label of that run; empty for none.
    #[serde(default)]
    pub overlap_with: String,
    /// The largest area of a leaf as a multiple of its original one.
    #[serde(default)]
    pub max_area_scale: Option<f64>,
    /// Over all views.
    pub values: Values,
    /// Of the worst view for each metric.
    pub worst: Values,
    /// Of each view.
    pub per_view: Vec<Values>,
    /// Where leaves were rasterised.
    pub engine: String,
    /// The GPU and its driver.
    pub adapter: Option<String>,
    /// Version of the program.
    pub version: String,
    /// The commit that it was built from, or `unknown`.
    pub commit: String,
    /// Processor and threads.
    pub machine: String,
    /// How to get this level again.
    pub command: String,
    /// The picture of it, a path from the study's folder.
    pub picture: String,
    /// The picture's difference from the original's, likewise; empty for none.
    #[serde(default)]
    pub difference: String,
}

/// What tells rows apart: tree, method, setting, change, seed, and level in
/// millionths.
pub type RowKey = ([String; 4], u64, u64);

impl Row {
    /// Rows of one key are the same run.
    pub fn key(&self) -> RowKey {
        let names = [&self.tree, &self.method, &self.setting, &self.change];
        let level = (1e6 * self.level).round() as u64;
        (names.map(String::clone), self.seed, level)
    }

    /// Setting and change, for readers.
    pub fn variant(&self) -> String {
        let parts = [self.setting.as_str(), self.change.as_str()];
        let parts = parts.into_iter().filter(|part| !part.is_empty());
        parts.collect::<Vec<_>>().join(", ")
    }

    /// Method, setting and change, for readers.
    pub fn label(&self) -> String {
        match self.variant().as_str() {
            "" => self.method.clone(),
            variant => format!("{} {variant}", self.method),
        }
    }
}

/// A row as a line of JSON, with its line end.
pub fn to_line(row: &Row) -> String {
    let json = serde_json::to_string(row).expect("rows have text keys");
    format!("{json}\n")
}

/// The rows of JSON lines, the later of equal keys. A last line without an end
/// was cut off when a study was killed and is passed over.
///
/// # Errors
/// The number of the first whole line that is no row, from 1, and why.
pub fn read_rows(text: &str) -> Result<Vec<Row>, (usize, String)> {
    let whole = text.rfind('\n').map_or("", |end| &text[..end]);
    let mut rows: Vec<Row> = Vec::new();
    let mut place_of: BTreeMap<RowKey, usize> = BTreeMap::new();
    for (line, number) in whole.lines().zip(1..) {
        if line.trim().is_empty() {
            continue;
        }
        let row: Row = serde_json::from_str(line).map_err(|e| (number, e.to_string()))?;
        match place_of.get(&row.key()) {
            Some(&place) => rows[place] = row,
            None => {
                place_of.insert(row.key(), rows.len());
                rows.push(row);
            }
        }
    }
    Ok(rows)
}

/// Rows as CSV: a line of names, a line each; no per-view values.
pub fn to_csv(rows: &[Row]) -> String {
    let mut text = "tree,method,setting,change,seed,level,leaves_original,leaves_final,triangles_final,seconds,peak_rss_bytes,resolution,kept_overlap,overlap_with,max_area_scale".to_owned();
    for prefix in ["", "worst_"] {
        for column in COLUMNS.iter() {
            text += &format!(",{prefix}{}", column.key);
        }
    }
    text += ",engine,adapter,version,commit,machine,command\n";
    for row in rows {
        let quoted = |text: &str| format!("\"{}\"", text.replace('"', "\"\""));
        let mut cells = vec![
            quoted(&row.tree),
            row.method.clone(),
            quoted(&row.setting),
            quoted(&row.change),
            row.seed.to_string(),
            row.level.to_string(),
            row.leaves_original.to_string(),
            row.leaves_final.to_string(),
            row.triangles_final.to_string(),
            row.seconds.to_string(),
            row.peak_rss_bytes.map_or(String::new(), |b| b.to_string()),
            row.resolution.to_string(),
            row.kept_overlap.map_or(String::new(), |o| o.to_string()),
            quoted(&row.overlap_with),
            row.max_area_scale.map_or(String::new(), |s| s.to_string()),
        ];
        for values in [&row.values, &row.worst] {
            let cell = |c: &super::Column| values.get(c.key).copied().flatten();
            let cells_of = COLUMNS
                .iter()
                .map(|c| cell(c).map_or(String::new(), |v| v.to_string()));
            cells.extend(cells_of);
        }
        cells.push(row.engine.clone());
        cells.push(quoted(row.adapter.as_deref().unwrap_or("")));
        cells.extend([row.version.clone(), row.commit.clone()]);
        cells.extend([quoted(&row.machine), quoted(&row.command)]);
        text += &cells.join(",");
        text.push('\n');
    }
    text
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    pub(in crate::study) fn row(method: &str, level: f64, seconds: f64, error: f64) -> Row {
        let values: Values = COLUMNS
            .iter()
            .map(|c| {
                (
                    c.key.to_owned(),
                    Some(if c.unit == "%" { error } else { 0.5 }),
                )
            })
            .collect();
        Row {
            tree: "oak".into(),
            method: method.into(),
            setting: String::new(),
            change: String::new(),
            seed: 0,
            level,
            leaves_original: 100,
            leaves_final: (100.0 * level) as u64,
            triangles_final: 7,
            seconds,
            peak_rss_bytes: Some(50 << 20),
            resolution: 256,
            kept_overlap: None,
            overlap_with: String::new(),
            max_area_scale: None,
            worst: values.clone(),
            per_view: vec![values.clone()],
            values,
            engine: "cpu".into(),
            adapter: None,
            version: "0".into(),
            commit: "unknown".into(),
            machine: "a \"machine\"".into(),
            command: "secateur".into(),
            picture: String::new(),
            difference: String::new(),
        }
    }

    #[test]
    fn rows_come_back_and_a_line_that_was_cut_off_does_not() {
        let (a, b) = (row("a", 0.5, 1.0, 2.0), row("b", 0.5, 1.0, 2.0));
        let again = Row {
            seconds: 9.0,
            ..a.clone()
        };
        let text = to_line(&a) + &to_line(&b) + &to_line(&again);
        assert_eq!(read_rows(&text).unwrap(), [again.clone(), b.clone()]);
        let cut = &text[..text.len() - 5];
        assert_eq!(read_rows(cut).unwrap(), [a, b]);
        assert_eq!(read_rows("").unwrap(), []);
        assert_eq!(read_rows("{}\nnonsense\n").unwrap_err().0, 1);
    }

    #[test]
    fn infinite_values_are_null_and_empty_cells() {
        let mut row = row("a", 0.5, 1.0, 2.0);
        row.values.insert("vmi_error_percent".into(), None);
        assert_eq!(read_rows(&to_line(&row)).unwrap(), [row.clone()]);
        let csv = to_csv(&[row]);
        let lines: Vec<&str> = csv.lines().collect();
        assert_eq!(lines.len(), 2);
        assert!(lines[1].contains(",256,,\"\",,,0.5,"), "{}", lines[1]);
        assert!(lines[1].contains("\"a \"\"machine\"\"\""));
    }
}
