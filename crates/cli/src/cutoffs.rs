//! Alpha cutoffs of a result, and what is said of them.

use schemars::JsonSchema;
use secateur_levels::ChosenCutoffs;
use serde::Serialize;

/// Alpha cutoffs that were chosen, and what they do.
#[derive(Serialize, JsonSchema)]
pub(crate) struct CutoffsRecord {
    /// By what all cutoffs were multiplied.
    times: f64,
    /// Numbers of materials with their cutoffs.
    of_materials: Vec<(usize, f64)>,
    raised: Option<RaisedRecord>,
    /// Numbers of materials whose textures are read without mip maps.
    without_mips: Vec<usize>,
    as_drawn: Vec<ShownRecord>,
}

/// Clear texels with more alpha than they had.
#[derive(Serialize, JsonSchema)]
struct RaisedRecord {
    /// Their alpha over the cutoff.
    share_of_cutoff: f64,
    /// Numbers of the materials in whose textures clear texels got an alpha.
    materials: Vec<usize>,
}

/// Pixels that a client shows over those truly covered, in pictures of one width.
#[derive(Serialize, JsonSchema)]
struct ShownRecord {
    width_px: u32,
    coverage_over_truth_before: f64,
    coverage_over_truth: f64,
}

impl From<&ChosenCutoffs> for CutoffsRecord {
    fn from(chosen: &ChosenCutoffs) -> Self {
        let shown = |(width_px, [before, after]): &(u32, [f64; 2])| ShownRecord {
            width_px: *width_px,
            coverage_over_truth_before: *before,
            coverage_over_truth: *after,
        };
        Self {
            times: chosen.times,
            of_materials: chosen.cutoffs.of_materials().collect(),
            raised: chosen.raised_share.map(|share| RaisedRecord {
                share_of_cutoff: share,
                materials: chosen.raised.iter().map(|one| one.material).collect(),
            }),
            without_mips: chosen.cutoffs.materials_without_mips().collect(),
            as_drawn: chosen.coverage.iter().map(shown).collect(),
        }
    }
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
    use serde_json::{Value, json};

    #[test]
    fn raised_texels_are_told() {
        let mut chosen = ChosenCutoffs {
            cutoffs: Cutoffs::default(),
            times: 1.0,
            raised: Vec::new(),
            raised_share: Some(0.6),
            coverage: vec![(512, [0.9, 1.0])],
        };
        let record = |chosen: &ChosenCutoffs| json!(CutoffsRecord::from(chosen));
        let told = record(&chosen);
        assert_eq!(
            told["raised"],
            json!({"share_of_cutoff": 0.6, "materials": []})
        );
        assert_eq!(
            in_words(&chosen),
            "times 1.00, clear texels away from leaves with an alpha of 0.6 of the cutoff; pixels that clients show over what there is: 0.90 -> 1.00 at 512 px"
        );
        chosen.raised_share = None;
        assert_eq!(record(&chosen)["raised"], Value::Null);
        assert!(!in_words(&chosen).contains("texels"));
    }
}
