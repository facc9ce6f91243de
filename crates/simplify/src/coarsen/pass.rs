//! How coarse leaves may become, as options and target ask for it.

use secateur_model::Foliage;

use super::{LossCurves, share_triangles};
use crate::{Error, LeafTriangles, Target};

impl LeafTriangles {
    /// How many triangles each leaf may keep for a target in numbers; none if they stay as they
    /// are. `curves` are those of the leaves, once they are known; `find` finds them.
    ///
    /// # Errors
    /// Those of `find`.
    pub(crate) fn shares(
        self,
        foliage: &Foliage,
        target: Target,
        curves: &mut Option<LossCurves>,
        find: impl FnOnce() -> Result<LossCurves, Error>,
    ) -> Result<Option<Vec<usize>>, Error> {
        Ok(match (self, target.triangle_count(foliage)) {
            (Self::AtMost(most), _) => Some(vec![most as usize; foliage.leaves().len()]),
            (Self::Auto, Some(at_most)) if at_most < foliage.triangles().len() => {
                let found = match curves.take() {
                    Some(known) => known,
                    None => find()?,
                };
                let shares = share_triangles(foliage, at_most, &found);
                *curves = Some(found);
                Some(shares)
            }
            (Self::Auto | Self::Keep, _) => None,
        })
    }
}
