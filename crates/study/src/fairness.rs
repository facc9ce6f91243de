//! Methods with what the default does beside choosing leaves: how much of its lead are sizes, cutoffs and colours
//! that any method could have.

use std::collections::BTreeSet;

use secateur_levels::CutoffChoice;
use secateur_simplify::meshopt::Borders;

use crate::columns::{DRAWN_WIDTHS_PX, column};
use crate::named_cases::{clusterlod, fsa, look, meshopt, stochastic};
use crate::rows::millionths;
use crate::table::Table;
use crate::{Case, Column, Row};

pub(crate) const TITLE: &str = "Rivals with what the default has";

/// What stands above the table.
pub(crate) const WHAT_IS_COMPARED: &str = "FLIP of pictures as a client draws them, 512 and 128 pixels wide, means over trees and levels. Each method is judged as it is, with sizes fitted as the default fits them, with alpha cutoffs and colours of clear texels chosen as for the default, and with both. The default has both.";

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
    own.map(|row| place(row)).collect()
}

fn place(row: &Row) -> Place<'_> {
    (&row.tree, millionths(row.level))
}

/// A line for each method, means over trees and levels on which all cases ran; nothing if there are none.
pub(crate) fn table(rows: &[Row]) -> Option<Table> {
    let judged = DRAWN_WIDTHS_PX.map(|px| column(&format!("flip_as_drawn_{px}")));
    let is_judged =
        |row: &&Row| row.is_of_leaves() && judged.iter().all(|by| by.value_of(row).is_finite());
    let rows: Vec<&Row> = rows.iter().filter(is_judged).collect();
    let compared = Compared::all();
    let cases = compared.iter().flat_map(|compared| &compared.variants);
    let common = cases.map(|case| places(&rows, case));
    let common = common.reduce(|a, b| a.intersection(&b).copied().collect())?;
    if common.is_empty() {
        return None;
    }
    let mut table = Table::new(&[
        "method",
        "as it is",
        "sizes fitted",
        "cutoffs and colours",
        "both",
    ]);
    for method in compared {
        let mean = |case: &Case| {
            let is_own = |row: &&&Row| row.label() == case.label() && common.contains(&place(row));
            let own: Vec<&&Row> = rows.iter().filter(is_own).collect();
            let mean = |by: &&Column| {
                own.iter().map(|row| by.value_of(row)).sum::<f64>() / own.len() as f64
            };
            let [near, far] = judged.each_ref().map(mean);
            format!("{near:.4}, {far:.4}")
        };
        let mut cells = vec![method.label];
        cells.extend(method.variants.each_ref().map(mean));
        table.push(cells);
    }
    Some(table)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rows::tests::row;

    fn of(case: &Case, tree: &str, value: f64) -> Row {
        let mut row = row(case.method(), 0.25, 1.0, 3.0);
        row.setting = case.setting();
        row.tree = tree.to_owned();
        for (key, more) in [("flip_as_drawn_512", 0.0), ("flip_as_drawn_128", 1.0)] {
            row.values.insert(key.to_owned(), Some(value + more));
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
        let cases = cases();
        let has_changes = cases.iter().map(|case| case.material_change().is_some());
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
        let expected = [
            "vds triangles",
            "0.0000, 1.0000",
            "0.0100, 1.0100",
            "0.0200, 1.0200",
            "0.0300, 1.0300",
        ];
        assert_eq!(table.body[0], expected);
        assert_eq!(table.body.len(), 5);
        assert_eq!(table.body[4][4], "0.1900, 1.1900");
        rows.remove(0);
        assert_eq!(super::table(&rows), None);
    }
}
