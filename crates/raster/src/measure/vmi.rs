//! Viewpoint mutual information (Entropy 2018, 20, 213, Eq. 1), in integers.
//!
//! With equal weights for the V views of P pixels each, and the background as
//! polygon 0,
//!
//! ```text
//! I(v;O) = log2 V + 1/P [ sum_o a_o(v) log2 a_o(v) - sum_o a_o(v) log2 S_o ]
//! ```
//!
//! where `a_o(v)` is the area of leaf o in view v in pixels and `S_o` its sum
//! over the views. Everything here works on `P * I` in units of 2^-27 bits, an
//! `i64` that is called *scaled*; [`Vmi::bits`] turns it into bits.

use super::lg::{LG_FRACTION_BITS, LgTable, lg};
use crate::AreaTable;

/// The VMI of each view of a view set.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Vmi {
    scaled: Vec<i64>,
    pixels_per_view: u32,
}

impl Vmi {
    /// From the areas of a foliage in all views.
    ///
    /// # Panics
    /// If the table has no view.
    pub fn of(areas: &AreaTable, table: &LgTable) -> Self {
        let width = areas.leaf_count() + 1;
        let mut totals = vec![0u32; width];
        for row in areas.rows() {
            for (total, area_px) in totals.iter_mut().zip(row) {
                *total += area_px;
            }
        }
        let lg_totals: Vec<i64> = totals.iter().map(|&s| table.lg(s)).collect();
        let lg_views = i64::from(lg(areas.view_count() as u32));
        let pixels_per_view: u32 = areas.row(0).iter().sum();
        let of_view = |row: &[u32]| {
            let terms = row.iter().zip(&lg_totals);
            let sum: i64 = terms.map(|(&a, &lg_s)| table.term(a, lg_s)).sum();
            sum + i64::from(pixels_per_view) * lg_views
        };
        Self {
            scaled: areas.rows().map(of_view).collect(),
            pixels_per_view,
        }
    }

    /// `P * I(v;O)` in units of 2^-27 bits, per view.
    pub fn scaled(&self) -> &[i64] {
        &self.scaled
    }

    /// I(v;O) in bits, per view.
    pub fn bits(&self) -> Vec<f64> {
        let bits = |s: &i64| scaled_to_bits(*s, self.pixels_per_view);
        self.scaled.iter().map(bits).collect()
    }

    /// VMI error of a simplified foliage against this, the original one, in per
    /// cent: `100 * sum_v |I(v;F) - I(v;F')| / |sum_v I(v;F)|`. 0 where both are
    /// without information.
    ///
    /// # Panics
    /// If the view counts differ.
    pub fn error_percent(&self, simplified: &Vmi) -> f64 {
        assert_eq!(
            self.scaled.len(),
            simplified.scaled.len(),
            "the same views for both"
        );
        let pairs = self.scaled.iter().zip(&simplified.scaled);
        error_percent(
            pairs.map(|(a, b)| (a - b).abs()).sum(),
            self.scaled.iter().sum(),
        )
    }
}

/// An amount of information times pixels of a view, in units of 2^-27 bits.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct ScaledBits(pub i64);

impl ScaledBits {
    /// In bits, for views of `pixels_per_view` pixels.
    pub fn bits(self, pixels_per_view: u32) -> f64 {
        scaled_to_bits(self.0, pixels_per_view)
    }
}

/// A scaled value, of views of `pixels_per_view` pixels, in bits.
pub fn scaled_to_bits(scaled: i64, pixels_per_view: u32) -> f64 {
    scaled as f64 / (f64::from(pixels_per_view) * f64::from(1u32 << LG_FRACTION_BITS))
}

/// VMI error in per cent, at least 0, of the scaled sums
/// `sum_v |I(v;F) - I(v;F')|` and `sum_v I(v;F)`. 0 for no deviation, even from
/// nothing.
///
/// Information is never negative, but logarithms are rounded: where a view
/// tells next to nothing, its scaled VMI may lie a few units below 0, and its
/// size counts.
pub fn error_percent(deviation: i64, original: i64) -> f64 {
    if deviation == 0 {
        0.0
    } else {
        100.0 * deviation as f64 / original.abs() as f64
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn bits(leaves: usize, rows: &[u32]) -> Vec<f64> {
        Vmi::of(
            &AreaTable::from_rows(leaves, rows.to_vec()),
            &LgTable::new(),
        )
        .bits()
    }

    #[test]
    fn what_looks_the_same_from_everywhere_tells_nothing() {
        assert_eq!(bits(1, &[48, 16, 48, 16]), [0.0, 0.0]);
    }

    #[test]
    fn a_leaf_seen_only_here_tells_all_of_its_area() {
        // Two views of 64 pixels. Each is half background and half a leaf that
        // the other view does not see: I = 1 + 1/64 [32 (5 - 6) + 32 (5 - 5)].
        assert_eq!(bits(2, &[32, 32, 0, 32, 0, 32]), [0.5, 0.5]);
    }

    #[test]
    fn an_error_is_never_negative() {
        let vmi = |rows: &[u32]| Vmi::of(&AreaTable::from_rows(1, rows.to_vec()), &LgTable::new());
        let original = vmi(&[5, 3, 5, 3, 5, 3]);
        let nothing = vmi(&[8, 0, 8, 0, 8, 0]);
        assert!(original.scaled().iter().all(|&s| s < 0), "rounded below 0");
        assert_eq!(original.error_percent(&nothing), 100.0);
    }

    #[test]
    fn the_formula_in_real_numbers_agrees() {
        let rows = [100u32, 7, 0, 149, 55, 200, 1, 0];
        let real = |v: usize| {
            let term = |o: usize| match f64::from(rows[v * 4 + o]) {
                0.0 => 0.0,
                a => a / 256.0 * (a / f64::from(rows[o] + rows[o + 4])).log2(),
            };
            1.0 + (0..4).map(term).sum::<f64>()
        };
        for (v, got) in bits(3, &rows).iter().enumerate() {
            assert!((got - real(v)).abs() < 1e-7, "{got} against {}", real(v));
        }
    }
}
