//! What is said of materials that a level changes.

use secateur::{ColorRecord, CutoffsRecord};

/// What was done to alpha cutoffs.
pub(crate) fn cutoffs(chosen: &CutoffsRecord) -> String {
    let coverage = chosen.as_drawn.iter().map(|shown| {
        let [before, after] = [shown.coverage_over_truth_before, shown.coverage_over_truth];
        format!("{before:.2} -> {after:.2} at {} px", shown.width_px)
    });
    let coverage: Vec<String> = coverage.collect();
    let mips = match chosen.without_mips[..] {
        [] => "",
        [..] => ", without mip maps",
    };
    let raised = chosen.raised.as_ref().map_or(String::new(), |raised| {
        let share = raised.share_of_cutoff;
        format!(", clear texels away from leaves with an alpha of {share:.1} of the cutoff")
    });
    format!(
        "times {:.2}{mips}{raised}; pixels that clients show over what there is: {}",
        chosen.times,
        coverage.join(", ")
    )
}

/// What was done to colours of clear texels, and of those beside charts.
pub(crate) fn colors(chosen: &[ColorRecord]) -> String {
    let most = chosen.iter().map(|one| one.difference).fold(0.0, f64::max);
    let textures = match chosen.len() {
        1 => "the texture of a material has".to_owned(),
        count => format!("the textures of {count} materials have"),
    };
    format!(
        "{textures} the colours of what is near where nothing of the plant is; others were seen there, or mixed in by mip maps, and off by {most:.0} of 255"
    )
}
