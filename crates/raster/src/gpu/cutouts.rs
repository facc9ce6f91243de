//! Cut-outs as one buffer of words.

use std::sync::Arc;

use secateur_model::Cutout;

use super::{Device, GpuError};

/// Words of a cut-out's entry in the table before the bits.
const ENTRY_WORDS: usize = 3;

/// The masks in the layout that `rasterise.wgsl` reads.
pub(super) fn upload(device: &Device, cutouts: &[Arc<Cutout>]) -> Result<wgpu::Buffer, GpuError> {
    let bits: usize = cutouts.iter().map(|c| c.words().len()).sum();
    let bytes = 4 * (cutouts.len() * ENTRY_WORDS + bits) as u64;
    if bytes > device.binding_limit() {
        return Err(GpuError::TooLarge {
            what: "the leaves' cut-outs together",
            bytes,
            limit: device.binding_limit(),
        });
    }
    let mut words = Vec::with_capacity(bytes as usize / 4);
    let mut start = cutouts.len() * ENTRY_WORDS;
    for cutout in cutouts {
        let wrap = cutout.wrap().map(|w| w as u32);
        words.extend([
            start as u32,
            cutout.width() | cutout.height() << 16,
            wrap[0] | wrap[1] << 16,
        ]);
        start += cutout.words().len();
    }
    for cutout in cutouts {
        words.extend_from_slice(cutout.words());
    }
    Ok(device.storage_of("cut-outs", &words))
}
