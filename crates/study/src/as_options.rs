//! Labels of rows as one types them: `vds triangles preset look` is `vds --triangles --preset look`.

/// The first words of options in settings; all others are values.
const OPTIONS: [&str; 24] = [
    "alpha",
    "area-weight",
    "branch-metric",
    "cluster-size",
    "corners",
    "cutoffs",
    "dilate-borders",
    "field-of-view",
    "fit",
    "hausdorff",
    "leaf-triangles",
    "max-coverage",
    "meshopt-mode",
    "needles",
    "neighbours",
    "preserve-area",
    "preset",
    "reference",
    "resize",
    "resolution",
    "sides",
    "ties",
    "triangles",
    "views",
];

/// A label of [`Row`](crate::Row) with dashes before its options.
pub(crate) fn as_options(label: &str) -> String {
    let words = label.split(' ').enumerate().map(|(place, word)| {
        let name = word.split('=').next().unwrap_or(word);
        // `fit` alone is a value, of cutoffs: sizes are fitted by `fit=coverage`.
        match place > 0 && word != "fit" && OPTIONS.contains(&name) {
            true => format!("--{word}"),
            false => word.to_owned(),
        }
    });
    words.collect::<Vec<_>>().join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Plan;
    use crate::plan::cases;

    #[test]
    fn options_get_dashes_and_values_none() {
        let label = "vds triangles preset information fit=none";
        assert_eq!(
            as_options(label),
            "vds --triangles --preset information --fit=none"
        );
        assert_eq!(as_options("fsa"), "fsa");
    }

    /// An option that the list lacks would stand there as a value.
    #[test]
    fn the_options_of_all_plans_are_known() {
        let plans = [Plan::Methods, Plan::Speed, Plan::Paper, Plan::Fairness];
        for case in cases(&plans, true) {
            let setting = case.setting();
            let command = case.command(std::path::Path::new("a.glb"), 0.5, None);
            let shown = as_options(&case.label());
            for option in shown.split(' ').filter(|word| word.starts_with("--")) {
                assert!(command.contains(option), "{option} of {setting}");
            }
            let typed = command.split("--method ").nth(1).unwrap();
            let typed = typed.split(" --").count() - 1;
            let triangles = usize::from(setting.starts_with("triangles"));
            let shown = shown.split(" --").count() - 1;
            assert_eq!(shown, typed + triangles, "{setting}");
        }
    }
}
