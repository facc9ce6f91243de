//! Alpha masks of leaf materials.

use std::collections::HashMap;
use std::sync::Arc;

use super::error::Fault;
use super::material::{MaterialLook, TextureUse};
use super::parts::check_limit;
use super::picture::{Decoded, Pictures};
use secateur_model::{AlphaMode, Cutout, Wrap};

/// The cutoff at which blended leaves count as cut out.
const BLEND_CUTOFF: f32 = 0.5;

/// The masks of a foliage; materials that cut out alike share one.
#[derive(Default)]
pub(crate) struct Cutouts {
    pub(crate) masks: Vec<Arc<Cutout>>,
    known: HashMap<Key, Option<u32>>,
    bytes: u64,
}

/// What a mask depends on.
#[derive(Clone, Copy, PartialEq, Eq, Hash)]
struct Key {
    image: Option<usize>,
    wrap: [Wrap; 2],
    /// For each alpha whether its texels are there, as bits.
    kept: [u64; 4],
}

impl Key {
    fn is_kept(&self, alpha: u8) -> bool {
        self.kept[usize::from(alpha / 64)] >> (alpha % 64) & 1 == 1
    }
}

/// The most bytes of all masks of one foliage. One takes up to half a mebibyte, those
/// of usual leaf textures a hundredth of that.
const MAX_MASK_BYTES: u64 = 256 << 20;

/// The cutoff of a look's alpha, `None` where alpha is ignored.
pub(crate) fn cutoff(look: &MaterialLook) -> Option<f32> {
    match look.alpha_mode {
        AlphaMode::Opaque => None,
        AlphaMode::Mask(cutoff) => Some(cutoff),
        AlphaMode::Blend => Some(BLEND_CUTOFF),
    }
}

/// Whether a texel of this alpha is there, in f32 as renderers compare.
pub(crate) fn is_kept(alpha: u8, factor: f32, cutoff: f32) -> bool {
    f32::from(alpha) / 255.0 * factor >= cutoff
}

impl Cutouts {
    /// The index of the mask of a look, or `None` where every texel is kept.
    pub(crate) fn index(
        &mut self,
        look: &MaterialLook,
        pictures: &mut Pictures<'_>,
    ) -> Result<Option<u32>, Fault> {
        let Some(cutoff) = cutoff(look) else {
            return Ok(None);
        };
        let key = Key {
            image: look.texture.and_then(|t| t.image),
            wrap: look
                .texture
                .map_or([Wrap::Repeat; 2], |t: TextureUse| t.wrap),
            kept: kept_alphas(look.base_color[3], cutoff),
        };
        self.of_key(key, pictures)
    }

    /// The index of a mask that keeps nothing.
    pub(crate) fn of_nothing(&mut self, pictures: &mut Pictures<'_>) -> Result<Option<u32>, Fault> {
        let key = Key {
            image: None,
            wrap: [Wrap::Repeat; 2],
            kept: [0; 4],
        };
        self.of_key(key, pictures)
    }

    fn of_key(&mut self, key: Key, pictures: &mut Pictures<'_>) -> Result<Option<u32>, Fault> {
        if let Some(index) = self.known.get(&key) {
            return Ok(*index);
        }
        let mask = mask(key, pictures)?;
        let words = mask.as_ref().map_or(0, |mask| mask.words().len());
        self.bytes += 4 * words as u64;
        check_limit("bytes of different alpha masks", self.bytes, MAX_MASK_BYTES)?;
        let index = mask.map(|mask| {
            self.masks.push(Arc::new(mask));
            self.masks.len() as u32 - 1
        });
        self.known.insert(key, index);
        Ok(index)
    }
}

fn kept_alphas(factor: f32, cutoff: f32) -> [u64; 4] {
    std::array::from_fn(|word| {
        (0..64u8)
            .filter(|bit| is_kept(64 * word as u8 + bit, factor, cutoff))
            .fold(0, |bits, bit| bits | 1 << bit)
    })
}

/// The mask, or `None` where every texel is kept.
fn mask(key: Key, pictures: &mut Pictures<'_>) -> Result<Option<Cutout>, Fault> {
    let picture = match key.image {
        Some(image) => pictures.get(image)?,
        None => Decoded::Unusable("no image".into()),
    };
    Ok(match picture {
        Decoded::Picture(picture) => {
            let tally = &picture.tally;
            if (0..=255).all(|alpha| key.is_kept(alpha) || tally.texels(alpha) == 0) {
                return Ok(None);
            }
            let image = &picture.image;
            let size = [image.width(), image.height()];
            let is_opaque = |x, y| key.is_kept(image.get_pixel(x, y).0[3]);
            Some(Cutout::from_fn(size, key.wrap, is_opaque))
        }
        Decoded::Unusable(_) if key.is_kept(255) => None,
        Decoded::Unusable(_) => Some(Cutout::from_fn([1, 1], key.wrap, |_, _| false)),
    })
}
