//! Figures in words, the same on every page.

use super::{Column, Row};

/// "10 %".
pub(super) fn percent(level: f64) -> String {
    format!("{} %", (1e4 * level).round() / 100.0)
}

pub(super) fn number(value: f64, column: &Column) -> String {
    match column.unit {
        _ if !value.is_finite() => "endless".to_owned(),
        "%" => format!("{value:.2}"),
        _ => format!("{value:.4}"),
    }
}

pub(super) fn duration(seconds: f64) -> String {
    match seconds {
        s if s < 0.1 => format!("{:.2} ms", 1e3 * s),
        s => format!("{s:.2} s"),
    }
}

pub(super) fn memory(bytes: Option<u64>) -> String {
    bytes.map_or("unknown".to_owned(), |b| format!("{} MiB", b >> 20))
}

pub(super) fn overlap_of(overlap: Option<f64>) -> String {
    overlap.map_or(String::new(), |share| format!("{share:.3}"))
}

/// "1 tree", "2 trees".
pub(super) fn trees(count: usize) -> String {
    match count {
        1 => "1 tree".to_owned(),
        _ => format!("{count} trees"),
    }
}

/// A row's value of a metric.
pub(super) fn number_of(row: &Row, column: &Column) -> String {
    let value = row.values.get(column.key).copied().flatten();
    number(value.unwrap_or(f64::INFINITY), column)
}
