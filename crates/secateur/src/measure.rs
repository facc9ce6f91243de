//! Judging by views that no simplifier sees.

use secateur_eval::{Judging, Measurement};
use secateur_model::Foliage;

use crate::{Error, sphere_of};

/// Measures a simplified foliage against its original from the held-out views:
/// the 12 vertices of an icosahedron about the original, 512 x 512.
///
/// Leaf numbers need not correspond: both are drawn and counted on their own.
/// [`eval::measure`](secateur_eval::measure()) takes other views.
///
/// # Errors
/// [`Error`] if the original has no leaf or is out of range.
pub fn measure(original: &Foliage, simplified: &Foliage) -> Result<Measurement, Error> {
    sphere_of(original)?;
    let judging = Judging::held_out(original)?;
    Ok(secateur_eval::measure(original, simplified, &judging)?)
}
