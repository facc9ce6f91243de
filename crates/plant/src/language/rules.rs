//! Rules as they are derived: symbols numbered, expressions compiled.

use std::ops::Range;

use super::code::{Code, Program};
use super::{RulePosition, Settings};

/// A symbol together with its number of parameters; `F(1)` and `F(1, 0)` are two.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct SymbolInfo {
    pub(crate) name: String,
    pub(crate) parameters: usize,
}

/// A module as it is written in an axiom or a successor.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Template {
    pub(crate) symbol: u16,
    /// An expression for each parameter.
    pub(crate) arguments: Vec<Code>,
    pub(crate) place: RulePosition,
}

#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Production {
    pub(crate) symbol: u16,
    /// Symbols that must come before, from the far one to the near one.
    pub(crate) left: Vec<u16>,
    /// Symbols that must come after, from the near one to the far one.
    pub(crate) right: Vec<u16>,
    pub(crate) condition: Option<Code>,
    pub(crate) weight: Option<Code>,
    pub(crate) bindings: Vec<Code>,
    /// Templates of the successor.
    pub(crate) successor: Range<u32>,
    /// Whether a module that it does not match now may match later: it has a
    /// context, or asks for the iteration.
    pub(crate) may_match_later: bool,
    pub(crate) place: RulePosition,
}

/// A rule file, ready to be derived: see [`language`](crate::language) for what
/// it can say.
#[derive(Clone, Debug, PartialEq)]
pub struct Rules {
    pub(crate) symbols: Vec<SymbolInfo>,
    pub(crate) templates: Vec<Template>,
    pub(crate) axiom: Range<u32>,
    pub(crate) productions: Vec<Production>,
    /// The productions of each symbol, as indices.
    pub(crate) productions_of: Vec<Vec<u32>>,
    /// For each symbol, whether contexts look through it.
    pub(crate) ignored: Vec<bool>,
    pub(crate) constants: Vec<Code>,
    pub(crate) iterations: Option<(Code, RulePosition)>,
    pub(crate) max_modules: usize,
    pub(crate) uses_detail: bool,
    /// Whether any production asks for the iteration.
    pub(crate) asks_iteration: bool,
    pub(crate) program: Program,
    pub(crate) settings: Settings,
}

impl Rules {
    /// The most modules that a derivation may make in all, unless the file sets
    /// a lower number.
    pub const MAX_MODULES: usize = 24_000_000;
    /// The most bytes of a file.
    pub const MAX_BYTES: usize = 1 << 20;
    /// The most steps of a derivation.
    pub const MAX_ITERATIONS: u32 = 100_000;

    /// What the file says about leaves, bark and counts.
    pub fn settings(&self) -> &Settings {
        &self.settings
    }

    /// Whether any expression asks for `detail`, so that more leaves can be had.
    pub fn uses_detail(&self) -> bool {
        self.uses_detail
    }
}
