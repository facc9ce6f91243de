//! Methods with what the default does beside choosing leaves: how much of its lead are sizes, cutoffs and colours
//! that any method could have.

use std::collections::BTreeSet;

use secateur_levels::CutoffChoice;
use secateur_simplify::meshopt::Borders;

use crate::columns::{DRAWN_WIDTHS_PX, column};
use crate::named_cases::{clusterlod, fsa, look, meshopt, stochastic};
use crate::rows::millionths;
use crate::table::Table;
use crate::{Case, Row};

pub(crate) const TITLE: &str = "Rivals with what the default has";

/// What stands above the table.
pub(crate) const WHAT_IS_COMPARED: &str = "FLIP and IoU with the truth of pictures as a client draws them, means over trees and levels. Each method is judged as it is, with sizes fitted as the default fits them, with alpha cutoffs and colours of clear texels chosen as for the default, and with both. The default has both.";

/// A tree and a level in millionths.
type Place<'r> = (&'r str, u64);

/// A method as it is, with fitted sizes, with chosen cutoffs, and with both.
struct Compared {
    label: String,
    variants: [Case; 4],
}

impl Compared {
    fn rival(base: Case) -> Self {
        let fitted = base.clone().fitted();
        let with_cutoffs = |case: &Case| case.clone().with_cutoffs(CutoffChoice::Fit);
        Self {
            label: base.label(),
            variants: [
                base.clone(),
                fitted.clone(),
                with_cutoffs(&base),
                with_cutoffs(&fitted),
            ],
        }
    }

    /// The default has all, so here things are taken from it.
    fn default() -> Self {
        let [whole, unfitted] = [look().of_triangles(), look().of_triangles().unfitted()];
        let without = |case: &Case| case.clone().with_cutoffs(CutoffChoice::Keep);
        Self {
            label: whole.label(),
            variants: [without(&unfitted), without(&whole), unfitted, whole],
        }
    }

    fn all() -> Vec<Self> {
        let rivals = [
            meshopt(Borders::PreserveArea),
            clusterlod(),
            fsa(),
            stochastic(),
        ];
        let rivals = rivals.map(Self::rival);
        std::iter::once(Self::default()).chain(rivals).collect()
    }
}

/// The cases of the plan.
pub(crate) fn cases() -> Vec<Case> {
    let all = Compared::all().into_iter();
    all.flat_map(|compared| compared.variants).collect()
}

/// Where a case ran; of several seeds one is enough.
fn places<'r>(rows: &[&'r Row], case: &Case) -> BTreeSet<Place<'r>> {
    let own = rows.iter().filter(|row| row.label() == case.label());
    own.map(|row| (row.tree.as_str(), millionths(row.level)))
        .collect()
}

/// A line for each width and method, means over trees and levels on which all cases ran; nothing if there are none.
pub(crate) fn table(rows: &[Row]) -> Option<Table> {
    let judged = |px| ["flip", "truth_iou"].map(|what| column(&format!("{what}_as_drawn_{px}")));
    let is_judged = |row: &&Row| {
        let mut all = DRAWN_WIDTHS_PX.into_iter().flat_map(judged);
        row.is_of_leaves() && all.all(|by| by.value_of(row).is_finite())
    };
    let rows: Vec<&Row> = rows.iter().filter(is_judged).collect();
    let compared = Compared::all();
    let cases = compared.iter().flat_map(|compared| &compared.variants);
    let common = cases.map(|case| places(&rows, case));
    let common = common.reduce(|a, b| a.intersection(&b).copied().collect())?;
    let mut table = Table::new(&[
        "as drawn",
        "method",
        "as it is",
        "sizes fitted",
        "cutoffs and colours",
        "both",
    ]);
    for px in DRAWN_WIDTHS_PX {
        for method in compared.iter().filter(|_| !common.is_empty()) {
            let mean = |case: &Case| {
                let is_own = |row: &&&Row| {
                    row.label() == case.label()
                        && common.contains(&(row.tree.as_str(), millionths(row.level)))
                };
                let own: Vec<&&Row> = rows.iter().filter(is_own).collect();
                let [flip, iou] = judged(px).map(|by| {
                    own.iter().map(|row| by.value_of(row)).sum::<f64>() / own.len() as f64
                });
                format!("{flip:.4}, {iou:.3}")
            };
            let mut cells = vec![format!("{px} px"), method.label.clone()];
            cells.extend(method.variants.each_ref().map(mean));
            table.push(cells);
        }
    }
    (!table.body.is_empty()).then_some(table)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::DRAWN_COLUMNS;
    use crate::rows::tests::row;

    fn of(case: &Case, tree: &str, value: f64) -> Row {
        let mut row = row(case.method(), 0.25, 1.0, 3.0);
        row.setting = case.setting();
        row.tree = tree.to_owned();
        for (column, more) in DRAWN_COLUMNS.iter().zip(0..) {
            let value = value + f64::from(more);
            row.values.insert(column.key.to_owned(), Some(value));
        }
        row
    }

    /// What differs from the default's `vds triangles` is taken away from it, and given to rivals.
    #[test]
    fn every_method_has_all_four_variants() {
        let labels: Vec<String> = cases().iter().map(Case::label).collect();
        let expected = [
            "vds triangles fit=none cutoffs keep",
            "vds triangles cutoffs keep",
            "vds triangles fit=none",
            "vds triangles",
            "meshopt preserve-area",
            "meshopt preserve-area fit=coverage",
            "meshopt preserve-area cutoffs fit",
            "meshopt preserve-area fit=coverage cutoffs fit",
            "meshopt meshopt-mode clusters dilate-borders",
        ];
        assert_eq!(labels[..expected.len()], expected);
        let has_changes = cases().iter().map(|case| case.material_change().is_some());
        let has_changes: Vec<bool> = has_changes.collect();
        assert_eq!(has_changes, [false, false, true, true].repeat(5));
    }

    /// On the elm one case is missing, so that only the oak counts.
    #[test]
    fn means_are_of_places_where_all_ran() {
        let all = cases();
        let mut rows = Vec::new();
        for (case, value) in all.iter().zip(0..) {
            rows.push(of(case, "oak", 0.01 * f64::from(value)));
            rows.push(of(case, "elm", 9.0));
        }
        rows.pop();
        let table = table(&rows).unwrap();
        assert_eq!(table.body.len(), 10, "five methods at two widths");
        let first = [
            "0.0000, 1.000",
            "0.0100, 1.010",
            "0.0200, 1.020",
            "0.0300, 1.030",
        ];
        assert_eq!(table.body[0][..2], ["512 px", "vds triangles"]);
        assert_eq!(table.body[0][2..], first);
        assert_eq!(table.body[9][5], "8.1900, 9.190");
        rows.remove(0);
        assert_eq!(super::table(&rows), None);
    }
}
