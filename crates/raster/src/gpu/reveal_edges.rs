//! Fragments to what each leaf hides. The twin of `cpu::reveal_edges`.

use rayon::prelude::*;

use super::stages::PIXEL_WORKGROUP;
use super::{Device, Dispatch, GpuError};
use crate::{Fragments, RevealEdge};

/// The most pixels at a time.
const MAX_PIXELS: u64 = 1 << 20;

/// Bytes of a slot; slots are twice to four times as many as pixels.
const SLOT_BYTES: u64 = 8;

/// The edges of all views, equal to those of
/// [`cpu::reveal_edges`](crate::cpu::reveal_edges).
///
/// # Errors
/// [`GpuError`] if the device fails.
pub fn reveal_edges(device: &Device, fragments: &Fragments) -> Result<Vec<RevealEdge>, GpuError> {
    device.check()?;
    let bindable = device.binding_limit() / (4 * SLOT_BYTES);
    let most = bindable.clamp(1, MAX_PIXELS) as usize;
    let pixels = fragments.pixels_per_view() * fragments.views().len();
    let mut edges = Vec::new();
    for first in (0..pixels).step_by(most) {
        let end = (first + most).min(pixels);
        edges.extend(edges_of_pixels(device, fragments, first..end)?);
    }
    edges.par_sort_unstable();
    // A view's pixels may have been counted in parts.
    edges.dedup_by(|next, kept| {
        let is_same = (next.front, next.second, next.view) == (kept.front, kept.second, kept.view);
        kept.pixels += if is_same { next.pixels } else { 0 };
        is_same
    });
    Ok(edges)
}

fn edges_of_pixels(
    device: &Device,
    fragments: &Fragments,
    pixels: std::ops::Range<usize>,
) -> Result<Vec<RevealEdge>, GpuError> {
    let first_pixel = pixels.start as u32;
    let per_view = fragments.pixels_per_view();
    let list = |pixel: usize| fragments.views()[pixel / per_view].at(pixel % per_view);
    let leaves: Vec<[u32; 2]> = pixels
        .into_par_iter()
        .map(|pixel| match list(pixel) {
            [] => [0, 0],
            [front] => [front.leaf(), 0],
            [front, second, ..] => [front.leaf(), second.leaf()],
        })
        .collect();
    let pixel_count = leaves.len() as u32;
    let slot_count = (2 * pixel_count).next_power_of_two();
    let table = device.uniform(&[pixel_count, per_view as u32, slot_count, first_pixel]);
    let leaves = device.storage_of("front and second", leaves.as_flattened());
    let slots = device.storage("slots", SLOT_BYTES * u64::from(slot_count));
    let edge_count = device.storage("edge count", 4);
    let edges = device.storage("edges", 16 * u64::from(pixel_count));
    let insert = Dispatch {
        stage: &device.stages.insert,
        bindings: &[(0, &table), (1, &leaves), (2, &slots)],
        workgroups: [pixel_count.div_ceil(PIXEL_WORKGROUP), 1, 1],
    };
    let gather = Dispatch {
        stage: &device.stages.gather,
        bindings: &[
            (0, &table),
            (1, &leaves),
            (2, &slots),
            (3, &edges),
            (4, &edge_count),
        ],
        workgroups: [slot_count.div_ceil(PIXEL_WORKGROUP), 1, 1],
    };
    let found = device.run(&[insert, gather], &edge_count, 4)?[0];
    let words = device.run(&[], &edges, 16 * u64::from(found))?;
    Ok(words
        .chunks_exact(4)
        .map(|w| RevealEdge {
            front: w[0],
            second: w[1],
            view: w[2],
            pixels: w[3],
        })
        .collect())
}
