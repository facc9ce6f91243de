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
    fn worst<'s>(several: impl Iterator<Item = &'s Self> + Clone) -> Self {
        let worst_of = |(index, metric): (usize, &Metric)| {
            let badness = |value: &f64| metric.direction.badness(*value);
            let values = several.clone().map(|scores| scores.0[index]);
            let worst = values.max_by(|a, b| badness(a).total_cmp(&badness(b)));
            worst.expect("at least one view was judged")
        };
        Self(METRICS.iter().enumerate().map(worst_of).collect())
    }

    /// The mean of each metric.
    fn mean<'s>(several: impl ExactSizeIterator<Item = &'s Self> + Clone) -> Self {
        let mean_of = |index: usize| {
            let values = several.clone().map(|scores| scores.0[index]);
            values.sum::<f64>() / several.len() as f64
        };
        Self((0..METRICS.len()).map(mean_of).collect())
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

#[cfg(feature = "cli")]
impl schemars::JsonSchema for Scores {
    fn schema_name() -> std::borrow::Cow<'static, str> {
        "Scores".into()
    }

    fn json_schema(_: &mut schemars::SchemaGenerator) -> schemars::Schema {
        crate::schema::of_metrics(METRICS.iter().map(|m| (m.key, m.title, m.unit)))
    }
}

/// How far a simplified foliage is from its original by one set of views. Serialises with the
/// overall scores at the top level.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct RigMeasurement {
    /// The metrics over all views of the set together.
    #[serde(flatten)]
    pub overall: Scores,
    /// The worst view's value of each metric (not always the same view's).
    pub worst: Scores,
    /// Of each view alone, in the order of the view set.
    pub per_view: Vec<Scores>,
}

/// How far a simplified foliage is from its original. Serialises with the
/// overall scores at the top level.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct Measurement {
    /// The mean over the sets of views.
    #[serde(flatten)]
    pub overall: Scores,
    /// The worst set's value of each metric (not always the same set's); of one set alone its
    /// worst view's.
    pub worst: Scores,
    /// Of each view alone, set by set.
    pub per_view: Vec<Scores>,
    /// How many views were judged, of all sets.
    pub views: usize,
    /// Image width and height in pixels.
    pub resolution: u32,
    /// Each set by itself.
    pub rigs: Vec<RigMeasurement>,
}

impl RigMeasurement {
    fn of(seen: &[SeenView]) -> Self {
        let alone = |view: &SeenView| Scores::of(std::slice::from_ref(view));
        let per_view: Vec<Scores> = seen.iter().map(alone).collect();
        Self {
            overall: Scores::of(seen),
            worst: Scores::worst(per_view.iter()),
            per_view,
        }
    }
}

impl Measurement {
    /// Of what the views of each set have seen.
    pub(super) fn of(seen: &[Vec<SeenView>], resolution: u32) -> Self {
        let rigs: Vec<RigMeasurement> = seen.iter().map(|seen| RigMeasurement::of(seen)).collect();
        let per_view: Vec<Scores> = (rigs.iter())
            .flat_map(|rig| rig.per_view.iter().cloned())
            .collect();
        Self {
            overall: Scores::mean(rigs.iter().map(|rig| &rig.overall)),
            worst: match &rigs[..] {
                [alone] => alone.worst.clone(),
                rigs => Scores::worst(rigs.iter().map(|rig| &rig.overall)),
            },
            views: per_view.len(),
            per_view,
            resolution,
            rigs,
        }
    }

    /// [`VMI_ERROR_PERCENT`], mean over the sets of views.
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
