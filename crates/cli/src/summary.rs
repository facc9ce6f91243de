//! Formats numbers and tables for people.

use secateur::Counts;

/// Groups digits by three: 20160 becomes "20,160".
pub(crate) fn grouped(number: u64) -> String {
    let digits = number.to_string();
    let mut text = String::with_capacity(digits.len() + digits.len() / 3);
    for (k, digit) in digits.chars().enumerate() {
        if k > 0 && (digits.len() - k).is_multiple_of(3) {
            text.push(',');
        }
        text.push(digit);
    }
    text
}

/// Bytes as "3.8 MB".
pub(crate) fn size(bytes: u64) -> String {
    match bytes {
        0..1_000 => format!("{bytes} B"),
        1_000..1_000_000 => format!("{:.0} kB", bytes as f64 / 1e3),
        _ => format!("{:.1} MB", bytes as f64 / 1e6),
    }
}

/// Per cent with the digits that matter.
pub(crate) fn percent(percent: f64) -> String {
    match percent {
        p if p == 0.0 || p >= 10.0 => format!("{p:.1} %"),
        p => format!("{p:.2} %"),
    }
}

/// "10 %" of the leaves.
pub(crate) fn share(kept: u64, count: u64) -> String {
    let share = 100.0 * kept as f64 / count.max(1) as f64;
    match share {
        s if (s - s.round()).abs() < 0.05 => format!("{s:.0} %"),
        s => format!("{s:.1} %"),
    }
}

/// A row of a number before and after, and the share that is left.
pub(crate) fn counts_row(name: &str, counts: Counts) -> Vec<String> {
    let [before, after] = [counts.original, counts.left].map(grouped);
    let share = share(counts.left, counts.original);
    vec![name.to_owned(), before, after, share]
}

/// Rows of cells as aligned columns: the first to the left, others to the right.
pub(crate) fn columns(rows: &[Vec<String>]) -> String {
    let width = |k: usize| rows.iter().map(|r| r[k].chars().count()).max().unwrap_or(0);
    let widths: Vec<usize> = (0..rows.first().map_or(0, Vec::len)).map(width).collect();
    let line = |row: &Vec<String>| {
        let cells = row.iter().zip(&widths).enumerate();
        let padded = cells.map(|(k, (cell, &width))| match k {
            0 => format!("{cell:<width$}"),
            _ => format!("{cell:>width$}"),
        });
        let text = padded.collect::<Vec<_>>().join("  ");
        format!("  {}\n", text.trim_end())
    };
    rows.iter().map(line).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn digits_go_by_threes() {
        assert_eq!(
            [0, 999, 1000, 20_160, 1_234_567].map(grouped),
            ["0", "999", "1,000", "20,160", "1,234,567"]
        );
    }

    #[test]
    fn columns_are_as_wide_as_their_widest_cell() {
        let row = |cells: [&str; 2]| cells.map(str::to_owned).to_vec();
        let text = columns(&[row(["", "leaves"]), row(["10 %", "300"])]);
        assert_eq!(text, "        leaves\n  10 %     300\n");
    }
}
