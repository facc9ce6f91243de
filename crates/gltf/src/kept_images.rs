//! Images of a document that stay decoded, for who draws many levels of one tree.

use std::collections::HashMap;
use std::fmt;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

use super::Document;
use super::picture::Decoded;
use secateur_model::{Filters, Texture, Wrap};

/// Of an image by its number, how it wraps and how it is filtered.
type TextureKey = (usize, [Wrap; 2], Filters);

/// What was decoded since somebody asked to keep it; nothing before.
#[derive(Default)]
pub(crate) struct KeptImages {
    is_on: AtomicBool,
    decoded: Mutex<HashMap<usize, Decoded>>,
    textures: Mutex<HashMap<TextureKey, Arc<Texture>>>,
}

impl KeptImages {
    fn is_on(&self) -> bool {
        self.is_on.load(Ordering::Relaxed)
    }

    /// The image of this number, if it is kept.
    pub(crate) fn image(&self, index: usize) -> Option<Decoded> {
        let known = self.decoded.lock().unwrap_or_else(PoisonError::into_inner);
        known.get(&index).cloned()
    }

    pub(crate) fn keep_image(&self, index: usize, decoded: &Decoded) {
        if self.is_on() {
            let mut known = self.decoded.lock().unwrap_or_else(PoisonError::into_inner);
            known.insert(index, decoded.clone());
        }
    }

    /// The texture that was made of an image, or the one that is made now.
    pub(crate) fn texture(
        &self,
        key: TextureKey,
        make: impl FnOnce() -> Arc<Texture>,
    ) -> Arc<Texture> {
        if !self.is_on() {
            return make();
        }
        let mut known = self.textures.lock().unwrap_or_else(PoisonError::into_inner);
        Arc::clone(known.entry(key).or_insert_with(make))
    }
}

impl fmt::Debug for KeptImages {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let is_on = self.is_on();
        f.debug_struct("KeptImages").field("is_on", &is_on).finish()
    }
}

impl Document {
    /// Has images that are decoded from now on stay in memory with the document and the levels of its
    /// tree ([`Tree::lod_document`](crate::Tree::lod_document)), four bytes a texel and as much again for
    /// each way to wrap and filter them. All surfaces that show the same then share one texture.
    pub fn keep_images(&self) {
        self.kept_images.is_on.store(true, Ordering::Relaxed);
    }
}
