//! One level of detail of a plant: what is left, what changes in its materials, and how it looks.

use std::ops::Deref;
use std::path::Path;

use secateur_eval::{Difference, DifferenceJudge, ViewCount};
use secateur_gltf::{
    Cutoffs, Detail, DrawnSurface, GltfError, PreparedLod, Tree, WholeTree, WriteOptions, Written,
};
use secateur_levels::chain::{LevelKind, LevelReport, filled_charts};
use secateur_levels::{ChosenCutoffs, Dilated, choose_cutoffs, dilated_textures, material_changes};
use secateur_model::{Budget, Foliage, Lod, Memory, Surface};
use secateur_raster::OpenEngine;
use secateur_runtime::Screen;
use secateur_simplify::whole::{
    Budget as TriangleBudget, Sharing, WholeLevel, WholePlant, WoodMode, simplify_keeping_wood,
};
use secateur_simplify::{
    Amount, Error as SimplifyError, Observer, Options, Progress, Shared, Simplified, Target,
    check_run, simplify_on, take_plant,
};
use web_time::Instant;

use crate::Error;
use crate::Session;
use crate::level_options::{ColorChoice, LevelOptions};
use crate::level_warning::LevelWarning;
use crate::opened_plant::{Parts, Plant};
use crate::part_levels::{PartLevel, Parted};

/// The height on the screen, in pixels, at which a level is looked at for whether it is the plant still: what is
/// coarse so small is so at any size.
const LOOKED_AT_PX: f64 = 128.0;

/// The height at which the nearest of several ways to share triangles is chosen: that of `measure`.
const CHOSEN_AT_PX: f64 = 540.0;

/// The stage in which wood is looked at and simplified, and triangles are shared between it and the leaves: all that a
/// level takes beside its run over the leaves.
const WOOD: &str = "wood";

/// All that makes up a level.
#[derive(Clone, Debug)]
pub struct LevelParts {
    /// How it was made: options with what plant, surroundings and session had of what they lacked.
    pub options: Options,
    /// The run over the leaves; where parts have levels of their own, over those of the part with the most, but all that
    /// is left.
    pub simplified: Simplified,
    /// What is left of all that [`Plant::tree`] can change.
    pub lod: Lod,
    /// Triangles of wood that are left.
    pub wood_triangles: u64,
    /// Other alpha cutoffs, if any were chosen.
    pub cutoffs: Option<ChosenCutoffs>,
    /// Textures with other colours where leaves are clear, and beside the charts of wood.
    pub colors: Vec<Dilated>,
    /// How far it looks from the plant 128 pixels high, if that is known.
    pub difference: Option<Difference>,
    /// What has to be said of it.
    pub warnings: Vec<LevelWarning>,
    /// How long its stages took beside those of the run, in seconds.
    pub seconds: Vec<(&'static str, f64)>,
}

impl LevelParts {
    /// All that changes in its materials.
    pub fn material_changes(&self) -> Cutoffs {
        material_changes(self.cutoffs.as_ref(), &self.colors)
    }
}

/// A level of a plant. It is written with the material changes that belong to it.
#[derive(Clone, Debug)]
pub struct Level {
    plant: Plant,
    parts: LevelParts,
}

impl Deref for Level {
    type Target = LevelParts;

    fn deref(&self) -> &LevelParts {
        &self.parts
    }
}

impl Level {
    /// The plant that it is of.
    pub fn plant(&self) -> &Plant {
        &self.plant
    }

    /// Its figures. The distance and the height in pixels are those from which it was looked at for its difference, on
    /// the usual [`Screen`]; what was not measured is 0 or none.
    pub fn report(&self) -> LevelReport {
        let run = &self.parts.simplified;
        let left = run.lod.foliage(self.plant.leaves());
        let foliage_triangles = left.triangles().len() as u64;
        let extents = self.plant.inspection().extents;
        let size = extents.map_or(0.0, |[low, high]| {
            (0..3).map(|k| high[k] - low[k]).fold(0.0, f64::max)
        });
        LevelReport {
            kind: LevelKind::Mesh,
            leaves: left.leaves().len() as u64,
            triangles: foliage_triangles + self.parts.wood_triangles,
            foliage_triangles,
            wood_triangles: self.parts.wood_triangles,
            distance: Screen::default().distance(size, LOOKED_AT_PX),
            pixels_high: LOOKED_AT_PX,
            difference: self.parts.difference.unwrap_or_default(),
            order_sha256: Some(run.passes.in_one_order().sha256()),
            view_count: Some(run.views.len()),
            ..LevelReport::default()
        }
    }

    /// The level as a GLB: what `secateur simplify` writes.
    ///
    /// # Errors
    /// [`GltfError`] if a part of the file that was not needed so far is damaged, or the result is beyond 4 GiB.
    pub fn to_bytes(&self) -> Result<Vec<u8>, GltfError> {
        let changes = self.parts.material_changes();
        self.plant
            .tree()
            .lod_to_bytes_with(&self.parts.lod, &changes)
    }

    /// Writes the level to a file whose name ends in .glb or .gltf.
    ///
    /// # Errors
    /// As [`prepare`](Self::prepare), or [`GltfError`] if a file can't get its name.
    pub fn write(&self, path: impl AsRef<Path>) -> Result<Written, GltfError> {
        self.prepare(path.as_ref(), WriteOptions::default())?
            .commit()
    }

    /// Writes the level under temporary names: a failure before the files get theirs leaves nothing.
    ///
    /// # Errors
    /// [`GltfError`] as [`to_bytes`](Self::to_bytes), or if the file can't be written there.
    pub fn prepare(&self, path: &Path, options: WriteOptions) -> Result<PreparedLod, GltfError> {
        let changes = self.parts.material_changes();
        let tree = self.plant.tree();
        tree.prepare_lod_with(&self.parts.lod, &changes, path, options)
    }

    /// The level without its plant.
    pub fn into_parts(self) -> LevelParts {
        self.parts
    }
}

impl Plant {
    /// Makes the level that the options ask for, with its material changes, and looks at it.
    ///
    /// # Errors
    /// [`Error::Simplify`] if the plant can't be simplified as asked.
    pub fn level(&self, options: &LevelOptions) -> Result<Level, Error> {
        self.level_in(&Session::default(), options)
    }

    /// As [`level`](Self::level), in a session.
    ///
    /// # Errors
    /// As [`level`](Self::level), or [`SimplifyError::Stopped`] if the session was cancelled.
    pub fn level_in(&self, session: &Session, options: &LevelOptions) -> Result<Level, Error> {
        session.watched(|observer| self.level_on(session, options, observer))
    }

    /// As [`level`](Self::level), with an observer that may borrow and may break it off.
    ///
    /// # Errors
    /// As [`level`](Self::level), or [`SimplifyError::Stopped`] if it was broken off.
    pub fn level_watched(
        &self,
        options: &LevelOptions,
        observer: &mut Observer<'_>,
    ) -> Result<Level, Error> {
        self.level_on(&Session::default(), options, observer)
    }

    fn level_on(
        &self,
        session: &Session,
        options: &LevelOptions,
        observer: &mut Observer<'_>,
    ) -> Result<Level, Error> {
        let simplify = self.completed(session, &options.simplify)?;
        let engine = session.engine(simplify.engine)?;
        let start = Instant::now();
        let mut parts = match &options.level_of[..] {
            [] => self.simplified(simplify, &engine, observer)?,
            levels => self.parted(simplify, levels, &engine, observer)?,
        };
        let of_run: f64 = parts.simplified.seconds.iter().map(|(_, took)| took).sum();
        let beside = start.elapsed().as_secs_f64() - of_run;
        parts.seconds.push((WOOD, beside.max(0.0)));
        let tree = self.tree();
        parts.timed("cutoffs", observer, |parts| {
            parts.choose_cutoffs(tree, options);
        })?;
        parts.timed("colors", observer, |parts| {
            parts.choose_colors(tree, options);
        })?;
        let has_other_wood = !matches!(self.wood_mode(), WoodMode::Keep | WoodMode::Ignore);
        let fills = has_other_wood && options.colors != ColorChoice::Keep;
        if options.judged || fills {
            parts.timed("difference", observer, |parts| {
                parts.look(tree, options.judged, fills);
            })?;
        }
        Ok(Level {
            plant: self.clone(),
            parts,
        })
    }

    /// Options with what plant, surroundings and session have of what they lack.
    fn completed(&self, session: &Session, options: &Options) -> Result<Options, Error> {
        let mut options = options.clone();
        self.surroundings().apply(&mut options);
        if options.memory == Memory::Auto {
            let left = match session.memory() {
                Memory::Auto => self.tree().memory_left(),
                own => own,
            };
            options.memory = self.surroundings().left_of(left);
        }
        if let Parts::Whole(tree, mode) = self.parts()
            && *mode != WoodMode::Keep
        {
            let mut budget = Budget::new(options.memory);
            take_plant(&mut budget, tree.leaves(), tree.wood()).map_err(SimplifyError::from)?;
            check_run(&budget, tree.leaves(), &options).map_err(SimplifyError::from)?;
            options.memory = budget.memory();
        }
        if options.method.needs_skeleton() && options.skeleton.is_none() {
            options.skeleton = self.skeleton()?;
        }
        Ok(options)
    }

    /// What is left of leaves and wood.
    fn simplified(
        &self,
        options: Options,
        engine: &OpenEngine,
        observer: &mut Observer<'_>,
    ) -> Result<LevelParts, Error> {
        let (tree, mode) = match self.parts() {
            Parts::Leaves(tree) => return Ok(simplified_leaves(tree, options, engine, observer)?),
            Parts::Whole(tree, mode) => (tree, *mode),
        };
        let level = whole_level(tree, mode, &options, engine, observer)?;
        let (leaves, wood) = (tree.leaves(), tree.wood());
        let left = level.leaves.lod.foliage(leaves).triangles().len() + level.wood_triangles;
        let there = leaves.triangles().len() + wood.triangles().len();
        options.check_met(left, there)?;
        let lod = tree.joined(&level.leaves.lod, &level.wood);
        let wood_triangles = level.wood_triangles as u64;
        Ok(LevelParts::of(options, level.leaves, (lod, wood_triangles)))
    }
}

impl Plant {
    /// What is left where parts have levels of their own.
    fn parted(
        &self,
        options: Options,
        levels: &[PartLevel],
        engine: &OpenEngine,
        observer: &mut Observer<'_>,
    ) -> Result<LevelParts, Error> {
        let no_wood = Foliage::default();
        let parted = Parted {
            all: [
                self.leaves(),
                self.whole().map_or(&no_wood, WholeTree::wood),
            ],
            tree: self.tree(),
            mode: self.wood_mode(),
            options: &options,
            engine,
        };
        let level = parted.level(levels, observer)?;
        let left = match self.whole() {
            Some(tree) => {
                let lod = tree.joined(&level.leaves.lod, &level.wood);
                (lod, level.wood_triangles as u64)
            }
            None => (level.leaves.lod.clone(), self.wood_triangle_count()),
        };
        Ok(LevelParts::of(options, level.leaves, left))
    }
}

/// A level of leaves and wood: of as many ways to share triangles as the effort and the plant have, the one that looks
/// nearest.
fn whole_level(
    tree: &WholeTree,
    mode: WoodMode,
    options: &Options,
    engine: &OpenEngine,
    observer: &mut Observer<'_>,
) -> Result<WholeLevel, Error> {
    let (leaves, wood) = (tree.leaves(), tree.wood());
    if mode == WoodMode::Keep {
        return Ok(simplify_keeping_wood(
            leaves, wood, options, engine, observer,
        )?);
    }
    let items = tree.items().foliage();
    let plant = WholePlant::within(items, leaves, wood, options, engine)?;
    let mut nearest = plant.simplified(options, engine, observer);
    let Target::Triangles(amount) = options.target else {
        return Ok(nearest?);
    };
    let triangles = amount.of(plant.triangle_count());
    let mut shared = Shared::default();
    let sharings = plant.sharings(options.effort.work().sharings_of_one);
    for sharing in sharings.into_iter().filter(|it| *it != Sharing::ByNumber) {
        let budget = TriangleBudget { triangles, sharing };
        let other = plant.level(budget, options, engine, Some(&mut shared), observer)?;
        let of_leaves = other.leaves.lod.foliage(leaves).triangles().len();
        let left = of_leaves + other.wood_triangles;
        if options.check_met(left, plant.triangle_count()).is_err() {
            continue;
        }
        nearest = match nearest {
            Ok(nearest) => Ok(nearer_of(tree, [nearest, other])?),
            Err(SimplifyError::BudgetNotMet { .. }) => Ok(other),
            Err(error) => return Err(error.into()),
        };
    }
    Ok(nearest?)
}

/// Of two levels the one that looks nearer to the tree.
fn nearer_of(tree: &WholeTree, [first, second]: [WholeLevel; 2]) -> Result<WholeLevel, Error> {
    let over = |level: &WholeLevel| -> Result<f64, Error> {
        let lod = tree.joined(&level.leaves.lod, &level.wood);
        let [plant, level] = drawn(tree.items(), &lod)?;
        Ok(difference_of(plant, level, CHOSEN_AT_PX).difference)
    };
    Ok(match over(&second)? < over(&first)? {
        true => second,
        false => first,
    })
}

fn simplified_leaves(
    tree: &Tree,
    options: Options,
    engine: &OpenEngine,
    observer: &mut Observer<'_>,
) -> Result<LevelParts, SimplifyError> {
    let result = simplify_on(engine, tree.foliage(), &options, observer)?;
    let left = result.lod.foliage(tree.foliage()).triangles().len();
    // Wood is a plant without leaves.
    let is_bare = left == 0 && tree.wood_triangle_count() > 0;
    if !(is_bare && asks_for_none(options.target)) {
        options.check_met(left, tree.foliage().triangles().len())?;
    }
    let left = (result.lod.clone(), tree.wood_triangle_count());
    Ok(LevelParts::of(options, result, left))
}

/// Whether no triangle is to be left of what is counted.
fn asks_for_none(target: Target) -> bool {
    match target {
        Target::Triangles(Amount::Count(count)) => count == 0,
        Target::Triangles(Amount::Share(share)) => share == 0.0,
        Target::Leaves(_) | Target::MaxErrorPercent(_) => false,
    }
}

impl LevelParts {
    /// Before anything is known but what is left.
    fn of(options: Options, simplified: Simplified, (lod, wood_triangles): (Lod, u64)) -> Self {
        let warnings = simplified.warnings.iter().cloned().map(LevelWarning::Run);
        Self {
            warnings: warnings.collect(),
            options,
            simplified,
            lod,
            wood_triangles,
            cutoffs: None,
            colors: Vec::new(),
            difference: None,
            seconds: Vec::new(),
        }
    }

    /// Does a stage and notes how long it took, unless the observer breaks it off.
    fn timed(
        &mut self,
        name: &'static str,
        observer: &mut Observer<'_>,
        stage: impl FnOnce(&mut Self),
    ) -> Result<(), SimplifyError> {
        if observer(Progress::Finish).is_break() {
            return Err(SimplifyError::Stopped);
        }
        let start = Instant::now();
        stage(self);
        self.seconds.push((name, start.elapsed().as_secs_f64()));
        Ok(())
    }

    /// Chooses the cutoffs of a level that needs others than those of the plant. What can't be drawn keeps its own.
    fn choose_cutoffs(&mut self, tree: &Tree, options: &LevelOptions) {
        let Some(change) = options.change() else {
            return;
        };
        match choose_cutoffs(tree, &self.lod, change) {
            Ok(chosen) => self.cutoffs = chosen,
            Err(error) => {
                let why = LevelWarning::CutoffsStay(error.to_string());
                self.warnings.push(why);
            }
        }
    }

    /// Chooses the colours of clear texels, unless the level is the plant. Where an image can't be read all keep theirs.
    fn choose_colors(&mut self, tree: &Tree, options: &LevelOptions) {
        if !options.dilates() || self.lod == Lod::original(tree.foliage().leaves().len()) {
            return;
        }
        match dilated_textures(tree) {
            Ok(dilated) => {
                if dilated.is_empty() && options.colors == ColorChoice::Dilate {
                    self.warnings.push(LevelWarning::NoOtherColors);
                }
                self.colors = dilated;
            }
            Err(error) => {
                let why = LevelWarning::TexturesStay(error.to_string());
                self.warnings.push(why);
            }
        }
    }

    /// Looks at the level: whether it is the plant still, where that is asked for, and, where its wood is another, what it
    /// shows beside the charts of opaque textures, which get the colours of these.
    fn look(&mut self, tree: &Tree, judged: bool, fills: bool) {
        let [plant, level] = match drawn(tree, &self.lod) {
            Ok(drawn) => drawn,
            Err(error) => {
                let why = LevelWarning::LookUnknown(error.to_string());
                self.warnings.push(why);
                return;
            }
        };
        if fills {
            let filled = filled_charts(tree.document(), &plant, &level);
            self.colors.extend(filled);
        }
        if judged {
            let difference = difference_of(plant, level, LOOKED_AT_PX);
            let warning = LevelWarning::of_difference(difference.difference);
            self.warnings.extend(warning);
            self.difference = Some(difference);
        }
    }
}

/// A tree and a level of it, as they are drawn.
fn drawn(tree: &Tree, lod: &Lod) -> Result<[Vec<DrawnSurface>; 2], GltfError> {
    let level = tree.lod_document(lod)?.drawn_as_one(Detail::Color)?;
    Ok([tree.drawn(Detail::Color)?, level])
}

/// How far a level looks from its plant where the screen shows the plant as `pixels_high` pixels.
fn difference_of(
    plant: Vec<DrawnSurface>,
    level: Vec<DrawnSurface>,
    pixels_high: f64,
) -> Difference {
    let is_wood: Vec<bool> = plant.iter().map(|drawn| !drawn.is_foliage).collect();
    let [plant, level] = [plant, level].map(|drawn| {
        let surfaces = drawn.into_iter().map(|drawn| drawn.surface);
        surfaces.collect::<Vec<Surface>>()
    });
    let judge = DifferenceJudge::new(plant, &is_wood);
    judge.difference(&level, pixels_high, ViewCount::Search)
}
