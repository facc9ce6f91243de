//! What clients show beside cards that became triangles: nothing, if it can be helped.
//!
//! A triangle around what a card shows reaches beyond the card, where its texture is empty or
//! repeats far enough away. In coarse mip maps that is not so: what is shown on the other side of
//! the texture is mixed in, and where the mean of all alpha passes the test, the whole triangle is
//! shown, which is narrow at its tips: specks in the air. So the texture is clamped where its rim
//! is empty and nothing needs it repeated, and the cutoff is raised above the mean alpha where that
//! changes hardly a texel of the texture itself.

use std::collections::BTreeMap;

use serde_json::{Value, json};

use super::base_color::change_sampler;
use super::cutoffs::Cutoffs;
use super::draft::Draft;
use super::plant::wrap_code;
use super::references::as_index;
use crate::error::Fault;
use crate::material::MaterialLook;
use crate::picture::{Decoded, Picture, Pictures};
use crate::tree::Tree;
use secateur_model::{AlphaMode, Lod, Mips, Place, Wrap};

/// Steps of alpha, of 255, by which the coarsest mip level may be above the mean: each level is
/// rounded.
const ROUNDING: f64 = 2.0;

/// One in this many of the texels that pass the test may fail it with a higher cutoff.
const LOST_PART: u64 = 100;

/// Texture coordinates that are beyond the rim by no more than this do not need the wrap.
const RIM: f64 = 1e-3;

/// Changes the materials of leaves that reach beyond their cards, but for the cutoffs of those for which somebody
/// chose a cutoff, or no mip maps.
pub(super) fn clear(
    draft: &mut Draft,
    tree: &Tree,
    lod: &Lod,
    chosen: &Cutoffs,
) -> Result<(), Fault> {
    let mut remedies = Remedies::new(tree);
    for (material, shown_by) in reaching(tree, lod)? {
        let mut remedy = remedies.of(material, shown_by)?;
        remedy.cutoff = remedy.cutoff.filter(|_| !chosen.has(material));
        remedy.apply(draft, tree, material, material);
    }
    Ok(())
}

/// The materials of leaves that reach beyond their cards, each with a mesh and its primitive that show it.
pub(super) fn reaching(tree: &Tree, lod: &Lod) -> Result<BTreeMap<usize, [usize; 2]>, Fault> {
    let mut reaching = BTreeMap::new();
    for (leaf, _) in lod.made() {
        let is_beyond = |place: &Place| matches!(place, Place::InPlaneOf { .. });
        if leaf.triangles.iter().flatten().any(|c| is_beyond(&c.place)) {
            let part = &tree.parts[tree.leaf_sources[leaf.donor.index()].part as usize];
            let primitive = tree.document.primitive(part.mesh, part.primitive)?;
            if let Some(material) = primitive.get("material").and_then(as_index) {
                reaching.insert(material, [part.mesh, part.primitive]);
            }
        }
    }
    Ok(reaching)
}

/// What helps materials of a tree.
pub(super) struct Remedies<'a> {
    tree: &'a Tree,
    pictures: Pictures<'a>,
}

/// How the specks beside triangles of a material are kept away.
#[derive(Default)]
pub(super) struct Remedy {
    is_clamped: bool,
    /// The cutoff before and from now on.
    cutoff: Option<(f32, f64)>,
}

impl<'a> Remedies<'a> {
    pub(super) fn new(tree: &'a Tree) -> Self {
        Self {
            tree,
            pictures: Pictures::new(&tree.document, tree.document.budget),
        }
    }

    /// What helps a material that this primitive of this mesh shows.
    pub(super) fn of(
        &mut self,
        material: usize,
        [mesh, primitive]: [usize; 2],
    ) -> Result<Remedy, Fault> {
        let look = self.tree.document.look(mesh, primitive)?;
        let AlphaMode::Mask(cutoff) = look.alpha_mode else {
            return Ok(Remedy::default());
        };
        let texture = look.texture.filter(|t| t.filters.mips != Mips::None);
        let Some(image) = texture.and_then(|texture| texture.image) else {
            return Ok(Remedy::default());
        };
        let Decoded::Picture(picture) = self.pictures.get(image)? else {
            return Ok(Remedy::default());
        };
        let is_kept = |alpha: u8| f64::from(alpha) * alpha_step(&look) >= f64::from(cutoff);
        let raised = raised_cutoff(&picture, &look, f64::from(cutoff));
        Ok(Remedy {
            is_clamped: is_rim_clear(&picture, is_kept)
                && needs_no_wrap(self.tree, material, &look)?,
            cutoff: raised.map(|raised| (cutoff, raised)),
        })
    }
}

impl Remedy {
    pub(super) fn is_nothing(&self) -> bool {
        !self.is_clamped && self.cutoff.is_none()
    }

    /// Changes `material`, which is or was made of that one of the tree's.
    pub(super) fn apply(&self, draft: &mut Draft, tree: &Tree, of_tree: usize, material: usize) {
        let place = tree.document.place("materials", of_tree);
        if self.is_clamped {
            clamp(draft, material);
            draft.notes.push(format!(
                "{place}: its texture is clamped, so that none of it shows beside leaves that became single triangles"
            ));
        }
        if let Some((cutoff, raised)) = self.cutoff {
            draft.root["materials"][material]["alphaCutoff"] = json!(raised);
            draft.notes.push(format!(
                "{place}: its alphaCutoff is {raised} instead of {cutoff}, so that leaves that became single triangles show no specks from afar"
            ));
        }
    }
}

/// What a step of 1 of 255 of a texel's alpha is after the material's factor.
fn alpha_step(look: &MaterialLook) -> f64 {
    f64::from(look.base_color[3]) / 255.0
}

/// A cutoff that the mean alpha does not pass; none where it does not pass the old one, where more
/// than half of the texture is there, so that nothing would be farther from the truth than all of
/// it, or where the texture itself would lose more than hardly anything.
fn raised_cutoff(picture: &Picture, look: &MaterialLook, cutoff: f64) -> Option<f64> {
    let step = alpha_step(look);
    let texels = |alpha: &u8| picture.tally.texels(*alpha);
    let all: u64 = (0..=255).map(|alpha| texels(&alpha)).sum();
    let sum: u64 = (0..=255).map(|a| u64::from(a) * texels(&a)).sum();
    let mean = sum as f64 / all as f64;
    // In four digits, which a reader of the file can take in.
    let raised = (((mean + ROUNDING) * step) * 1e4).ceil() / 1e4;
    let count = |least: f64| -> u64 {
        let passes = |alpha: &u8| f64::from(*alpha) * step >= least;
        (0..=255).filter(passes).map(|alpha| texels(&alpha)).sum()
    };
    let (before, after) = (count(cutoff), count(raised));
    let is_sparse = mean < 127.5;
    let is_harmless = LOST_PART * (before - after.min(before)) <= before;
    (raised > cutoff && is_sparse && is_harmless).then_some(raised)
}

/// Whether no texel at the rim passes the test.
fn is_rim_clear(picture: &Picture, is_kept: impl Fn(u8) -> bool) -> bool {
    let image = &picture.image;
    let (right, bottom) = (image.width() - 1, image.height() - 1);
    let rows = (0..=right).flat_map(|x| [(x, 0), (x, bottom)]);
    let columns = (0..=bottom).flat_map(|y| [(0, y), (right, y)]);
    let mut rim = rows.chain(columns);
    !rim.any(|(x, y)| is_kept(image.get_pixel(x, y).0[3]))
}

/// Whether the texture repeats, and nothing in the file that shows the material lies beyond its rim.
fn needs_no_wrap(tree: &Tree, material: usize, look: &MaterialLook) -> Result<bool, Fault> {
    let document = &tree.document;
    let Some(texture) = look.texture.filter(|t| t.wrap != [Wrap::ClampToEdge; 2]) else {
        return Ok(false);
    };
    let meshes = document.root.get("meshes").and_then(Value::as_array);
    for (mesh, fields) in meshes.into_iter().flatten().enumerate() {
        let primitives = fields.get("primitives").and_then(Value::as_array);
        for (number, primitive) in primitives.into_iter().flatten().enumerate() {
            let has_variants = primitive
                .pointer("/extensions/KHR_materials_variants")
                .is_some();
            if has_variants {
                return Ok(false);
            }
            if primitive.get("material").and_then(as_index) != Some(material) {
                continue;
            }
            let uvs = document.texture_coordinates(mesh, number, texture.uv_set)?;
            let mut uvs = uvs.into_iter().flatten();
            let is_within = |uv: glam::DVec2| {
                let uv = texture.transform.apply(uv);
                uv.min_element() >= -RIM && uv.max_element() <= 1.0 + RIM
            };
            if !uvs.all(is_within) {
                return Ok(false);
            }
        }
    }
    Ok(true)
}

/// Gives the base colour texture of a material a sampler that clamps.
fn clamp(draft: &mut Draft, material: usize) {
    change_sampler(draft, material, |sampler| {
        for side in ["wrapS", "wrapT"] {
            sampler[side] = wrap_code(Wrap::ClampToEdge).into();
        }
    });
}
