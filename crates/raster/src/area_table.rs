//! How many pixels each leaf owns in each view.

use sha2::{Digest, Sha256};

/// Projected areas: for each view a row of `leaf_count + 1` pixel counts, the
/// background first. Every row sums to the pixels of a view.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct AreaTable {
    leaf_count: usize,
    area_px: Vec<u32>,
}

impl AreaTable {
    /// A table from its rows, one after the other.
    ///
    /// # Panics
    /// If the length is no multiple of `leaf_count + 1`.
    pub fn from_rows(leaf_count: usize, area_px: Vec<u32>) -> Self {
        assert_eq!(
            area_px.len() % (leaf_count + 1),
            0,
            "rows of {} areas",
            leaf_count + 1
        );
        Self {
            leaf_count,
            area_px,
        }
    }

    /// Leaves, without the background.
    pub fn leaf_count(&self) -> usize {
        self.leaf_count
    }

    /// Number of views, one row of areas each.
    pub fn view_count(&self) -> usize {
        self.area_px.len() / (self.leaf_count + 1)
    }

    /// The areas of one view in pixels, indexed by leaf number, background
    /// first.
    pub fn row(&self, view: usize) -> &[u32] {
        let width = self.leaf_count + 1;
        &self.area_px[view * width..(view + 1) * width]
    }

    /// The rows, view 0 first.
    pub fn rows(&self) -> std::slice::ChunksExact<'_, u32> {
        self.area_px.chunks_exact(self.leaf_count + 1)
    }

    /// All areas, row by row.
    pub fn as_slice(&self) -> &[u32] {
        &self.area_px
    }

    /// SHA-256 over the areas as u32 little-endian, row by row, as lower-case
    /// hexadecimal digits.
    pub fn sha256(&self) -> String {
        let mut hash = Sha256::new();
        for area_px in &self.area_px {
            hash.update(area_px.to_le_bytes());
        }
        secateur_model::hex(&hash.finalize())
    }
}
