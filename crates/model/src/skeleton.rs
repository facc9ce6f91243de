//! The skeleton of a plant: pieces of wood, and which leaf grows on which.

use glam::DVec3;

/// The place of a segment in [`PlantSkeleton::segments`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct SegmentIndex(u32);

impl SegmentIndex {
    /// The segment at this place, from 0.
    ///
    /// # Panics
    /// If it does not fit 32 bits.
    pub fn from_index(index: usize) -> Self {
        Self(u32::try_from(index).expect("a segment index fits 32 bits"))
    }

    /// Its place, from 0.
    pub fn index(self) -> usize {
        self.0 as usize
    }
}

/// A tapered piece of wood.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Segment {
    /// The segment it grows from; always an earlier one.
    pub parent: Option<SegmentIndex>,
    /// Whether it goes on where its parent ends, as the same branch.
    pub continues_parent: bool,
    /// Where it starts, in metres.
    pub start: DVec3,
    /// Where it ends, in metres.
    pub end: DVec3,
    /// The radius at its start, in metres.
    pub start_radius_m: f64,
    /// The radius at its end, in metres; 0 for a tip.
    pub end_radius_m: f64,
    /// How many sides it has, 3 to 64.
    pub sides: u32,
}

impl Segment {
    /// From its start to its end, in metres.
    pub fn length_m(&self) -> f64 {
        (self.end - self.start).length()
    }

    fn is_sound(&self) -> bool {
        let radius = |r: f64| r.is_finite() && r >= 0.0;
        self.start.is_finite()
            && self.end.is_finite()
            && radius(self.start_radius_m)
            && radius(self.end_radius_m)
            && (3..=64).contains(&self.sides)
    }
}

/// What a file keeps of the way a plant has grown.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PlantSkeleton {
    /// Pieces of wood, parents before children, y up.
    pub segments: Vec<Segment>,
    /// For each leaf, in leaf order, the segment it grows on, if any.
    pub leaf_segments: Vec<Option<SegmentIndex>>,
}

/// Why segments and leaves are no skeleton.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum SkeletonError {
    /// A number that is not finite, a negative radius, sides outside 3 to 64.
    #[error("segment {0} of the skeleton has a number out of range")]
    OutOfRange(usize),
    /// A segment that grows from a later one, or from itself.
    #[error("segment {0} of the skeleton grows from one that is not before it")]
    NotBefore(usize),
    /// A leaf on a segment that is not there.
    #[error("leaf {leaf} of the skeleton grows on segment {segment}, of {count}")]
    NoSuchSegment {
        /// The leaf, from 0.
        leaf: usize,
        /// The segment, from 0.
        segment: usize,
        /// How many segments there are.
        count: usize,
    },
    /// The skeleton of another foliage.
    #[error("the skeleton knows {known} leaves where the foliage has {leaves}")]
    LeafCount {
        /// Leaves of the skeleton.
        known: usize,
        /// Leaves of the foliage.
        leaves: usize,
    },
}

impl PlantSkeleton {
    /// Checks that it can be walked over, and that it is of this number of leaves.
    ///
    /// # Errors
    /// [`SkeletonError`]: the first thing that is wrong.
    pub fn check(&self, leaves: usize) -> Result<(), SkeletonError> {
        for (index, segment) in self.segments.iter().enumerate() {
            if segment.parent.is_some_and(|parent| parent.index() >= index) {
                return Err(SkeletonError::NotBefore(index));
            }
            if !segment.is_sound() {
                return Err(SkeletonError::OutOfRange(index));
            }
        }
        let count = self.segments.len();
        for (leaf, segment) in self.leaf_segments.iter().enumerate() {
            if let Some(segment) = segment.map(SegmentIndex::index).filter(|&s| s >= count) {
                return Err(SkeletonError::NoSuchSegment {
                    leaf,
                    segment,
                    count,
                });
            }
        }
        let known = self.leaf_segments.len();
        if known != leaves {
            return Err(SkeletonError::LeafCount { known, leaves });
        }
        Ok(())
    }
}
