//! Raw rows: a run at a level, judged, with all that is needed to get it again.

use std::collections::BTreeMap;

use secateur_eval::JudgingViews;
use serde::{Deserialize, Serialize};

use crate::older_rows;
use crate::{JudgedLeaves, LevelOf, Provenance, SeenFrom, WalkFrame, WholeCounts};

/// Values by the keys of [`COLUMNS`](crate::COLUMNS); nothing where one is infinite.
pub type Values = BTreeMap<String, Option<f64>>;

/// One run of a method on a tree, judged at one level.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
pub struct Row {
    /// Version of the shape of rows: [`Self::SCHEMA_VERSION`]. Older rows have none and are of the first.
    #[serde(default = "first_version")]
    pub schema_version: u32,
    /// The tree's name: its file name without ending.
    pub tree: String,
    /// SHA-256 of the tree's files in hexadecimal; unknown of rows that are older.
    #[serde(default)]
    pub tree_sha256: Option<String>,
    /// The method as `--method` spells it.
    pub method: String,
    /// What is not the method's default, in words; empty for the default.
    pub setting: String,
    /// What of the tree or the views was changed a little to see whether it
    /// matters; empty for nothing.
    pub change: String,
    /// The seed of methods that draw lots.
    pub seed: u64,
    /// The share that was asked for, 0 to 1; 1 of what is drawn at a distance, for which none is.
    pub level: f64,
    /// What the level is a share of; of a whole plant all its triangles.
    pub level_of: LevelOf,
    /// Which views judged it. Older rows were judged by one icosahedron.
    #[serde(default = "one_icosahedron")]
    pub judged_by: JudgingViews,
    /// As what its leaves were counted. Older rows were counted as the file has them.
    #[serde(default)]
    pub judged_leaves: JudgedLeaves,
    /// Whether some of the views that drove the method are among those that judge it.
    pub is_driven_by_judging_views: bool,
    /// Leaves of the original.
    pub leaves_original: u64,
    /// Leaves that are left; 0 of a whole plant that another program made, which knows none.
    pub leaves_final: u64,
    /// Triangles of the leaves that are left; of a whole plant all that are left.
    pub triangles_final: u64,
    /// What is counted of a whole plant beside; nothing of rows of leaves. Outlines are the whole
    /// plant's then too.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub whole: Option<WholeCounts>,
    /// From where the plant is seen, of rows of what is drawn at a distance; their triangles are those of
    /// the whole plant, and FLIP is their only metric, from six of the views that judge.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub seen_from: Option<SeenFrom>,
    /// Which frame of a walk it is, of rows of frames; their triangles are those of all plants in view, and FLIP is
    /// that of the frame against full geometry.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub walk: Option<WalkFrame>,
    /// Wall time of the method alone to this level; 0 of frames of a walk, which are not timed.
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
    /// The metrics, mean over the sets of judging views.
    pub values: Values,
    /// Each metric in the worst set; where there is one, in its worst view.
    pub worst: Values,
    /// The metrics by each set of judging views.
    #[serde(default)]
    pub rigs: Vec<Values>,
    /// The metrics in each view, of rows that are older.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub per_view: Vec<Values>,
    /// What a client shows of the tree itself in single frames, and how much it flickers, by the keys of
    /// [`DRAWN_COLUMNS`](crate::DRAWN_COLUMNS); of rows that were judged so.
    #[serde(default, skip_serializing_if = "Values::is_empty")]
    pub original: Values,
    /// What it shows if the client read its textures without mip maps.
    #[serde(default, skip_serializing_if = "Values::is_empty")]
    pub original_without_mips: Values,
    /// What rasterised leaves: `cpu` or `gpu`.
    pub engine: String,
    /// The GPU and its driver, if there was one.
    pub adapter: Option<String>,
    /// Version of the program.
    pub version: String,
    /// The commit that it was built from, or `unknown`.
    pub commit: String,
    /// Processor, threads and system.
    pub machine: String,
    /// The command that makes this level again, given in the study's folder.
    pub command: String,
    /// The picture of it, a path from the study's folder.
    pub picture: String,
    /// The picture's difference from the original's, likewise; empty for none.
    #[serde(default)]
    pub difference: String,
}

fn first_version() -> u32 {
    1
}

fn one_icosahedron() -> JudgingViews {
    JudgingViews::Icosahedron
}

/// Which tree a row is of, which program made it and which views judged it. Rows of one name that
/// differ in this can't stand beside each other.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Identity {
    /// Name of the tree: its file's without the ending.
    pub tree: String,
    /// SHA-256 of the tree's files, where the row has it.
    pub tree_sha256: Option<String>,
    /// Version of the program.
    pub version: String,
    /// Which views judged it.
    pub judged_by: JudgingViews,
    /// As what its leaves were counted.
    pub judged_leaves: JudgedLeaves,
}

/// The key of a row: rows of one key are the same run.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct RowKey {
    /// The tree and the program.
    pub identity: Identity,
    /// The method as `--method` spells it.
    pub method: String,
    /// What is not the method's default.
    pub setting: String,
    /// What was changed a little.
    pub change: String,
    /// The seed of methods that draw lots.
    pub seed: u64,
    /// The level in millionths.
    pub level_millionths: u64,
}

impl Identity {
    /// The identity of a tree whose files are at hand.
    pub(crate) fn new(
        tree: &str,
        tree_sha256: &str,
        provenance: &Provenance,
        judged_by: JudgingViews,
        judged_leaves: JudgedLeaves,
    ) -> Self {
        Self {
            tree: tree.to_owned(),
            tree_sha256: Some(tree_sha256.to_owned()),
            version: provenance.version.clone(),
            judged_by,
            judged_leaves,
        }
    }

    /// What the names of this tree's files begin with, so that another tree of the same name, or
    /// another program, does not write over them.
    pub(crate) fn file_stem(&self) -> String {
        match &self.tree_sha256 {
            Some(sha256) => {
                let short = sha256.get(..8).unwrap_or(sha256);
                format!("{}-{short}-{}", self.tree, self.version)
            }
            None => self.tree.clone(),
        }
    }

    /// The picture of the tree itself, a path from the study's folder.
    pub(crate) fn original_picture(&self) -> String {
        format!("pictures/{}-original.jpg", self.file_stem())
    }
}

/// A level in millionths, which can be compared exactly.
pub(crate) fn millionths(level: f64) -> u64 {
    (1e6 * level).round() as u64
}

impl Row {
    /// Version of the shape of rows. It changes where a column goes or gets another meaning.
    pub const SCHEMA_VERSION: u32 = 1;

    /// A row of nothing yet, of this tree and program.
    pub(crate) fn blank(identity: &Identity, provenance: Provenance) -> Self {
        Self {
            schema_version: Self::SCHEMA_VERSION,
            tree: identity.tree.clone(),
            tree_sha256: identity.tree_sha256.clone(),
            method: String::new(),
            setting: String::new(),
            change: String::new(),
            seed: 0,
            level: 1.0,
            level_of: LevelOf::Triangles,
            judged_by: identity.judged_by,
            judged_leaves: identity.judged_leaves,
            is_driven_by_judging_views: false,
            leaves_original: 0,
            leaves_final: 0,
            triangles_final: 0,
            whole: None,
            seen_from: None,
            walk: None,
            seconds: 0.0,
            peak_rss_bytes: None,
            resolution: 0,
            kept_overlap: None,
            overlap_with: String::new(),
            max_area_scale: None,
            values: Values::new(),
            worst: Values::new(),
            rigs: Vec::new(),
            per_view: Vec::new(),
            original: Values::new(),
            original_without_mips: Values::new(),
            engine: "cpu".to_owned(),
            adapter: None,
            version: identity.version.clone(),
            commit: provenance.commit,
            machine: provenance.machine,
            command: String::new(),
            picture: String::new(),
            difference: String::new(),
        }
    }

    /// Whether it is of leaves, and so has a place in tables of methods and levels.
    pub(crate) fn is_of_leaves(&self) -> bool {
        self.whole.is_none() && self.seen_from.is_none() && self.walk.is_none()
    }

    /// Which tree the row is of, and which program made it.
    pub fn identity(&self) -> Identity {
        Identity {
            tree: self.tree.clone(),
            tree_sha256: self.tree_sha256.clone(),
            version: self.version.clone(),
            judged_by: self.judged_by,
            judged_leaves: self.judged_leaves,
        }
    }

    /// What tells this row's run from all others.
    pub fn key(&self) -> RowKey {
        RowKey {
            identity: self.identity(),
            method: self.method.clone(),
            setting: self.setting.clone(),
            change: self.change.clone(),
            seed: self.seed,
            level_millionths: millionths(self.level),
        }
    }

    /// Setting and change as reports show them.
    pub fn variant(&self) -> String {
        let parts = [self.setting.as_str(), self.change.as_str()];
        let parts = parts.into_iter().filter(|part| !part.is_empty());
        parts.collect::<Vec<_>>().join(", ")
    }

    /// Method, setting and change as reports show them.
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
        let is_no_row = |e: serde_json::Error| (number, e.to_string());
        let mut value: serde_json::Value = serde_json::from_str(line).map_err(is_no_row)?;
        older_rows::complete(&mut value);
        let row: Row = serde_json::from_value(value).map_err(is_no_row)?;
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

/// The rows that are drawn: of each name those of the same tree and program as its last row.
/// Others stay in the file.
pub fn current_rows(rows: Vec<Row>) -> Vec<Row> {
    let last: BTreeMap<String, Identity> = (rows.iter())
        .map(|row| (row.tree.clone(), row.identity()))
        .collect();
    let mut rows = rows;
    rows.retain(|row| last.get(&row.tree) == Some(&row.identity()));
    rows
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use crate::COLUMNS;

    pub(crate) fn row(method: &str, level: f64, seconds: f64, error: f64) -> Row {
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
            schema_version: Row::SCHEMA_VERSION,
            tree: "oak".into(),
            tree_sha256: None,
            method: method.into(),
            setting: String::new(),
            change: String::new(),
            seed: 0,
            level,
            level_of: LevelOf::Leaves,
            judged_by: JudgingViews::HeldOut,
            judged_leaves: JudgedLeaves::AsInFile,
            is_driven_by_judging_views: false,
            leaves_original: 100,
            leaves_final: (100.0 * level) as u64,
            triangles_final: 7,
            whole: None,
            seen_from: None,
            walk: None,
            seconds,
            peak_rss_bytes: Some(50 << 20),
            resolution: 256,
            kept_overlap: None,
            overlap_with: String::new(),
            max_area_scale: None,
            worst: values.clone(),
            rigs: vec![values.clone()],
            per_view: Vec::new(),
            original: Values::new(),
            original_without_mips: Values::new(),
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
    fn infinite_values_come_back_as_nothing() {
        let mut row = row("a", 0.5, 1.0, 2.0);
        row.values.insert("vmi_error_percent".into(), None);
        assert_eq!(read_rows(&to_line(&row)).unwrap(), [row]);
    }

    /// What was judged before by other views stays in the file, and is not drawn beside what is
    /// judged now.
    #[test]
    fn rows_of_two_judges_do_not_stand_beside_each_other() {
        let now = row("vds", 0.5, 1.0, 1.0);
        let mut old: serde_json::Value = serde_json::from_str(&to_line(&now)).unwrap();
        let columns = old.as_object_mut().unwrap();
        for new in ["judged_by", "rigs"] {
            columns.remove(new).unwrap();
        }
        columns.insert("per_view".into(), serde_json::json!([{"ssim": 0.5}]));
        let text = format!("{old}\n{}", to_line(&now));
        let rows = read_rows(&text).unwrap();
        assert_eq!(rows[0].judged_by, JudgingViews::Icosahedron);
        assert_eq!((rows[0].rigs.len(), rows[0].per_view.len()), (0, 1));
        assert_eq!(rows[1], now);
        assert_eq!(current_rows(rows), [now]);
    }

    /// Two trees of one name, and two programs: the last row decides, whatever the others are.
    #[test]
    fn rows_of_one_tree_and_program_are_drawn() {
        let of = |tree: &str, sha256: &str, version: &str, method: &str| Row {
            tree: tree.into(),
            tree_sha256: Some(sha256.into()),
            version: version.into(),
            ..row(method, 0.5, 1.0, 1.0)
        };
        let mut rows = vec![
            row("without a hash", 0.5, 1.0, 1.0),
            of("oak", "a", "1", "vds"),
            of("elm", "c", "1", "vds"),
            of("oak", "b", "1", "vds"),
            of("oak", "b", "1", "fsa"),
        ];
        let text: String = rows.iter().map(to_line).collect();
        assert_eq!(read_rows(&text).unwrap(), rows, "each has a key of its own");
        assert_eq!(current_rows(rows.clone()), rows[2..]);
        rows.push(of("oak", "b", "2", "fsa"));
        assert_eq!(
            current_rows(rows.clone()),
            [rows[2].clone(), rows[5].clone()]
        );
        assert_eq!(current_rows(vec![]), []);
    }
}
