//! Which of several leaves of the same cost goes first.

use secateur_model::LeafId;

use super::Ties;

impl Ties {
    /// A number of its own for each leaf; of equals the lowest goes.
    #[inline]
    pub(crate) fn rank(self, leaf: LeafId) -> u32 {
        match self {
            Ties::Order => leaf.get(),
            Ties::Spread => mix(leaf.get()),
        }
    }
}

/// A bijection of 32 bits: xor-shifts and odd multiplications can all be undone.
fn mix(mut x: u32) -> u32 {
    x ^= x >> 16;
    x = x.wrapping_mul(0x7FEB_352D);
    x ^= x >> 15;
    x = x.wrapping_mul(0x846C_A68B);
    x ^ (x >> 16)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn spread_ranks_are_all_different_and_far_from_the_order() {
        let mut ranks: Vec<(u32, u32)> = (1..=10_000)
            .map(|n| (Ties::Spread.rank(LeafId::new(n).unwrap()), n))
            .collect();
        ranks.sort_unstable();
        assert!(ranks.windows(2).all(|w| w[0].0 < w[1].0));
        // Of the first tenth to go, about half come from either half.
        let low_half = ranks[..1000].iter().filter(|r| r.1 <= 5000).count();
        assert!((400..600).contains(&low_half), "{low_half}");
    }
}
