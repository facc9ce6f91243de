//! Levels of detail of skeletons.

mod chain;
mod merge;
