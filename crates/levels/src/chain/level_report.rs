//! The figures of a level, as records, tables, pages and `extras` have them.

use secateur_eval::Difference;
use secateur_model::Foliage;
use serde::{Serialize, Serializer};
use serde_json::{Map, Value, json};

use super::blend::BlendBand;
use super::level_as_drawn::LevelAsDrawn;
use super::textures::Textures;

/// The figures of a level. Infinite ones are written as `null`.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
pub struct LevelReport {
    /// Whether it is the plant itself, a mesh of fewer triangles, or a picture.
    pub kind: LevelKind,
    /// The difference between it and the level before where they switch, as `difference`; none for the first.
    pub pop: Option<f64>,
    /// Leaves that are left; 0 for impostors.
    pub leaves: u64,
    /// Triangles of the whole plant.
    pub triangles: u64,
    /// Triangles that leaves have in this level; 0 for impostors.
    pub foliage_triangles: u64,
    /// Triangles that wood has in this level; 0 for impostors.
    pub wood_triangles: u64,
    /// From how far off it is used, in metres: units of the file, unless the plant's height was given.
    pub distance: f64,
    /// How many pixels high the screen shows the plant's largest extent there; infinite at distance 0.
    #[cfg_attr(feature = "cli", schemars(with = "Option<f64>"))]
    pub pixels_high: f64,
    /// The least share of the screen's height at which it is drawn, before the next level takes
    /// over; 0 for the last.
    pub screen_coverage: f64,
    /// Where a client blends into the next level; none for the last.
    pub blend: Option<BlendBand>,
    /// How far it looks from the original there, with its own textures.
    #[serde(flatten)]
    pub difference: Difference,
    /// Mean FLIP of the whole plant against the original at that height, over the frame of `measure`.
    pub flip_mean: f64,
    /// Outline of the leaves against the original's, by three of the held-out views in 256 x 256
    /// pixels, without exact textures; none for impostors.
    pub silhouette_iou: Option<f64>,
    /// VMI error of the leaves by the same, in per cent; none for impostors.
    pub vmi_error_percent: Option<f64>,
    /// SHA-256 of all that was done to the leaves; none for impostors and files of several plants.
    pub order_sha256: Option<String>,
    /// From how many views its leaves were chosen; none for impostors.
    pub view_count: Option<usize>,
    /// Whether its textures were made for its distance or are those of the tree.
    #[serde(rename = "textures")]
    pub leaf_textures: Textures,
    /// Which colours clear texels of its textures have; none for impostors.
    #[serde(rename = "colors")]
    pub clear_texels: Option<ClearTexels>,
    /// What all images of its materials take, four bytes a texel, with mips where they are read.
    pub texture_bytes: u64,
    /// How much of it a client shows; none for octahedral views, which only their sampler shows.
    #[serde(flatten, serialize_with = "AsDrawn::serialize_of")]
    #[cfg_attr(feature = "cli", schemars(with = "AsDrawn"))]
    pub as_drawn: Option<LevelAsDrawn>,
    /// Layout and pictures of an impostor, and what it was chosen against.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub impostor: Option<ImpostorReport>,
}

/// What a level is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
#[serde(rename_all = "lowercase")]
pub enum LevelKind {
    /// The plant as its file has it, not simplified.
    Original,
    /// The plant with fewer triangles.
    #[default]
    Mesh,
    /// A picture of it.
    Impostor,
}

/// Which colours clear texels of a level's textures have.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
#[serde(rename_all = "lowercase")]
pub enum ClearTexels {
    /// Colours of the tree.
    Keep,
    /// Colours of the leaves near them.
    Dilate,
}

/// An impostor, and what it was chosen against.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
pub struct ImpostorReport {
    /// What samplers need to know: `layout`, and by it sizes of the atlas.
    #[serde(flatten)]
    pub facts: Map<String, Value>,
    /// Triangles of the mesh that would be drawn there if it were left out.
    pub mesh_triangles: u64,
    /// How far that mesh looks from the original by the judge of the impostor.
    pub mesh_difference: f64,
    /// Triangles of a mesh of as many triangles as the impostor has; none where the impostor is no lighter than the
    /// mesh above, or no such mesh can be made.
    pub same_cost_triangles: Option<u64>,
    /// How far that one looks from the original by the same judge.
    pub same_cost_difference: Option<f64>,
}

/// How a client draws a level, by the keys of records.
#[derive(Default, Serialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
struct AsDrawn {
    /// The number of `coverage_as_drawn` again, under the key that other records have for coverage.
    coverage_ratio: Option<f64>,
    /// Pixels that a client covers over those truly covered, from where the level begins to be seen.
    coverage_as_drawn: Option<f64>,
    /// What a client shows of it, over what there is, from where the next level takes over.
    coverage_as_drawn_at_end: Option<f64>,
    /// Islands of up to 3 pixels in a view, from where the level begins to be seen.
    specks_as_drawn: Option<f64>,
    /// Specks beyond those of the original, at the worse of the two distances.
    more_specks_as_drawn: Option<f64>,
}

impl AsDrawn {
    fn serialize_of<S: Serializer>(
        level: &Option<LevelAsDrawn>,
        serializer: S,
    ) -> Result<S::Ok, S::Error> {
        let keys = level.map_or_else(Self::default, |shown| Self {
            coverage_ratio: Some(shown.begin.coverage_over_truth),
            coverage_as_drawn: Some(shown.begin.coverage_over_truth),
            coverage_as_drawn_at_end: Some(shown.end.coverage_over_truth),
            specks_as_drawn: Some(shown.begin.specks_per_view),
            more_specks_as_drawn: Some(shown.more_specks_per_view),
        });
        keys.serialize(serializer)
    }
}

/// Keys that the `extras` of a level's node have of its report, where they are known.
const IN_EXTRAS: [&str; 9] = [
    "kind",
    "distance",
    "pixels_high",
    "screen_coverage",
    "triangles",
    "difference",
    "block_coverage",
    "pop",
    "order_sha256",
];

impl LevelReport {
    /// The plant itself, seen from distance 0 on.
    pub fn of_plant(leaves: &Foliage, wood_triangles: u64) -> Self {
        let foliage_triangles = leaves.triangles().len() as u64;
        Self {
            kind: LevelKind::Original,
            leaves: leaves.leaves().len() as u64,
            triangles: foliage_triangles + wood_triangles,
            foliage_triangles,
            wood_triangles,
            pixels_high: f64::INFINITY,
            silhouette_iou: Some(1.0),
            vmi_error_percent: Some(0.0),
            leaf_textures: Textures::Keep,
            ..Self::default()
        }
    }

    /// What the `extras` of its node say, in numbers of five digits: further ones differ between kinds of processors.
    /// `shadow` is the name of the node that casts its shadow.
    pub fn extras(&self, shadow: &str) -> Map<String, Value> {
        let report = json!(self);
        let mut extras = Map::new();
        for key in IN_EXTRAS {
            if key == "pop" {
                extras.insert("shadow".to_owned(), shadow.into());
            }
            if !report[key].is_null() {
                extras.insert(key.to_owned(), rounded(&report[key]));
            }
        }
        let blend = json!(self.blend);
        for (key, value) in blend.as_object().into_iter().flatten() {
            extras.insert(format!("blend_{key}"), rounded(value));
        }
        if let Some(impostor) = &self.impostor {
            let facts = impostor.facts.clone();
            extras.insert("impostor".to_owned(), facts.into());
        }
        extras
    }
}

/// A number with a fraction to five digits; everything else as it is.
fn rounded(value: &Value) -> Value {
    match value.as_f64().filter(|_| value.is_f64()) {
        Some(x) => format!("{x:.4e}")
            .parse()
            .map_or(Value::Null, |x: f64| x.into()),
        None => value.clone(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use secateur_eval::Shown;

    /// Logarithms and roots of other libraries differ behind the ninth digit: files do not.
    #[test]
    fn extras_have_five_digits() {
        let of = |difference: f64| {
            let difference = Difference {
                difference,
                ..Difference::default()
            };
            let report = LevelReport {
                difference,
                triangles: 1_234_567,
                ..LevelReport::default()
            };
            report.extras("oak_LOD1")
        };
        assert_eq!(of(0.220_287_389_878), of(0.220_287_389_697));
        assert_eq!(of(0.220_287_389_878)["difference"], 0.22029);
        assert_eq!(of(0.2)["triangles"], 1_234_567);
    }

    #[test]
    fn extras_have_what_is_known_of_a_level() {
        let mut report = LevelReport {
            pixels_high: f64::INFINITY,
            triangles: 7,
            ..LevelReport::default()
        };
        let keys = |report: &LevelReport| -> Vec<String> {
            report.extras("oak_LOD2").keys().cloned().collect()
        };
        let always = ["kind", "distance", "screen_coverage", "triangles"];
        let judged = ["difference", "block_coverage", "shadow"];
        assert_eq!(keys(&report), [&always[..], &judged].concat());
        assert_eq!(report.extras("oak_LOD2")["shadow"], "oak_LOD2");
        report.pixels_high = 540.0;
        report.pop = Some(0.1);
        report.blend = Some(BlendBand::before(20.0, 270.0));
        assert_eq!(keys(&report)[2], "pixels_high");
        assert_eq!(keys(&report)[8], "pop");
        let blend = ["begin", "end", "hysteresis", "begin_px", "end_px"];
        let blend = blend.map(|key| report.extras("oak_LOD2")[&format!("blend_{key}")].as_f64());
        let expected = [20.0, 22.0, 1.0, 270.0, 245.45].map(Some);
        assert_eq!(blend, expected);
    }

    /// Readers find every key, whether a client draws the level or not.
    #[test]
    fn a_figure_that_is_not_known_is_null() {
        let mut report = LevelReport::default();
        assert_eq!(json!(report)["coverage_ratio"], Value::Null);
        assert!(json!(report).get("coverage_ratio").is_some());
        let shown = Shown {
            coverage_over_truth: 0.9,
            specks_per_view: 3.0,
        };
        report.as_drawn = Some(LevelAsDrawn {
            begin: shown,
            end: shown,
            more_specks_per_view: 1.0,
        });
        assert_eq!(json!(report)["coverage_ratio"], 0.9);
        assert_eq!(json!(report)["more_specks_as_drawn"], 1.0);
    }
}
