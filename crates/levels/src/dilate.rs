//! What clear texels get from what is near: filters and mips then mix in nothing dark (pull and
//! push; Gortler et al., The Lumigraph, 1996).

use glam::Vec3;

/// What texels hold, as sums by how much of each is covered, and how much that is.
pub(crate) type Weighted<const N: usize> = ([Vec3; N], f32);

/// The means of covered texels, and for the others that of the smallest mip texel above that has
/// any, or `nothing`. Sizes are powers of two.
pub(crate) fn dilated<const N: usize>(
    texels: Vec<Weighted<N>>,
    size: [usize; 2],
    nothing: [Vec3; N],
) -> Vec<[Vec3; N]> {
    assert!(size.iter().all(|side| side.is_power_of_two()) && texels.len() == size[0] * size[1]);
    let mut mips = vec![(size, texels)];
    while let Some((finer, sums)) = mips.last().filter(|(size, _)| *size != [1, 1]) {
        let size = finer.map(|side| (side / 2).max(1));
        let steps = [finer[0] / size[0], finer[1] / size[1]];
        let sum = |at: usize| {
            let (x, y) = (at % size[0] * steps[0], at / size[0] * steps[1]);
            let mut sum = ([Vec3::ZERO; N], 0.0);
            for row in y..y + steps[1] {
                for (values, weight) in &sums[row * finer[0] + x..][..steps[0]] {
                    for (sum, value) in sum.0.iter_mut().zip(values) {
                        *sum += *value;
                    }
                    sum.1 += weight;
                }
            }
            sum
        };
        let coarser = (0..size[0] * size[1]).map(sum).collect();
        mips.push((size, coarser));
    }
    let mut above = ([1, 1], vec![nothing]);
    for (size, sums) in mips.into_iter().rev() {
        let [across, down] = [size[0] / above.0[0], size[1] / above.0[1]];
        let of_texel = |(at, (values, weight)): (usize, Weighted<N>)| match weight > 0.0 {
            true => values.map(|value| value / weight),
            false => {
                let (x, y) = (at % size[0] / across, at / size[0] / down);
                above.1[y * above.0[0] + x]
            }
        };
        let own = sums.into_iter().enumerate().map(of_texel).collect();
        above = (size, own);
    }
    above.1
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn clear_texels_have_the_colours_of_what_is_near() {
        // The left quarter of the upper half is red, of the lower half green.
        let texel = |at: usize| match (at % 8 < 2, at < 32) {
            (true, true) => ([Vec3::X * 0.5], 0.5),
            (true, false) => ([Vec3::Y * 0.5], 0.5),
            _ => ([Vec3::ZERO], 0.0),
        };
        let filled = dilated((0..64).map(texel).collect(), [8, 8], [Vec3::ZERO]);
        // The right half is as near to one as to the other.
        for (at, [color]) in filled.iter().enumerate().filter(|(at, _)| at % 8 < 4) {
            let expected = if at < 32 { Vec3::X } else { Vec3::Y };
            assert!(color.distance(expected) < 1e-6, "texel {at}: {color}");
        }
    }

    #[test]
    fn a_row_is_filled_along_itself() {
        let mut texels = vec![([Vec3::ZERO], 0.0); 8];
        texels[1] = ([Vec3::X], 1.0);
        texels[6] = ([Vec3::Y], 1.0);
        let filled = dilated(texels, [8, 1], [Vec3::ZERO]);
        let reds: Vec<bool> = filled.iter().map(|[color]| *color == Vec3::X).collect();
        assert_eq!(reds, [true, true, true, true, false, false, false, false]);
    }

    #[test]
    fn nothing_at_all_stays_nothing() {
        let filled = dilated(vec![([Vec3::ONE], 0.0); 4], [2, 2], [Vec3::Z]);
        assert_eq!(filled, [[Vec3::Z]; 4]);
    }
}
