//! Means over trees and seeds, and which of them no other beats.

use std::collections::BTreeMap;

use super::{Column, Row};

/// A method and setting at a level.
#[derive(Clone, Debug, PartialEq)]
pub struct Point {
    /// The method's name.
    pub method: String,
    /// Method and setting.
    pub label: String,
    /// Geometric mean of the times.
    pub seconds: f64,
    /// Arithmetic mean of the metric; infinite where one value is.
    pub mean: f64,
    /// The worst value of any view of any tree and seed.
    pub worst: f64,
    /// How many rows it stands for.
    pub rows: usize,
}

/// A point for each method and setting at a level, in the order of first rows.
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
            worst: worst
                .max_by(|a, b| badness(a).total_cmp(&badness(b)))
                .unwrap_or(f64::NAN),
            rows: rows.len(),
            label,
        }
    };
    labels.into_iter().map(point).collect()
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

#[cfg(test)]
mod tests {
    use super::super::COLUMNS;
    use super::super::rows::tests::row;
    use super::*;

    /// Times 1 and 4 have the geometric mean 2, errors 2 and 6 the mean 4.
    #[test]
    fn points_are_means_over_trees() {
        let a = row("a", 0.5, 1.0, 2.0);
        let mut b = row("a", 0.5, 4.0, 6.0);
        b.tree = "pine".into();
        let points = summarise(&[&a, &b], &COLUMNS[0]);
        assert_eq!(points.len(), 1);
        assert!((points[0].seconds - 2.0).abs() < 1e-12);
        assert_eq!(
            (points[0].mean, points[0].worst, points[0].rows),
            (4.0, 6.0, 2)
        );
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
}
