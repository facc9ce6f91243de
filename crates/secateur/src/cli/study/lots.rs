//! Numbers drawn by lot, the same on every machine.

use glam::DVec3;
use secateur_plant::Random;

/// Draws lots of a seed: seeds near each other give streams that share nothing.
pub(super) struct Lots(Random);

impl Lots {
    pub(super) fn new(seed: u64) -> Self {
        let mut lots = Self(Random::new(seed.wrapping_mul(0xD134_2543_DE82_EF95)));
        lots.draw();
        lots
    }

    pub(super) fn draw(&mut self) -> u64 {
        self.0.bits()
    }

    /// -1 to 1.
    pub(super) fn signed(&mut self) -> f64 {
        self.0.between(-1.0, 1.0)
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
