//! Alpha cutoffs of a level, as records have them.

use secateur_levels::ChosenCutoffs;
use serde::Serialize;

/// Alpha cutoffs that were chosen, and what they do.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
pub struct CutoffsRecord {
    /// By what all cutoffs were multiplied.
    pub times: f64,
    /// Numbers of materials with their cutoffs.
    pub of_materials: Vec<(usize, f64)>,
    /// Clear texels with more alpha than they had, if there are any.
    pub raised: Option<RaisedRecord>,
    /// Numbers of materials whose textures are read without mip maps.
    pub without_mips: Vec<usize>,
    /// How much a client shows, in pictures of several widths.
    pub as_drawn: Vec<ShownRecord>,
}

/// Clear texels with more alpha than they had.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
pub struct RaisedRecord {
    /// Their alpha over the cutoff.
    pub share_of_cutoff: f64,
    /// Numbers of the materials in whose textures clear texels got an alpha.
    pub materials: Vec<usize>,
}

/// Pixels that a client shows over those truly covered, in pictures of one width.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
pub struct ShownRecord {
    /// Width and height of the pictures in pixels.
    pub width_px: u32,
    /// The share with the plant's cutoffs.
    pub coverage_over_truth_before: f64,
    /// The share with the chosen ones.
    pub coverage_over_truth: f64,
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

#[cfg(test)]
mod tests {
    use super::*;
    use secateur_gltf::Cutoffs;
    use serde_json::{Value, json};

    #[test]
    fn raised_texels_are_recorded() {
        let mut chosen = ChosenCutoffs {
            cutoffs: Cutoffs::default(),
            times: 1.0,
            raised: Vec::new(),
            raised_share: Some(0.6),
            coverage: vec![(512, [0.9, 1.0])],
        };
        let raised = |chosen: &ChosenCutoffs| json!(CutoffsRecord::from(chosen))["raised"].clone();
        let expected = json!({"share_of_cutoff": 0.6, "materials": []});
        assert_eq!(raised(&chosen), expected);
        chosen.raised_share = None;
        assert_eq!(raised(&chosen), Value::Null);
    }
}
