//! How numbers are written, the same on every page.

use super::{Column, Row};

/// A share in per cent: "10 %".
pub(crate) fn percent(level: f64) -> String {
    format!("{} %", (1e4 * level).round() / 100.0)
}

/// A value of a metric with the digits that matter.
pub(crate) fn number(value: f64, column: &Column) -> String {
    match column.unit {
        _ if !value.is_finite() => "endless".to_owned(),
        "%" => format!("{value:.2}"),
        _ => format!("{value:.4}"),
    }
}

/// A time in ms below 0.1 s, else in s: "2.50 ms", "12.00 s".
pub(crate) fn duration(seconds: f64) -> String {
    match seconds {
        s if s < 0.1 => format!("{:.2} ms", 1e3 * s),
        s => format!("{s:.2} s"),
    }
}

/// Bytes in whole MiB, or that they are unknown.
pub(crate) fn memory(bytes: Option<u64>) -> String {
    bytes.map_or("unknown".to_owned(), |b| format!("{} MiB", b >> 20))
}

/// A share of leaves; empty where there is none.
pub(crate) fn overlap_of(overlap: Option<f64>) -> String {
    overlap.map_or(String::new(), |share| format!("{share:.3}"))
}

/// A number of trees: "1 tree", "2 trees".
pub(crate) fn trees(count: usize) -> String {
    match count {
        1 => "1 tree".to_owned(),
        _ => format!("{count} trees"),
    }
}

/// A row's value of a metric, as [`number`] writes it.
pub(crate) fn number_of(row: &Row, column: &Column) -> String {
    let value = row.values.get(column.key).copied().flatten();
    number(value.unwrap_or(f64::INFINITY), column)
}
