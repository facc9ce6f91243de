//! The pixels over which a level is judged.

/// By how many pixels the mask grows.
const GROWN_BY_PX: usize = 2;

/// Pixels with this much of the plant or more are its own.
pub(super) const LEAST_COVERAGE: f32 = 0.1;

/// U: the pixels, row by row, no more than two from one in which either picture shows a tenth of plant or more.
pub(crate) fn judged_pixels(a: &[f32], b: &[f32], width: usize) -> Vec<u32> {
    let pairs = a.iter().zip(b);
    let is_plant: Vec<bool> = pairs.map(|(a, b)| a.max(*b) >= LEAST_COVERAGE).collect();
    let all = grown(&is_plant, width, GROWN_BY_PX);
    (0..)
        .zip(all)
        .filter_map(|(k, is)| is.then_some(k))
        .collect()
}

/// Pixels, of `pixels`, no more than `reach_px` rows and columns from one where two pictures differ: with filters
/// of this reach FLIP is 0 at all others. `differs` is by pixel, row by row.
pub(super) fn near_difference(
    pixels: &[u32],
    differs: &[bool],
    width: usize,
    reach_px: usize,
) -> Vec<u32> {
    let is_near = grown(differs, width, reach_px);
    let near = pixels.iter().filter(|k| is_near[**k as usize]);
    near.copied().collect()
}

/// A mask grown by `by_px` pixels both ways along its rows, and then along its columns.
fn grown(mask: &[bool], width: usize, by_px: usize) -> Vec<bool> {
    let across = grown_along(mask, width, 1, by_px);
    grown_along(&across, width, width, by_px)
}

/// A mask grown along a row (`step` 1) or a column (`step` of a row's width).
fn grown_along(mask: &[bool], width: usize, step: usize, by_px: usize) -> Vec<bool> {
    let mut grown = mask.to_vec();
    let (height, is_along_row) = (mask.len() / width.max(1), step == 1);
    let count = if is_along_row { width } else { height };
    for k in (0..mask.len()).filter(|k| mask[*k]) {
        let at = if is_along_row { k % width } else { k / width };
        // Where the next pixel is in the mask too, it grows to that side, and farther.
        if at > 0 && !mask[k - step] {
            for away in 1..=by_px.min(at) {
                grown[k - away * step] = true;
            }
        }
        if at + 1 < count && !mask[k + step] {
            for away in 1..=by_px.min(count - 1 - at) {
                grown[k + away * step] = true;
            }
        }
    }
    grown
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A pixel in the corner of 5 x 4 grows to 3 x 3; one below a tenth does not.
    #[test]
    fn pixels_of_the_plant_grow_by_two() {
        let mut a = [0.0; 20];
        let mut b = [0.0; 20];
        (a[0], b[19]) = (0.1, 0.09);
        let expected = [0, 1, 2, 5, 6, 7, 10, 11, 12];
        assert_eq!(judged_pixels(&a, &b, 5), expected);
        assert_eq!(judged_pixels(&b, &a, 5), expected);
        (a[0], b[19]) = (0.0, 1.0);
        assert_eq!(judged_pixels(&a, &b, 5), [7, 8, 9, 12, 13, 14, 17, 18, 19]);
    }

    /// The first and the last of 5 x 4 pixels differ: three of four others are next to them.
    #[test]
    fn pixels_near_a_difference_are_found() {
        let mut differs = [false; 20];
        (differs[0], differs[19]) = (true, true);
        assert_eq!(near_difference(&[1, 6, 12, 13], &differs, 5, 1), [1, 6, 13]);
        assert!(near_difference(&[3, 8], &differs, 5, 0).is_empty());
    }
}
