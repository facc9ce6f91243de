//! Why levels are no chain.

/// The most levels of a chain: as many as Unity's LOD Group has.
pub const MAX_LEVELS: usize = 8;

/// Why levels are no chain.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum ChainProblem {
    /// A chain of no level, or of too many.
    #[error("a chain has 1 to {MAX_LEVELS} levels, not {0}")]
    Levels(usize),
    /// A name that cannot be the name of a file.
    #[error("`{0}` cannot be the name of a level: it must be the name of a file, without a path")]
    Name(String),
    /// Two levels of one name.
    #[error("two levels are named `{0}`")]
    SameName(String),
    /// No `screen_coverage`, or one that is not less than that of the level before.
    #[error(
        "the fact `screen_coverage` of level `{0}` must be a number that is at least 0 and less than that of the level before it"
    )]
    Coverage(String),
}
