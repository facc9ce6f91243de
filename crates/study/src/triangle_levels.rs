//! Which methods have levels that are shares of the triangles.

use super::{LevelOf, Row};

/// A sentence that names the methods whose levels are shares of triangles, and those that left
/// more leaves than the level's share, as mesh simplifiers do; none if there are none.
pub(crate) fn note_of(rows: &[Row]) -> Option<String> {
    let mut labels: Vec<String> = Vec::new();
    // Whole plants have tables of their own, and so has what is drawn at distances.
    let rows = rows.iter().filter(|row| row.is_of_leaves());
    for row in rows.filter(|row| is_of_triangles(row)) {
        let label = Row {
            change: String::new(),
            ..row.clone()
        }
        .label();
        if !labels.contains(&label) {
            labels.push(label);
        }
    }
    (!labels.is_empty()).then(|| {
        format!(
            "Levels are shares of the leaves, but of the triangles for {}, which may have more leaves left.",
            labels.join("; ")
        )
    })
}

/// Whether a row's level is a share of the triangles, or it has more leaves than its share.
pub(crate) fn is_of_triangles(row: &Row) -> bool {
    let share = (row.level * row.leaves_original as f64).round();
    row.level_of == LevelOf::Triangles || row.leaves_final as f64 > share
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rows::tests::row;

    #[test]
    fn methods_that_count_triangles_are_named() {
        let with = |method: &str, leaves_final, change: &str| Row {
            leaves_original: 99,
            leaves_final,
            change: change.into(),
            ..row(method, 0.5, 1.0, 1.0)
        };
        // Half of 99 leaves are 50.
        let mut rows = vec![with("vds", 50, ""), with("chain", 41, "")];
        assert_eq!(note_of(&rows), None);
        rows.extend(["", "turned"].map(|change| with("meshopt", 51, change)));
        let note = note_of(&rows).unwrap();
        assert!(note.contains("triangles for meshopt, which"), "{note}");
        rows.push(Row {
            setting: "triangles".into(),
            level_of: LevelOf::Triangles,
            ..with("vds", 50, "")
        });
        let note = note_of(&rows).unwrap();
        assert!(note.contains("for meshopt; vds triangles, which"), "{note}");
    }
}
