//! The record of `secateur simplify`.

use std::path::Path;

use schemars::JsonSchema;
use secateur::chain::LevelReport;
use secateur::{
    Alpha, AreaTable, Effort, Engine, FieldOfView, Inspection, Judging, LeafTriangles, LevelParts,
    Needles, Objective, Plant, Preset, PrimitiveReport, Sides, TakenFor, Target, Views, Vmi,
    WoodMode, Written,
};
use serde::Serialize;
use serde_json::{Map, Value, json};

use super::args;
use super::colors::ColorRecord;
use super::cutoffs::CutoffsRecord;
use super::record::{self, Bytes, Counts, bytes_of, shown};
use super::surroundings::SurroundingsRecord;

/// A plant and a level of it.
#[derive(Serialize, JsonSchema)]
pub(crate) struct SimplifyRecord {
    /// The plant's file.
    input: String,
    /// The files that were written, the one that was asked for first.
    output: Vec<String>,
    bytes: Bytes,
    leaves: Counts,
    /// Triangles of the whole plant.
    triangles: Counts,
    /// Triangles of leaves.
    foliage_triangles: Counts,
    /// Triangles of wood.
    wood_triangles: Counts,
    /// The method as `--method` spells it.
    method: &'static str,
    /// Where leaves were drawn: `cpu` or `gpu`.
    engine: &'static str,
    /// The GPU and its driver; none on the CPU.
    adapter: Option<String>,
    /// SHA-256 of all that was done to the leaves.
    order_sha256: String,
    /// SHA-256 of the pixels of each leaf in each view; none of methods that see none.
    areas_sha256: Option<String>,
    /// The largest area of a leaf as a multiple of its original one.
    max_area_scale: f64,
    /// VMI of what is left in each driving view, in bits.
    vmi_bits: Option<Vec<f64>>,
    /// VMI of the original in each driving view, in bits.
    vmi_bits_original: Vec<f64>,
    /// VMI error in the driving views, in per cent.
    driving_vmi_error_percent: Option<f64>,
    /// Why it stopped.
    stopped: &'static str,
    /// Alpha cutoffs that were chosen; none where all stay.
    cutoffs: Option<CutoffsRecord>,
    /// Textures with other colours in clear texels; none where all stay.
    colors: Option<Vec<ColorRecord>>,
    /// What drew the result again with the same areas.
    audit: Option<&'static str>,
    settings: Settings,
    /// What was taken for foliage, and why.
    foliage: Vec<PrimitiveReport>,
    /// What has to be said of the result, a sentence each.
    warnings: Vec<String>,
    /// What of the written file is not as one might expect, a sentence each.
    notes: Vec<String>,
}

/// How it was asked for, and what was decided meanwhile.
#[derive(Serialize, JsonSchema)]
struct Settings {
    /// The driving views by their name, or the file of cameras.
    views: String,
    views_reason: Option<String>,
    view_count: usize,
    /// How many of the driving views are among those that `measure` judges by.
    views_that_judge: usize,
    #[schemars(with = "String")]
    field_of_view: FieldOfView,
    /// Width and height of images in pixels.
    resolution: u32,
    resolution_reason: String,
    preset: Preset,
    effort: Effort,
    target: Target,
    wood: WoodMode,
    #[schemars(with = "String")]
    leaf_triangles: LeafTriangles,
    needles: Needles,
    /// `coverage`, or the weight of the outline; none where sizes stay.
    fit: Option<Value>,
    alpha: Alpha,
    sides: Sides,
    engine: Engine,
    seed: u64,
    /// Selectors of foliage that were given.
    foliage: Vec<String>,
    /// Levels of parts that were given, such as `material:bark=0.1`.
    level_of: Vec<String>,
    #[serde(flatten)]
    surroundings: SurroundingsRecord,
    /// Options of the method, as the library spells them.
    #[serde(flatten)]
    of_method: Map<String, Value>,
}

/// A result and all that went into it.
pub(crate) struct Simplifying<'a> {
    pub(crate) input: &'a Path,
    pub(crate) plant: &'a Plant,
    pub(crate) level: &'a LevelParts,
    /// The figures of plant and level.
    pub(crate) reports: [LevelReport; 2],
    pub(crate) written: &'a Written,
    pub(crate) warnings: &'a [String],
}

impl Simplifying<'_> {
    /// What is to be said of the plant and of the files.
    pub(crate) fn notes(&self) -> Vec<String> {
        record::notes(self.plant, self.written.notes.iter())
    }

    /// What the record says.
    pub(crate) fn record(&self, args: &args::Simplify) -> SimplifyRecord {
        let (plant, level, written) = (self.plant, self.level, self.written);
        let result = &level.simplified;
        let [before, after] = &self.reports;
        let counts = |of: fn(&LevelReport) -> u64| Counts::of(of(before), of(after));
        let colors = level.colors.iter().map(ColorRecord::from);
        SimplifyRecord {
            input: self.input.display().to_string(),
            output: shown(&written.files),
            bytes: Bytes {
                original: bytes_of(self.input),
                written: written.bytes,
            },
            leaves: counts(|of| of.leaves),
            triangles: counts(|of| of.triangles),
            foliage_triangles: counts(|of| of.foliage_triangles),
            wood_triangles: counts(|of| of.wood_triangles),
            method: level.options.method.name(),
            engine: result.engine,
            adapter: result.adapter.clone(),
            order_sha256: after.order_sha256.clone().unwrap_or_default(),
            areas_sha256: result.areas.as_ref().map(AreaTable::sha256),
            max_area_scale: result.passes.max_area_scale(),
            vmi_bits: result.vmi_final.as_ref().map(Vmi::bits),
            vmi_bits_original: result.vmi_original.bits(),
            driving_vmi_error_percent: result.driving_error_percent(),
            stopped: result.stopped.name(),
            cutoffs: level.cutoffs.as_ref().map(CutoffsRecord::from),
            colors: (!level.colors.is_empty()).then(|| colors.collect()),
            audit: result.audited_by,
            settings: self.settings(args),
            foliage: foliage(plant.inspection()),
            warnings: self.warnings.to_vec(),
            notes: self.notes(),
        }
    }

    fn settings(&self, args: &args::Simplify) -> Settings {
        let (result, options) = (&self.level.simplified, &self.level.options);
        let method = json!(options.method);
        let of_method = method.as_object().and_then(|named| named.values().next());
        Settings {
            views: match options.views {
                Views::Cameras(_) => args.views.clone().unwrap_or_else(|| "scene".to_owned()),
                _ => result.driven_by.name().to_owned(),
            },
            views_reason: result.views_reason.clone(),
            view_count: result.views.len(),
            views_that_judge: self.driving_views_that_judge(),
            field_of_view: options.field_of_view(),
            resolution: result.resolution,
            resolution_reason: result.resolution_reason.clone(),
            preset: options.preset,
            effort: options.effort,
            target: options.target,
            wood: self.plant.wood_mode(),
            leaf_triangles: options.leaf_triangles,
            needles: options.needles,
            fit: options.objective().map(|objective| match objective {
                Objective::Information { outline_weight } => json!(outline_weight),
                Objective::Coverage => json!("coverage"),
            }),
            alpha: options.alpha,
            sides: options.sides,
            engine: options.engine,
            seed: args.stochastic.seed,
            foliage: args.foliage.foliage.iter().map(|s| s.to_string()).collect(),
            level_of: args.level_of.iter().map(|l| l.to_string()).collect(),
            surroundings: args.scene.record(self.plant.surroundings()),
            of_method: of_method
                .and_then(Value::as_object)
                .cloned()
                .unwrap_or_default(),
        }
    }

    /// How many of the views that leaves were chosen or sized from are held-out views, by which
    /// `measure` judges.
    pub(crate) fn driving_views_that_judge(&self) -> usize {
        let options = &self.level.options;
        let is_driven = options.method.vds().is_some() || options.objective().is_some();
        let foliage = self.plant.leaves();
        let about = (foliage.bounding_sphere(), Judging::held_out(foliage));
        let (Some(sphere), Ok(judging)) = about else {
            return 0;
        };
        let sets = self.level.simplified.driving(options, sphere);
        let counts = (sets.iter()).map(|set| judging.views_that_judge(set, sphere.centre));
        if is_driven { counts.sum() } else { 0 }
    }
}

/// What was taken for foliage, and why.
fn foliage(inspection: &Inspection) -> Vec<PrimitiveReport> {
    let is_taken =
        |p: &&PrimitiveReport| matches!(p.taken_for, TakenFor::Foliage | TakenFor::FoliageInPart);
    inspection
        .primitives
        .iter()
        .filter(is_taken)
        .cloned()
        .collect()
}
