//! Levels of detail of skeletons.

mod chain;
