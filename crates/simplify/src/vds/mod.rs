//! Viewpoint-driven simplification (Gasch et al., Entropy 2018, 20, 213).
//!
//! Each step prunes the leaf whose absence changes the VMI of the views least
//! (Eq. 4) and lets its nearest neighbours grow (Eq. 5). [`reference`](mod@reference) does so
//! as Algorithm 1 is written, drawing every view anew for every candidate of
//! every step; [`fast`] makes the very same choices without drawing.

pub mod fast;
mod methods;
mod options;
mod outcome;
mod phases;
pub mod reference;
mod resize;
mod ties;

pub use methods::{Fast, Literal};
pub use options::{Reference, Resize, Ties, VdsOptions, VdsRun, ViewPlan, ViewStage};
pub use outcome::{Progress, VdsError, VdsOutcome};
pub(crate) use phases::final_views;
