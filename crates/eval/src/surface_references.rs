//! Surfaces as callers have them, owned or shared, as pictures take them: by reference. So what draws is compiled once.

use std::borrow::Borrow;

use secateur_model::Surface;

/// The surfaces of a caller, each by reference, in the caller's order.
pub(crate) fn references<S: Borrow<Surface>>(surfaces: &[S]) -> Vec<&Surface> {
    surfaces.iter().map(S::borrow).collect()
}
