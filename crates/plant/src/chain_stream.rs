//! A chain as bytes that can be drawn while they arrive.
//!
//! ```text
//! "secateur chain 1"            16 bytes, then records, all little-endian:
//! 0                             LEVEL
//! 1 id:u32                      SAVE
//! 2 id:u32                      RESTORE
//! 3 continues:u8 sides:u32 start:3f64 end:3f64 start_radius:f64 end_radius:f64
//! 4 number:u32 base:3f64 along:3f64 facing:3f64 length:f64 width:f64 kind:u8
//!                               kind: 0 quad, 1 crossed, 2 needle, or a blade's
//!                               triangles plus 128
//! ```
//!
//! There are no counts in front: a stream may end after any record.

use std::io::{self, Read, Write};

use glam::DVec3;

use crate::chain::{ChainError, Interpreter, Record};
use crate::{LeafKind, LeafPose, Segment, SegmentIndex};

const MAGIC: &[u8; 16] = b"secateur chain 1";

/// Why a chain cannot be read.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum StreamError {
    /// The first bytes are not a chain's.
    #[error("this is no chain: it does not start with \"secateur chain 1\"")]
    NoChain,
    /// A record of no known kind.
    #[error("byte {offset} of the chain starts a record of the unknown kind {kind}")]
    UnknownKind {
        /// Where the record starts, in bytes from 0.
        offset: u64,
        /// The first byte, which names the kind.
        kind: u8,
    },
    /// A leaf of no known kind.
    #[error("byte {offset} of the chain starts a leaf of the unknown kind {kind}")]
    UnknownLeaf {
        /// Where its record starts, from 0.
        offset: u64,
        /// The first byte, which names the kind.
        kind: u8,
    },
    /// The stream ends inside a record.
    #[error("the chain ends inside the record that starts at byte {offset}")]
    Truncated {
        /// Where the record starts, from 0.
        offset: u64,
    },
    /// The records cannot be drawn.
    #[error(transparent)]
    Chain(#[from] ChainError),
    /// The source cannot be read.
    #[error("the chain cannot be read: {0}")]
    Io(#[from] io::Error),
}

/// Writes records to a stream, such as [`Chain::prefix`](crate::Chain::prefix).
///
/// # Errors
/// What `to` says; [`io::ErrorKind::InvalidInput`] for a leaf whose blade is not
/// of 2 to 18 triangles, an even number.
pub fn write_chain(records: &[Record], to: &mut impl Write) -> io::Result<()> {
    to.write_all(MAGIC)?;
    for record in records {
        if let Record::Leaf(number, leaf) = record
            && kind_of(kind_byte(leaf.kind)) != Some(leaf.kind)
        {
            let why = format!("leaf {number} is a {:?}, which no chain holds", leaf.kind);
            return Err(io::Error::new(io::ErrorKind::InvalidInput, why));
        }
        to.write_all(&bytes_of(record))?;
    }
    Ok(())
}

fn bytes_of(record: &Record) -> Vec<u8> {
    let mut bytes = Vec::with_capacity(96);
    let mut reals = |head: &[u8], vectors: &[DVec3], scalars: &[f64]| {
        bytes.extend_from_slice(head);
        let all = vectors.iter().flat_map(|v| v.to_array());
        for real in all.chain(scalars.iter().copied()) {
            bytes.extend_from_slice(&real.to_le_bytes());
        }
    };
    match *record {
        Record::Level => reals(&[0], &[], &[]),
        Record::Save(id) => reals(&headed(1, id.index() as u32), &[], &[]),
        Record::Restore(id) => reals(&headed(2, id.index() as u32), &[], &[]),
        Record::Segment(s) => {
            let mut head = vec![3, u8::from(s.continues_parent)];
            head.extend_from_slice(&s.sides.to_le_bytes());
            let radii = [s.start_radius_m, s.end_radius_m];
            reals(&head, &[s.start, s.end], &radii);
        }
        Record::Leaf(number, leaf) => {
            let vectors = [leaf.base, leaf.along, leaf.facing];
            let sizes = [leaf.length_m, leaf.width_m];
            reals(&headed(4, number), &vectors, &sizes);
            bytes.push(kind_byte(leaf.kind));
        }
    }
    bytes
}

fn kind_byte(kind: LeafKind) -> u8 {
    match kind {
        LeafKind::Quad => 0,
        LeafKind::Crossed => 1,
        LeafKind::Needle => 2,
        LeafKind::Blade { triangles } => 128 + triangles.min(127),
    }
}

fn kind_of(byte: u8) -> Option<LeafKind> {
    match byte {
        0 => Some(LeafKind::Quad),
        1 => Some(LeafKind::Crossed),
        2 => Some(LeafKind::Needle),
        blade => {
            let triangles = blade.checked_sub(128)?;
            let is_blade = (2..=18).contains(&triangles) && triangles.is_multiple_of(2);
            is_blade.then_some(LeafKind::Blade { triangles })
        }
    }
}

fn headed(kind: u8, number: u32) -> [u8; 5] {
    let [a, b, c, d] = number.to_le_bytes();
    [kind, a, b, c, d]
}

/// Reads a chain and draws it as it comes. `seen` is shown the plant after each
/// record and may end the reading by returning false.
///
/// Memory in proportion to what has been drawn.
///
/// # Errors
/// [`StreamError`]; `seen` has been shown all that came before. An end between
/// records is none.
pub fn read_chain(
    from: &mut impl Read,
    seen: &mut dyn FnMut(&Interpreter) -> bool,
) -> Result<Interpreter, StreamError> {
    let mut source = Source { from, offset: 0 };
    let magic: [u8; 16] = source.take().map_err(|error| match error {
        StreamError::Truncated { .. } => StreamError::NoChain,
        other => other,
    })?;
    source.offset = MAGIC.len() as u64;
    if &magic != MAGIC {
        return Err(StreamError::NoChain);
    }
    let mut interpreter = Interpreter::default();
    while let Some(record) = source.record()? {
        interpreter.obey(&record)?;
        if !seen(&interpreter) {
            break;
        }
    }
    Ok(interpreter)
}

struct Source<'a, R> {
    from: &'a mut R,
    /// Where the record starts that is being read.
    offset: u64,
}

impl<R: Read> Source<'_, R> {
    fn record(&mut self) -> Result<Option<Record>, StreamError> {
        let mut kind = [0];
        loop {
            match self.from.read(&mut kind) {
                Ok(0) => return Ok(None),
                Ok(_) => break,
                Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
                Err(error) => return Err(error.into()),
            }
        }
        let (record, bytes) = match kind[0] {
            0 => (Record::Level, 1),
            1 => (Record::Save(self.id()?), 5),
            2 => (Record::Restore(self.id()?), 5),
            3 => (Record::Segment(self.segment()?), 70),
            4 => (Record::Leaf(self.number()?, self.leaf()?), 94),
            kind => {
                let offset = self.offset;
                return Err(StreamError::UnknownKind { offset, kind });
            }
        };
        self.offset += bytes;
        Ok(Some(record))
    }

    fn take<const N: usize>(&mut self) -> Result<[u8; N], StreamError> {
        let mut bytes = [0; N];
        match self.from.read_exact(&mut bytes) {
            Ok(()) => Ok(bytes),
            Err(error) if error.kind() == io::ErrorKind::UnexpectedEof => {
                Err(StreamError::Truncated {
                    offset: self.offset,
                })
            }
            Err(error) => Err(error.into()),
        }
    }

    fn number(&mut self) -> Result<u32, StreamError> {
        self.take().map(u32::from_le_bytes)
    }

    fn id(&mut self) -> Result<SegmentIndex, StreamError> {
        Ok(SegmentIndex::from_index(self.number()? as usize))
    }

    fn real(&mut self) -> Result<f64, StreamError> {
        self.take().map(f64::from_le_bytes)
    }

    fn vector(&mut self) -> Result<DVec3, StreamError> {
        Ok(DVec3::new(self.real()?, self.real()?, self.real()?))
    }

    fn segment(&mut self) -> Result<Segment, StreamError> {
        let [continues] = self.take()?;
        Ok(Segment {
            parent: None,
            continues_parent: continues != 0,
            sides: self.number()?,
            start: self.vector()?,
            end: self.vector()?,
            start_radius_m: self.real()?,
            end_radius_m: self.real()?,
        })
    }

    fn leaf(&mut self) -> Result<LeafPose, StreamError> {
        let [base, along, facing] = [self.vector()?, self.vector()?, self.vector()?];
        let (length_m, width_m) = (self.real()?, self.real()?);
        let [kind] = self.take()?;
        let offset = self.offset;
        Ok(LeafPose {
            segment: None,
            base,
            along,
            facing,
            length_m,
            width_m,
            kind: kind_of(kind).ok_or(StreamError::UnknownLeaf { offset, kind })?,
        })
    }
}
