//! Logarithms of counts, in integers.
//!
//! Areas are whole numbers, so every logarithm the measure needs is that of a
//! whole number. Computed by integer arithmetic alone, it has the same bits on
//! every platform, and sums of it do not depend on their order.

/// Fractional bits of a logarithm.
///
/// Bound: [`lg`] of anything up to 2^30 is below 30 * 2^27 < 2^32, and with at
/// most 2^29 pixels over all views ([`crate::MAX_TOTAL_PIXELS`]) a sum
/// over all views of `2 * area * lg` stays below 2 * 2^29 * 29 * 2^27 < 2^62.
pub const LG_FRACTION_BITS: u32 = 27;

use std::sync::OnceLock;

/// Largest count in the tables: the pixels of a 256 x 256 view.
const TABLE_MAX: u32 = 1 << 16;

/// Logarithms that are computed together when the first of them is asked for:
/// areas of the background, beyond the tables, change by a few pixels a step.
const PAGE: usize = 256;

/// Logarithms that are computed side by side; divides a page and the tables.
const TOGETHER: usize = 8;

/// Pages there are; beyond them every logarithm is computed anew.
const PAGES: usize = 1 << 17;

/// log2 of `n >= 1` in units of 2^-27, rounded down to within 1.2 units.
///
/// The fraction comes bit by bit from squaring a 32-bit mantissa.
pub fn lg(n: u32) -> u32 {
    debug_assert!(n > 0 && n < 1 << 31);
    let exponent = n.ilog2();
    let mut mantissa = n << (31 - exponent);
    let mut bits = exponent;
    for _ in 0..LG_FRACTION_BITS {
        let square = u64::from(mantissa) * u64::from(mantissa);
        let carry = (square >> 63) as u32;
        mantissa = (square >> (31 + carry)) as u32;
        bits = bits << 1 | carry;
    }
    bits
}

/// [`lg`] of several numbers, step by step together: no step of one waits for
/// those of another.
fn lg_together<const N: usize>(numbers: [u32; N]) -> [u32; N] {
    let mut bits = numbers.map(u32::ilog2);
    let mut mantissas = numbers;
    for k in 0..N {
        mantissas[k] <<= 31 - bits[k];
    }
    for _ in 0..LG_FRACTION_BITS {
        for k in 0..N {
            let square = u64::from(mantissas[k]) * u64::from(mantissas[k]);
            let carry = (square >> 63) as u32;
            mantissas[k] = (square >> (31 + carry)) as u32;
            bits[k] = bits[k] << 1 | carry;
        }
    }
    bits
}

/// Tables of `lg n` and `n lg n` for the counts of leaves, which are small, and
/// pages of `lg n` for those of the background, filled as they are asked for.
#[derive(Clone, Debug)]
pub struct LgTable {
    lg: Vec<u32>,
    n_lg_n: Vec<i64>,
    pages: Vec<OnceLock<Box<[u32; PAGE]>>>,
}

impl LgTable {
    /// Computes the tables, some milliseconds.
    pub fn new() -> Self {
        let mut lg = vec![0u32; TABLE_MAX as usize + 1];
        for first in (1..TABLE_MAX).step_by(2 * TOGETHER) {
            let odd: [u32; TOGETHER] = std::array::from_fn(|k| first + 2 * k as u32);
            for (n, lg_n) in odd.into_iter().zip(lg_together(odd)) {
                lg[n as usize] = lg_n;
            }
        }
        // Twice a number has the same mantissa.
        for n in (2..=TABLE_MAX as usize).step_by(2) {
            lg[n] = lg[n / 2] + (1 << LG_FRACTION_BITS);
        }
        let n_lg_n = lg.iter().zip(0i64..).map(|(l, n)| n * i64::from(*l));
        Self {
            n_lg_n: n_lg_n.collect(),
            lg,
            pages: (0..PAGES).map(|_| OnceLock::new()).collect(),
        }
    }

    fn beyond_table(&self, n: u32) -> u32 {
        match self.page(n as usize / PAGE) {
            Some(page) => page[n as usize % PAGE],
            None => lg(n),
        }
    }

    fn page(&self, page: usize) -> Option<&[u32; PAGE]> {
        let page_of_n = self.pages.get(page)?;
        let first = (page * PAGE) as u32;
        let fill = || {
            let mut page = Box::new([0; PAGE]);
            for (k, lgs) in page.chunks_exact_mut(TOGETHER).enumerate() {
                let first = first + (k * TOGETHER) as u32;
                let numbers: [u32; TOGETHER] = std::array::from_fn(|k| first + k as u32);
                lgs.copy_from_slice(&lg_together(numbers));
            }
            page
        };
        Some(page_of_n.get_or_init(fill))
    }

    /// [`lg`] of n; 0 for 0, which only ever stands beside a factor 0.
    #[inline]
    pub fn lg(&self, n: u32) -> i64 {
        match self.lg.get(n as usize) {
            Some(l) => i64::from(*l),
            None => i64::from(self.beyond_table(n)),
        }
    }

    /// [`lg`](Self::lg) of `first` and the numbers that follow it.
    pub fn lg_from(&self, first: u32, mut lgs: &mut [u32]) {
        let mut n = first as usize;
        while !lgs.is_empty() {
            let (page, at) = (n / PAGE, n % PAGE);
            let known = match self.lg.get(n..) {
                Some(known) if !known.is_empty() => known,
                _ => self.page(page).map_or(&[][..], |page| &page[at..]),
            };
            let count = known.len().min(lgs.len()).max(1);
            let (head, rest) = lgs.split_at_mut(count);
            match known.get(..count) {
                Some(known) => head.copy_from_slice(known),
                None => head[0] = lg(n as u32),
            }
            (n, lgs) = (n + count, rest);
        }
    }

    /// `n lg n`, 0 for 0.
    #[inline]
    pub fn n_lg_n(&self, n: u32) -> i64 {
        match self.n_lg_n.get(n as usize) {
            Some(l) => *l,
            None => i64::from(n) * i64::from(self.beyond_table(n)),
        }
    }

    /// `a (lg a - lg s)`: what a leaf of area `a` in a view and `s` over all
    /// views adds to the view's VMI, times the pixels of a view.
    #[inline]
    pub fn term(&self, a: u32, lg_s: i64) -> i64 {
        self.n_lg_n(a) - i64::from(a) * lg_s
    }
}

impl Default for LgTable {
    fn default() -> Self {
        Self::new()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn powers_of_two_are_exact() {
        for exponent in 0..31 {
            assert_eq!(lg(1 << exponent), exponent << LG_FRACTION_BITS);
        }
    }

    #[test]
    fn close_to_the_real_logarithm_and_never_above() {
        let one = f64::from(1u32 << LG_FRACTION_BITS);
        let mut n = 1u32;
        while n < 1 << 30 {
            let exact = f64::from(n).log2() * one;
            let error = exact - f64::from(lg(n));
            assert!((-1e-6..1.2).contains(&error), "lg({n}) is off by {error}");
            n += 1 + n / 977;
        }
    }

    #[test]
    fn monotonic_over_the_table_and_its_end() {
        let table = LgTable::new();
        for n in 1..TABLE_MAX + 1000 {
            assert!(table.lg(n) < table.lg(n + 1), "{n}");
            assert_eq!(table.n_lg_n(n), i64::from(n) * table.lg(n));
        }
    }

    #[test]
    fn the_table_equals_the_computation_near_and_far() {
        let table = LgTable::new();
        for n in 1..=TABLE_MAX {
            assert_eq!(table.lg(n), i64::from(lg(n)), "{n}");
        }
        let last_of_pages = (PAGE * PAGES) as u32 - 1;
        for around in [1 << 16, 1_310_720, 5_242_880, last_of_pages, 1 << 28] {
            for n in around - 300..around + 300 {
                assert_eq!(table.lg(n), i64::from(lg(n)), "{n}");
                assert_eq!(table.n_lg_n(n), i64::from(n) * i64::from(lg(n)));
            }
        }
    }

    #[test]
    fn a_run_of_logarithms_is_one_after_the_other() {
        let table = LgTable::new();
        let last_of_pages = (PAGE * PAGES) as u32 - 1;
        for first in [0, 1, 65_530, 1 << 16, 70_000, 1_310_700, last_of_pages - 9] {
            for count in [0, 1, 7, 300] {
                let mut lgs = vec![0; count];
                table.lg_from(first, &mut lgs);
                for (n, lg_n) in (first..).zip(lgs) {
                    assert_eq!(i64::from(lg_n), table.lg(n), "{n} of {count} from {first}");
                }
            }
        }
    }

    #[test]
    fn bits_are_pinned() {
        // log2 3 = 1.58496250072..., in units of 2^-27: 212730065.8
        assert_eq!(lg(3), 212_730_065);
        assert_eq!(lg(10), 445_861_641);
    }
}
