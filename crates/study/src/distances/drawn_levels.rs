//! What is drawn of a plant at the distances of a walk.

use std::collections::BTreeMap;
use std::ops::ControlFlow;
use std::path::Path;
use std::time::Instant;

use secateur_eval::{Difference, Limits};
use secateur_gltf::{Cutoffs, WholeTree};
use secateur_levels::chain::{ChainError, ChainOptions, Shape, Textures, Wanted, chain};
use secateur_levels::impostor::Choice;
use secateur_model::Surface;
use secateur_raster::OpenEngine;
use secateur_runtime::Screen;
use secateur_simplify::whole::{WholePlant, WoodMode};
use secateur_simplify::{Amount, Error as SimplifyError, Options, Preset, Progress, Target};

use super::judge::Place;
use super::{DistanceCase, Drawn, joined};
use crate::judge::surfaces_of;
use crate::shell;
use crate::{Error, Host};

/// How chains are made, and their leaves.
fn chain_options(wanted: Wanted, impostor: Choice, leaves: &Options) -> ChainOptions {
    ChainOptions {
        wanted,
        wood: WoodMode::Auto,
        screen: Screen::default(),
        max_difference: Limits::GOOD.difference,
        original: false,
        plant_height_m: None,
        leaves: leaves.clone(),
        impostor: Some(impostor),
        shadow_steps: 1,
        max_pop: None,
        // The judge sees how far meshes look from the plant, not what a client's mips make of them.
        textures: Textures::Keep,
        ..ChainOptions::default()
    }
}

/// Levels of these shares.
fn of_shares(shares: &[f64]) -> Wanted {
    Wanted::Triangles(shares.iter().map(|share| Amount::Share(*share)).collect())
}

/// Whether there can be such levels.
pub(super) fn check(distances_m: &[f64], shares: &[f64]) -> Result<(), Error> {
    let leaves = Options::with_preset(Preset::default(), Target::triangle_share(1.0));
    let check = |wanted| {
        let checked = chain_options(wanted, Choice::None, &leaves).check();
        checked.map_err(ChainError::from)
    };
    check(Wanted::Distances(distances_m.to_vec()))?;
    Ok(check(of_shares(shares))?)
}

/// A level, ready to be drawn.
struct Level {
    surfaces: Vec<Surface>,
    is_impostor: bool,
    leaves: u64,
    triangles: u64,
}

/// The levels of a chain, the finest first.
pub(super) struct LevelSet {
    levels: Vec<Level>,
    /// From where each is drawn, in metres.
    pub(super) begins_m: Vec<f64>,
    seconds: f64,
    command: String,
}

/// A mesh as light as an impostor.
struct Light {
    surfaces: Vec<Surface>,
    leaves: u64,
    triangles: u64,
    seconds: f64,
}

/// Makes levels of a plant.
pub(super) struct Maker<'a> {
    tree: &'a WholeTree,
    path: &'a Path,
    host: &'a dyn Host,
    pub(super) engine: OpenEngine,
    leaf_options: Options,
    /// Meshes as light as impostors by their budgets; none where there can be none.
    light: BTreeMap<u64, Option<Light>>,
}

impl<'a> Maker<'a> {
    pub(super) fn new(
        tree: &'a WholeTree,
        path: &'a Path,
        host: &'a dyn Host,
    ) -> Result<Self, Error> {
        let leaf_options = Options {
            audit: false,
            memory: tree.items().memory_left(),
            ..Options::with_preset(Preset::default(), Target::triangle_share(1.0))
        };
        let engine = OpenEngine::open(leaf_options.engine).map_err(SimplifyError::from)?;
        Ok(Self {
            tree,
            path,
            host,
            engine,
            leaf_options,
            light: BTreeMap::new(),
        })
    }

    /// What `lods --distances` makes.
    pub(super) fn for_distances(&self, distances_m: &[f64]) -> Result<LevelSet, Error> {
        let options = format!(
            "--distances {} --max-difference {}",
            joined(distances_m),
            Limits::GOOD.difference
        );
        self.levels(
            Wanted::Distances(distances_m.to_vec()),
            Choice::Auto,
            &options,
        )
    }

    /// Levels for distances, without impostors.
    pub(super) fn meshes_for_distances(&self, distances_m: &[f64]) -> Result<LevelSet, Error> {
        let options = format!(
            "--distances {} --max-difference {} --impostor none",
            joined(distances_m),
            Limits::GOOD.difference
        );
        self.levels(
            Wanted::Distances(distances_m.to_vec()),
            Choice::None,
            &options,
        )
    }

    /// What `lods --levels` makes.
    pub(super) fn of_shares(&self, shares: &[f64]) -> Result<LevelSet, Error> {
        let options = format!("--levels {}", joined(shares));
        self.levels(of_shares(shares), Choice::None, &options)
    }

    fn levels(&self, wanted: Wanted, impostor: Choice, words: &str) -> Result<LevelSet, Error> {
        let options = chain_options(wanted, impostor, &self.leaf_options);
        let begun = Instant::now();
        let mut observer = |_: Progress| self.goes_on();
        let made = chain(self.tree, &options, &self.engine, &mut observer)?;
        let seconds = begun.elapsed().as_secs_f64();
        let mut levels = Vec::new();
        let mut begins_m = Vec::new();
        for level in &made.levels {
            let surfaces = match &level.shape {
                Shape::Original(lod) | Shape::Mesh(lod) => {
                    surfaces_of(self.tree.items(), self.path, lod, &Cutoffs::default())?
                }
                Shape::Impostor(made) => vec![made.impostor.surface.clone()],
            };
            levels.push(Level {
                surfaces,
                is_impostor: matches!(level.shape, Shape::Impostor(_)),
                leaves: level.leaves,
                triangles: level.triangles,
            });
            begins_m.push(level.distance);
        }
        Ok(LevelSet {
            levels,
            begins_m,
            seconds,
            command: format!(
                "secateur lods {} -o levels --no-original --textures keep {words}",
                shell::path(self.path)
            ),
        })
    }

    fn goes_on(&self) -> ControlFlow<()> {
        match self.host.is_stop_asked() {
            false => ControlFlow::Continue(()),
            true => ControlFlow::Break(()),
        }
    }

    /// The level for a distance.
    pub(super) fn level_for(&self, set: &LevelSet, case: DistanceCase, place: &Place<'_>) -> Drawn {
        let level = &set.levels[set.begun_at(place.distance_m)];
        let difference = match level.is_impostor {
            true => place.difference_beside_impostor(&level.surfaces),
            false => place.difference(&level.surfaces),
        };
        set.drawn(level, case, difference)
    }

    /// The coarsest level that is at most `most_over` times the limits there; else the original.
    pub(super) fn coarsest(
        &self,
        set: &LevelSet,
        place: &Place<'_>,
        most_over: f64,
    ) -> Result<Drawn, Error> {
        for level in set.levels.iter().rev() {
            let drawn = set.drawn(
                level,
                DistanceCase::FixedShares,
                place.difference(&level.surfaces),
            );
            if drawn.difference.over(Limits::GOOD) <= most_over {
                return Ok(drawn);
            }
        }
        let original = Level {
            surfaces: Vec::new(),
            is_impostor: false,
            leaves: self.tree.leaves().leaves().len() as u64,
            triangles: self.tree.items().foliage().triangles().len() as u64,
        };
        Ok(set.drawn(&original, DistanceCase::FixedShares, Difference::default()))
    }

    /// A mesh of as many triangles as the impostor for a distance, if one can be made, and the impostor.
    pub(super) fn impostor_and_mesh(&mut self, place: &Place<'_>) -> Result<Vec<Drawn>, Error> {
        let begun = Instant::now();
        let Some((impostor, difference)) = place.crossed() else {
            return Ok(Vec::new());
        };
        let seconds = begun.elapsed().as_secs_f64();
        let triangles = impostor.surface.triangles.len() as u64;
        let path = shell::path(self.path);
        let impostor = Drawn {
            case: DistanceCase::Impostor,
            leaves: 0,
            triangles,
            difference,
            seconds,
            command: format!(
                "secateur lods {path} -o levels --distances {} --impostor crossed",
                place.distance_m
            ),
        };
        let command =
            format!("secateur simplify {path} -o out.glb --triangles {triangles} --no-audit");
        let mesh = self.light(triangles)?.map(|light| Drawn {
            case: DistanceCase::MeshOfSameCost,
            leaves: light.leaves,
            triangles: light.triangles,
            difference: place.difference_beside_impostor(&light.surfaces),
            seconds: light.seconds,
            command,
        });
        Ok(mesh.into_iter().chain([impostor]).collect())
    }

    /// The plant with this many triangles.
    fn light(&mut self, triangles: u64) -> Result<Option<&Light>, Error> {
        if !self.light.contains_key(&triangles) {
            let made = self.made_light(triangles)?;
            self.light.insert(triangles, made);
        }
        Ok(self.light[&triangles].as_ref())
    }

    fn made_light(&self, triangles: u64) -> Result<Option<Light>, Error> {
        let tree = self.tree;
        let options = Options {
            target: Target::triangles(triangles),
            ..self.leaf_options.clone()
        };
        let mut observer = |_: Progress| self.goes_on();
        let begun = Instant::now();
        let (items, leaves, wood) = (tree.items().foliage(), tree.leaves(), tree.wood());
        let plant = WholePlant::new(items, leaves, wood, &self.engine)?;
        let made = match plant.simplified(&options, &self.engine, &mut observer) {
            Ok(made) => made,
            // A plant that cannot be made so light has no mesh to hold the impostor against.
            Err(SimplifyError::BudgetNotMet { .. } | SimplifyError::NoLeaf) => return Ok(None),
            Err(error) => return Err(error.into()),
        };
        let seconds = begun.elapsed().as_secs_f64();
        let left = made.leaves.lod.foliage(leaves);
        Ok(Some(Light {
            surfaces: surfaces_of(
                tree.items(),
                self.path,
                &tree.joined(&made.leaves.lod, &made.wood),
                &Cutoffs::default(),
            )?,
            leaves: left.leaves().len() as u64,
            triangles: (left.triangles().len() + made.wood_triangles) as u64,
            seconds,
        }))
    }
}

impl LevelSet {
    fn drawn(&self, level: &Level, case: DistanceCase, difference: Difference) -> Drawn {
        Drawn {
            case,
            leaves: level.leaves,
            triangles: level.triangles,
            difference,
            seconds: self.seconds,
            command: self.command.clone(),
        }
    }

    #[cfg(test)]
    pub(super) fn with_begins(begins_m: &[f64]) -> Self {
        Self {
            levels: Vec::new(),
            begins_m: begins_m.to_vec(),
            seconds: 0.0,
            command: String::new(),
        }
    }
}
