//! Means over trees and seeds, their Pareto frontier, and spreads over perturbations.

use std::collections::BTreeMap;

use super::{Column, Row, held_out};
use crate::rows::millionths;

/// A method with a setting at a level, over trees and seeds.
#[derive(Clone, Debug, PartialEq)]
pub struct Point {
    /// The method as `--method` spells it.
    pub method: String,
    /// Method and setting in words, as charts name the line.
    pub label: String,
    /// Geometric mean of the times.
    pub seconds: f64,
    /// Arithmetic mean of the metric; infinite where one value is.
    pub mean: f64,
    /// The mean of the worst set's values, or of the worst views' where there is one set.
    pub mean_of_worst: f64,
    /// The worst value of any set of views of any tree and seed.
    pub worst: f64,
    /// Whether judging views drove it.
    pub is_driven_by_judging_views: bool,
    /// The number of rows.
    pub rows: usize,
    /// The most memory of any tree and seed, where a system told.
    pub peak_rss_bytes: Option<u64>,
    /// Mean of the overlaps of kept leaves, where there are any.
    pub kept_overlap: Option<f64>,
}

impl Point {
    /// Method and setting as readers see them.
    pub(crate) fn shown(&self) -> String {
        held_out::shown(&self.label, self.is_driven_by_judging_views)
    }
}

/// A point for each method and setting of rows of one level, in the order of their first rows.
pub fn summarise(rows: &[&Row], column: &Column) -> Vec<Point> {
    let mut labels: Vec<String> = Vec::new();
    let mut of_label: BTreeMap<String, Vec<&Row>> = BTreeMap::new();
    for row in rows {
        let label = row.label();
        if !labels.contains(&label) {
            labels.push(label.clone());
        }
        of_label.entry(label).or_default().push(row);
    }
    let point = |label: String| {
        let rows = &of_label[&label];
        let count = rows.len() as f64;
        let value = |v: Option<&Option<f64>>| v.copied().flatten().unwrap_or(f64::INFINITY);
        let values = rows.iter().map(|r| value(r.values.get(column.key)));
        let worst = rows.iter().map(|r| value(r.worst.get(column.key)));
        let badness = |v: &f64| column.direction.badness(*v);
        let logs = rows.iter().map(|r| r.seconds.max(1e-6).ln());
        Point {
            method: rows[0].method.clone(),
            seconds: (logs.sum::<f64>() / count).exp(),
            mean: values.sum::<f64>() / count,
            mean_of_worst: worst.clone().sum::<f64>() / count,
            is_driven_by_judging_views: rows.iter().any(|r| r.is_driven_by_judging_views),
            worst: worst
                .max_by(|a, b| badness(a).total_cmp(&badness(b)))
                .unwrap_or(f64::NAN),
            rows: rows.len(),
            peak_rss_bytes: rows.iter().filter_map(|r| r.peak_rss_bytes).max(),
            kept_overlap: overlap(rows).map(|(mean, _)| mean),
            label,
        }
    };
    labels.into_iter().map(point).collect()
}

/// Mean and least overlap of kept leaves, where there are any.
pub fn overlap(rows: &[&Row]) -> Option<(f64, f64)> {
    let overlaps: Vec<f64> = rows.iter().filter_map(|r| r.kept_overlap).collect();
    let mean = overlaps.iter().sum::<f64>() / overlaps.len() as f64;
    let least = overlaps.into_iter().min_by(f64::total_cmp)?;
    Some((mean, least))
}

/// The points that no other beats: none is at least as fast and better, or
/// faster and as good. Fastest first.
pub fn pareto<'p>(points: &'p [Point], column: &Column) -> Vec<&'p Point> {
    let mut sorted: Vec<&Point> = points.iter().filter(|p| p.mean.is_finite()).collect();
    let badness = |p: &Point| column.direction.badness(p.mean);
    sorted.sort_by(|a, b| {
        let by_time = a.seconds.total_cmp(&b.seconds);
        by_time.then(badness(a).total_cmp(&badness(b)))
    });
    let mut best = f64::INFINITY;
    sorted.retain(|point| {
        let is_better = badness(point) < best;
        best = best.min(badness(point));
        is_better
    });
    sorted
}

/// How much a method's result on one tree depends on changes that should not
/// matter, and on seeds.
#[derive(Clone, Debug, PartialEq)]
pub struct Spread {
    /// The number of rows, at least 2.
    pub rows: usize,
    /// Arithmetic mean of the metric.
    pub mean: f64,
    /// Standard deviation, with the rows less one as the divisor.
    pub deviation: f64,
    /// The worst row's value.
    pub worst: f64,
}

/// What rows of different changes and seeds have in common.
pub type Group<'r> = (&'r str, &'r str, &'r str, u64);

/// Rows of one tree, method, setting and level (in millionths) that differ in
/// change or seed, where there are at least 2.
pub fn groups(rows: &[Row]) -> BTreeMap<Group<'_>, Vec<&Row>> {
    let mut groups: BTreeMap<Group, Vec<&Row>> = BTreeMap::new();
    for row in rows {
        let level = millionths(row.level);
        let group = (
            row.tree.as_str(),
            row.method.as_str(),
            row.setting.as_str(),
            level,
        );
        groups.entry(group).or_default().push(row);
    }
    groups.retain(|_, rows| rows.len() > 1);
    groups
}

/// The spread of a metric over a group.
pub fn spread(rows: &[&Row], column: &Column) -> Spread {
    let value = |row: &&Row| row.values.get(column.key).copied().flatten();
    let values: Vec<f64> = rows
        .iter()
        .map(|row| value(row).unwrap_or(f64::INFINITY))
        .collect();
    let count = values.len() as f64;
    let mean = values.iter().sum::<f64>() / count;
    let squares = values.iter().map(|v| (v - mean) * (v - mean));
    let badness = |v: &f64| column.direction.badness(*v);
    let worst = values
        .iter()
        .copied()
        .max_by(|a, b| badness(a).total_cmp(&badness(b)));
    Spread {
        rows: values.len(),
        mean,
        deviation: (squares.sum::<f64>() / (count - 1.0).max(1.0)).sqrt(),
        worst: worst.unwrap_or(f64::NAN),
    }
}

#[cfg(test)]
mod tests {
    use super::super::COLUMNS;
    use super::*;
    use crate::rows::tests::row;

    /// Times 1 and 4 have the geometric mean 2, errors 2 and 6 the mean 4.
    #[test]
    fn points_are_means_over_trees() {
        let a = row("a", 0.5, 1.0, 2.0);
        let mut b = row("a", 0.5, 4.0, 6.0);
        b.tree = "pine".into();
        b.peak_rss_bytes = Some(80 << 20);
        b.kept_overlap = Some(0.25);
        let points = summarise(&[&a, &b], &COLUMNS[0]);
        assert_eq!(points.len(), 1);
        assert!((points[0].seconds - 2.0).abs() < 1e-12);
        assert_eq!(
            (points[0].mean, points[0].worst, points[0].rows),
            (4.0, 6.0, 2)
        );
        assert_eq!(points[0].peak_rss_bytes, Some(80 << 20));
        assert_eq!(points[0].kept_overlap, Some(0.25), "of those that have one");
    }

    #[test]
    fn overlaps_are_pooled_where_there_are_any() {
        let mut rows = [0.2, 0.6, 1.0].map(|_| row("a", 0.5, 1.0, 1.0));
        assert_eq!(overlap(&rows.each_ref()), None);
        (rows[0].kept_overlap, rows[2].kept_overlap) = (Some(0.5), Some(1.0));
        assert_eq!(overlap(&rows.each_ref()), Some((0.75, 0.5)));
    }

    /// (1 s, 9), (2 s, 5), (3 s, 7), (4 s, 5), (5 s, 1): the third is slower and
    /// worse than the second, the fourth slower and no better.
    #[test]
    fn the_frontier_is_what_nothing_beats() {
        let rows = [
            ("a", 1.0, 9.0),
            ("b", 2.0, 5.0),
            ("c", 3.0, 7.0),
            ("d", 4.0, 5.0),
            ("e", 5.0, 1.0),
        ]
        .map(|(name, seconds, error)| row(name, 0.5, seconds, error));
        let rows: Vec<&Row> = rows.iter().collect();
        let points = summarise(&rows, &COLUMNS[0]);
        let names: Vec<&str> = pareto(&points, &COLUMNS[0])
            .iter()
            .map(|p| p.label.as_str())
            .collect();
        assert_eq!(names, ["a", "b", "e"]);
    }

    /// 1, 2 and 6 have the mean 3 and the deviation sqrt((4 + 1 + 9) / 2); the
    /// row of another setting is no part of it.
    #[test]
    fn spreads_are_over_changes_and_seeds() {
        let mut rows = [1.0, 2.0, 6.0, 99.0].map(|error| row("a", 0.5, 1.0, error));
        rows[1].change = "jitter".into();
        rows[2].seed = 1;
        rows[3].setting = "other".into();
        let groups = groups(&rows);
        assert_eq!(groups.len(), 1);
        let found = spread(&groups[&("oak", "a", "", 500_000)], &COLUMNS[0]);
        assert_eq!((found.rows, found.mean, found.worst), (3, 3.0, 6.0));
        assert!((found.deviation - 7f64.sqrt()).abs() < 1e-12);
    }
}
