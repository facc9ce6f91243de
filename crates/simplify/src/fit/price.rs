//! What it costs that views tell less than they did of the original, or more.

/// Of the information of a view one part in this number is free.
const FREE: i64 = 400;

/// Much is one part in this number of all information, or what was missing at first if that
/// is more.
const MUCH: i128 = 10;

/// Each bit above much counts this many times more.
const DEAR: i128 = 3;

/// By `P * (I(v;F') - I(v;F))` of the views, scaled.
pub(super) struct Price {
    /// How much of each view's is free.
    free: Vec<i64>,
    /// Above which all together is dear.
    much: i128,
}

impl Price {
    /// For views that tell this of the original, and that much else of what is left.
    pub(super) fn new(original: &[i64], deviations: impl Iterator<Item = i64>) -> Self {
        let information: i128 = original.iter().map(|bits| i128::from(*bits)).sum();
        let missing: i128 = deviations.map(|d| i128::from(d.unsigned_abs())).sum();
        Self {
            // Rounding may leave next to nothing below 0.
            free: original.iter().map(|bits| bits.max(&0) / FREE).collect(),
            much: missing.max(information / MUCH),
        }
    }

    pub(super) fn of(&self, deviations: impl Iterator<Item = i64>) -> i128 {
        let (mut cost, mut magnitude) = (0, 0);
        for (deviation, free) in deviations.zip(&self.free) {
            cost += i128::from((deviation.abs() - free).max(0));
            magnitude += i128::from(deviation.abs());
        }
        cost + DEAR * (magnitude - self.much).max(0)
    }

    /// How much is free of all information.
    pub(super) fn free(&self) -> i128 {
        self.free.iter().copied().map(i128::from).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_little_is_free_and_much_is_dear() {
        // Free: 10 and 20; much: 1201, a tenth of all, or what was missing.
        let information = [4000, 8020, -10];
        let price = Price::new(&information, [-100, 0, 0].into_iter());
        let of = |deviations: [i64; 3]| price.of(deviations.into_iter());
        assert_eq!(of([-10, 20, 0]), 0);
        assert_eq!(of([-11, 22, 3]), 1 + 2 + 3);
        assert_eq!(of([10, -1190, 0]), 1170);
        assert_eq!(of([-10, 1192, 0]), 1172 + 3);
        let price = Price::new(&information, [-1300, 100, 0].into_iter());
        let of = |deviations: [i64; 3]| price.of(deviations.into_iter());
        assert_eq!(of([-10, 1390, 0]), 1370);
        assert_eq!(of([-10, 1391, 1]), 1371 + 1 + 3 * 2);
    }
}
