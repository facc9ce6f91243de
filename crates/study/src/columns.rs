//! The metrics of a row, in the order in which tables show them.

use std::sync::LazyLock;

use secateur_eval::measure::{Direction, METRICS};
use secateur_eval::pictures::PICTURE_METRICS;

/// A metric as tables and charts need it.
#[derive(Clone, Copy, Debug)]
pub struct Column {
    /// The key of its values in rows.
    pub key: &'static str,
    /// Its name in tables and charts.
    pub title: &'static str,
    /// The unit of its values; empty for a ratio.
    pub unit: &'static str,
    /// Which values are good.
    pub direction: Direction,
}

/// The metrics of foliage, then those of pictures.
pub static COLUMNS: LazyLock<Vec<Column>> = LazyLock::new(|| {
    let counted = METRICS.iter().map(|m| Column {
        key: m.key,
        title: m.title,
        unit: m.unit,
        direction: m.direction,
    });
    let pictured = PICTURE_METRICS.iter().map(|m| Column {
        key: m.key,
        title: m.title,
        unit: m.unit,
        direction: m.direction,
    });
    counted.chain(pictured).collect()
});

impl Column {
    /// Which values are good, in words: "lower is better".
    pub fn better(&self) -> &'static str {
        match self.direction {
            Direction::Lower => "lower is better",
            Direction::Higher => "higher is better",
            Direction::NearerToOne => "nearer to 1 is better",
        }
    }
}
