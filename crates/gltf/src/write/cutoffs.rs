//! Alpha cutoffs of a level's own.

use std::collections::BTreeMap;
use std::path::Path;

use serde_json::{Value, json};

use super::draft::Draft;
use super::files::{PreparedLod, WriteOptions};
use crate::error::GltfError;
use crate::tree::Tree;
use secateur_model::{AlphaMode, Lod, Mips};

/// What glTF has where a material that cuts out says nothing.
const DEFAULT_CUTOFF: f64 = 0.5;

/// Which alpha cutoffs materials of a tree have in a level, where they are not those of the tree.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Cutoffs(BTreeMap<usize, f64>);

impl Cutoffs {
    /// The cutoff of each of these materials, by its number in the file; in four digits, which a
    /// reader of the file can take in.
    pub fn new(of_materials: impl IntoIterator<Item = (usize, f64)>) -> Self {
        let rounded = |(material, cutoff): (usize, f64)| (material, (cutoff * 1e4).round() / 1e4);
        Self(of_materials.into_iter().map(rounded).collect())
    }

    /// Each material that has one of its own, by its number in the file, with its cutoff.
    pub fn of_materials(&self) -> impl Iterator<Item = (usize, f64)> {
        self.0.iter().map(|(material, cutoff)| (*material, *cutoff))
    }

    /// Whether all materials keep theirs.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    pub(super) fn has(&self, material: usize) -> bool {
        self.0.contains_key(&material)
    }

    /// Gives them to the materials of a draft. What the file does not have, or does not cut out, stays
    /// as it is.
    pub(super) fn apply(&self, draft: &mut Draft, tree: &Tree) {
        for (material, cutoff) in self.of_materials() {
            let fields = draft.root.pointer_mut(&format!("/materials/{material}"));
            let is_masked = |fields: &&mut Value| fields["alphaMode"] == "MASK";
            let Some(fields) = fields.filter(is_masked) else {
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
