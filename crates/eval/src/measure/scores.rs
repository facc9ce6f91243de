//! What a measurement found.

use serde::ser::{Serialize, SerializeMap, Serializer};

use super::{
    COVERAGE_RATIO, METRICS, Metric, PRECISION, RECALL, SILHOUETTE_IOU, SeenView, VMI_ERROR_PERCENT,
};

/// A value for each of [`METRICS`]. Serialises as a map from their keys;
/// infinite values, which JSON doesn't know, become null there.
#[derive(Clone, Debug, PartialEq)]
pub struct Scores(Vec<f64>);

impl Scores {
    fn of(views: &[SeenView]) -> Self {
        Self(METRICS.iter().map(|metric| (metric.of)(views)).collect())
    }

    /// The worst of each metric.
    fn worst(per_view: &[Scores]) -> Self {
        let worst_of = |(index, metric): (usize, &Metric)| {
            let badness = |value: &f64| metric.direction.badness(*value);
            let values = per_view.iter().map(|scores| scores.0[index]);
            let worst = values.max_by(|a, b| badness(a).total_cmp(&badness(b)));
            worst.expect("at least one view was judged")
        };
        Self(METRICS.iter().enumerate().map(worst_of).collect())
    }

    /// The value of the metric with this key, if there is such a metric.
    pub fn get(&self, key: &str) -> Option<f64> {
        self.iter()
            .find_map(|(metric, value)| (metric.key == key).then_some(value))
    }

    /// Every metric with its value, in the order of [`METRICS`].
    pub fn iter(&self) -> impl Iterator<Item = (&'static Metric, f64)> + '_ {
        METRICS.iter().zip(self.0.iter().copied())
    }
}

impl Serialize for Scores {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(Some(METRICS.len()))?;
        for (metric, value) in self.iter() {
            map.serialize_entry(metric.key, &value)?;
        }
        map.end()
    }
}

/// How far a simplified foliage is from its original. Serialises with the
/// overall scores at the top level.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct Measurement {
    /// The metrics over all views together.
    #[serde(flatten)]
    pub overall: Scores,
    /// The worst view's value of each metric (not always the same view's).
    pub worst: Scores,
    /// Of each view alone, in the order of the view set.
    pub per_view: Vec<Scores>,
    /// How many views were judged.
    pub views: usize,
    /// Image width and height in pixels.
    pub resolution: u32,
}

impl Measurement {
    pub(super) fn of(seen: &[SeenView], resolution: u32) -> Self {
        let alone = |view: &SeenView| Scores::of(std::slice::from_ref(view));
        let per_view: Vec<Scores> = seen.iter().map(alone).collect();
        Self {
            overall: Scores::of(seen),
            worst: Scores::worst(&per_view),
            per_view,
            views: seen.len(),
            resolution,
        }
    }

    /// [`VMI_ERROR_PERCENT`] over all views.
    pub fn vmi_error_percent(&self) -> f64 {
        self.value(&VMI_ERROR_PERCENT)
    }

    /// [`SILHOUETTE_IOU`], mean over the views.
    pub fn silhouette_iou(&self) -> f64 {
        self.value(&SILHOUETTE_IOU)
    }

    /// [`PRECISION`], mean over the views.
    pub fn precision(&self) -> f64 {
        self.value(&PRECISION)
    }

    /// [`RECALL`], mean over the views.
    pub fn recall(&self) -> f64 {
        self.value(&RECALL)
    }

    /// [`COVERAGE_RATIO`], mean over the views.
    pub fn coverage_ratio(&self) -> f64 {
        self.value(&COVERAGE_RATIO)
    }

    fn value(&self, metric: &Metric) -> f64 {
        self.overall.get(metric.key).expect("it is one of METRICS")
    }
}
