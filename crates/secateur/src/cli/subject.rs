//! A tree that is simplified: its leaves alone, or its wood too.

use std::path::Path;
use std::sync::Arc;

use secateur::{
    Amount, Foliage, Lod, Memory, Observer, OpenEngine, Options, PlantSkeleton, Selector,
    Simplified, SimplifyError, Target, Tree, WholePlant, WholeTree, WoodMode,
    simplify_keeping_wood, simplify_with,
};

use super::failure::Failure;

/// A tree, and what becomes of its wood.
pub(crate) enum Subject {
    /// The leaves alone are simplified; wood is ignored.
    Leaves(Tree),
    /// Leaves are simplified beside the wood, which is treated as the mode says.
    Whole(WholeTree, WoodMode),
}

/// What came of a run.
pub(crate) struct Outcome {
    /// The run over the leaves.
    pub(crate) result: Simplified,
    /// The level of everything that [`Subject::tree`] can edit.
    pub(crate) lod: Lod,
    /// Triangles of wood that are left.
    pub(crate) wood_triangles: u64,
}

/// What becomes of the wood where nothing else is said: a budget of triangles is the whole plant's,
/// other targets are of leaves.
pub(crate) fn usual_mode(target: Target) -> WoodMode {
    match target {
        Target::Triangles(_) => WoodMode::Auto,
        Target::Leaves(_) | Target::MaxErrorPercent(_) => WoodMode::Ignore,
    }
}

impl Subject {
    pub(crate) fn open(
        path: &Path,
        selectors: &[Selector],
        mode: WoodMode,
        memory: Memory,
    ) -> Result<Self, Failure> {
        Ok(match mode {
            WoodMode::Ignore => Self::Leaves(Tree::open_within(path, selectors, memory)?),
            mode => {
                let tree = WholeTree::open_within(path, selectors, memory)?;
                Self::Whole(tree, mode.decided())
            }
        })
    }

    /// What a LOD of [`Outcome::lod`] is written with.
    pub(crate) fn tree(&self) -> &Tree {
        match self {
            Self::Leaves(tree) => tree,
            Self::Whole(tree, _) => tree.items(),
        }
    }

    /// The same, to be changed.
    pub(crate) fn tree_mut(&mut self) -> &mut Tree {
        match self {
            Self::Leaves(tree) => tree,
            Self::Whole(tree, _) => tree.items_mut(),
        }
    }

    pub(crate) fn leaves(&self) -> &Foliage {
        match self {
            Self::Leaves(tree) => tree.foliage(),
            Self::Whole(tree, _) => tree.leaves(),
        }
    }

    /// Triangles of the wood as it was.
    pub(crate) fn wood_triangles(&self) -> u64 {
        match self {
            Self::Leaves(tree) => tree.wood_triangle_count(),
            Self::Whole(tree, _) => tree.wood().triangles().len() as u64,
        }
    }

    /// Triangles of the plant as it was.
    pub(crate) fn triangles(&self) -> u64 {
        self.leaves().triangles().len() as u64 + self.wood_triangles()
    }

    /// What becomes of the wood, decided.
    pub(crate) fn mode(&self) -> WoodMode {
        match self {
            Self::Leaves(_) => WoodMode::Ignore,
            Self::Whole(_, mode) => *mode,
        }
    }

    pub(crate) fn skeleton(&self) -> Result<Option<Arc<PlantSkeleton>>, Failure> {
        let skeleton = match self {
            Self::Leaves(tree) => tree.skeleton()?,
            Self::Whole(tree, _) => tree.skeleton()?,
        };
        Ok(skeleton.map(Arc::new))
    }

    /// Simplifies the tree and shows progress meanwhile.
    pub(crate) fn simplified(
        &self,
        options: &Options,
        observer: &mut Observer<'_>,
    ) -> Result<Outcome, SimplifyError> {
        let (tree, mode) = match self {
            Self::Leaves(tree) => {
                let result = simplify_with(tree.foliage(), options, observer)?;
                let left = result.lod.foliage(tree.foliage()).triangles().len();
                // Wood is a plant without leaves.
                let is_bare = left == 0 && tree.wood_triangle_count() > 0;
                if !(is_bare && asks_for_none(options.target)) {
                    options.check_met(left, tree.foliage().triangles().len())?;
                }
                return Ok(Outcome {
                    lod: result.lod.clone(),
                    result,
                    wood_triangles: tree.wood_triangle_count(),
                });
            }
            Self::Whole(tree, mode) => (tree, *mode),
        };
        let engine = OpenEngine::open(options.engine)
            .map_err(|reason| SimplifyError::Gpu(reason.to_string()))?;
        let (leaves, wood) = (tree.leaves(), tree.wood());
        let level = match mode {
            WoodMode::Keep => simplify_keeping_wood(leaves, wood, options, &engine, observer)?,
            mode => WholePlant::by(mode, tree.items().foliage(), leaves, wood, options, &engine)?
                .simplified(options, &engine, observer)?,
        };
        let left = level.leaves.lod.foliage(leaves).triangles().len() + level.wood_triangles;
        let there = leaves.triangles().len() + wood.triangles().len();
        options.check_met(left, there)?;
        Ok(Outcome {
            lod: tree.joined(&level.leaves.lod, &level.wood),
            result: level.leaves,
            wood_triangles: level.wood_triangles as u64,
        })
    }
}

/// Whether no triangle is to be left of what is counted.
fn asks_for_none(target: Target) -> bool {
    match target {
        Target::Triangles(Amount::Count(count)) => count == 0,
        Target::Triangles(Amount::Share(share)) => share == 0.0,
        Target::Leaves(_) | Target::MaxErrorPercent(_) => false,
    }
}
