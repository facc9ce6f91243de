//! Trees in a scene: how large a screen shows them, and a page to look at them.
//!
//! - [`Screen`]: how many pixels high a screen shows a plant at a distance.
//! - [`preview`]: a page that shows a tree's levels of detail beside the original.
//!
//! Nothing here reads or writes a tree's file, or knows a method.

pub mod preview;
mod screen;

pub use screen::Screen;
