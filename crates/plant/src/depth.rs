//! How long a way from the root may be.

use crate::Segment;

/// The most segments on a way from a root to a tip that [`check_depth`] lets pass:
/// several times those of a species with a million leaves.
pub const MAX_DEPTH: u32 = 10_000;

/// A skeleton with too many segments one on another.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "segment {segment} of the skeleton grows {depth} segments above its root: levels of detail by \
     branches are for {MAX_DEPTH} at most"
)]
pub struct TooDeep {
    /// The first such segment, from 0.
    pub segment: usize,
    /// How many segments lead to it, itself included.
    pub depth: u32,
}

/// Whether chains and merging, whose time goes with leaves times depth, come to an
/// end soon on these segments, which may be any file's. Parents come before
/// children.
///
/// # Errors
/// [`TooDeep`] beyond [`MAX_DEPTH`].
///
/// # Panics
/// If a parent is not an earlier segment.
pub fn check_depth(segments: &[Segment]) -> Result<(), TooDeep> {
    let mut depths: Vec<u32> = Vec::with_capacity(segments.len());
    for (segment, parent) in segments.iter().map(|s| s.parent).enumerate() {
        let depth = 1 + parent.map_or(0, |parent| depths[parent.index()]);
        if depth > MAX_DEPTH {
            return Err(TooDeep { segment, depth });
        }
        depths.push(depth);
    }
    Ok(())
}
