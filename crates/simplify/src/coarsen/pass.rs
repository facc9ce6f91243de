//! The pass that makes leaves coarser, as options and target ask for it.

use secateur_model::Foliage;

use super::{Coarse, LossCurves, coarsen, share_triangles};
use crate::{LeafTriangles, Target};

impl LeafTriangles {
    /// Coarser leaves for a target in numbers; nothing if they stay as they are.
    pub(crate) fn coarsen(self, foliage: &Foliage, target: Target) -> Option<Coarse> {
        let most = match (self, target.triangle_count(foliage)) {
            (Self::AtMost(most), _) => {
                let most = vec![most as usize; foliage.leaves().len()];
                return coarsen(foliage, &LossCurves::of(foliage), &most);
            }
            (Self::Auto, Some(at_most)) if at_most < foliage.triangles().len() => at_most,
            (Self::Auto | Self::Keep, _) => return None,
        };
        let curves = LossCurves::of(foliage);
        coarsen(foliage, &curves, &share_triangles(foliage, most, &curves))
    }
}
