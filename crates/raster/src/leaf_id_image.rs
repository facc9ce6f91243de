//! Which leaf owns each pixel.

/// Leaf numbers of the pixels of one view, row by row from the top; 0 is the
/// background.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LeafIdImage {
    /// Width and height in pixels.
    pub resolution: u32,
    /// `resolution * resolution` leaf numbers.
    pub leaf_ids: Vec<u32>,
}

impl LeafIdImage {
    /// Pixels as 8-bit RGB for the eye: black for the background, and for each
    /// leaf a colour of its own drawn from its number, so that neighbours
    /// differ.
    pub fn to_rgb(&self) -> Vec<u8> {
        let colour = |&leaf: &u32| {
            if leaf == 0 {
                return [0, 0, 0];
            }
            // A multiplicative hash spreads consecutive numbers; the offset
            // keeps leaves brighter than the background.
            let bits = leaf.wrapping_mul(0x9E37_79B1);
            [24, 16, 8].map(|shift| 64 + ((bits >> shift & 0xFF) * 3 / 4) as u8)
        };
        self.leaf_ids.iter().flat_map(colour).collect()
    }
}
