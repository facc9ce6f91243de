//! Pages that show a plant in a browser, each a file of its own that needs no network.
//!
//! - [`preview`]: a plant's levels of detail beside the original.
//! - [`stream`]: a plant that can be drawn while it arrives, every prefix a plant.

#![forbid(unsafe_code)]

pub mod preview;
pub mod stream;
