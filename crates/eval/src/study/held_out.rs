//! Which methods were judged by the views that drove them.

use super::Row;

/// A sentence that names the methods that were driven by the judging views, the
/// 12 vertices of an icosahedron; none if all judging views are held out.
pub(super) fn note_of(rows: &[Row]) -> Option<String> {
    let mut labels: Vec<String> = Vec::new();
    for row in rows.iter().filter(|row| is_driven_by_its_judges(row)) {
        if !labels.contains(&row.label()) {
            labels.push(row.label());
        }
    }
    (!labels.is_empty()).then(|| {
        format!(
            "The judging views also drove {}: what is said of it is not of unseen views, and flatters it.",
            labels.join(", ")
        )
    })
}

/// By its setting, as it is written on the command line without dashes.
pub(super) fn is_driven_by_its_judges(row: &Row) -> bool {
    let words: Vec<&str> = row.setting.split_whitespace().collect();
    let views = words.windows(2).find(|pair| pair[0] == "views");
    views.is_some_and(|pair| ["12", "icosahedron"].contains(&pair[1]))
}

#[cfg(test)]
mod tests {
    use super::super::rows::tests::row;
    use super::*;

    #[test]
    fn only_methods_driven_by_judges_are_named() {
        let with = |setting: &str| Row {
            setting: setting.into(),
            ..row("vds", 0.5, 1.0, 1.0)
        };
        let mut rows = vec![with(""), with("views 92"), with("resolution 12")];
        assert_eq!(note_of(&rows), None);
        rows.extend([with("resolution 64 views 12"), with("views icosahedron")]);
        rows.push(with("views 12"));
        rows.push(with("views 12"));
        let note = note_of(&rows).unwrap();
        let named = "drove vds resolution 64 views 12, vds views icosahedron, vds views 12:";
        assert!(note.contains(named), "{note}");
    }
}
