//! Alpha cutoffs of a level's own, and textures of it that are read without mip maps.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use serde_json::{Value, json};

use super::base_color::change_sampler;
use super::draft::Draft;
use super::files::{PreparedLod, WriteOptions};
use crate::error::GltfError;
use crate::tree::Tree;
use secateur_model::{AlphaMode, Lod, Mips};

/// What glTF has where a material that cuts out says nothing.
const DEFAULT_CUTOFF: f64 = 0.5;

/// Codes of filters in a sampler.
const NEAREST: u64 = 9728;
const LINEAR: u64 = 9729;
/// Nearest texels of one mip level, and of two.
const NEAREST_WITH_MIPS: [u64; 2] = [9984, 9986];

/// Which alpha cutoffs materials of a tree have in a level, where they are not those of the tree, and which
/// of them clients are to read without mip maps.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Cutoffs {
    of_materials: BTreeMap<usize, f64>,
    without_mips: BTreeSet<usize>,
}

impl Cutoffs {
    /// The cutoff of each of these materials, by its number in the file; in four digits, which a
    /// reader of the file can take in.
    pub fn new(of_materials: impl IntoIterator<Item = (usize, f64)>) -> Self {
        let rounded = |(material, cutoff): (usize, f64)| (material, (cutoff * 1e4).round() / 1e4);
        Self {
            of_materials: of_materials.into_iter().map(rounded).collect(),
            without_mips: BTreeSet::new(),
        }
    }

    /// The same, with base colour textures of these materials, by their numbers in the file, read without
    /// mip maps.
    #[must_use]
    pub fn without_mips(mut self, materials: impl IntoIterator<Item = usize>) -> Self {
        self.without_mips.extend(materials);
        self
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
        self.of_materials.is_empty() && self.without_mips.is_empty()
    }

    /// Whether something was chosen for a material.
    pub(super) fn has(&self, material: usize) -> bool {
        self.of_materials.contains_key(&material) || self.without_mips.contains(&material)
    }

    /// Gives them to the materials of a draft. What the file does not have, or does not cut out, stays
    /// as it is.
    pub(super) fn apply(&self, draft: &mut Draft, tree: &Tree) {
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
        self.prepare_lod_beside((lod, cutoffs), path, options, &[])
    }

    /// The materials of leaves that cut out what a texture with mip maps shows, by their numbers in
    /// the file.
    pub fn cut_out_materials(&self) -> Vec<usize> {
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
        let material = |part: &usize| {
            let part = &self.parts[*part];
            let look = document.look(part.mesh, part.primitive).ok()?;
            let is_masked = matches!(look.alpha_mode, AlphaMode::Mask(_));
            let texture = look.texture.filter(|texture| texture.image.is_some())?;
            let has_mips = texture.filters.mips != Mips::None;
            (is_masked && has_mips).then_some(look.material).flatten()
        };
        let mut materials: Vec<usize> = parts.iter().filter_map(material).collect();
        materials.sort_unstable();
        materials.dedup();
        materials
    }
}
