//! Spots: flowers, fruits and the like, few pixels of another colour than the plant, which everyone misses.

use crate::flip::chroma;

/// A pixel has another colour where its chroma, a* and b*, is so far from the mean of the plant. Red berries on a green
/// bush, yellow anthers on a pink blossom are; other distances were not tried.
const ANOTHER_COLOR: f32 = 25.0;

/// Of more of the plant's pixels than this share another colour is one of its own, such as that of bark or a pot. Others
/// were not tried.
const MOST_SPOTS: f64 = 0.2;

/// A pixel shows the plant where this share of it does.
const MOSTLY: f32 = 0.5;

/// By pixel, in rows of `width`, whether it and the eight about it show another colour than most of the plant does.
/// `rgb`: linear, times coverage.
pub(super) fn spots(rgb: &[[f32; 3]], coverage: &[f32], width: usize) -> Vec<bool> {
    let shown: Vec<usize> = (0..rgb.len()).filter(|k| coverage[*k] >= MOSTLY).collect();
    let light_of = |k: &usize| rgb[*k].map(|light| light / coverage[*k]);
    let colors = chroma(shown.iter().map(light_of));
    let count = shown.len() as f64;
    let mean = [0, 1].map(|axis| {
        let sum: f64 = colors.iter().map(|color| f64::from(color[axis])).sum();
        (sum / count) as f32
    });
    let mut others = vec![false; rgb.len()];
    for (pixel, [a, b]) in shown.iter().zip(&colors) {
        others[*pixel] = (a - mean[0]).hypot(b - mean[1]) > ANOTHER_COLOR;
    }
    let found: Vec<usize> = (0..others.len()).filter(|k| others[*k]).collect();
    let mut spots = vec![false; rgb.len()];
    if found.len() as f64 <= MOST_SPOTS * count {
        for pixel in found {
            let x = pixel % width;
            let rows = [pixel.checked_sub(width), Some(pixel), Some(pixel + width)];
            let mut beside = rows.into_iter().flatten().flat_map(|at| {
                let columns = at - usize::from(x > 0)..=at + usize::from(x + 1 < width);
                columns.filter(|at| *at < others.len())
            });
            spots[pixel] = beside.all(|at| others[at]);
        }
    }
    spots
}

#[cfg(test)]
mod tests {
    use super::*;

    const GREEN: [f32; 3] = [0.1, 0.35, 0.05];

    /// How many spots a picture of 40 x 20 pixels has, half of it green, with this colour over `width` x 6 pixels in one
    /// corner of that half, and the last of them.
    fn found(color: [f32; 3], width: usize) -> (usize, Option<usize>) {
        let (mut rgb, mut coverage) = (vec![[0.0; 3]; 40 * 20], vec![0.0; 40 * 20]);
        for y in 0..20 {
            for x in 0..20 {
                let shown = if x < width && y < 6 { color } else { GREEN };
                // Nothing but the light of what is covered counts.
                rgb[y * 40 + x] = shown.map(|light| 0.8 * light);
                coverage[y * 40 + x] = 0.8;
            }
        }
        let spots = spots(&rgb, &coverage, 40);
        let count = spots.iter().filter(|spot| **spot).count();
        (count, spots.iter().rposition(|spot| *spot))
    }

    #[test]
    fn spots_are_few_pixels_of_another_colour() {
        let red = [0.6, 0.05, 0.05];
        let whole = found(red, 6);
        assert_eq!(whole, (25, Some(4 * 40 + 4)), "but for the rim");
        assert_eq!(found(red, 1), (0, None), "all rim");
        assert_eq!(found(red, 14).0, 0, "more than a fifth");
        assert_eq!(found(GREEN.map(|light| 0.2 * light), 6).0, 0, "a shadow");
        assert!(spots(&[], &[], 0).is_empty());
    }
}
