//! Alpha whose own box-filtered mips cover as much as the picture does.
//!
//! A client halves an image again and again by the means of 2 x 2 texels and tests each level
//! against one cutoff. Where a crown is sparse the means fall below it and the crown fades away;
//! where it is dense they rise above it and gaps close. A PNG carries no mips of its own that could
//! be scaled instead (Castaño, Computing Alpha Mipmaps, 2010), so the image itself is made such
//! that the means fall on the right side.
//!
//! From fine to coarse, each texel of each mip is decided to be there or not, so that about as many
//! are there as the crown covers, in every part of it (error diffusion; Floyd, Steinberg 1976).
//! Alpha has room for that: a texel that is there may have any alpha from the cutoff to 1, one
//! that is not any from 0 to the cutoff. From coarse to fine, the four below a texel then get
//! alphas of which it is the mean, as near to what they would have had as can be.
//!
//! There is an end to the room: where few texels are there and lie scattered one by one, not in
//! clumps as leaves do, the third mip and coarser ones lose some of them still.

use super::cell::Place;

/// What alpha is tested against, 0 to 1.
pub const CUTOFF: f32 = 0.5;

/// How far alpha keeps from the cutoff: more than rounding to bytes moves it over all mips.
const MARGIN: f32 = 4.0 / 255.0;

/// Mips with a side of this and less are left as they come: there a crown is a few texels.
const LEAST_SIDE: usize = 4;

/// Halvings of the step in the search for what to add to four alphas.
const HALVINGS: usize = 16;

/// A mip: for each texel the alpha that it would have, the share of the finest mip's texels below
/// it that are there, and the range that its alpha may be in.
struct Mip {
    /// Texels across and down.
    size: [usize; 2],
    alphas: Vec<f32>,
    shares: Vec<f32>,
    ranges: Vec<[f32; 2]>,
}

/// Alpha for texels that are covered by these shares, of which as many are there in each picture as it covers. Mips
/// do not keep that: it is for samplers that read none.
pub(super) fn alpha_without_mips(coverage: &[f32], size: [u32; 2], pictures: &[Place]) -> Vec<u8> {
    let size = size.map(|side| side as usize);
    bytes(finest(coverage, size, pictures).alphas)
}

/// Alpha for texels that are covered by these shares, a power of two of them on each side. As many texels of each
/// picture are there as it covers; outside of pictures nothing is.
pub(super) fn alpha_that_keeps_coverage(
    coverage: &[f32],
    size: [u32; 2],
    pictures: &[Place],
) -> Vec<u8> {
    let size = size.map(|side| side as usize);
    assert!(size.iter().all(|side| side.is_power_of_two()) && coverage.len() == size[0] * size[1]);
    let mut mips = vec![finest(coverage, size, pictures)];
    while let Some(finer) = mips
        .last()
        .filter(|mip| mip.size.iter().all(|s| *s > LEAST_SIDE))
    {
        let coarser = halved(finer);
        mips.push(coarser);
    }
    let mut above: Option<(usize, Vec<f32>)> = None;
    for mip in mips.iter().rev() {
        let alphas = match &above {
            None => held(&mip.alphas, &mip.ranges),
            Some((width, means)) => spread(mip, means, *width),
        };
        above = Some((mip.size[0], alphas));
    }
    let (_, alphas) = above.unwrap_or_default();
    bytes(alphas)
}

fn bytes(alphas: Vec<f32>) -> Vec<u8> {
    let byte = |alpha: f32| (alpha.clamp(0.0, 1.0) * 255.0).round() as u8;
    alphas.into_iter().map(byte).collect()
}

fn finest(coverage: &[f32], size: [usize; 2], pictures: &[Place]) -> Mip {
    let texels = coverage.len();
    let mut mip = Mip {
        size,
        alphas: vec![0.0; texels],
        shares: vec![0.0; texels],
        ranges: vec![range(false); texels],
    };
    for picture in pictures {
        let [left, top] = picture.corner.map(|texels| texels as usize);
        let [across, down] = picture.size.map(|texels| texels as usize);
        let at = |k: usize| (top + k / across) * size[0] + left + k % across;
        let own: Vec<f32> = (0..across * down).map(|k| coverage[at(k)]).collect();
        for (k, (alpha, is_there)) in of_picture(&own, [across, down]).into_iter().enumerate() {
            let range = range(is_there);
            mip.alphas[at(k)] = alpha.clamp(range[0], range[1]);
            mip.shares[at(k)] = f32::from(u8::from(is_there));
            mip.ranges[at(k)] = range;
        }
    }
    mip
}

/// As many texels of a picture are there as are covered in all: those that are covered most. With the alpha
/// that each would have.
fn of_picture(coverage: &[f32], [across, down]: [usize; 2]) -> Vec<(f32, bool)> {
    let wanted = coverage.iter().sum::<f32>().round() as usize;
    // Of texels with as much coverage, those come first whose neighbours have more.
    let key = |at: usize| {
        let (x, y) = (at % across, at / across);
        let get = |x: usize, y: usize| coverage[y.min(down - 1) * across + x.min(across - 1)];
        let around = get(x + 1, y) + get(x.saturating_sub(1), y);
        let around = around + get(x, y + 1) + get(x, y.saturating_sub(1));
        coverage[at] + 1e-3 * around
    };
    let keys: Vec<f32> = (0..coverage.len()).map(key).collect();
    let mut covered: Vec<usize> = (0..coverage.len())
        .filter(|&at| coverage[at] > 0.0)
        .collect();
    covered.sort_by(|&a, &b| keys[b].total_cmp(&keys[a]).then(a.cmp(&b)));
    let mut is_there = vec![false; coverage.len()];
    for &at in covered.iter().take(wanted) {
        is_there[at] = true;
    }
    let edge = wanted.checked_sub(1).and_then(|last| covered.get(last));
    let edge = edge.map_or(1.0, |&at| coverage[at]).clamp(0.05, 0.95);
    let alpha = |covered: f32| match covered < edge {
        true => CUTOFF * covered / edge,
        false => CUTOFF + (1.0 - CUTOFF) * (covered - edge) / (1.0 - edge),
    };
    let alphas = coverage.iter().map(|&covered| alpha(covered));
    alphas.zip(is_there).collect()
}

fn range(is_there: bool) -> [f32; 2] {
    match is_there {
        true => [CUTOFF + MARGIN, 1.0],
        false => [0.0, CUTOFF - MARGIN],
    }
}

fn held(alphas: &[f32], ranges: &[[f32; 2]]) -> Vec<f32> {
    let pairs = alphas.iter().zip(ranges);
    pairs.map(|(a, [low, high])| a.clamp(*low, *high)).collect()
}

/// The four texels of a finer mip below one.
fn below(x: usize, y: usize, finer_width: usize) -> [usize; 4] {
    let first = 2 * y * finer_width + 2 * x;
    [
        first,
        first + 1,
        first + finer_width,
        first + finer_width + 1,
    ]
}

fn halved(finer: &Mip) -> Mip {
    let [width, height] = finer.size.map(|side| side / 2);
    let mean = |values: &[f32], four: [usize; 4]| four.map(|k| values[k]).iter().sum::<f32>() / 4.0;
    let mut mip = Mip {
        size: [width, height],
        alphas: Vec::with_capacity(width * height),
        shares: Vec::with_capacity(width * height),
        ranges: Vec::with_capacity(width * height),
    };
    for y in 0..height {
        for x in 0..width {
            let four = below(x, y, finer.size[0]);
            mip.alphas.push(mean(&finer.alphas, four));
            mip.shares.push(mean(&finer.shares, four));
            let bound = |k: usize| four.iter().map(|&at| finer.ranges[at][k]).sum::<f32>() / 4.0;
            mip.ranges.push([bound(0), bound(1)]);
        }
    }
    let is_there = there(&mip);
    for (range_of, is_there) in mip.ranges.iter_mut().zip(is_there) {
        let ([low, high], [from, to]) = (*range_of, range(is_there));
        *range_of = [low.max(from).min(high), high.min(to).max(low)];
    }
    mip
}

/// Which texels of a mip are there: as many as its shares say, wherever they are, where the ranges
/// of their alphas let them.
fn there(mip: &Mip) -> Vec<bool> {
    let [width, height] = mip.size;
    let may_be = |at: usize| mip.shares[at] > 0.0 && mip.ranges[at][1] >= CUTOFF + MARGIN;
    let may_not = |at: usize| mip.shares[at] < 1.0 && mip.ranges[at][0] <= CUTOFF - MARGIN;
    let mut is_there = vec![false; width * height];
    // What texels so far showed too little, for this row and the next.
    let mut owed = [vec![0.0f32; width + 2], vec![0.0f32; width + 2]];
    for y in 0..height {
        for x in 0..width {
            let at = y * width + x;
            let wanted = mip.shares[at] + owed[0][x + 1];
            is_there[at] = (may_be(at) && wanted >= 0.5) || !may_not(at);
            // Gaps hand on what is owed to what lies beyond them.
            let left = (wanted - f32::from(u8::from(is_there[at]))).clamp(-1.0, 1.0);
            owed[0][x + 2] += left * 7.0 / 16.0;
            owed[1][x] += left * 3.0 / 16.0;
            owed[1][x + 1] += left * 5.0 / 16.0;
            owed[1][x + 2] += left * 1.0 / 16.0;
        }
        owed.swap(0, 1);
        owed[1].fill(0.0);
    }
    // What was handed on beyond the rim comes back to those that are nearest to the other side.
    let wanted = mip.shares.iter().sum::<f32>().round() as usize;
    let found = is_there.iter().filter(|&&is| is).count();
    let lacks = found < wanted;
    let mut others: Vec<usize> = (0..width * height)
        .filter(|&at| match lacks {
            true => !is_there[at] && may_be(at),
            false => is_there[at] && may_not(at),
        })
        .collect();
    let by_share = |a: &usize, b: &usize| mip.shares[*a].total_cmp(&mip.shares[*b]).then(a.cmp(b));
    others.sort_by(|a, b| match lacks {
        true => by_share(b, a),
        false => by_share(a, b),
    });
    for at in others.into_iter().take(found.abs_diff(wanted)) {
        is_there[at] = lacks;
    }
    is_there
}

/// Alphas of a mip whose means are those of the mip above it: all four get the same more or less,
/// as far as their ranges let them.
fn spread(mip: &Mip, means: &[f32], width_above: usize) -> Vec<f32> {
    let mut alphas = vec![0.0; mip.alphas.len()];
    for y in 0..mip.size[1] / 2 {
        for x in 0..width_above {
            let four = below(x, y, mip.size[0]);
            let own = four.map(|k| (mip.alphas[k], mip.ranges[k]));
            let held = |more: f32| own.map(|(a, [low, high])| (a + more).clamp(low, high));
            let wanted = 4.0 * means[y * width_above + x];
            let (mut low, mut high) = (-1.0f32, 1.0f32);
            for _ in 0..HALVINGS {
                let middle = (low + high) / 2.0;
                match held(middle).iter().sum::<f32>() < wanted {
                    true => low = middle,
                    false => high = middle,
                }
            }
            for (k, alpha) in four.into_iter().zip(held((low + high) / 2.0)) {
                alphas[k] = alpha;
            }
        }
    }
    alphas
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of_square(coverage: &[f32], side: u32) -> Vec<u8> {
        let (corner, size) = ([0, 0], [side; 2]);
        alpha_that_keeps_coverage(coverage, size, &[Place { corner, size }])
    }

    /// The share of texels of each mip that pass the test, as a client makes mips: finest first.
    fn shares(alpha: &[u8], side: usize) -> Vec<f32> {
        let (mut alpha, mut side) = (alpha.to_vec(), side);
        let mut shares = Vec::new();
        loop {
            let there = alpha.iter().filter(|&&a| f32::from(a) / 255.0 >= CUTOFF);
            shares.push(there.count() as f32 / alpha.len() as f32);
            if side <= LEAST_SIDE {
                return shares;
            }
            let mean = |at: usize| {
                let four = below(at % (side / 2), at / (side / 2), side);
                let sum: u32 = four.iter().map(|&k| u32::from(alpha[k])).sum();
                ((sum + 2) / 4) as u8
            };
            alpha = (0..side * side / 4).map(mean).collect();
            side /= 2;
        }
    }

    /// A round crown of clumps of leaves, 4 texels wide, each there by chance, with gaps in them.
    fn crown(side: usize, density: f32) -> Vec<f32> {
        let mut state = 7u32;
        let mut chance = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (state >> 8) as f32 / (1 << 24) as f32
        };
        let half = side as f32 / 2.0;
        let clumps: Vec<bool> = (0..side * side / 16).map(|_| chance() < density).collect();
        let texel = |at: usize| {
            let (x, y) = (at % side, at / side);
            let from_middle = [x, y].map(|k| k as f32 + 0.5 - half);
            let is_inside = from_middle[0].hypot(from_middle[1]) < 0.9 * half;
            let is_leaf = clumps[y / 4 * (side / 4) + x / 4] && chance() < 0.8;
            match is_inside && is_leaf {
                true => 0.25 + 0.75 * chance(),
                false => 0.0,
            }
        };
        (0..side * side).map(texel).collect()
    }

    #[test]
    fn each_mip_covers_what_the_crown_does_dense_or_sparse() {
        for density in [0.25, 0.5, 0.75, 0.95] {
            let coverage = crown(128, density);
            let truth = coverage.iter().sum::<f32>() / coverage.len() as f32;
            let kept = shares(&of_square(&coverage, 128), 128);
            // 128, 64, 32, 16 texels a side; of 8 x 8 one is 2 % of all.
            for (mip, share) in kept.iter().take(4).enumerate() {
                let ratio = share / truth;
                assert!(
                    (0.9..=1.1).contains(&ratio),
                    "mip {mip} of {density}: {ratio}"
                );
            }
            let plain: Vec<u8> = coverage.iter().map(|c| (c * 255.0) as u8).collect();
            let lost = shares(&plain, 128)[3] / truth;
            assert!(!(0.9..=1.1).contains(&lost), "plain means do not: {lost}");
        }
    }

    #[test]
    fn what_is_whole_stays_whole_and_nothing_stays_nothing() {
        for whole in [0.0, 1.0] {
            let alpha = of_square(&[whole; 64], 8);
            assert!(alpha.iter().all(|&a| a == (255.0 * whole) as u8));
        }
        assert_eq!(of_square(&[1.0], 1), [255]);
    }
}
