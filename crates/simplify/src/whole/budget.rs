//! What a level of a whole plant may have.

/// How many triangles a level may have, and how they are shared between leaves and wood.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Budget {
    /// The most triangles.
    pub triangles: usize,
    /// How they are shared.
    pub sharing: Sharing,
}

/// How triangles are shared between leaves and wood, and, of a plant without leaves, among its pieces.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Sharing {
    /// As [`Self::LeafMargin`] with .15, or up to .3 for levels with less than a fifth of all triangles. Pieces of plants
    /// without leaves get triangles where these save the most pixels.
    #[default]
    ByNumber,
    /// What another triangle of leaves saves, as a share of what the views show of leaves for each triangle of the
    /// budget, 0 or more: the first triangles save more than the last. Wood gets the triangles that save more each.
    LeafMargin(f64),
    /// For plants without leaves, and wood with a solid crown: collapses over all pieces put every surface off by about
    /// the same distance, thin pieces by less, and move vertices. Other plants as [`Self::ByNumber`].
    Evenly,
}

impl From<usize> for Budget {
    fn from(triangles: usize) -> Self {
        Self {
            triangles,
            sharing: Sharing::ByNumber,
        }
    }
}
