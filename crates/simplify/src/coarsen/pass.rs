//! How coarse leaves may become, as options and target ask for it.

use secateur_model::{Foliage, LeafId};

use super::{LossCurves, share_among, share_triangles};
use crate::{Error, FinerLevel, LeafTriangles, Target};

impl LeafTriangles {
    /// How many triangles each leaf may keep for a target in numbers; none if they stay as they
    /// are. `curves` are those of the leaves, once they are known; `find` finds them. Leaves that are gone at a finer
    /// level keep theirs, which do not count.
    ///
    /// # Errors
    /// As `find`, where curves are not known yet.
    pub(crate) fn shares(
        self,
        foliage: &Foliage,
        target: Target,
        finer: Option<&FinerLevel>,
        curves: &mut Option<LossCurves>,
        find: impl FnOnce() -> Result<LossCurves, Error>,
    ) -> Result<Option<Vec<usize>>, Error> {
        let left = finer.map(FinerLevel::left);
        let count = |leaf: &LeafId| foliage.triangles_of(*leaf).len();
        let there = match &left {
            Some(left) => left.iter().map(count).sum(),
            None => foliage.triangles().len(),
        };
        Ok(match (self, target.triangle_count(foliage)) {
            (Self::AtMost(most), _) => Some(vec![most as usize; foliage.leaves().len()]),
            (Self::Auto, Some(at_most)) if at_most < there => {
                let found = match curves.take() {
                    Some(known) => known,
                    None => find()?,
                };
                let shares = match left {
                    Some(left) => share_among(foliage, left, at_most, &found),
                    None => share_triangles(foliage, at_most, &found),
                };
                *curves = Some(found);
                Some(shares)
            }
            (Self::Auto | Self::Keep, _) => None,
        })
    }
}
