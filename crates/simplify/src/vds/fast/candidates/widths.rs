//! How wide the deltas of a block's leaves are in each view: where deviations are wider,
//! an excess loses nothing.

/// The largest delta of either sign in a view, without the sign: two numbers of
/// eight significant bits, rounded up.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Width(u32);

impl Width {
    pub(super) const ZERO: Self = Self(0);

    /// Of deltas of which the largest is `up` and the least `-down`.
    #[inline(always)]
    pub(super) fn new(up: f32, down: f32) -> Self {
        Self(rounded_up(up) & 0xFFFF_0000 | rounded_up(down) >> 16)
    }

    /// The largest delta, without its sign, that points against a deviation.
    #[inline(always)]
    pub(super) fn against(self, is_negative: bool) -> f32 {
        let (up, down) = (self.0 & 0xFFFF_0000, self.0 << 16);
        f32::from_bits(if is_negative { up } else { down })
    }

    /// With one more delta.
    #[inline(always)]
    pub(super) fn with(self, delta: f32) -> Self {
        let (up, down) = (self.against(true), self.against(false));
        let (with_up, with_down) = (rounded_up(delta.max(0.0)), rounded_up((-delta).max(0.0)));
        Self(
            up.to_bits().max(with_up & 0xFFFF_0000)
                | (down.to_bits().max(with_down & 0xFFFF_0000)) >> 16,
        )
    }
}

/// The bits of a number that is not negative, of which the upper half is not
/// below it.
#[inline(always)]
fn rounded_up(number: f32) -> u32 {
    number.abs().to_bits() + 0xFFFF
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_width_is_never_less_than_its_deltas() {
        for (up, down) in [(0.0, 0.0), (1.0, 3.5), (1.1e9, 0.0), (7e3, 1.234_567e12)] {
            let width = Width::new(up, down);
            for (bound, delta) in [(width.against(true), up), (width.against(false), down)] {
                assert!(
                    bound >= delta && bound <= delta * 1.01,
                    "{bound} for {delta}"
                );
            }
            assert_eq!(Width::ZERO.with(up).with(-down), width);
        }
    }
}
