//! A plant in a file, opened to be made lighter.

use std::ffi::OsStr;
use std::path::Path;
use std::sync::Arc;

#[cfg(feature = "plant")]
use secateur_gltf::plant_into_glb;
use secateur_gltf::{Document, GltfError, Inspection, Selector, Tree, VertexAlpha, WholeTree};
use secateur_levels::chain::LevelReport;
use secateur_model::{Foliage, Memory, PlantSkeleton};
#[cfg(feature = "plant")]
use secateur_plant::{GrowOptions, Species};
use secateur_simplify::whole::WoodMode;
use secateur_simplify::wood::{FoundHolds, found_holds};

#[cfg(feature = "plant")]
use crate::Error;
use crate::Surroundings;

/// How a plant is opened.
#[derive(Clone, Debug)]
pub struct Opening {
    /// What is foliage; empty where the evidence shows it.
    pub foliage: Vec<Selector>,
    /// What is not the plant, beside what is found to be ground or a helper.
    pub not_plant: Vec<Selector>,
    /// Whether the alpha of vertex colours hides leaves.
    pub vertex_alpha: VertexAlpha,
    /// What becomes of the wood in levels: [`LevelOptions::usual_wood`](crate::LevelOptions::usual_wood) is what the
    /// program takes for a target.
    pub wood: WoodMode,
    /// Whether it is found by where leaves and wood are what they hang on, where the file does not say it: vertex
    /// attributes that every level keeps, for shaders that sway the plant.
    pub wind: bool,
    /// How much memory the plant and its levels may take.
    pub memory: Memory,
}

impl Default for Opening {
    /// Of evidence, with the wood simplified, in the memory that there is.
    fn default() -> Self {
        Self {
            foliage: Vec::new(),
            not_plant: Vec::new(),
            vertex_alpha: VertexAlpha::Auto,
            wood: WoodMode::Auto,
            wind: false,
            memory: Memory::Auto,
        }
    }
}

/// A plant in a file: its leaves are known, and its wood unless it is ignored. Copies share all that they hold.
#[derive(Clone, Debug)]
pub struct Plant {
    parts: Arc<Parts>,
    surroundings: Arc<Surroundings>,
}

/// A plant with what leaves and wood hang on beside their vertices.
fn hung(whole: WholeTree) -> Result<WholeTree, GltfError> {
    if whole.says_what_it_hangs_on() {
        return Ok(whole);
    }
    let FoundHolds { leaves, wood } = found_holds(whole.leaves(), whole.wood());
    whole.hung(&leaves, &wood)
}

/// What of a plant is simplified.
#[derive(Clone, Debug)]
pub(crate) enum Parts {
    /// Leaves whose wood is ignored.
    Leaves(Tree),
    /// Leaves beside the wood, which is treated as the mode says.
    Whole(WholeTree, WoodMode),
}

impl Plant {
    /// Opens a .glb or .gltf as [`Opening::default`] has it.
    ///
    /// # Errors
    /// [`GltfError`] if it can't be read, or no foliage is found.
    pub fn open(path: impl AsRef<Path>) -> Result<Self, GltfError> {
        Self::open_with(path, &Opening::default())
    }

    /// Opens a .glb or .gltf.
    ///
    /// # Errors
    /// As [`open`](Self::open).
    pub fn open_with(path: impl AsRef<Path>, opening: &Opening) -> Result<Self, GltfError> {
        let document = Document::open_within(path.as_ref(), opening.memory)?;
        Self::of(document, opening)
    }

    /// A plant of the bytes of a .glb; `name` is what errors call it.
    ///
    /// # Errors
    /// As [`open`](Self::open).
    pub fn from_bytes(name: &str, bytes: Vec<u8>, opening: &Opening) -> Result<Self, GltfError> {
        let document = Document::from_bytes_within(name, bytes, None, opening.memory)?;
        Self::of(document, opening)
    }

    /// Grows a plant: a file of [`plant_to_glb`](crate::plant_to_glb) that never was on disk.
    ///
    /// # Errors
    /// [`Error::Grow`] for a number of leaves that can't be had.
    #[cfg(feature = "plant")]
    pub fn grow(species: Species, options: &GrowOptions) -> Result<Self, Error> {
        let glb = plant_into_glb(secateur_plant::grow(species, options)?);
        let name = format!("{}.glb", species.name());
        Ok(Self::from_bytes(&name, glb, &Opening::default())?)
    }

    fn of(document: Document, opening: &Opening) -> Result<Self, GltfError> {
        let document = document.with_vertex_alpha(opening.vertex_alpha);
        let document = document.with_not_plant(&opening.not_plant)?;
        let selectors = &opening.foliage[..];
        if !opening.wind {
            return Self::of_decided(document, selectors, opening.wood);
        }
        let whole = hung(document.into_whole_tree(selectors)?)?;
        let parts = match opening.wood {
            WoodMode::Ignore => Parts::Leaves(whole.into_document().into_tree(selectors)?),
            mode => Parts::Whole(whole, mode.decided()),
        };
        Ok(Self {
            parts: Arc::new(parts),
            surroundings: Arc::default(),
        })
    }

    /// A plant of a document that knows what the alpha of its vertex colours is.
    pub(crate) fn of_decided(
        document: Document,
        selectors: &[Selector],
        wood: WoodMode,
    ) -> Result<Self, GltfError> {
        let parts = match wood {
            WoodMode::Ignore => Parts::Leaves(document.into_tree(selectors)?),
            mode => Parts::Whole(document.into_whole_tree(selectors)?, mode.decided()),
        };
        Ok(Self {
            parts: Arc::new(parts),
            surroundings: Arc::default(),
        })
    }

    /// The plant with this about it, which its levels are made for.
    #[must_use]
    pub fn within(mut self, surroundings: Surroundings) -> Self {
        self.surroundings = Arc::new(surroundings);
        self
    }

    /// What is about it.
    pub fn surroundings(&self) -> &Surroundings {
        &self.surroundings
    }

    /// The name of its file without folder and extension.
    pub(crate) fn name(&self) -> String {
        let file = Path::new(self.tree().document().name());
        let stem = file.file_stem().and_then(OsStr::to_str);
        stem.unwrap_or("tree").to_owned()
    }

    /// Its leaves and wood; nothing where the wood is ignored.
    pub fn whole(&self) -> Option<&WholeTree> {
        match &*self.parts {
            Parts::Leaves(_) => None,
            Parts::Whole(tree, _) => Some(tree),
        }
    }

    /// What was taken for leaves and wood, and why.
    pub fn inspection(&self) -> &Inspection {
        self.tree().inspection()
    }

    /// The file, with all that levels may change as its foliage.
    pub fn tree(&self) -> &Tree {
        match &*self.parts {
            Parts::Leaves(tree) => tree,
            Parts::Whole(tree, _) => tree.items(),
        }
    }

    /// The [`tree`](Self::tree), to be changed; copies of the plant, and levels of it, keep theirs.
    pub fn tree_mut(&mut self) -> &mut Tree {
        match Arc::make_mut(&mut self.parts) {
            Parts::Leaves(tree) => tree,
            Parts::Whole(tree, _) => tree.items_mut(),
        }
    }

    /// Its leaves in world space, as the file has them.
    pub fn leaves(&self) -> &Foliage {
        match &*self.parts {
            Parts::Leaves(tree) => tree.foliage(),
            Parts::Whole(tree, _) => tree.leaves(),
        }
    }

    /// How many triangles the wood has.
    pub fn wood_triangle_count(&self) -> u64 {
        match &*self.parts {
            Parts::Leaves(tree) => tree.wood_triangle_count(),
            Parts::Whole(tree, _) => tree.wood().triangles().len() as u64,
        }
    }

    /// How many triangles the plant has, wood included.
    pub fn triangle_count(&self) -> u64 {
        self.leaves().triangles().len() as u64 + self.wood_triangle_count()
    }

    /// Its figures, as those of a level that is the plant itself.
    pub fn report(&self) -> LevelReport {
        LevelReport::of_plant(self.leaves(), self.wood_triangle_count())
    }

    /// What becomes of the wood, decided.
    pub fn wood_mode(&self) -> WoodMode {
        match &*self.parts {
            Parts::Leaves(_) => WoodMode::Ignore,
            Parts::Whole(_, mode) => *mode,
        }
    }

    /// The skeleton that the file has, for methods that follow branches.
    ///
    /// # Errors
    /// [`GltfError`] if it does not fit the plant.
    pub fn skeleton(&self) -> Result<Option<Arc<PlantSkeleton>>, GltfError> {
        let skeleton = match &*self.parts {
            Parts::Leaves(tree) => tree.skeleton()?,
            Parts::Whole(tree, _) => tree.skeleton()?,
        };
        Ok(skeleton.map(Arc::new))
    }

    pub(crate) fn parts(&self) -> &Parts {
        &self.parts
    }
}
