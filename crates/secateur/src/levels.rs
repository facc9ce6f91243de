//! The levels of detail of a plant that an engine loads: complete from 0 m on.

use std::ops::ControlFlow;
use std::path::Path;

use secateur_gltf::chain::{ChainFiles, Layout, Level, PreparedChain, WrittenChain};
use secateur_gltf::{GltfError, WholeTree, WriteOptions};
use secateur_raster::OpenEngine;
use secateur_scene::chain::{
    Chain, ChainError, ChainLevel, ChainOptions as LevelsOptions, Shape, chain,
};
use secateur_simplify::{Error as SimplifyError, Observer};
use serde_json::{Map, Value};

use crate::opened_plant::{Parts, Plant};

/// Levels of a plant, finest first. They are written with the material changes that belong to them.
#[derive(Debug)]
pub struct Levels<'p> {
    tree: &'p WholeTree,
    name: String,
    /// The levels, and what has to be said of them.
    pub chain: Chain,
    /// Where leaves were drawn: `cpu` or `gpu`.
    pub engine: &'static str,
    /// The adapter's name and driver; none on the CPU.
    pub adapter: Option<String>,
}

impl Plant {
    /// Makes levels of the plant.
    ///
    /// # Errors
    /// [`ChainError`] if the options contradict each other, the plant was opened with its wood ignored, or it can't be
    /// simplified as asked.
    pub fn levels(&self, options: &LevelsOptions) -> Result<Levels<'_>, ChainError> {
        self.levels_watched(options, &mut |_| ControlFlow::Continue(()))
    }

    /// As [`levels`](Self::levels), telling its progress; the observer may break it off.
    ///
    /// # Errors
    /// As [`levels`](Self::levels), or [`SimplifyError::Stopped`] if it was broken off.
    pub fn levels_watched(
        &self,
        options: &LevelsOptions,
        observer: &mut Observer<'_>,
    ) -> Result<Levels<'_>, ChainError> {
        let Parts::Whole(tree, _) = self.parts() else {
            return Err(ChainError::Wanted(
                "levels are of wood and leaves: open the plant without ignoring its wood"
                    .to_owned(),
            ));
        };
        let engine = OpenEngine::open(options.leaves.engine)
            .map_err(|reason| SimplifyError::Gpu(reason.to_string()))?;
        Ok(Levels {
            chain: chain(tree, options, &engine, observer)?,
            tree,
            name: self.name(),
            engine: engine.name(),
            adapter: engine.adapter(),
        })
    }
}

impl Levels<'_> {
    /// These levels with another name than that of the plant's file: their nodes and files are called after it.
    #[must_use]
    pub fn named(self, name: impl Into<String>) -> Self {
        let name = name.into();
        Self { name, ..self }
    }

    /// The plant that they are of.
    pub fn tree(&self) -> &WholeTree {
        self.tree
    }

    /// The levels as GLB files: what `secateur lods` writes.
    ///
    /// # Errors
    /// [`GltfError`] if a part of the file that was not needed so far is damaged, or the result is beyond 4 GiB.
    pub fn to_bytes(&self, layout: Layout) -> Result<ChainFiles, GltfError> {
        let items = self.tree.items();
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
        let items = self.tree.items();
        items.prepare_chain(&self.name, &self.written_levels(), layout, path, options)
    }

    fn written_levels(&self) -> Vec<Level<'_>> {
        let levels = self.chain.levels.iter().enumerate();
        levels
            .map(|(k, level)| {
                let facts = facts(&self.name, level);
                match &level.shape {
                    Shape::Original(lod) | Shape::Mesh(lod) => {
                        Level::new(&self.name, k, lod, facts).with_textures(&level.textures)
                    }
                    Shape::Impostor(made) => {
                        Level::of_surface(&self.name, k, &made.impostor.surface, facts)
                    }
                }
            })
            .collect()
    }
}

/// What the node of a level says in its extras.
fn facts(name: &str, level: &ChainLevel) -> Map<String, Value> {
    let mut facts = Map::new();
    let mut say = |name: &str, value: Value| facts.insert(name.to_owned(), value);
    say("kind", level.kind().into());
    say("distance", level.distance.into());
    if level.pixels_high.is_finite() {
        say("pixels_high", level.pixels_high.into());
    }
    say("screen_coverage", level.screen_coverage.into());
    say("triangles", level.triangles().into());
    say("difference", level.difference.difference.into());
    say("block_coverage", level.difference.block_coverage.into());
    say("shadow", format!("{name}_LOD{}", level.shadow).into());
    if let Some(pop) = level.pop {
        say("pop", pop.into());
    }
    if let Some(sha256) = &level.order_sha256 {
        say("order_sha256", sha256.clone().into());
    }
    if let Shape::Impostor(made) = &level.shape {
        say("impostor", made.impostor.facts());
    }
    facts
}
