//! What the textures of a level take in a client's memory.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use secateur_gltf::Document;
use secateur_gltf::chain::LevelTexture;
use secateur_model::{Mips, Texture};

/// Bytes of all images that these materials of a file use, four a texel, one a texel in blocks, mips where they are read; textures of a level's
/// own count in place of theirs.
pub fn texture_bytes(
    document: &Document,
    materials: &[Option<usize>],
    own: &[LevelTexture],
) -> u64 {
    let materials: BTreeSet<usize> = materials.iter().copied().flatten().collect();
    let mut images: BTreeMap<usize, u64> = BTreeMap::new();
    for material in materials {
        let own = own.iter().filter(|own| own.material == material);
        let replaced: Vec<Option<usize>> = own.map(|own| own.image).collect();
        for image in document.images_of_material(material) {
            let place = (!image.is_base_color).then_some(image.image);
            if replaced.contains(&place) {
                continue;
            }
            let bytes = match image.is_in_blocks {
                true => blocks_bytes(image.size, image.has_mips),
                false => image_bytes(image.size, image.has_mips),
            };
            let known = images.entry(image.image).or_insert(0);
            *known = bytes.max(*known);
        }
    }
    let mut own: Vec<&Arc<Texture>> = own.iter().map(|own| &own.texture).collect();
    own.sort_by_key(|texture| Arc::as_ptr(texture));
    own.dedup_by_key(|texture| Arc::as_ptr(texture));
    let own = own.into_iter().map(|texture| bytes_of(texture));
    images.into_values().chain(own).sum()
}

/// The bytes of one texture.
pub(crate) fn bytes_of(texture: &Texture) -> u64 {
    let has_mips = texture.filters.mips != Mips::None;
    image_bytes([texture.width, texture.height], has_mips)
}

/// Four bytes a texel.
fn image_bytes(size: [u32; 2], has_mips: bool) -> u64 {
    with_mips(size, has_mips, |[width, height]| {
        4 * u64::from(width) * u64::from(height)
    })
}

/// 16 bytes for each block of 4 x 4 texels.
fn blocks_bytes(size: [u32; 2], has_mips: bool) -> u64 {
    with_mips(size, has_mips, |size| {
        let [wide, high] = size.map(|side| u64::from(side.div_ceil(4)));
        16 * wide * high
    })
}

fn with_mips([mut width, mut height]: [u32; 2], has_mips: bool, of: fn([u32; 2]) -> u64) -> u64 {
    let mut bytes = 0;
    loop {
        bytes += of([width, height]);
        if !has_mips || width.max(height) <= 1 {
            return bytes;
        }
        (width, height) = ((width / 2).max(1), (height / 2).max(1));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn mips_count_where_they_are_read() {
        assert_eq!(image_bytes([4, 2], false), 4 * 8);
        assert_eq!(image_bytes([4, 2], true), 4 * (8 + 2 + 1));
        assert_eq!(image_bytes([1, 1], true), 4);
        assert_eq!(blocks_bytes([8, 4], false), 2 * 16);
        assert_eq!(blocks_bytes([8, 4], true), (2 + 1 + 1 + 1) * 16);
    }
}
