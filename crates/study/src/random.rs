//! Random numbers and places, the same on every machine.

use glam::DVec3;
use secateur_plant::Random;

/// The stream of a seed. Small seeds, which studies count from 0, are spread over all states, so
/// that no stream is the beginning of another.
pub(crate) fn stream(seed: u64) -> Random {
    let mut random = Random::new(seed.wrapping_mul(0xD134_2543_DE82_EF95));
    random.bits();
    random
}

/// A number from -1 to 1.
pub(crate) fn signed(random: &mut Random) -> f64 {
    random.between(-1.0, 1.0)
}

/// A point whose coordinates are from -1 to 1.
pub(crate) fn in_cube(random: &mut Random) -> DVec3 {
    DVec3::new(signed(random), signed(random), signed(random))
}

/// A point of the unit ball, evenly spread, but not its very centre.
pub(crate) fn in_ball(random: &mut Random) -> DVec3 {
    loop {
        let at = in_cube(random);
        if (1e-6..=1.0).contains(&at.length_squared()) {
            return at;
        }
    }
}

/// A point of the unit sphere, evenly spread.
pub(crate) fn direction(random: &mut Random) -> DVec3 {
    in_ball(random).normalize()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Committed rows are of these scenes and perturbations: another sequence would be of others.
    #[test]
    fn streams_are_those_of_committed_rows() {
        let mut random = stream(1);
        assert_eq!(random.bits(), FIRST_BITS);
        assert_eq!(signed(&mut random).to_bits(), SECOND_SIGNED);
        let shifted = |bits: u64| (bits >> 11) as f64 / (1u64 << 52) as f64 - 1.0;
        let (mut a, mut b) = (stream(7), stream(7));
        for _ in 0..1000 {
            assert_eq!(signed(&mut a).to_bits(), shifted(b.bits()).to_bits());
        }
    }

    /// Of seed 1, computed apart from this program.
    const FIRST_BITS: u64 = 0xBFA9_AE8D_44B4_5A35;
    const SECOND_SIGNED: u64 = 0x3FE5_093C_9953_CC5A;
}
