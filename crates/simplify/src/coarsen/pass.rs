//! How coarse leaves may become, as options and target ask for it.

use secateur_model::Foliage;

use super::{Shapes, shared_out};
use crate::{LeafTriangles, Target};

impl LeafTriangles {
    /// How many triangles each leaf may keep for a target in numbers; nothing if they stay as they
    /// are. `shapes` are those of the leaves, once they are known.
    pub(crate) fn shares(
        self,
        foliage: &Foliage,
        target: Target,
        shapes: &mut Option<Shapes>,
    ) -> Option<Vec<usize>> {
        match (self, target.triangle_count(foliage)) {
            (Self::AtMost(most), _) => Some(vec![most as usize; foliage.leaves().len()]),
            (Self::Auto, Some(at_most)) if at_most < foliage.triangles().len() => {
                let shapes = shapes.get_or_insert_with(|| Shapes::of(foliage));
                Some(shared_out(foliage, at_most, shapes))
            }
            (Self::Auto | Self::Keep, _) => None,
        }
    }
}
