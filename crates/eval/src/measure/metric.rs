//! The metrics, a row each.

use secateur_raster::measure::vmi;

use super::SeenView;

/// Which values of a metric are the good ones.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Direction {
    /// Lower is better.
    Lower,
    /// Higher is better.
    Higher,
    /// Nearer to 1 is better.
    NearerToOne,
}

impl Direction {
    /// How bad a value is, only to be compared with others of its metric.
    pub fn badness(self, value: f64) -> f64 {
        match self {
            Self::Lower => value,
            Self::Higher => -value,
            Self::NearerToOne => (value - 1.0).abs(),
        }
    }
}

/// A number that says how far a simplified foliage is from its original.
#[derive(Clone, Copy, Debug)]
pub struct Metric {
    /// Its name in reports.
    pub key: &'static str,
    /// Its name for readers.
    pub title: &'static str,
    /// The unit of its values; empty for a ratio.
    pub unit: &'static str,
    /// Which values are good.
    pub direction: Direction,
    /// Its value over these views, or of one, where there is only one.
    pub of: fn(&[SeenView]) -> f64,
}

/// All metrics, in the order of reports. A new one is one more entry.
pub const METRICS: &[Metric] = &[
    VMI_ERROR_PERCENT,
    SILHOUETTE_IOU,
    PRECISION,
    RECALL,
    COVERAGE_RATIO,
];

/// `100 * sum_v |I(v;F) - I(v;F')| / |sum_v I(v;F)|` (Entropy 2018, 20, 213,
/// section 4.2). 0 or more; infinite where the original is without information
/// and the simplified foliage is not.
pub const VMI_ERROR_PERCENT: Metric = Metric {
    key: "vmi_error_percent",
    title: "VMI error",
    unit: "%",
    direction: Direction::Lower,
    of: |views| {
        let deviation = |v: &SeenView| (v.original_vmi_scaled - v.simplified_vmi_scaled).abs();
        vmi::error_percent(
            views.iter().map(deviation).sum(),
            views.iter().map(|v| v.original_vmi_scaled).sum(),
        )
    },
};

/// Mean of `|A and B| / |A or B|` over the views, A and B the foliage pixels of
/// the original and of the simplified foliage. 0 to 1.
pub const SILHOUETTE_IOU: Metric = Metric {
    key: "silhouette_iou",
    title: "Silhouette IoU",
    unit: "",
    direction: Direction::Higher,
    of: |views| {
        mean(views, |v| {
            let either_px = v.original_px + v.simplified_px - v.shared_px;
            share(v.shared_px, either_px)
        })
    },
};

/// Mean of `|A and B| / |B|`: how much of what is drawn belongs there (Neubert
/// et al. 2011). 0 to 1.
pub const PRECISION: Metric = Metric {
    key: "precision",
    title: "Precision",
    unit: "",
    direction: Direction::Higher,
    of: |views| mean(views, |v| share(v.shared_px, v.simplified_px)),
};

/// Mean of `|A and B| / |A|`: how much of what belongs there is drawn (Neubert
/// et al. 2011). 0 to 1.
pub const RECALL: Metric = Metric {
    key: "recall",
    title: "Recall",
    unit: "",
    direction: Direction::Higher,
    of: |views| mean(views, |v| share(v.shared_px, v.original_px)),
};

/// Mean of `|B| / |A|`: 1 where as many pixels are foliage as were. 0 or more;
/// infinite where leaves appear in a view that had none.
pub const COVERAGE_RATIO: Metric = Metric {
    key: "coverage_ratio",
    title: "Coverage",
    unit: "",
    direction: Direction::NearerToOne,
    of: |views| mean(views, |v| share(v.simplified_px, v.original_px)),
};

fn mean(views: &[SeenView], of_view: impl Fn(&SeenView) -> f64) -> f64 {
    views.iter().map(of_view).sum::<f64>() / views.len() as f64
}

/// Part of whole; nothing of nothing is all of it.
fn share(part_px: u32, whole_px: u32) -> f64 {
    if whole_px == 0 && part_px == 0 {
        1.0
    } else {
        f64::from(part_px) / f64::from(whole_px)
    }
}
