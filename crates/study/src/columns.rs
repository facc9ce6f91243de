//! The metrics of a row, in the order in which tables show them.

use std::sync::LazyLock;

use secateur_eval::measure::{Direction, METRICS};
use secateur_eval::pictures::PICTURE_METRICS;
use secateur_eval::{AsDrawnMeasurement, OriginalAsDrawn};

use crate::{Row, Values};

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

/// Widths of the pictures that are judged as a client draws them, in pixels: a tree that fills a
/// good part of a screen, and one far off.
pub const DRAWN_WIDTHS_PX: [u32; 2] = [512, 128];

/// The metrics of what a client draws: mip maps, the alpha test at the middle of each pixel, back
/// faces culled; over frames as well ([`secateur_eval::OverFrames`]), in large pictures only where that was
/// asked for, with how much changes between frames. Rows that are older, and those that a paper's views judge, lack their values.
pub const DRAWN_COLUMNS: [Column; 16] = [
    drawn(
        "flip_as_drawn_512",
        "FLIP at 512 px as drawn",
        Direction::Lower,
    ),
    drawn(
        "truth_iou_as_drawn_512",
        "IoU with the truth at 512 px as drawn",
        Direction::Higher,
    ),
    drawn(
        "iou_as_drawn_512",
        "IoU at 512 px as drawn",
        Direction::Higher,
    ),
    drawn(
        "coverage_as_drawn_512",
        "coverage at 512 px as drawn",
        Direction::NearerToOne,
    ),
    drawn(
        "flip_over_frames_512",
        "FLIP at 512 px over frames",
        Direction::Lower,
    ),
    drawn(
        "truth_iou_over_frames_512",
        "IoU with the truth at 512 px over frames",
        Direction::Higher,
    ),
    drawn(
        "coverage_over_frames_512",
        "coverage at 512 px over frames",
        Direction::NearerToOne,
    ),
    drawn(
        "flicker_over_frames_512",
        "flicker at 512 px",
        Direction::Lower,
    ),
    drawn(
        "flip_as_drawn_128",
        "FLIP at 128 px as drawn",
        Direction::Lower,
    ),
    drawn(
        "truth_iou_as_drawn_128",
        "IoU with the truth at 128 px as drawn",
        Direction::Higher,
    ),
    drawn(
        "iou_as_drawn_128",
        "IoU at 128 px as drawn",
        Direction::Higher,
    ),
    drawn(
        "coverage_as_drawn_128",
        "coverage at 128 px as drawn",
        Direction::NearerToOne,
    ),
    drawn(
        "flip_over_frames_128",
        "FLIP at 128 px over frames",
        Direction::Lower,
    ),
    drawn(
        "truth_iou_over_frames_128",
        "IoU with the truth at 128 px over frames",
        Direction::Higher,
    ),
    drawn(
        "coverage_over_frames_128",
        "coverage at 128 px over frames",
        Direction::NearerToOne,
    ),
    drawn(
        "flicker_over_frames_128",
        "flicker at 128 px",
        Direction::Lower,
    ),
];

/// How high a plant is in the pictures whose [`Difference`](secateur_eval::Difference) rows have, in pixels.
pub const DIFFERENCE_PX: u32 = 300;

/// How far the whole plant looks from the original, as `lods` chooses levels. Rows that are older lack it.
pub const DIFFERENCE_COLUMN: Column =
    drawn("difference_300", "Difference at 300 px", Direction::Lower);

/// How high the crown is left, as a share of the original's: from the lowest to the highest corner of a leaf. Rows that
/// are older lack it.
pub(crate) const CROWN_HEIGHT_COLUMN: Column = drawn(
    "crown_height_kept",
    "Crown height kept",
    Direction::NearerToOne,
);

/// Up to which width the program has pictures judged over frames if it is not told: of larger ones that takes
/// longer than all else.
pub const FRAMES_UP_TO_PX: u32 = 128;

const fn drawn(key: &'static str, title: &'static str, direction: Direction) -> Column {
    Column {
        key,
        title,
        unit: "",
        direction,
    }
}

/// The column of a key.
///
/// # Panics
/// If there is none.
pub(crate) fn column(key: &str) -> &'static Column {
    let mut all = (COLUMNS.iter().chain(&DRAWN_COLUMNS)).chain([&DIFFERENCE_COLUMN]);
    all.find(|column| column.key == key).expect("a metric")
}

/// A value of [`DRAWN_COLUMNS`] by its key; none where it is not finite.
fn keyed(what: &str, how: &str, width_px: u32, value: f64) -> (String, Option<f64>) {
    let key = format!("{what}_{how}_{width_px}");
    (key, Some(value).filter(|value| value.is_finite()))
}

/// The values of [`DRAWN_COLUMNS`] of one width, by their keys.
pub(crate) fn values_as_drawn(measured: &AsDrawnMeasurement) -> Vec<(String, Option<f64>)> {
    let value = |what, value| keyed(what, "as_drawn", measured.width_px, value);
    let mut values = vec![
        value("flip", measured.flip_mean),
        value("truth_iou", measured.truth_iou),
        value("iou", measured.silhouette_iou),
        value("coverage", measured.coverage_over_truth),
    ];
    if let Some(over_frames) = measured.over_frames {
        let value = |what, value| keyed(what, "over_frames", measured.width_px, value);
        values.extend([
            value("flip", over_frames.flip_mean),
            value("truth_iou", over_frames.truth_iou),
            value("coverage", over_frames.coverage_over_truth),
            value("flicker", over_frames.flicker),
        ]);
    }
    values
}

/// The values of [`DRAWN_COLUMNS`] of the tree itself in single frames, and how much it flickers: as a client
/// draws it, and as it would without mip maps. Its overlap with itself is left out.
pub(crate) fn values_of_original(measured: &[AsDrawnMeasurement]) -> [Values; 2] {
    let of = |shown: &OriginalAsDrawn, flicker: Option<f64>, width_px| {
        let value = |what, value| keyed(what, "as_drawn", width_px, value);
        let in_frames = [
            value("flip", shown.flip_mean),
            value("truth_iou", shown.truth_iou),
            value("coverage", shown.coverage_over_truth),
        ];
        let flicker = flicker.map(|value| keyed("flicker", "over_frames", width_px, value));
        in_frames.into_iter().chain(flicker)
    };
    let as_it_is = |drawn: &AsDrawnMeasurement| {
        let flicker = drawn.original_over_frames.map(|frames| frames.flicker);
        of(&drawn.original(), flicker, drawn.width_px)
    };
    // Without mip maps frames show the truth.
    let without_mips = |drawn: &AsDrawnMeasurement| {
        let flicker = drawn
            .original_over_frames
            .map(|frames| frames.truth_flicker);
        of(&drawn.original_without_mips, flicker, drawn.width_px)
    };
    [
        measured.iter().flat_map(as_it_is).collect(),
        measured.iter().flat_map(without_mips).collect(),
    ]
}

impl Column {
    /// Its value in a row; infinite where there is none.
    pub(crate) fn value_of(&self, row: &Row) -> f64 {
        self.value_in(&row.values).unwrap_or(f64::INFINITY)
    }

    /// Its value among some; nothing where there is none.
    pub(crate) fn value_in(&self, values: &Values) -> Option<f64> {
        values.get(self.key).copied().flatten()
    }

    /// Whether a row has a better value than another; not if either has none.
    pub(crate) fn is_better(&self, row: &Row, than: &Row) -> bool {
        let [own, other] = [row, than].map(|row| self.value_of(row));
        own.is_finite()
            && other.is_finite()
            && self.direction.badness(own) < self.direction.badness(other)
    }

    /// Which values are good, in words: "lower is better".
    pub fn better(&self) -> &'static str {
        match self.direction {
            Direction::Lower => "lower is better",
            Direction::Higher => "higher is better",
            Direction::NearerToOne => "nearer to 1 is better",
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use secateur_eval::{OriginalAsDrawn, OverFrames};

    fn measured(width_px: u32) -> AsDrawnMeasurement {
        let frames = OverFrames {
            frames: 16,
            coverage_over_truth: 1.0,
            truth_iou: 1.0,
            flip_mean: 0.0,
            flicker: 0.5,
            truth_flicker: 0.4,
        };
        AsDrawnMeasurement {
            width_px,
            coverage_over_truth: 1.0,
            original_coverage_over_truth: 1.1,
            silhouette_iou: 1.0,
            truth_iou: 1.0,
            specks_per_view: 0.0,
            original_specks_per_view: 0.0,
            flip_mean: f64::NAN,
            original_flip_mean: 0.2,
            original_truth_iou: 0.7,
            original_without_mips: OriginalAsDrawn {
                coverage_over_truth: 1.0,
                truth_iou: 0.6,
                specks_per_view: 0.0,
                flip_mean: 0.1,
            },
            over_frames: Some(frames),
            original_over_frames: Some(OverFrames {
                flicker: 0.3,
                ..frames
            }),
        }
    }

    #[test]
    fn every_width_as_drawn_has_its_columns() {
        let keys = DRAWN_WIDTHS_PX.map(|width_px| values_as_drawn(&measured(width_px)));
        let all: Vec<&str> = keys.iter().flatten().map(|(key, _)| key.as_str()).collect();
        assert_eq!(all, DRAWN_COLUMNS.map(|column| column.key));
        assert_eq!(keys[0][0].1, None, "rows hold finite numbers");
    }

    #[test]
    fn what_the_original_shows_is_known_by_the_keys_of_levels() {
        let originals = values_of_original(&DRAWN_WIDTHS_PX.map(measured));
        for (shown, expected) in originals
            .iter()
            .zip([[0.2, 0.7, 1.1, 0.3], [0.1, 0.6, 1.0, 0.4]])
        {
            assert_eq!(shown.len(), 4 * DRAWN_WIDTHS_PX.len());
            let keys = [
                "flip_as_drawn_128",
                "truth_iou_as_drawn_128",
                "coverage_as_drawn_128",
                "flicker_over_frames_128",
            ];
            let values = keys.map(|key| column(key).value_in(shown).unwrap());
            assert_eq!(values, expected);
            let near = column("flicker_over_frames_512").value_in(shown);
            assert_eq!(near, Some(expected[3]));
        }
        let in_a_frame = AsDrawnMeasurement {
            over_frames: None,
            original_over_frames: None,
            ..measured(512)
        };
        assert_eq!(values_as_drawn(&in_a_frame).len(), 4);
        for shown in values_of_original(&[in_a_frame]) {
            assert_eq!(shown.len(), 3);
        }
    }
}
