//! The pixels over which a level is judged.

/// By how many pixels the mask grows.
const GROWN_BY_PX: usize = 2;

/// Pixels with this much of the plant or more are its own.
const LEAST_COVERAGE: f32 = 0.1;

/// U: the pixels, row by row, no more than two from one in which either picture shows a tenth of plant or more.
pub(crate) fn judged_pixels(a: &[f32], b: &[f32], width: usize) -> Vec<u32> {
    let pairs = a.iter().zip(b);
    let is_plant: Vec<bool> = pairs.map(|(a, b)| a.max(*b) >= LEAST_COVERAGE).collect();
    let across = grown(&is_plant, width, 1);
    let all = grown(&across, width, width);
    (0..)
        .zip(all)
        .filter_map(|(k, is)| is.then_some(k))
        .collect()
}

/// A mask grown both ways along a row (`step` 1) or a column (`step` of a row's width).
fn grown(mask: &[bool], width: usize, step: usize) -> Vec<bool> {
    let mut grown = mask.to_vec();
    let (height, is_along_row) = (mask.len() / width.max(1), step == 1);
    let count = if is_along_row { width } else { height };
    for k in (0..mask.len()).filter(|k| mask[*k]) {
        let at = if is_along_row { k % width } else { k / width };
        for away in 1..=GROWN_BY_PX {
            if at >= away {
                grown[k - away * step] = true;
            }
            if at + away < count {
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
}
