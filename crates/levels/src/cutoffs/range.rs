//! Which cutoffs leave leaf textures nearly as they are close by.

use secateur_gltf::DrawnSurface;
use secateur_model::{AlphaMode, Texture};

/// The cutoffs that are tried are between these.
const RANGE: [f32; 2] = [0.1, 0.9];

/// The share by which a texture itself may show more or less with another cutoff.
const NEAR_BY: f64 = 0.02;

/// By what the cutoffs of these surfaces may be multiplied, at least and at most: within [`RANGE`],
/// and so that near by no texture shows much more or less. None if there are no surfaces.
pub(super) fn range<'a>(drawn: impl Iterator<Item = &'a DrawnSurface>) -> Option<[f32; 2]> {
    let mut range: Option<[f32; 2]> = None;
    let mut seen: Vec<usize> = Vec::new();
    for drawn in drawn {
        let material = &drawn.surface.material;
        let (Some(texture), AlphaMode::Mask(cutoff)) = (&material.texture, material.alpha_mode)
        else {
            continue;
        };
        let Some(number) = drawn.material.filter(|number| !seen.contains(number)) else {
            continue;
        };
        seen.push(number);
        let own = range_of(texture, cutoff / material.base_color[3]);
        let [low, high] = range.unwrap_or([0.0, f32::INFINITY]);
        range = Some([low.max(own[0]), high.min(own[1])]);
    }
    range.filter(|[low, high]| low <= high)
}

/// The range of one texture whose alpha is held against this cutoff.
fn range_of(texture: &Texture, cutoff: f32) -> [f32; 2] {
    if !(cutoff > 0.0 && cutoff.is_finite()) {
        return [1.0; 2];
    }
    let mut texels = [0u64; 256];
    for texel in texture.rgba.chunks_exact(4) {
        texels[usize::from(texel[3])] += 1;
    }
    let shown = |cutoff: f32| -> u64 {
        let passes = |alpha: &usize| *alpha as f32 / 255.0 >= cutoff;
        (0..256).filter(passes).map(|alpha| texels[alpha]).sum()
    };
    let before = shown(cutoff) as f64;
    let is_the_same = |other: f32| (shown(other) as f64 - before).abs() <= NEAR_BY * before;
    let at = |step: usize| RANGE[0] + (RANGE[1] - RANGE[0]) * step as f32 / 80.0;
    let same: Vec<f32> = (0..=80)
        .map(at)
        .filter(|other| is_the_same(*other))
        .collect();
    let low = same.first().copied().unwrap_or(cutoff).min(cutoff);
    let high = same.last().copied().unwrap_or(cutoff).max(cutoff);
    [low / cutoff, high / cutoff]
}

#[cfg(test)]
mod tests {
    use super::*;
    use secateur_model::{Filters, Wrap};

    #[test]
    fn only_cutoffs_that_change_hardly_a_texel_are_tried() {
        let texture = |alphas: &[u8]| Texture {
            width: alphas.len() as u32,
            height: 1,
            rgba: alphas.iter().flat_map(|a| [0, 0, 0, *a]).collect(),
            wrap: [Wrap::Repeat; 2],
            filters: Filters::default(),
        };
        let times = |alphas: &[u8], cutoff| range_of(&texture(alphas), cutoff);
        let near =
            |a: [f32; 2], b: [f32; 2]| (a[0] - b[0]).abs() < 0.05 && (a[1] - b[1]).abs() < 0.05;
        // There or not: anything between a tenth and nine.
        assert!(near(times(&[0, 255], 0.5), [0.2, 1.8]));
        // As many texels of .4 as of 1: not below that.
        assert!(near(times(&[0, 102, 255], 0.5), [0.82, 1.8]));
        assert_eq!(times(&[0, 255], 0.0), [1.0; 2]);
    }
}
