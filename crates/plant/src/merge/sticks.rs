//! Which sticks go at a threshold, and in which order.

use super::thresholds::StickSize;
use crate::Segment;

/// HR: the height of a stick's start above the ground over its radius there.
/// Infinite where the radius is 0.
pub fn height_over_radius(stick: &Segment, ground_m: f64) -> f64 {
    if stick.start_radius_m == 0.0 {
        return f64::INFINITY;
    }
    (stick.start.y - ground_m) / stick.start_radius_m
}

/// For each stick the threshold below which it is replaced: the least slenderness (HR, or how thin
/// it is) of it and of all that grows on it, so that what is replaced is always whole subtrees.
/// Nothing for roots.
///
/// # Panics
/// If a parent is not an earlier stick.
pub(super) fn replaced_below(sticks: &[Segment], size: StickSize) -> Vec<Option<f64>> {
    let roots = sticks.iter().filter(|stick| stick.parent.is_none());
    let ground_m = roots.map(|root| root.start.y).fold(f64::INFINITY, f64::min);
    let mut least: Vec<f64> = sticks
        .iter()
        .map(|stick| size.slenderness(stick, ground_m))
        .collect();
    for index in (0..sticks.len()).rev() {
        if let Some(parent) = sticks[index].parent {
            assert!(parent.index() < index, "parents come before children");
            least[parent.index()] = least[parent.index()].min(least[index]);
        }
    }
    let of = |(stick, least): (&Segment, f64)| stick.parent.map(|_| least);
    sticks.iter().zip(least).map(of).collect()
}

/// The sticks that can be replaced, first gone first: the largest HR first, what
/// grows on a stick before the stick.
pub(super) fn in_order(replaced_below: &[Option<f64>]) -> Vec<(f64, u32)> {
    let with_index = replaced_below.iter().enumerate();
    let mut sticks: Vec<(f64, u32)> = with_index
        .filter_map(|(index, hr)| Some(((*hr)?, index as u32)))
        .collect();
    // Children come later than their parents and have at least their value.
    sticks.sort_unstable_by(|a, b| b.0.total_cmp(&a.0).then(b.1.cmp(&a.1)));
    sticks
}

/// The thresholds at which about these shares of `count` sticks are gone; equal
/// HRs go together. `in_order` has those that can go.
pub(super) fn thresholds(in_order: &[(f64, u32)], count: usize, shares: &[f64]) -> Vec<f64> {
    let gone_above = |hr: f64| in_order.partition_point(|stick| stick.0 > hr);
    let threshold = |share: &f64| {
        let wanted = libm::round(share * count as f64) as usize;
        let Some(&(hr, _)) = in_order.get(wanted) else {
            return f64::NEG_INFINITY;
        };
        // Without the equals of the first that need not go, or with them.
        let fewer = gone_above(hr);
        let more = in_order.partition_point(|stick| stick.0 >= hr);
        match more.abs_diff(wanted) < fewer.abs_diff(wanted) {
            true => in_order.get(more).map_or(f64::NEG_INFINITY, |next| next.0),
            false => hr,
        }
    };
    shares.iter().map(threshold).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// HRs 40, 40, 40, 20, 20 and 10, of seven sticks with the root.
    #[test]
    fn equal_sticks_go_together_to_the_nearer_count() {
        let values = [40.0, 40.0, 40.0, 20.0, 20.0, 10.0];
        let in_order: Vec<(f64, u32)> = values.into_iter().zip(1..).collect();
        let gone = |wanted: f64| {
            let threshold = thresholds(&in_order, 7, &[wanted / 7.0])[0];
            in_order.iter().filter(|stick| stick.0 > threshold).count()
        };
        let expected = [0, 0, 3, 3, 3, 5, 6, 6];
        for (wanted, expected) in expected.into_iter().enumerate() {
            assert_eq!(gone(wanted as f64), expected, "{wanted}");
        }
    }
}
