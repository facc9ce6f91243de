//! A plant that can be drawn while it arrives: every prefix is a plant.
//!
//! The coarsest level comes first, then what makes it finer, up to the original: the progressive
//! sending of Lluch et al. (Hybrid, ICCS 2010, section 6), with any removal order in the place of
//! their chain. A stream that is cut anywhere behind its first piece is the plant of the pieces before
//! the cut; the whole stream is the original.
//!
//! ```text
//! "secateur stream" 0                16 bytes, then all little-endian:
//! version:u32 = 2
//! tag:16 bytes                       of the leaves and their order: no other stream has it
//! pieces, one after another
//!
//! piece   number:u32                 from 0
//!         tag:u32                    the first four bytes of the stream's
//!         packed_bytes:u32 bytes:u32 of the body, as it lies here and as it is
//!         body                       in zlib's form
//! body    of piece 0 only: head_bytes:u32 pictures_bytes:u32, head (JSON), pictures (PNG files),
//!         each filled up with zeros to a multiple of 4 that the counts leave out
//!         steps:u32                  of the removal order that are made at this level
//!         leaves:u32 scale:f32       of the level, and by what all its original leaves are scaled
//!         gone:u32 resized:u32
//!         gone x name:u32            parts that go
//!         resized x name:u32, resized x scale:f32
//!         for each surface of the head, what is new in it:
//!           parts:u32 vertices:u32 triangles:u32
//!           parts x name:u32, parts x vertices:u32, parts x triangles:u32
//!           parts x centre:3f32, parts x scale:f32
//!           vertices x position:3f32
//!           vertices x normal:2i16   where the surface has normals: on an unfolded octahedron
//!           vertices x uv:2f32       where it has texture coordinates
//!           vertices x colour:4u16   where it has colours
//!           vertices x hold:3f32,f32,u32
//!                                    where it says what it hangs on: the pivot, how far that is
//!                                    along the wood, and the number of the piece of wood, 0 for
//!                                    none; all of a leaf or piece that is scaled sways by these
//!           triangles x 3 corner:u32 vertices of their part, from 0
//! ```
//!
//! A part is a leaf or a connected piece of wood. Leaves have the names that the removal order has
//! for them; those up to `leaf_names` of the head are original ones. Surfaces hold their parts in the
//! order of names. A position is drawn at centre + scale * (position - centre), and at itself where the
//! scale is 1: so the last piece ends in the original's positions as f32, bit for bit. Normals have 16
//! bits a coordinate, colours 16 bits, and pictures at most 2,048 texels a side. Other attributes are not
//! sent, nor skins, morph targets and animations: the plant is sent as it stands.

mod bytes;
mod head;
mod not_sent;
mod page;
mod part;
mod read;
mod wood;
mod write;

use crate::preview::PreviewError;

pub(crate) use part::{Leaves, Part};

pub use not_sent::not_sent;
pub use page::stream_page;
pub use read::{StreamReader, StreamedPlant, read_stream};
pub use write::{Piece, Stream, stream_of_bodies, write_stream};

const MAGIC: &[u8; 16] = b"secateur stream\0";
const VERSION: u32 = 2;
/// What comes before the first piece, and before a piece's body.
const START_BYTES: usize = 16 + 4 + 16;
const PIECE_HEAD_BYTES: usize = 16;
/// The most that a body may be larger than it is packed: more is not written, and is refused.
const MOST_UNPACKED: u64 = 256;

/// Why bytes are no stream of a plant.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum StreamError {
    /// The first bytes are others.
    #[error("this is no stream of a plant: it does not start with \"secateur stream\"")]
    NoStream,
    /// Another version of the form.
    #[error("the stream is of version {0}; this program reads version 2")]
    Version(u32),
    /// The stream ends before there is a plant.
    #[error(
        "the stream is cut short within its first piece: {found} bytes of at least {needed} that \
         are needed for a plant"
    )]
    CutShort {
        /// How many there are.
        found: u64,
        /// How many are needed, as far as is known.
        needed: u64,
    },
    /// A piece of another stream.
    #[error("piece {0} of the stream is of another tree, or of another removal order")]
    OtherTree(u32),
    /// A piece that is not the next one.
    #[error("the stream has piece {found} where piece {expected} should be")]
    OutOfOrder {
        /// The number that is there.
        found: u32,
        /// The number of the next piece.
        expected: u32,
    },
    /// A body that is not what zlib makes, or of another length than is said.
    #[error("piece {0} of the stream cannot be unpacked")]
    Packing(u32),
    /// A body that cannot be followed.
    #[error("piece {number} of the stream is damaged: {what}")]
    Damaged {
        /// The number of the piece, counted from the first.
        number: u32,
        /// What is wrong with it, as the end of a sentence.
        what: &'static str,
    },
    /// Bytes behind the last piece.
    #[error("the stream goes on after its last piece")]
    TooLong,
}

/// Why a tree is not made into a stream.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum WriteStreamError {
    /// A picture that cannot be packed, or nothing to see.
    #[error(transparent)]
    Picture(#[from] PreviewError),
    /// A piece beyond 4 GiB.
    #[error("a piece of the stream would have more than 4 GiB")]
    TooLarge,
    /// More parts than 32 bits count.
    #[error("a stream has at most 4,294,967,295 parts")]
    TooMany,
}

#[cfg(test)]
mod seeds;
#[cfg(test)]
mod tests;
