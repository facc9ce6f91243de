//! Which methods have means that can be compared: those that ran on every tree.

use std::collections::{BTreeMap, BTreeSet};

use super::Row;

/// Takes out the rows of incomplete cases: methods and settings that did not run on every tree at
/// a level, so that their means would be over other trees than the means of the rest. Returns
/// their labels.
pub(crate) fn take_out_partial(rows: &mut Vec<Row>) -> BTreeSet<String> {
    let trees: BTreeSet<String> = rows.iter().map(|row| row.tree.clone()).collect();
    let key = |row: &Row| (row.label(), row.level.to_bits());
    let mut trees_of: BTreeMap<(String, u64), BTreeSet<String>> = BTreeMap::new();
    for row in rows.iter() {
        let of_key = trees_of.entry(key(row)).or_default();
        of_key.insert(row.tree.clone());
    }
    trees_of.retain(|_, of_key| of_key.len() < trees.len());
    rows.retain(|row| !trees_of.contains_key(&key(row)));
    trees_of.into_keys().map(|(label, _)| label).collect()
}

/// A sentence that names the methods that were taken out; none if there are none.
pub(crate) fn note_of(partial: &BTreeSet<String>) -> Option<String> {
    let labels: Vec<&str> = partial.iter().map(String::as_str).collect();
    (!labels.is_empty()).then(|| {
        format!(
            "Not among the means, at some level at least, because not run on every tree: {}.",
            labels.join("; ")
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rows::tests::row;

    #[test]
    fn only_what_ran_on_every_tree_stays() {
        let mut rows = Vec::new();
        for (tree, method, level) in [
            ("oak", "vds", 0.5),
            ("oak", "fsa", 0.5),
            ("oak", "fsa", 0.1),
            ("pine", "vds", 0.5),
            ("pine", "fsa", 0.1),
        ] {
            let row = row(method, level, 1.0, 1.0);
            rows.push(Row {
                tree: tree.into(),
                ..row
            });
        }
        let partial = take_out_partial(&mut rows);
        assert_eq!(partial, BTreeSet::from(["fsa".to_owned()]));
        let left: Vec<_> = rows.iter().map(|r| (r.method.as_str(), r.level)).collect();
        let expected = [("vds", 0.5), ("fsa", 0.1), ("vds", 0.5), ("fsa", 0.1)];
        assert_eq!(left, expected);
        assert_eq!(
            note_of(&partial).unwrap(),
            "Not among the means, at some level at least, because not run on every tree: fsa."
        );
        assert_eq!(note_of(&BTreeSet::new()), None);
    }
}
