//! The binary chunk of a GLB: in memory, or left in its file and read piece by piece.
//!
//! The chunk is nearly all of a large file, and a million leaves take half a gibibyte in it. Each
//! piece is needed when leaves are found and again when the result is written; in between the
//! memory is better spent on what views show.

use std::borrow::Cow;
use std::fs::File;
use std::io::{self, Read, Seek, SeekFrom};
use std::ops::Range;
use std::sync::{Mutex, PoisonError};
use std::time::SystemTime;

use super::error::Problem;

/// The bytes of a chunk.
#[derive(Debug)]
pub(crate) enum BinaryChunk {
    Memory(Vec<u8>),
    Disk(ChunkOnDisk),
}

impl BinaryChunk {
    pub(crate) fn len(&self) -> usize {
        match self {
            Self::Memory(bytes) => bytes.len(),
            Self::Disk(chunk) => chunk.length,
        }
    }

    /// Some of its bytes.
    ///
    /// # Errors
    /// [`Problem::Unreadable`] if the file they are in can't be read, or is not what it was when it
    /// was opened.
    ///
    /// # Panics
    /// If the range ends beyond the chunk.
    pub(crate) fn bytes(&self, range: Range<usize>) -> Result<Cow<'_, [u8]>, Problem> {
        match self {
            Self::Memory(bytes) => Ok(Cow::Borrowed(&bytes[range])),
            Self::Disk(chunk) => {
                let mut bytes = Vec::new();
                chunk.append_to(&mut bytes, range)?;
                Ok(Cow::Owned(bytes))
            }
        }
    }

    /// Appends some of its bytes to others.
    ///
    /// # Errors
    /// As [`bytes`](Self::bytes).
    ///
    /// # Panics
    /// As [`bytes`](Self::bytes).
    pub(crate) fn append_to(
        &self,
        others: &mut Vec<u8>,
        range: Range<usize>,
    ) -> Result<(), Problem> {
        match self {
            Self::Memory(bytes) => {
                others.extend_from_slice(&bytes[range]);
                Ok(())
            }
            Self::Disk(chunk) => chunk.append_to(others, range),
        }
    }
}

/// A chunk in a file that stays open.
#[derive(Debug)]
pub(crate) struct ChunkOnDisk {
    file: Mutex<File>,
    /// How the file was when it was opened.
    stamp: Stamp,
    /// Where the chunk begins in it, in bytes.
    start: u64,
    length: usize,
}

/// What tells that somebody has written to a file.
#[derive(Debug, PartialEq)]
struct Stamp {
    bytes: u64,
    /// `None` where the system does not say.
    modified: Option<SystemTime>,
}

impl Stamp {
    fn of(file: &File) -> io::Result<Self> {
        let there = file.metadata()?;
        Ok(Self {
            bytes: there.len(),
            modified: there.modified().ok(),
        })
    }
}

impl ChunkOnDisk {
    /// The chunk that takes this range of a file, whose bytes are all there.
    pub(crate) fn new(file: File, range: Range<usize>) -> io::Result<Self> {
        Ok(Self {
            stamp: Stamp::of(&file)?,
            file: Mutex::new(file),
            start: range.start as u64,
            length: range.len(),
        })
    }

    fn append_to(&self, others: &mut Vec<u8>, range: Range<usize>) -> Result<(), Problem> {
        assert!(range.end <= self.length, "the range is within the chunk");
        let mut read = || {
            // A thread that panicked while it read leaves the file as good as it was.
            let mut file = self.file.lock().unwrap_or_else(PoisonError::into_inner);
            file.seek(SeekFrom::Start(self.start + range.start as u64))?;
            let before = others.len();
            others.reserve_exact(range.len());
            (&*file).take(range.len() as u64).read_to_end(others)?;
            let is_whole = others.len() - before == range.len();
            match is_whole && Stamp::of(&file)? == self.stamp {
                true => Ok(()),
                false => Err(io::Error::other("it was changed while it was being read")),
            }
        };
        read().map_err(Problem::Unreadable)
    }
}
