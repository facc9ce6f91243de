//! Numbers drawn by lot, the same on every machine.

use glam::DVec3;

/// SplitMix64 (Steele, Lea, Flood 2014).
pub(super) struct Lots(u64);

impl Lots {
    pub(super) fn new(seed: u64) -> Self {
        let mut lots = Self(seed.wrapping_mul(0xD134_2543_DE82_EF95));
        lots.draw();
        lots
    }

    pub(super) fn draw(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    /// -1 to 1.
    pub(super) fn signed(&mut self) -> f64 {
        (self.draw() >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }

    /// Within the unit ball, evenly, and not at its very centre.
    pub(super) fn in_ball(&mut self) -> DVec3 {
        loop {
            let at = DVec3::new(self.signed(), self.signed(), self.signed());
            if (1e-6..=1.0).contains(&at.length_squared()) {
                return at;
            }
        }
    }

    /// On the unit sphere, evenly.
    pub(super) fn direction(&mut self) -> DVec3 {
        self.in_ball().normalize()
    }
}
