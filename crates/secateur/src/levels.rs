//! The levels of detail of a plant that an engine loads: complete from 0 m on.

use std::path::Path;

use secateur_gltf::chain::{ChainFiles, Layout, Level, PreparedChain, WrittenChain};
use secateur_gltf::{GltfError, LevelCost, WholeTree, WriteOptions};
use secateur_levels::chain::{
    BadOptions, Chain, ChainLevel, ChainOptions as LevelsOptions, CostWeights, LevelParts,
    LevelReport, Shape, chain,
};
use secateur_model::Memory;
use secateur_runtime::Screen;
use secateur_simplify::Observer;
use serde::Serialize;

use crate::opened_plant::{Parts, Plant};
use crate::{Error, LevelWarning, Session};

/// Levels of a plant, finest first. They are written with the material changes that belong to them.
#[derive(Debug)]
pub struct Levels {
    plant: Plant,
    name: String,
    pub(crate) screen: Screen,
    weights: CostWeights,
    /// The levels, and what has to be said of them.
    pub chain: Chain,
    /// Where leaves were drawn: `cpu` or `gpu`.
    pub engine: &'static str,
    /// The adapter's name and driver; none on the CPU.
    pub adapter: Option<String>,
}

/// A level that was written: where, and its figures.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
pub struct PlacedLevel {
    /// The file or node that holds the level.
    #[serde(flatten)]
    pub place: LevelPlace,
    /// Where the level is that casts its shadow.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub shadow: Option<LevelPlace>,
    /// Primitives that are drawn, each instance counted.
    pub draws: u64,
    /// Bytes of its file; of levels in one file those that lie there for it and for no finer one.
    pub bytes: u64,
    /// Bytes that it takes in a GPU's memory: `texture_bytes`, vertices and indices. What levels share counts for each.
    pub gpu_bytes: u64,
    /// Triangles, draws and bytes as one figure, by the weights of the chain's options.
    pub cost: f64,
    /// The figures of the level, as reports have them.
    #[serde(flatten)]
    pub report: LevelReport,
}

/// Where a level is: a file of its own, or a node of the file of all levels.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
#[serde(rename_all = "lowercase")]
pub enum LevelPlace {
    /// The level's file.
    File(String),
    /// The name of the level's node.
    Node(String),
}

impl PlacedLevel {
    /// A level that casts its own shadow.
    pub fn new(
        place: LevelPlace,
        cost: LevelCost,
        report: LevelReport,
        weights: CostWeights,
    ) -> Self {
        let parts = LevelParts {
            triangles: report.triangles,
            draws: cost.draws,
            bytes: cost.bytes,
            gpu_bytes: report.texture_bytes + cost.geometry_bytes,
        };
        Self {
            place,
            shadow: None,
            draws: parts.draws,
            bytes: parts.bytes,
            gpu_bytes: parts.gpu_bytes,
            cost: weights.cost(parts),
            report,
        }
    }
}

impl Plant {
    /// Makes levels of the plant.
    ///
    /// # Errors
    /// [`Error::Levels`] if the options contradict each other or the plant was opened with its wood ignored,
    /// [`Error::Simplify`] if it can't be simplified as asked.
    pub fn levels(&self, options: &LevelsOptions) -> Result<Levels, Error> {
        self.levels_in(&Session::default(), options)
    }

    /// As [`levels`](Self::levels), in a session.
    ///
    /// # Errors
    /// As [`levels`](Self::levels), or [`SimplifyError::Stopped`](secateur_simplify::Error::Stopped) if the session was
    /// cancelled.
    pub fn levels_in(&self, session: &Session, options: &LevelsOptions) -> Result<Levels, Error> {
        session.watched(|observer| self.levels_on(session, options, observer))
    }

    /// As [`levels`](Self::levels), with an observer that may borrow and may break it off.
    ///
    /// # Errors
    /// As [`levels`](Self::levels), or [`SimplifyError::Stopped`](secateur_simplify::Error::Stopped) if it was broken off.
    pub fn levels_watched(
        &self,
        options: &LevelsOptions,
        observer: &mut Observer<'_>,
    ) -> Result<Levels, Error> {
        self.levels_on(&Session::default(), options, observer)
    }

    pub(crate) fn levels_on(
        &self,
        session: &Session,
        options: &LevelsOptions,
        observer: &mut Observer<'_>,
    ) -> Result<Levels, Error> {
        let Parts::Whole(tree, _) = self.parts() else {
            return Err(BadOptions::WoodIgnored.into());
        };
        let mut options = options.clone();
        self.surroundings().apply_to_levels(&mut options);
        if options.leaves.memory == Memory::Auto {
            options.leaves.memory = session.memory();
        }
        let engine = session.engine(options.leaves.engine)?;
        Ok(Levels {
            chain: chain(tree, &options, &engine, observer)?,
            plant: self.clone(),
            name: self.name(),
            screen: options.screen,
            weights: options.cost,
            engine: engine.name(),
            adapter: engine.adapter(),
        })
    }
}

impl Levels {
    /// These levels with another name than that of the plant's file: their nodes and files are called after it.
    #[must_use]
    pub fn named(self, name: impl Into<String>) -> Self {
        let name = name.into();
        Self { name, ..self }
    }

    /// What their nodes and files are called after.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The plant that they are of.
    pub fn plant(&self) -> &Plant {
        &self.plant
    }

    /// Its leaves and wood.
    pub fn tree(&self) -> &WholeTree {
        match self.plant.parts() {
            Parts::Whole(tree, _) => tree,
            Parts::Leaves(_) => unreachable!("levels are of plants with their wood"),
        }
    }

    /// What has to be said of how they look: whether one looks like another plant.
    pub fn warning(&self) -> Option<LevelWarning> {
        let levels = self.chain.levels.iter();
        let differences = levels.map(|level| level.difference.difference);
        LevelWarning::of_difference(differences.fold(0.0, f64::max))
    }

    /// The levels as GLB files: what `secateur lods` writes.
    ///
    /// # Errors
    /// [`GltfError`] if a part of the file that was not needed so far is damaged, or the result is beyond 4 GiB.
    pub fn to_bytes(&self, layout: Layout) -> Result<ChainFiles, GltfError> {
        let items = self.tree().items();
        items.chain_to_bytes(&self.name, &self.written_levels(), layout)
    }

    /// Writes the levels: to the folder `path` in the layout of files, else to the file `path`.
    ///
    /// # Errors
    /// As [`prepare`](Self::prepare), or [`GltfError`] if a file can't get its name.
    pub fn write(&self, path: impl AsRef<Path>, layout: Layout) -> Result<WrittenChain, GltfError> {
        self.prepare(path.as_ref(), layout, WriteOptions::default())?
            .commit()
    }

    /// Writes the levels under temporary names: a failure before the files get theirs leaves nothing.
    ///
    /// # Errors
    /// [`GltfError`] as [`to_bytes`](Self::to_bytes), or if files can't be written there.
    pub fn prepare(
        &self,
        path: &Path,
        layout: Layout,
        options: WriteOptions,
    ) -> Result<PreparedChain, GltfError> {
        let items = self.tree().items();
        items.prepare_chain(&self.name, &self.written_levels(), layout, path, options)
    }

    /// The figures of each level, finest first, with the places that it was written to in this layout.
    pub fn placed(&self, layout: Layout, written: &WrittenChain) -> Vec<PlacedLevel> {
        let place = |k: usize| match layout {
            Layout::Files => LevelPlace::File(written.files[k].display().to_string()),
            Layout::Siblings | Layout::Msft | Layout::Usd => LevelPlace::Node(self.node(k)),
        };
        let placed = |(k, level): (usize, &ChainLevel)| PlacedLevel {
            shadow: Some(place(level.shadow)),
            ..PlacedLevel::new(
                place(k),
                written.costs[k],
                level.report.clone(),
                self.weights,
            )
        };
        self.chain.levels.iter().enumerate().map(placed).collect()
    }

    /// The name of the node of a level, counted from 0.
    pub fn node(&self, level: usize) -> String {
        format!("{}_LOD{level}", self.name)
    }

    pub(crate) fn written_levels(&self) -> Vec<Level<'_>> {
        let levels = self.chain.levels.iter().enumerate();
        levels
            .map(|(k, level)| {
                let facts = level.extras(&self.node(level.shadow));
                match &level.shape {
                    Shape::Original(lod) | Shape::Mesh(lod) => {
                        let written = Level::new(&self.name, k, lod, facts);
                        let written = written.with_textures(&level.textures);
                        written.with_morph(level.morph.as_ref())
                    }
                    Shape::Impostor(made) => {
                        Level::of_surface(&self.name, k, &made.impostor.surface, facts)
                    }
                }
            })
            .collect()
    }
}
