//! Levels of detail of skeletons.

mod chain;
mod corpus;
mod merge;
