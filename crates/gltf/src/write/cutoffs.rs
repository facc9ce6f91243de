//! What materials of a level have of their own: alpha cutoffs, textures that are read without mip maps, and other
//! texels.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;
use std::sync::Arc;

use serde_json::{Value, json};

use super::base_color::change_sampler;
use super::draft::Draft;
use super::files::{PreparedLod, WriteOptions};
use super::references::as_index;
use super::texels;
use crate::error::{ALLOW_MORE, GltfError, Problem};
use crate::material::{MaterialLook, base_color_texture};
use crate::picture::Pictures;
use crate::surfaces::texture_of;
use crate::tree::Tree;
use secateur_model::{AlphaMode, Lod, Mips, Texture};

/// What glTF has where a material that cuts out says nothing.
const DEFAULT_CUTOFF: f64 = 0.5;

/// What a texel of an image takes that is changed: the new one, what it is made from, and its PNG.
const BYTES_A_CHANGED_TEXEL: u64 = 16;

/// Codes of filters in a sampler.
const NEAREST: u64 = 9728;
const LINEAR: u64 = 9729;
/// Nearest texels of one mip level, and of two.
const NEAREST_WITH_MIPS: [u64; 2] = [9984, 9986];

/// Which alpha cutoffs materials of a tree have in a level, where they are not those of the tree, which
/// of them clients are to read without mip maps, and which have other texels.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Cutoffs {
    of_materials: BTreeMap<usize, f64>,
    without_mips: BTreeSet<usize>,
    texels: BTreeMap<usize, Arc<Texture>>,
}

/// The base colour texture of leaves that are cut out.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct CutOutTexture {
    /// The number of the material in the file.
    pub material: usize,
    /// The number of its image in the file.
    pub image: usize,
    /// Its texels and its sampler.
    pub texture: Arc<Texture>,
    /// The alpha of a texel, 0 to 1, from which on it is shown.
    pub cutoff: f32,
}

impl Cutoffs {
    /// The cutoff of each of these materials, by its number in the file; in four digits, which a
    /// reader of the file can take in.
    pub fn new(of_materials: impl IntoIterator<Item = (usize, f64)>) -> Self {
        let rounded = |(material, cutoff): (usize, f64)| (material, (cutoff * 1e4).round() / 1e4);
        Self {
            of_materials: of_materials.into_iter().map(rounded).collect(),
            ..Self::default()
        }
    }

    /// These cutoffs, with base colour textures of these materials, by their numbers in the file, read without
    /// mip maps.
    #[must_use]
    pub fn without_mips(mut self, materials: impl IntoIterator<Item = usize>) -> Self {
        self.without_mips.extend(materials);
        self
    }

    /// These cutoffs, with the texels of these textures as base colour of materials, by their numbers in the file:
    /// PNG images in the result, read by the samplers that were there. Of materials that share an image the first
    /// says what it becomes.
    #[must_use]
    pub fn with_texels(mut self, texels: impl IntoIterator<Item = (usize, Arc<Texture>)>) -> Self {
        self.texels.extend(texels);
        self
    }

    /// Each material whose base colour has other texels, by its number in the file.
    pub fn materials_with_texels(&self) -> impl Iterator<Item = usize> {
        self.texels.keys().copied()
    }

    /// Each material that has one of its own, by its number in the file, with its cutoff.
    pub fn of_materials(&self) -> impl Iterator<Item = (usize, f64)> {
        let pairs = self.of_materials.iter();
        pairs.map(|(material, cutoff)| (*material, *cutoff))
    }

    /// Each material whose base colour texture is read without mip maps, by its number in the file.
    pub fn materials_without_mips(&self) -> impl Iterator<Item = usize> {
        self.without_mips.iter().copied()
    }

    /// Whether all materials stay as they are.
    pub fn is_empty(&self) -> bool {
        self.of_materials.is_empty() && self.without_mips.is_empty() && self.texels.is_empty()
    }

    /// Whether a cutoff was chosen for a material, or no mip maps.
    pub(super) fn has(&self, material: usize) -> bool {
        self.of_materials.contains_key(&material) || self.without_mips.contains(&material)
    }

    /// Gives them to the materials of a draft. What the file does not have, or does not cut out, stays
    /// as it is.
    pub(super) fn apply(&self, draft: &mut Draft, tree: &Tree) {
        texels::replace(draft, &self.texels);
        for material in self.materials_with_texels() {
            let change = match masked(draft, material) {
                Some(_) => {
                    "clear texels of its texture have other colours, or an alpha below the cutoff, so that mip maps show leaves as they are"
                }
                None => {
                    "its texture has the colours of what is near where the plant shows nothing of it, so that a coarser mesh shows no slits"
                }
            };
            let place = tree.document.place("materials", material);
            draft.notes.push(format!("{place}: {change}"));
        }
        for material in self.materials_without_mips() {
            if masked(draft, material).is_none() {
                continue;
            }
            change_sampler(draft, material, leave_out_mips);
            let place = tree.document.place("materials", material);
            draft.notes.push(format!(
                "{place}: its texture is read without mip maps, so that clients show as much of the crown from afar as there is"
            ));
        }
        for (material, cutoff) in self.of_materials() {
            let Some(fields) = masked(draft, material) else {
                continue;
            };
            let before = fields["alphaCutoff"].as_f64().unwrap_or(DEFAULT_CUTOFF);
            fields["alphaCutoff"] = json!(cutoff);
            let place = tree.document.place("materials", material);
            draft.notes.push(format!(
                "{place}: its alphaCutoff is {cutoff} instead of {before}, so that clients show as much of the crown from afar as there is"
            ));
        }
    }
}

/// The fields of a material that cuts out.
fn masked<'a>(draft: &'a mut Draft, material: usize) -> Option<&'a mut Value> {
    let fields = draft.root.pointer_mut(&format!("/materials/{material}"));
    fields.filter(|fields| fields["alphaMode"] == "MASK")
}

/// Makes a sampler read the image alone where it is shown small, filtered as it was.
fn leave_out_mips(sampler: &mut Value) {
    let before = sampler["minFilter"].as_u64().unwrap_or(LINEAR);
    let is_nearest = before == NEAREST || NEAREST_WITH_MIPS.contains(&before);
    sampler["minFilter"] = json!(if is_nearest { NEAREST } else { LINEAR });
}

/// Whether an extension names a copy of a material's base colour image.
fn has_other_formats(tree: &Tree, material: usize) -> bool {
    let root = &tree.document.root;
    let texture = root["materials"].get(material).and_then(base_color_texture);
    let number = texture.and_then(|info| as_index(info.get("index")?));
    let Some(texture) = number.and_then(|number| root["textures"].get(number)) else {
        return false;
    };
    let extensions = texture.get("extensions").and_then(Value::as_object);
    // An image that is named in an extension alone is no copy.
    let names_own = usize::from(texture.get("source").is_some());
    extensions.is_some_and(|all| all.len() + names_own > 1)
}

impl Tree {
    /// [`prepare_lod`](Self::prepare_lod) with alpha cutoffs of its own.
    ///
    /// # Errors
    /// As [`prepare_lod`](Self::prepare_lod).
    ///
    /// # Panics
    /// If the LOD is of another number of leaves.
    pub fn prepare_lod_with(
        &self,
        lod: &Lod,
        cutoffs: &Cutoffs,
        path: &Path,
        options: WriteOptions,
    ) -> Result<PreparedLod, GltfError> {
        self.prepare_lod_beside((lod, cutoffs), (path, true), options, &[])
    }

    /// The materials of leaves that cut out what a texture with mip maps shows, by their numbers in
    /// the file.
    pub fn cut_out_materials(&self) -> Vec<usize> {
        self.cut_out_looks().into_keys().collect()
    }

    /// The base colour textures of these materials. Those that can't be decoded, or have an image in another
    /// format than PNG and JPEG beside, are left out. Room to change each image once is taken, too.
    ///
    /// # Errors
    /// [`GltfError`] if an image can't be read, or they are too large.
    pub fn cut_out_textures(&self) -> Result<Vec<CutOutTexture>, GltfError> {
        let mut pictures = Pictures::new(&self.document, self.document.budget);
        let mut found: Vec<CutOutTexture> = Vec::new();
        for (material, look) in self.cut_out_looks() {
            let (AlphaMode::Mask(cutoff), Some(used)) = (look.alpha_mode, look.texture) else {
                continue;
            };
            let Some(image) = used.image.filter(|_| !has_other_formats(self, material)) else {
                continue;
            };
            let texture = texture_of(used, &mut pictures);
            let Some(texture) = texture.map_err(|fault| self.document.error(fault))? else {
                continue;
            };
            if found.iter().all(|other| other.image != image) {
                let bytes = BYTES_A_CHANGED_TEXEL * (texture.rgba.len() as u64 / 4);
                let [width, height] = [texture.width, texture.height];
                let what = || format!("an image of {width} x {height} texels to change");
                let taken = pictures.budget.take(bytes, what, ALLOW_MORE);
                taken.map_err(|over| self.document.error(Problem::from(over)))?;
            }
            found.push(CutOutTexture {
                material,
                image,
                texture,
                cutoff: cutoff / look.base_color[3],
            });
        }
        Ok(found)
    }

    fn cut_out_looks(&self) -> BTreeMap<usize, MaterialLook> {
        let document = &self.document;
        let mut parts: Vec<usize> = Vec::new();
        for source in &self.leaf_sources {
            let part = source.part as usize;
            if parts.last() != Some(&part) {
                parts.push(part);
            }
        }
        parts.sort_unstable();
        parts.dedup();
        let look = |part: &usize| {
            let part = &self.parts[*part];
            let look = document.look(part.mesh, part.primitive).ok()?;
            let is_masked = matches!(look.alpha_mode, AlphaMode::Mask(_));
            let texture = look.texture.filter(|texture| texture.image.is_some())?;
            let has_mips = texture.filters.mips != Mips::None;
            let material = look.material.filter(|_| is_masked && has_mips)?;
            Some((material, look))
        };
        parts.iter().filter_map(look).collect()
    }
}
