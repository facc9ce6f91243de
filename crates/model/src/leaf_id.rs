//! The name of a leaf.

use std::num::NonZeroU32;

/// A leaf's number: leaves count from 1, in file order.
///
/// In leaf-ID images and area tables 0 is the background (the paper's polygon
/// 0), which is why this type cannot hold it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct LeafId(NonZeroU32);

impl LeafId {
    /// The value that stands for the background wherever leaf IDs are drawn.
    pub const BACKGROUND: u32 = 0;

    /// The leaf with this number, or `None` for 0, the background.
    pub fn new(number: u32) -> Option<Self> {
        NonZeroU32::new(number).map(Self)
    }

    /// The leaf at this place (from 0) of a list of leaves.
    ///
    /// # Panics
    /// If `index` is `u32::MAX` or more: no list of leaves is that long.
    pub fn from_index(index: usize) -> Self {
        let number = u32::try_from(index + 1).expect("a leaf index fits 32 bits");
        Self(NonZeroU32::new(number).expect("an index plus one is not zero"))
    }

    /// Its number, from 1.
    pub fn get(self) -> u32 {
        self.0.get()
    }

    /// Its place in a list of leaves, from 0.
    pub fn index(self) -> usize {
        self.0.get() as usize - 1
    }
}

impl std::fmt::Display for LeafId {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "leaf {}", self.0)
    }
}
