//! Short names of methods with their settings, for pages that are read quickly.

use std::collections::BTreeMap;

use crate::Row;
use crate::table::Table;

/// The longest setting that is a name by itself, in characters.
const LONGEST: usize = 20;

/// Method, setting as rows spell it, its short name, and what that means.
const KNOWN: [[&str; 4]; 21] = [
    [
        "vds",
        "",
        "",
        "the default: made to look like the original, sizes of leaves fitted last",
    ],
    [
        "vds",
        "fit=none",
        "unfitted",
        "the same without fitting sizes",
    ],
    [
        "vds",
        "preset information",
        "information",
        "made to lose the least VMI",
    ],
    [
        "vds",
        "preset information resize none",
        "no growth",
        "leaves that stay keep their size",
    ],
    [
        "vds",
        "preset information reference previous resize deficit neighbours 4",
        "shared growth",
        "what a leaf has lost goes to its four neighbours",
    ],
    [
        "vds",
        "preset information reference previous resize deficit neighbours 4 max-coverage 1",
        "coverage kept",
        "the same, and the crown may not cover more than it did",
    ],
    [
        "vds",
        "triangles",
        "triangles",
        "the default by a budget of triangles: leaves become coarser before they go",
    ],
    [
        "vds",
        "triangles fit=none",
        "triangles unfitted",
        "the same without fitting sizes",
    ],
    [
        "vds",
        "triangles preset information",
        "triangles information",
        "the least VMI lost by a budget of triangles",
    ],
    [
        "vds",
        "triangles preset information fit=none",
        "triangles inf. unfitted",
        "the same without fitting sizes",
    ],
    [
        "fsa",
        "",
        "spread",
        "leaf collapse with corners that make no slivers",
    ],
    [
        "fsa",
        "corners furthest",
        "published",
        "leaf collapse as its authors describe it",
    ],
    [
        "fsa",
        "corners furthest hausdorff surface",
        "surfaces",
        "the same by the distances of whole surfaces",
    ],
    [
        "stochastic",
        "",
        "",
        "leaves drawn by lot; the others grow to cover as much",
    ],
    [
        "stochastic",
        "area-weight 0.5",
        "half area",
        "the same, growing half as much",
    ],
    [
        "stochastic",
        "fit=coverage",
        "fitted",
        "sizes fitted as the default of vds has it",
    ],
    [
        "fsa",
        "corners furthest fit=coverage",
        "published, fitted",
        "sizes fitted as the default of vds has it",
    ],
    [
        "meshopt",
        "preserve-area",
        "preserve-area",
        "meshoptimizer's simplifier, borders moved outwards to give back area",
    ],
    [
        "meshopt",
        "preserve-area fit=coverage",
        "preserve-area, fitted",
        "the same, sizes fitted as the default of vds has it",
    ],
    [
        "meshopt",
        "dilate-borders",
        "dilate-borders",
        "meshoptimizer's simplifier, borders moved outwards after each halving as its example does",
    ],
    [
        "meshopt",
        "dilate-borders fit=coverage",
        "dilate-borders, fitted",
        "the same, sizes fitted as the default of vds has it",
    ],
];

/// Rows whose settings have short names, and what stands for which.
pub(crate) struct ShortNames {
    /// By method and setting.
    names: BTreeMap<(String, String), String>,
    list: Table,
}

impl ShortNames {
    /// Of all methods and settings that rows have.
    pub(crate) fn of(rows: &[Row]) -> Self {
        let mut names: BTreeMap<(String, String), String> = BTreeMap::new();
        let mut list = Table::new(&["short name", "method and setting", "what it is"]);
        let mut unknown: BTreeMap<String, u8> = BTreeMap::new();
        for row in rows {
            let key = (row.method.clone(), row.setting.clone());
            if names.contains_key(&key) {
                continue;
            }
            let known = KNOWN.iter().find(|k| k[..2] == [&row.method, &row.setting]);
            let name = match known {
                Some([_, _, name, _]) => (*name).to_owned(),
                None if row.setting.len() <= LONGEST => row.setting.clone(),
                None => {
                    let count = unknown.entry(row.method.clone()).or_default();
                    *count += 1;
                    format!("setting {count}")
                }
            };
            let joined = |setting: &str| format!("{} {setting}", row.method).trim_end().to_owned();
            let meaning = known.map_or("", |known| known[3]);
            if name != row.setting || !meaning.is_empty() {
                list.push(vec![
                    joined(&name),
                    joined(&row.setting),
                    meaning.to_owned(),
                ]);
            }
            names.insert(key, name);
        }
        Self { names, list }
    }

    /// Rows with short names in place of their settings.
    pub(crate) fn shorten(&self, rows: &mut [Row]) {
        for row in rows {
            let key = (row.method.clone(), row.setting.clone());
            if let Some(name) = self.names.get(&key) {
                row.setting.clone_from(name);
            }
        }
    }

    /// What stands for which, a line for each name that does not say so itself.
    pub(crate) fn list(&self) -> &Table {
        &self.list
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::named_cases::{fsa_of_surfaces, look, shared_deficit};
    use crate::plan::cases;
    use crate::rows::tests::row;
    use crate::{Case, Plan};

    fn of(case: &Case) -> Row {
        Row {
            setting: case.setting(),
            ..row(case.method(), 0.5, 1.0, 1.0)
        }
    }

    #[test]
    fn names_are_short_and_tell_all_cases_of_a_plan_apart() {
        let rows: Vec<Row> = cases(&[Plan::Methods], true).iter().map(of).collect();
        let names = ShortNames::of(&rows);
        let mut short = rows.clone();
        names.shorten(&mut short);
        let mut labels: Vec<String> = short.iter().map(Row::label).collect();
        for label in &labels {
            assert!(label.len() <= 30, "{label}");
        }
        labels.sort();
        labels.dedup();
        assert_eq!(labels.len(), rows.len());
        let listed = &names.list().body;
        assert!(listed.iter().any(|line| line[0] == "fsa surfaces"));
    }

    /// A setting that is spelled otherwise would lose its name without a word.
    #[test]
    fn settings_that_are_known_are_spelled_as_in_rows() {
        let known = |case: &Case| {
            let own = [case.method().to_owned(), case.setting()];
            KNOWN.iter().any(|known| known[..2] == own)
        };
        let all = [
            look(),
            look().unfitted(),
            look().of_triangles(),
            shared_deficit(),
            fsa_of_surfaces(),
        ];
        assert!(all.iter().all(known));
    }

    #[test]
    fn what_nobody_named_is_numbered() {
        let long = |setting: &str| Row {
            setting: setting.into(),
            ..row("vds", 0.5, 1.0, 1.0)
        };
        let mut rows = vec![
            long("views 12"),
            long("views 92 resolution 1024 max-coverage 1"),
            long("views 92 resolution 2048 max-coverage 1"),
        ];
        let names = ShortNames::of(&rows);
        names.shorten(&mut rows);
        let labels: Vec<String> = rows.iter().map(Row::label).collect();
        assert_eq!(labels, ["vds views 12", "vds setting 1", "vds setting 2"]);
        assert_eq!(names.list().body.len(), 2);
    }
}
