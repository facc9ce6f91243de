//! Plants whose wood stays as it is.

use std::sync::Arc;

use secateur_model::{Foliage, Lod};
use secateur_raster::OpenEngine;

use super::WholeLevel;
use crate::stage::Observer;
use crate::{Error, Options, Shared, Target, simplify_sharing};

/// Simplifies the leaves of a plant whose wood stays as it is, and hides leaves. A target of
/// triangles counts leaves and wood.
///
/// # Errors
/// [`Error::BudgetBelowWood`] if the wood alone has more triangles than may be left; else as
/// [`simplify_on`](crate::simplify_on).
pub fn simplify_keeping_wood(
    leaves: &Foliage,
    wood: &Foliage,
    options: &Options,
    engine: &OpenEngine,
    observer: &mut Observer<'_>,
) -> Result<WholeLevel, Error> {
    simplify_keeping_wood_sharing(leaves, wood, options, engine, None, observer)
}

/// [`simplify_keeping_wood`], several times with different targets: what one run finds the next goes on
/// from. All else must be the same each time.
///
/// # Errors
/// As [`simplify_keeping_wood`].
pub fn simplify_keeping_wood_sharing(
    leaves: &Foliage,
    wood: &Foliage,
    options: &Options,
    engine: &OpenEngine,
    shared: Option<&mut Shared>,
    observer: &mut Observer<'_>,
) -> Result<WholeLevel, Error> {
    options.target.check()?;
    let least = wood.triangles().len();
    let target = match options.target {
        Target::Triangles(amount) => {
            let asked = amount.of(leaves.triangles().len() + least);
            let rest = asked.checked_sub(least);
            let rest = rest.ok_or(Error::BudgetBelowWood { asked, least })?;
            Target::triangles(rest as u64)
        }
        other => other,
    };
    let occluders = match &options.occluders {
        Some(others) => wood.followed_by(others)?,
        None => wood.clone(),
    };
    let options = Options {
        target,
        occluders: Some(Arc::new(occluders)),
        ..options.clone()
    };
    Ok(WholeLevel {
        leaves: simplify_sharing(engine, leaves, &options, shared, observer)?,
        wood: Lod::original(wood.leaves().len()),
        wood_triangles: least,
        wood_gone: Vec::new(),
        leaf_gap: None,
    })
}
