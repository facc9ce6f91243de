//! Removal orders as files: any level later, without simplifying again.
//!
//! ```text
//! "secateur lod"  version:u32 = 1 or 2              16 bytes, all little-endian
//! foliage_sha256:32 bytes                           of the leaves that the order is of
//! leaf_count:u32 step_count:u32 made_count:u32 shape_count:u32
//! shapes, then steps, bit by bit: the lowest bit of a byte first, zeros up to the last byte's end
//!
//! gamma   Elias' code: n zeros, 1, n bits; of a number from 1 on. "small" is gamma of it plus 1
//! name    as many bits as leaf_count + made_count has; leaves count from 1
//! leaf    as many bits as leaf_count has
//! shape   triangles:gamma, then per corner
//!           0 corner:small same-look             a corner of the donor
//!           1 plane 3 x f64 like:small           in the plane of three corners of the donor
//! plane   version 1: triangle:small, all three its corners; version 2: 3 x corner:small
//! step    0    one leaf goes: name
//!         10   one goes, one grows: name, name, area scale as f64
//!         110  two go, one is made: name, name, made
//!         111  removed:small grown:small made:small
//!              1 and the survivors' scale as f64 where it changes, else 0; names, growths, made
//! names   of more than two: 1 where they ascend, then their differences as gamma; or 0, names
//! made    1, number of the shape (as many bits as shape_count has), donor
//!         0, donor, triangles:gamma, then per corner
//!           0 which:1 corner:small same-look     a corner of the step's k-th removed leaf or the
//!                                                next one, where this is the k-th it makes
//!           10 corner:small                      as an earlier one of this leaf
//!           110 leaf corner:small same-look      a corner of any leaf
//!           1110 3 x f64 like:small              anywhere, in world space
//!           1111 as in a shape
//! donor   0 that of the step's k-th removed leaf, 10 of the next one, 11 leaf
//! same-look   1 where it looks like the donor's corner of that number; or 0, like:small
//! ```
//!
//! A leaf and its neighbour that grows take 64 bits of size and two names: 12.4 bytes among
//! 100,000 leaves. Two leaves that become one take about as much.

mod bits;
mod read;
mod write;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use secateur_model::{
    CornerRef, Foliage, LeafId, LodModel, NewLeaf, OrderError, Place, RemovalOrder,
};

pub use read::read_order;
pub use write::write_order;

const MAGIC: &[u8; 12] = b"secateur lod";

/// What files are of whose planes are all those of triangles.
const PLANES_OF_TRIANGLES: u32 = 1;

/// What files are of where planes are of any three corners of a leaf.
const PLANES_OF_CORNERS: u32 = 2;

const HEADER_BYTES: usize = 12 + 4 + 32 + 4 * 4;

/// Why bytes are no order of a foliage.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum OrderFileError {
    /// The first bytes are others.
    #[error("this is no removal order: it does not start with \"secateur lod\"")]
    NoOrder,
    /// A text that is no base64.
    #[error("the removal order is no base64")]
    NoBase64,
    /// Another version of the form.
    #[error("the removal order is of version {0}; only versions 1 and 2 can be read")]
    Version(u32),
    /// The order of other leaves.
    #[error("the removal order is of another tree, or of other leaves of it")]
    OtherTree,
    /// Fewer bytes than the counts say.
    #[error("the removal order is cut short: it ends in {part} {number} of {count}")]
    Truncated {
        /// What the file ends in: `step` or `shape`.
        part: &'static str,
        /// The number of that step or shape, from 1.
        number: usize,
        /// How many the file claims.
        count: u32,
    },
    /// Ends within its head.
    #[error("the removal order is cut short: {0} bytes are no whole head")]
    TruncatedHead(usize),
    /// Bytes after the last step.
    #[error("the removal order goes on for {0} bytes after its last step")]
    TooLong(u64),
    /// What a step is made of is not there.
    #[error("step {0} of the removal order names what is not there")]
    NoSuchThing(usize),
    /// Another number of made leaves than the head says.
    #[error("the removal order makes {made} leaves where its head says {claimed}")]
    MadeCount {
        /// Made leaves of the steps.
        made: usize,
        /// The count that the head claims.
        claimed: u32,
    },
    /// Steps that cannot be followed.
    #[error(transparent)]
    Order(#[from] OrderError),
}

/// [`write_order`] as a text, for the extras of a glTF.
pub fn order_to_base64(model: &LodModel, foliage: &Foliage) -> String {
    STANDARD.encode(write_order(model, foliage))
}

/// [`read_order`] of a text.
///
/// # Errors
/// As [`read_order`], and [`OrderFileError::NoBase64`].
pub fn order_from_base64(text: &str, foliage: &Foliage) -> Result<LodModel, OrderFileError> {
    let bytes = STANDARD.decode(text);
    read_order(&bytes.map_err(|_| OrderFileError::NoBase64)?, foliage)
}

/// How many bits hold any number up to this one.
fn width(largest: usize) -> u32 {
    usize::BITS - largest.leading_zeros()
}

/// The leaf that another looks like: itself if it is an original one.
fn donor_of(order: &RemovalOrder, leaf: LeafId) -> Option<LeafId> {
    match leaf.get().checked_sub(order.leaf_count() + 1) {
        None => Some(leaf),
        Some(made) => Some(order.made().get(made as usize)?.donor),
    }
}

/// A corner of a leaf, where that is one of the original foliage.
fn corner_of(order: &RemovalOrder, leaf: LeafId, corner: u32) -> Option<CornerRef> {
    let Some(made) = leaf.get().checked_sub(order.leaf_count() + 1) else {
        return Some(CornerRef { leaf, corner });
    };
    let corners = order.made().get(made as usize)?.triangles.as_flattened();
    match corners.get(corner as usize)?.place {
        Place::Of(at) => Some(at),
        Place::At(_) | Place::InPlaneOf { .. } => None,
    }
}

/// Whether a leaf has the form of a shape: made of its donor alone, of at most as many triangles, so
/// that a few bits do not make many.
fn is_shape(made: &NewLeaf, foliage: &Foliage) -> bool {
    let of_donor = foliage.triangles_of(made.donor).len();
    let is_of_donor = made
        .triangles
        .iter()
        .flatten()
        .all(|corner| match corner.place {
            Place::Of(at) => at.leaf == made.donor,
            Place::InPlaneOf { .. } => true,
            Place::At(_) => false,
        });
    is_of_donor && made.triangles.len() <= of_donor
}

#[cfg(test)]
mod seeds;
#[cfg(test)]
mod tests;
