//! Alpha cutoffs of a result, and what is said of them.

use secateur_scene::ChosenCutoffs;
use serde_json::{Value, json};

/// What the record says of them; nothing where all stay.
pub(crate) fn record(chosen: Option<&ChosenCutoffs>) -> Value {
    let of_width = |(width_px, [before, after]): &(u32, [f64; 2])| {
        json!({
            "width_px": width_px,
            "coverage_over_truth_before": before,
            "coverage_over_truth": after,
        })
    };
    json!(chosen.map(|chosen| json!({
        "times": chosen.times,
        "of_materials": chosen.cutoffs.of_materials().collect::<Vec<_>>(),
        "raised": chosen.raised_share.map(|share| json!({
            "share_of_cutoff": share,
            "materials": chosen.raised.iter().map(|one| one.material).collect::<Vec<_>>(),
        })),
        "without_mips": chosen.cutoffs.materials_without_mips().collect::<Vec<_>>(),
        "as_drawn": chosen.coverage.iter().map(of_width).collect::<Vec<_>>(),
    })))
}

/// A line of the summary.
pub(crate) fn in_words(chosen: &ChosenCutoffs) -> String {
    let of = |(width_px, [before, after]): &(u32, [f64; 2])| {
        format!("{before:.2} -> {after:.2} at {width_px} px")
    };
    let coverage: Vec<String> = chosen.coverage.iter().map(of).collect();
    let mips = match chosen.cutoffs.materials_without_mips().next() {
        Some(_) => ", without mip maps",
        None => "",
    };
    let raised = chosen.raised_share.map_or(String::new(), |share| {
        format!(", clear texels away from leaves with an alpha of {share:.1} of the cutoff")
    });
    let what = format!("times {:.2}{mips}{raised}", chosen.times);
    format!(
        "{what}; pixels that clients show over what there is: {}",
        coverage.join(", ")
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use secateur_gltf::Cutoffs;

    #[test]
    fn raised_texels_are_told() {
        let mut chosen = ChosenCutoffs {
            cutoffs: Cutoffs::default(),
            times: 1.0,
            raised: Vec::new(),
            raised_share: Some(0.6),
            coverage: vec![(512, [0.9, 1.0])],
        };
        let told = record(Some(&chosen));
        assert_eq!(
            told["raised"],
            json!({"share_of_cutoff": 0.6, "materials": []})
        );
        assert_eq!(
            in_words(&chosen),
            "times 1.00, clear texels away from leaves with an alpha of 0.6 of the cutoff; pixels that clients show over what there is: 0.90 -> 1.00 at 512 px"
        );
        chosen.raised_share = None;
        assert_eq!(record(Some(&chosen))["raised"], Value::Null);
        assert!(!in_words(&chosen).contains("texels"));
    }
}
