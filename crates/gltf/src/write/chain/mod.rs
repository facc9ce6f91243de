//! Chains of levels of detail, in the layouts that engines read.
//!
//! Each level is an edited copy of the same tree. What the edits leave alone has
//! the same number in every copy, so that levels share it: materials, textures,
//! images, skins, and vertices that they have in common.

mod as_it_came;
mod cards_apart;
mod deduplicate;
mod layout;
mod materials;
mod merged;
mod mesh_levels;
mod morph;
mod names;
mod node_trees;
mod on_disk;
mod one_mesh;
mod others;
mod placement;
mod plan;
mod retexture;
mod scene;
mod usd;
mod vertices;

use std::collections::HashSet;
use std::sync::Arc;

use serde_json::{Map, Value};

pub(super) use deduplicate::forget_unused;
pub use layout::{Layout, UnknownLayout};
pub(super) use merged::{LevelPrimitive, merged};
pub use morph::{MORPH, Morph};
pub use on_disk::{PreparedChain, WrittenChain};
pub(super) use vertices::Baker;

use super::content::{Content, count_triangles, finished, without_repeats};
use super::draft::Draft;
use super::drop_unreferenced::{References, drop_meshes, undrawn_meshes};
use super::files::compressed_as;
use super::leaf_edits::LeafEdits;
use super::nodes::leave_out_levels;
use super::skeleton::{drop_skeleton, rewrite_skeleton};
use crate::chain_problem::{ChainProblem, MAX_LEVELS};
use crate::container::glb_bytes;
use crate::cost::{Counted, LevelCost};
use crate::error::{Fault, GltfError, Problem};
use crate::level_names::with_level;
use crate::tree::Tree;
use crate::write_problem::WriteProblem;
use secateur_model::{Lod, Surface, Texture};

/// What a level shows.
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub enum LevelContent<'a> {
    /// The tree with the leaves of a LOD.
    Tree(&'a Lod),
    /// Something else that stands for the tree, in world space: an impostor. Textures become PNG
    /// images in the file.
    Surface(&'a Surface),
}

/// A texture of a level's own.
#[derive(Clone, Debug, PartialEq)]
pub struct LevelTexture {
    /// The number of the material that shows it.
    pub material: usize,
    /// The image of the file that it takes the place of wherever the material shows that, but as its base colour; the base
    /// colour where there is none.
    pub image: Option<usize>,
    /// Its texels and its sampler; a PNG image in the file.
    pub texture: Arc<Texture>,
    /// Whether the material's sampler stays instead.
    pub keeps_sampler: bool,
}

/// A level of a chain.
#[derive(Clone, Debug)]
pub struct Level<'a> {
    /// The geometry of the level: a LOD of the tree, or a surface of its own, such as an impostor.
    pub content: LevelContent<'a>,
    /// What its node, its mesh and, in the layout of files, its file are called.
    pub name: String,
    /// Its number in the chain, 0 being the finest: materials and images of its own are called after it.
    pub number: usize,
    /// Plain facts for the `extras` of its node.
    ///
    /// [`Layout::Msft`] and [`Layout::Usd`] need one of them, the number `screen_coverage`: the
    /// least share of the screen at which the level is drawn. Below it the next
    /// level takes over, or nothing is drawn any more after the last one, which
    /// therefore should have 0.
    pub facts: Map<String, Value>,
    /// What its materials show instead of the tree's textures; all else of them stays.
    pub textures: &'a [LevelTexture],
    /// Where its vertices go on the way to the next level: the attribute [`MORPH`]. A level of copied nodes, or with
    /// bones, is written without.
    pub morph: Option<&'a Morph>,
}

impl<'a> Level<'a> {
    /// The level of this number, 0 being the finest, named as most engines want
    /// it: `oak_LOD0`.
    pub fn new(chain: &str, number: usize, lod: &'a Lod, facts: Map<String, Value>) -> Self {
        Self {
            content: LevelContent::Tree(lod),
            name: with_level(chain, number),
            number,
            facts,
            textures: &[],
            morph: None,
        }
    }

    /// As [`Level::new`], of a surface that stands for the tree.
    pub fn of_surface(
        chain: &str,
        number: usize,
        surface: &'a Surface,
        facts: Map<String, Value>,
    ) -> Self {
        Self {
            content: LevelContent::Surface(surface),
            name: with_level(chain, number),
            number,
            facts,
            textures: &[],
            morph: None,
        }
    }

    /// With textures of its own.
    pub fn with_textures(self, textures: &'a [LevelTexture]) -> Self {
        Self { textures, ..self }
    }

    /// With what its vertices do on the way to the next level.
    pub fn with_morph(self, morph: Option<&'a Morph>) -> Self {
        Self { morph, ..self }
    }

    fn screen_coverage(&self) -> Option<f64> {
        self.facts.get("screen_coverage").and_then(Value::as_f64)
    }
}

/// The files of a chain, and what they hold.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct ChainFiles {
    /// One file, or one for each level.
    pub files: Vec<ChainFile>,
    /// Triangles of each level, finest first, each instance counted.
    pub triangles: Vec<u64>,
    /// What it costs to draw each level, finest first.
    pub costs: Vec<LevelCost>,
    /// What is not as one might expect, a sentence each.
    pub notes: Vec<String>,
}

/// A file of a chain.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct ChainFile {
    /// Its name: that of the chain, or of its level, and `.glb`; in the layout of USD that of the chain and `.usda`, or
    /// that of a texture below the folder of textures.
    pub name: String,
    /// The bytes of a GLB, a layer of USD, or an image.
    pub bytes: Vec<u8>,
    /// Whether it is the plant as the input has it, compressed as it was.
    pub is_as_it_came: bool,
}

impl Tree {
    /// The levels of a chain, finest first, as GLB files.
    ///
    /// Every level is a node with one mesh, whose primitives are wood and leaves;
    /// the transforms of the tree's nodes are put into the vertices, but for the
    /// place of a tree that stands in one root: the node of a level, or of all
    /// siblings, stands there too, and its mesh is about the tree's own pivot. Where that cannot be, since the tree is animated, instanced or
    /// has several skins, a level is a node that holds a copy of the node tree,
    /// and a note says so. Materials, textures, images and skins are there once
    /// for each file; what one level alone shows is called after it, `leaves_LOD1`, unless the level is the plant as
    /// it is. The facts of a level are in its node's `extras`, with the
    /// extras of the nodes that it takes the place of. Images in files of their
    /// own stay there. In the layout of files the level that is the plant itself is as the input has it, where it would
    /// otherwise be larger. The same input gives the same bytes.
    ///
    /// # Errors
    /// [`GltfError`] as [`lod_to_bytes`](Self::lod_to_bytes), and with
    /// [`ChainProblem`] if the levels are no chain.
    ///
    /// # Panics
    /// If a level is of another number of leaves.
    pub fn chain_to_bytes(
        &self,
        name: &str,
        levels: &[Level],
        layout: Layout,
    ) -> Result<ChainFiles, GltfError> {
        self.chain_files(name, levels, layout, true)
    }

    /// The files of a chain, compressed by Draco where the input is or not yet.
    fn chain_files(
        &self,
        name: &str,
        levels: &[Level],
        layout: Layout,
        compresses: bool,
    ) -> Result<ChainFiles, GltfError> {
        let failed = |fault: Fault| self.document.error(fault);
        check(name, levels, layout).map_err(|problem| failed(Problem::Chain(problem).into()))?;
        let mut chain = ChainFiles {
            files: Vec::new(),
            triangles: Vec::new(),
            costs: Vec::new(),
            notes: Vec::new(),
        };
        for level in levels {
            chain.triangles.push(match level.content {
                LevelContent::Tree(lod) => {
                    count_triangles(self, &LeafEdits::new(self, lod)).map_err(failed)?
                }
                LevelContent::Surface(surface) => surface.triangles.len() as u64,
            });
        }
        let of_files: Vec<(&str, &[Level])> = match layout {
            Layout::Files | Layout::Usd => levels
                .iter()
                .map(|level| (level.name.as_str(), std::slice::from_ref(level)))
                .collect(),
            Layout::Siblings | Layout::Msft => vec![(name, levels)],
        };
        // USD gets the plant alone.
        let with_others = |number| number == 0 && layout != Layout::Usd;
        for (number, (file, levels)) in of_files.into_iter().enumerate() {
            let content =
                content(self, name, levels, layout, with_others(number)).map_err(failed)?;
            chain.notes.extend_from_slice(&content.notes);
            let mut counted = Counted::default();
            for level in levels {
                let cost = LevelCost::of_level(&content.root, &level.name, &mut counted);
                chain.costs.push(cost);
            }
            let compresses =
                compresses && layout != Layout::Usd && self.document.draco_bits.is_some();
            let to_compress = compresses.then(|| content.clone());
            let too_large = || failed(Problem::from(WriteProblem::TooLarge).into());
            let mut bytes = glb_bytes(&content.root, content.buffer).ok_or_else(too_large)?;
            let mut is_as_it_came = false;
            if let (Layout::Files, [level], Some(cost)) = (layout, levels, chain.costs.last()) {
                let came = as_it_came::as_it_came(self, level, cost.draws, bytes.len());
                if let Some(came) = came.map_err(failed)? {
                    (bytes, is_as_it_came) = (came, true);
                }
            }
            if let Some(content) = to_compress.filter(|_| !is_as_it_came) {
                let content = compressed_as(&self.document, content)?;
                bytes = glb_bytes(&content.root, content.buffer).ok_or_else(too_large)?;
            }
            if let (Layout::Files, Some(cost)) = (layout, chain.costs.last_mut()) {
                cost.bytes = bytes.len() as u64;
            }
            let name = format!("{file}.glb");
            chain.files.push(ChainFile {
                name,
                bytes,
                is_as_it_came,
            });
        }
        if layout == Layout::Usd {
            usd::rewrite(self, name, levels, &mut chain)?;
        }
        chain.notes = without_repeats(chain.notes);
        Ok(chain)
    }
}

/// Refuses a name that nodes and files of levels cannot have everywhere.
///
/// # Errors
/// [`ChainProblem::Name`].
pub fn check_name(name: &str) -> Result<(), ChainProblem> {
    let is_plain = !name.is_empty()
        && !name.starts_with('.')
        && !name.contains(|c: char| c.is_control() || r#"/\:*?"<>|"#.contains(c));
    match is_plain {
        true => Ok(()),
        false => Err(ChainProblem::Name(crate::error::shortened(name))),
    }
}

fn check(name: &str, levels: &[Level], layout: Layout) -> Result<(), ChainProblem> {
    if levels.is_empty() || levels.len() > MAX_LEVELS {
        return Err(ChainProblem::Levels(levels.len()));
    }
    let mut names = HashSet::new();
    for name in levels.iter().map(|level| level.name.as_str()).chain([name]) {
        check_name(name)?;
        if !names.insert(name) {
            return Err(ChainProblem::SameName(name.to_owned()));
        }
    }
    if matches!(layout, Layout::Msft | Layout::Usd) {
        let mut last = f64::INFINITY;
        for level in levels {
            match level.screen_coverage() {
                Some(coverage) if (0.0..last).contains(&coverage) => last = coverage,
                _ => return Err(ChainProblem::Coverage(level.name.clone())),
            }
        }
    }
    Ok(())
}

/// The content of one file, with what is not the plant or without.
fn content(
    tree: &Tree,
    name: &str,
    levels: &[Level],
    layout: Layout,
    with_others: bool,
) -> Result<Content, Fault> {
    for level in levels {
        let LevelContent::Tree(lod) = level.content else {
            continue;
        };
        assert_eq!(
            lod.area_scales().len(),
            tree.foliage.leaves().len(),
            "a LOD knows every leaf of its tree"
        );
    }
    if let [level] = levels
        && let LevelContent::Surface(surface) = level.content
    {
        let pivot = placement::placement(tree);
        return mesh_levels::alone(&tree.document, level, surface, pivot);
    }
    let mut draft = Draft::new(&tree.document);
    let before = References::of(&mut draft.root);
    draft
        .notes
        .extend(tree.document.notes_of_others(&tree.others));
    let mut left_out = leave_out_levels(&mut draft, tree);
    if !with_others {
        left_out.extend(others::leave_out(&mut draft, tree));
    }
    let mut nodes = match plan::one_mesh(tree) {
        Ok(plan) => {
            if plan.skin.is_some() {
                note_without_morph(&mut draft, levels);
            }
            one_mesh::build(&mut draft, tree, levels, &plan, with_others)?
        }
        Err(obstacle) => {
            draft.notes.push(format!(
                "the levels keep the node tree of the file instead of one mesh each: {obstacle}"
            ));
            note_without_morph(&mut draft, levels);
            node_trees::build(&mut draft, tree, levels)?
        }
    };
    nodes.needless.extend(left_out);
    let copies = cards_apart::clear_levels(&mut draft, tree, levels, &nodes.levels)?;
    retexture::retexture(&mut draft, levels, &nodes.levels, &copies);
    let beside = [&nodes.with_tree[..], &nodes.others].concat();
    names::name_levels(&mut draft, levels, &nodes.levels, &beside);
    scene::arrange(&mut draft, name, levels, layout, nodes);
    drop_undrawn_meshes(&mut draft);
    match layout {
        // All levels are in the scene: the leaves of a reader are those of all.
        Layout::Siblings if levels.len() > 1 => drop_skeleton(&mut draft),
        _ => match levels[0].content {
            LevelContent::Tree(lod) => rewrite_skeleton(&mut draft, tree, lod)?,
            LevelContent::Surface(_) => drop_skeleton(&mut draft),
        },
    }
    deduplicate::deduplicate_accessors(&mut draft);
    let mut content = finished(draft, &before, 0)?;
    content.notes = without_repeats(content.notes);
    Ok(content)
}

/// Says that levels do not tell how one becomes the next, where they were to.
fn note_without_morph(draft: &mut Draft, levels: &[Level]) {
    if levels.iter().any(|level| level.morph.is_some()) {
        let note = format!("the levels have no {MORPH}: it is for one mesh without bones");
        draft.notes.push(note);
    }
}

/// Drops meshes that were drawn in the file and are not any more.
fn drop_undrawn_meshes(draft: &mut Draft) {
    let undrawn = undrawn_meshes(draft);
    drop_meshes(draft, &undrawn);
}
