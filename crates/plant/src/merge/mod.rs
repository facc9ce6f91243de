//! Merging of sticks and leaf clusters: levels of detail of a whole plant.
//!
//! Hughes, Moshell, Sims, Yu: Dynamic Computation of Levels of Detail in Complex
//! Outdoor Environments (L-plants), section IV. A stick is a segment. Its HR is
//! the height of its start above the ground over its radius there: small at the
//! foot of the trunk, large in the twigs. At a threshold every stick of larger HR
//! is replaced by its parent, extended; where a stick has something below the
//! threshold growing on it, it stays with all that is between (the continuity
//! rule, Fig. 4). The leaves of what was replaced become one cluster at the top of
//! the extended stick, of radius
//!
//! ```text
//! R0 = mean distance of its leaves from there + mean radius of its leaves
//! ```
//!
//! always of the original leaves, so that nothing adds up from level to level;
//! distances are between the tops of sticks. On a plant whose leaves stand far
//! apart, cards of that radius cover more than the leaves did: [`ClusterSize`] can
//! bound their area by that of the leaves.
//!
//! Where the paper is silent:
//! - A stick is extended along its own direction, as far as the farthest end that
//!   it replaces, but not higher than the highest. It stays as it is where a stick
//!   that continues it stays. So that the height is kept, the stick that stands for
//!   the plant's highest end turns to it if it would stay below and bears nothing.
//! - Its own leaves join the cluster once nothing grows on it any more.
//! - A leaf alone is no cluster: it stays where it stands.
//! - The radius of a leaf is from its centre to its farthest corner; a cluster
//!   looks like that of its leaves which is nearest to its centre, larger.
//! - Roots stay. The paper's schemes add up to all of the geometry, with a texture
//!   for what is left: so the last level of a tree is a pole with one cluster, whose
//!   coverage R0 does not keep. A scheme that stops short, such as 50-25-12.5, has no
//!   such level.

mod clusters;
mod levels;
mod merging;
mod order;
mod scheme;
mod sticks;
mod thresholds;

pub use clusters::ClusterSize;
pub use levels::{MergedLevel, merge_at, merge_below, merge_levels};
pub use order::merge_order;
pub use scheme::{Scheme, SchemeError};
pub use sticks::height_over_radius;
pub use thresholds::{StickSize, Thresholds, ThresholdsError};
