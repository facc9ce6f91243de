//! What an engine links: plants at any level of detail, without what makes the levels.
//!
//! - [`Screen`]: how many pixels high a screen shows a plant at a distance.
//! - [`order_file`]: removal orders as files, for any level later.
//! - [`prefix_buffers`]: a removal order on a GPU, every level a prefix of one index buffer.
//! - [`view_dependent`]: parts of a crown in full detail, others coarse, as a view asks for it.
//! - [`stand`]: instances of a plant, those that a camera sees, and how much detail each needs.
//! - [`morph`]: how a level becomes the next one while the camera goes away.
//! - [`wind`]: how a plant sways, original and levels alike.

#![forbid(unsafe_code)]

#[cfg(test)]
mod gpu_for_tests;
pub mod morph;
pub mod order_file;
pub mod prefix_buffers;
mod screen;
pub mod stand;
pub mod view_dependent;
pub mod wind;

pub use screen::{SCREEN_HEIGHTS_PX, Screen};
