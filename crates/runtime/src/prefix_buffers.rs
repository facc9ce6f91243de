//! A removal order for a GPU: every level is a prefix of one index buffer.
//!
//! Gasch, Remolar, Chover, Rebollo (Entropy 2018, section 6) propose to keep the sequence of
//! removals on the GPU, so that the number of leaves changes continuously. Here leaves lie in the
//! order in which they go, the last to go first: the level after some steps is a prefix of the
//! triangles. A leaf's size at a level is looked up in the vertex shader, in a list of the steps that
//! gave it another: nothing is uploaded when the level changes but the number of steps. Two levels
//! next to each other differ by one step, so no more than a leaf pops; over the last steps before it
//! goes a leaf can fade.
//!
//! The shader is `leaf_sizes.wgsl` of `secateur-shaders`, all in integers; a vertex shader ends in
//!
//! ```wgsl
//! let scale = bitcast<f32>(scale_bits(leaf, level.steps)) * common_linear_scale;
//! let position = centre + (corner - centre) * scale;
//! ```
//!
//! with `common_linear_scale` of [`PrefixBuffers::common_linear_scale`], 1 but for stochastic
//! pruning. A leaf that is not made yet has scale 0: its triangles have no area.

use secateur_model::{Foliage, LeafId, LodModel};

/// A leaf that is shown whole: see [`PrefixBuffers::shown`].
pub const WHOLE: u32 = 1 << 16;

/// From some step on a leaf has this size.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SizeAt {
    /// How many steps are made, at least.
    pub step: u32,
    /// The bits of its linear scale as f32.
    pub scale_bits: u32,
}

/// The lists that a renderer uploads once. A place is a leaf's place in [`Self::leaves`].
#[derive(Clone, Debug, PartialEq)]
pub struct PrefixBuffers {
    leaves: Vec<LeafId>,
    /// By places, and one more: triangles before it.
    first_triangle: Vec<u32>,
    first_size: Vec<u32>,
    sizes: Vec<SizeAt>,
    gone_after: Vec<u32>,
    common_linear_scale: Vec<f32>,
}

impl PrefixBuffers {
    /// The lists of a model of this foliage.
    ///
    /// # Panics
    /// If the model is one of another foliage.
    pub fn new(model: &LodModel, foliage: &Foliage) -> Self {
        let order = model.order();
        let (names, originals) = (order.name_count(), order.leaf_count() as usize);
        assert_eq!(originals, foliage.leaves().len());
        let at = |step: usize, scale: f64| SizeAt {
            step: step as u32,
            scale_bits: (scale.sqrt() as f32).to_bits(),
        };
        let mut gone_after = vec![u32::MAX; names];
        let mut sizes: Vec<Vec<SizeAt>> = vec![vec![at(0, 1.0)]; originals];
        for (index, step) in order.steps().enumerate() {
            let steps = index + 1;
            sizes.resize(sizes.len() + step.made.len(), vec![at(steps, 1.0)]);
            for leaf in step.removed {
                gone_after[leaf.index()] = steps as u32;
            }
            for growth in step.grown {
                sizes[growth.leaf.index()].push(at(steps, growth.area_scale));
            }
        }
        let mut leaves: Vec<LeafId> = (0..names).map(LeafId::from_index).collect();
        leaves.sort_by_key(|leaf| (std::cmp::Reverse(gone_after[leaf.index()]), *leaf));
        let triangles = |leaf: &LeafId| match leaf.index().checked_sub(originals) {
            None => foliage.triangles_of(*leaf).len() as u32,
            Some(made) => order.made()[made].triangles.len() as u32,
        };
        let sizes_of = |leaf: &LeafId| &sizes[leaf.index()];
        let commons = (0..=order.len()).map(|k| order.survivors_area_scale_after(k));
        Self {
            first_triangle: sums(leaves.iter().map(triangles)),
            first_size: sums(leaves.iter().map(|leaf| sizes_of(leaf).len() as u32)),
            sizes: leaves.iter().flat_map(sizes_of).copied().collect(),
            gone_after: leaves.iter().map(|l| gone_after[l.index()]).collect(),
            common_linear_scale: commons.map(|scale| scale.sqrt() as f32).collect(),
            leaves,
        }
    }

    /// The leaves, made ones included, the last to go first: the order in which their triangles lie
    /// in the index buffer.
    pub fn leaves(&self) -> &[LeafId] {
        &self.leaves
    }

    /// For each place where its sizes begin in [`Self::sizes`], and one more.
    pub fn first_size(&self) -> &[u32] {
        &self.first_size
    }

    /// The sizes of all leaves, place by place, by their steps.
    pub fn sizes(&self) -> &[SizeAt] {
        &self.sizes
    }

    /// For each place the number of steps after which its leaf is gone; `u32::MAX` if never.
    pub fn gone_after(&self) -> &[u32] {
        &self.gone_after
    }

    /// How many leaves the level after `steps` steps has to draw; some of these may not be made yet.
    pub fn places_after(&self, steps: u32) -> usize {
        self.gone_after.partition_point(|gone| *gone > steps)
    }

    /// How many triangles of the index buffer that are.
    pub fn triangles_after(&self, steps: u32) -> u32 {
        self.first_triangle[self.places_after(steps)]
    }

    /// By what original leaves are scaled beside their own size.
    ///
    /// # Panics
    /// If there are fewer steps.
    pub fn common_linear_scale(&self, steps: u32) -> f32 {
        self.common_linear_scale[steps as usize]
    }

    /// The linear scale of a leaf as the bits of an f32; 0 where it is not made yet. The twin of
    /// `scale_bits` of the shader.
    ///
    /// # Panics
    /// If there is no such place.
    pub fn scale_bits(&self, place: usize, steps: u32) -> u32 {
        let [first, end] = [place, place + 1].map(|k| self.first_size[k] as usize);
        let sizes = &self.sizes[first..end];
        let begun = sizes.partition_point(|size| size.step <= steps);
        begun
            .checked_sub(1)
            .map_or(0, |last| sizes[last].scale_bits)
    }

    /// How much of a leaf is shown, of [`WHOLE`]: less and less over the last `fade_steps` steps
    /// before it goes. The twin of `shown` of the shader.
    ///
    /// # Panics
    /// If there is no such place.
    pub fn shown(&self, place: usize, steps: u32, fade_steps: u32) -> u32 {
        let left = self.gone_after[place].saturating_sub(steps);
        match left {
            0 => 0,
            left if left >= fade_steps => WHOLE,
            left => left * (WHOLE / fade_steps),
        }
    }

    /// Bytes on the GPU beside vertices and indices.
    pub fn bytes(&self) -> usize {
        4 * (self.first_size.len() + 2 * self.sizes.len() + self.gone_after.len())
    }
}

/// The sums of the numbers before each, and of all.
fn sums(numbers: impl Iterator<Item = u32>) -> Vec<u32> {
    let mut sums = vec![0];
    let mut sum = 0;
    for number in numbers {
        sum += number;
        sums.push(sum);
    }
    sums
}

#[cfg(test)]
mod tests;
