//! The blocks of a picture, and the worst of them.

/// A block is judged if at least this share of its pixels is in U.
pub(super) const LEAST_JUDGED: f64 = 0.25;

/// The wood of a block, or its spots, are judged if at least this share of its pixels shows them.
pub(super) const LEAST_OF_PART: f64 = 0.05;

/// Coverage of a block is compared if the plant covers at least this share of it.
const LEAST_PLANT: f64 = 0.1;

/// What a view says of a level.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct ViewScores {
    /// B.
    pub(super) worst_block: f64,
    /// M.
    pub(super) mean: f64,
    /// C.
    pub(super) block_coverage: f64,
    /// W.
    pub(super) worst_wood: f64,
}

/// Sums over a block.
#[derive(Clone, Copy, Debug, Default)]
struct Block {
    judged_px: usize,
    flip: f64,
}

/// The worst block, and the mean, of FLIP `errors` at the pixels `judged`, of the blocks that have at least so large a
/// share of them, if any has; `block_of` names the block of a pixel.
pub(super) fn worst_and_mean(
    least_judged: f64,
    (judged, errors): (&[u32], &[f32]),
    block_px: u32,
    block_count: usize,
    block_of: impl Fn(u32) -> usize,
) -> (Option<f64>, f64) {
    if judged.is_empty() {
        return (None, 0.0);
    }
    let mut blocks = vec![Block::default(); block_count];
    let mut sum = 0.0;
    for (pixel, error) in judged.iter().zip(errors) {
        let block = &mut blocks[block_of(*pixel)];
        block.judged_px += 1;
        block.flip += f64::from(*error);
        sum += f64::from(*error);
    }
    let mean = sum / judged.len() as f64;
    let least_px = least_judged * f64::from(block_px).powi(2);
    let is_judged = |block: &&Block| block.judged_px as f64 >= least_px;
    let means = blocks.iter().filter(is_judged);
    let means = means.map(|block| block.flip / block.judged_px as f64);
    (means.reduce(f64::max), mean)
}

/// The largest relative difference of what two pictures cover of a block of which the first covers a tenth or
/// more; of the whole picture where no block has that.
pub(super) fn largest_coverage_difference(
    [original, level]: [&[f32]; 2],
    block_px: u32,
    block_count: usize,
    block_of: impl Fn(u32) -> usize,
) -> f64 {
    let mut covered = vec![[0.0f64; 2]; block_count];
    for (pixel, (a, b)) in (0..).zip(original.iter().zip(level)) {
        if *a > 0.0 || *b > 0.0 {
            let block = &mut covered[block_of(pixel)];
            block[0] += f64::from(*a);
            block[1] += f64::from(*b);
        }
    }
    let least = LEAST_PLANT * f64::from(block_px).powi(2);
    let relative = |[a, b]: &[f64; 2]| (b - a).abs() / a;
    let blocks = covered.iter().filter(|[a, _]| *a >= least);
    let largest = blocks.map(relative).reduce(f64::max);
    largest.unwrap_or_else(|| {
        let all = covered.iter().fold([0.0; 2], |all, block| {
            [all[0] + block[0], all[1] + block[1]]
        });
        match all {
            [0.0, 0.0] => 0.0,
            [0.0, _] => 1.0,
            all => relative(&all),
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Blocks of 2 x 1 pixels: the second, with a quarter of its four pixels judged, is the worst; the third has none.
    #[test]
    fn the_worst_block_is_one_with_enough_pixels() {
        let errors = [0.25, 0.25, 1.0, 0.5];
        let judged = [0, 1, 2, 9];
        let block_of = |pixel: u32| (pixel / 2) as usize;
        let of = |block_px| worst_and_mean(0.25, (&judged, &errors), block_px, 5, block_of);
        assert_eq!(of(2), (Some(1.0), 0.5));
        // A quarter of 3 x 3 are more than two pixels: no block has them.
        assert_eq!(of(3), (None, 0.5));
        let none = worst_and_mean(0.25, (&[], &[]), 2, 5, block_of);
        assert_eq!(none, (None, 0.0));
    }

    /// Blocks of two pixels: 2 for 1 covered, then 1 for 2; then nothing for a twentieth of the block.
    #[test]
    fn coverage_differs_by_its_share() {
        let original = [1.0, 1.0, 0.5, 0.5, 0.1, 0.0];
        let level = [0.5, 1.0, 1.0, 1.0, 0.0, 0.0];
        let of = |a: &[f32], b: &[f32]| {
            largest_coverage_difference([a, b], 2, 3, |pixel| (pixel / 2) as usize)
        };
        assert_eq!(of(&original, &level), 1.0);
        assert_eq!(of(&original[..2], &level[..2]), 0.25);
        assert_eq!(of(&original[4..], &level[4..]), 1.0);
        assert_eq!(of(&[0.0], &[0.0]), 0.0);
        assert_eq!(of(&[0.0], &[1.0]), 1.0);
    }
}
