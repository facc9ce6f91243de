//! The record of `secateur simplify`.

use std::path::Path;

use schemars::JsonSchema;
use secateur::{
    Alpha, Effort, Engine, FieldOfView, Inspection, LeafTriangles, LevelParts, LevelRecord,
    Needles, Objective, Plant, Preset, PrimitiveReport, Selector, Sides, TakenFor, Target, Views,
    WoodMode, Written,
};
use serde::Serialize;
use serde_json::{Map, Value, json};

use super::super::args;
use super::super::record::{self, Bytes, bytes_of, shown};
use super::super::surroundings::SurroundingsRecord;

/// A plant and a level of it.
#[derive(Serialize, JsonSchema)]
pub(crate) struct SimplifyRecord {
    /// Path of the plant's file as the call gives it.
    input: String,
    /// The files that were written, the one that was asked for first.
    output: Vec<String>,
    bytes: Bytes,
    #[serde(flatten)]
    level: LevelRecord,
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
    /// Selectors of what is not the plant that were given.
    not_plant: Vec<String>,
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
    pub(crate) record: LevelRecord,
    /// How many of the driving views are among those that `measure` judges by.
    pub(crate) views_that_judge: usize,
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
        SimplifyRecord {
            input: self.input.display().to_string(),
            output: shown(&self.written.files),
            bytes: Bytes {
                original: bytes_of(self.input),
                written: self.written.bytes,
            },
            level: self.record.clone(),
            settings: self.settings(args),
            foliage: foliage(self.plant.inspection()),
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
            views_that_judge: self.views_that_judge,
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
            foliage: texts(&args.foliage.foliage),
            not_plant: texts(&args.not_plant.not_plant),
            level_of: args.level_of.iter().map(|l| l.to_string()).collect(),
            surroundings: args.scene.record(self.plant.surroundings()),
            of_method: of_method
                .and_then(Value::as_object)
                .cloned()
                .unwrap_or_default(),
        }
    }
}

fn texts(selectors: &[Selector]) -> Vec<String> {
    selectors.iter().map(ToString::to_string).collect()
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
