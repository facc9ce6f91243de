//! What an area table says.
//!
//! - [`mod@lg`]: logarithms of counts, in integers.
//! - [`vmi`]: viewpoint mutual information, per view.
//! - [`incremental`]: the same, as areas change.
//! - [`rows`]: rows of tables for those leaves that need one.
//!
//! The measure stands here, beside the areas, because both who simplifies and who judges
//! need it, and neither may know the other.

pub mod incremental;
pub mod lg;
pub mod rows;
pub mod vmi;
