//! Alpha masks of leaf materials.

use std::sync::Arc;

use super::error::Fault;
use super::material::{Look, TextureUse};
use super::picture::{Decoded, Pictures};
use crate::{AlphaMode, Cutout, Wrap};

/// The cutoff at which blended leaves count as cut out.
const BLEND_CUTOFF: f32 = 0.5;

/// The masks of a foliage; materials that cut out alike share one.
#[derive(Default)]
pub(crate) struct Cutouts {
    pub(crate) masks: Vec<Arc<Cutout>>,
    known: Vec<(Key, Option<u32>)>,
}

/// What a mask depends on.
#[derive(Clone, Copy, PartialEq)]
struct Key {
    image: Option<usize>,
    wrap: [Wrap; 2],
    cutoff: f32,
    factor: f32,
}

/// The cutoff of a look's alpha, `None` where alpha is ignored.
pub(crate) fn cutoff(look: &Look) -> Option<f32> {
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
        look: &Look,
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
            cutoff,
            factor: look.base_color[3],
        };
        if let Some((_, index)) = self.known.iter().find(|(known, _)| *known == key) {
            return Ok(*index);
        }
        let mask = self.mask(key, pictures)?;
        let index = mask.map(|mask| {
            self.masks.push(Arc::new(mask));
            self.masks.len() as u32 - 1
        });
        self.known.push((key, index));
        Ok(index)
    }

    fn mask(&self, key: Key, pictures: &mut Pictures<'_>) -> Result<Option<Cutout>, Fault> {
        let picture = match key.image {
            Some(image) => pictures.get(image)?,
            None => Decoded::Unusable("no image".into()),
        };
        let kept: [bool; 256] =
            std::array::from_fn(|alpha| is_kept(alpha as u8, key.factor, key.cutoff));
        Ok(match picture {
            Decoded::Picture(picture) => {
                let is_opaque = |x, y| kept[usize::from(picture.get_pixel(x, y).0[3])];
                if picture.pixels().all(|p| kept[usize::from(p.0[3])]) {
                    return Ok(None);
                }
                let size = [picture.width(), picture.height()];
                Some(Cutout::from_fn(size, key.wrap, is_opaque))
            }
            Decoded::Unusable(_) if kept[255] => None,
            Decoded::Unusable(_) => Some(Cutout::from_fn([1, 1], key.wrap, |_, _| false)),
        })
    }
}
