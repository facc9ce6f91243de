//! How coarse leaves may become, as options and target ask for it.

use secateur_model::Foliage;

use super::{LossCurves, share_triangles};
use crate::{LeafTriangles, Target};

impl LeafTriangles {
    /// How many triangles each leaf may keep for a target in numbers; none if they stay as they
    /// are. `curves` are those of the leaves, once they are known.
    pub(crate) fn shares(
        self,
        foliage: &Foliage,
        target: Target,
        curves: &mut Option<LossCurves>,
    ) -> Option<Vec<usize>> {
        match (self, target.triangle_count(foliage)) {
            (Self::AtMost(most), _) => Some(vec![most as usize; foliage.leaves().len()]),
            (Self::Auto, Some(at_most)) if at_most < foliage.triangles().len() => {
                let curves = curves.get_or_insert_with(|| LossCurves::of(foliage));
                Some(share_triangles(foliage, at_most, curves))
            }
            (Self::Auto | Self::Keep, _) => None,
        }
    }
}
