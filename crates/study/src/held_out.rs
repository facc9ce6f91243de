//! Which methods were judged by the views that drove them.

use super::Row;

/// A sentence that names the methods that were driven by the judging views, the
/// 12 vertices of an icosahedron; none if all judging views are held out.
pub(crate) fn note_of(rows: &[Row]) -> Option<String> {
    let mut labels: Vec<String> = Vec::new();
    for row in rows.iter().filter(|row| row.is_driven_by_judging_views) {
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rows::tests::row;

    #[test]
    fn only_methods_driven_by_judges_are_named() {
        let with = |setting: &str, is_driven_by_judging_views| Row {
            setting: setting.into(),
            is_driven_by_judging_views,
            ..row("vds", 0.5, 1.0, 1.0)
        };
        let mut rows = vec![with("", false), with("views 92", false)];
        assert_eq!(note_of(&rows), None);
        rows.push(with("views 12 resolution 64", true));
        rows.extend([with("views 12", true), with("views 12", true)]);
        let note = note_of(&rows).unwrap();
        let named = "drove vds views 12 resolution 64, vds views 12:";
        assert!(note.contains(named), "{note}");
    }
}
