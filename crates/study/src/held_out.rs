//! Which views judged, and which methods were judged by views that drove them.

use secateur_eval::JudgingViews;

use super::{JudgedLeaves, Row};

/// Who judged the rows, in sentences.
pub(crate) fn who_judged(rows: &[Row]) -> String {
    if !rows.is_empty() && rows.iter().all(|row| row.walk.is_some()) {
        return "Frames of the walk are judged each by itself, against full geometry.".to_owned();
    }
    let by = |views| rows.iter().any(|row| row.judged_by == views);
    let held_out = "Judged by four sets of 12 held-out views (icosahedra, 3 radii away, 60 degrees, 512 x 512), none nearer than 10 degrees to a view of the sets that drive by default, each with a VMI of its own: values are means over the four, and beside them stands the worst.";
    let icosahedron = "one icosahedron of 12 views, the paper's, each 10.8 degrees from a driving view where a direction at random is 18: that flatters methods that are driven by views.";
    let solid = rows
        .iter()
        .any(|row| row.judged_leaves == JudgedLeaves::Solid);
    let leaves = match solid {
        true => " Leaves are counted as whole polygons, seen from both sides, as they drive.",
        false => "",
    };
    let views = match (by(JudgingViews::HeldOut), by(JudgingViews::Icosahedron)) {
        (true, false) => held_out.to_owned(),
        (true, true) => {
            let mut trees: Vec<&str> = Vec::new();
            for row in rows
                .iter()
                .filter(|r| r.judged_by == JudgingViews::Icosahedron)
            {
                if !trees.contains(&row.tree.as_str()) {
                    trees.push(&row.tree);
                }
            }
            format!("{held_out} But {} by {icosahedron}", trees.join(", "))
        }
        _ => format!("Judged by {icosahedron}"),
    };
    format!("{views}{leaves}")
}

/// What stands beside the label of a method that the judging views drove.
pub(crate) const MARK: &str = " (judged by its own views)";

/// A label as readers see it.
pub(crate) fn shown(label: &str, is_driven_by_judging_views: bool) -> String {
    match is_driven_by_judging_views {
        true => format!("{label}{MARK}"),
        false => label.to_owned(),
    }
}

/// A sentence that names the methods that were driven by judging views; none if all judging views
/// are held out.
pub(crate) fn note_of(rows: &[Row]) -> Option<String> {
    let mut labels: Vec<String> = Vec::new();
    for row in rows.iter().filter(|row| row.is_driven_by_judging_views) {
        if !labels.contains(&row.label()) {
            labels.push(row.label());
        }
    }
    (!labels.is_empty()).then(|| {
        format!(
            "Judged by views that also drove it: {}. What is said of it is not of unseen views, and flatters it.",
            labels.join(", ")
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rows::tests::row;

    #[test]
    fn who_judged_is_said_of_each_tree() {
        let of = |tree: &str, judged_by| Row {
            tree: tree.into(),
            judged_by,
            ..row("vds", 0.5, 1.0, 1.0)
        };
        let both = [
            of("oak", JudgingViews::HeldOut),
            of("pine", JudgingViews::Icosahedron),
        ];
        let said = who_judged(&both);
        assert!(
            said.contains("four sets") && said.contains("But pine by one icosahedron"),
            "{said}"
        );
        assert!(!who_judged(&both[..1]).contains("But "));
        assert!(who_judged(&both[1..]).starts_with("Judged by one icosahedron"));
    }

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
        let named = "drove it: vds views 12 resolution 64, vds views 12.";
        assert!(note.contains(named), "{note}");
    }
}
