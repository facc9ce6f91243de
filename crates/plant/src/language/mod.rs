//! Rule files: L-systems written down.
//!
//! A file says what a plant starts from and how its parts become others. All
//! modules are rewritten at once, step after step; what is left at the end is
//! drawn by a turtle. After Prusinkiewicz and Lindenmayer: The Algorithmic Beauty
//! of Plants (1990), chapter 1.
//!
//! ```
//! use secateur_plant::{Random, Rules, draw};
//!
//! let rules = Rules::parse("
//!     ## A stem of four nodes, a leaf at each.
//!     let internode = 0.1;
//!     axiom: !(0.01) Stem(4);
//!     Stem(n) if n > 0
//!         with turn = normal(137.5, 10)
//!         -> F(internode) [ &(50) leaf(0.2) ] /(turn) Stem(n - 1);
//! ")?;
//! let word = rules.derive(1.0, &mut Random::new(7))?;
//! assert_eq!(draw(&rules, &word)?.leaves.len(), 4);
//! # Ok::<(), secateur_plant::RulesError>(())
//! ```
//!
//! # Statements
//! Each ends in `;`, blanks and line ends mean nothing, `#` starts a comment.
//!
//! | statement | what it says |
//! |---|---|
//! | `axiom: WORD;` | what derivation starts from; once |
//! | `let NAME = EXPRESSION;` | a constant; lots in it are drawn once for each plant |
//! | `LEFT < HEAD > RIGHT if E weight E with NAME = E, ... -> WORD;` | a production; only the head and the word must be there |
//! | `symbol S, T(a, b);` | symbols without a production, so that they are known |
//! | `ignore S T;` | symbols that contexts look through |
//! | `iterations = EXPRESSION;` | how many steps; without it, until no production matches |
//! | `modules = NUMBER;` | the most modules that may be made in all, up to [`Rules::MAX_MODULES`] |
//! | `set NAME = VALUE;` | how the plant looks: the fields of [`Settings`] |
//!
//! # Productions
//! A *head* is a symbol with names for its parameters: `Limb(node, length)`. The
//! same symbol with another number of parameters is another symbol. A production
//! matches a module of its head's symbol
//! - if what comes before and after it matches `LEFT <` and `> RIGHT`: heads in the
//!   order of the word. Towards the left the context follows the axis down to
//!   the root and passes over branches; towards the right it follows the axis to
//!   its end and passes over branches;
//! - and the condition after `if` is not 0.
//!
//! Of several that match, one is drawn by their weights (1 where none is given).
//! The names after `with` are worked out in order, lots included, before the
//! successor. A module that no production matches stays as it is.
//!
//! # Expressions
//! From weak to strong: `or`, `and`, `not`, comparisons (`< <= > >= == !=`, 1 or 0),
//! `+ -`, `* /`, a sign, `^`. Functions: abs, sqrt, exp, log, sin, cos, tan, asin,
//! acos, atan, floor, ceil, round of one argument; min, max, pow, mod, atan2 of
//! two; clamp(x, low, high); select(condition, then, otherwise), which works out
//! both. Angles are in degrees. `uniform(low, high)` and `normal(mean, deviation)`
//! draw lots; not in conditions and weights.
//!
//! Names: the constants so far, `detail` (1, or more where a plant needs more
//! leaves than the rules make at 1), and in productions `iteration` (from 0), the
//! parameters of the head and its contexts, and what `with` has named before.
//!
//! # The turtle
//! Lengths in metres, angles in degrees. It starts at the origin, heading up (y).
//!
//! | module | what it does |
//! |---|---|
//! | `F(length)` `F(length, radius)` | advance and leave wood behind, tapering to this radius |
//! | `f(length)` | advance |
//! | `!(radius)` `sides(n)` | the wood's radius, and its number of sides (3 to 64) |
//! | `+(a)` `-(a)` | turn left, right |
//! | `&(a)` `^(a)` | pitch down, up |
//! | `\(a)` `/(a)` | roll left, right |
//! | `\|` | turn around |
//! | `$` | roll so that the turtle's up points to the sky |
//! | `tropism(s)` `tropism(s, x, y, z)` | from here on, each advance bends the heading towards the sky, or this direction, by s radians where it is at right angles to it |
//! | `[` `]` | remember where the turtle is; go back there |
//! | `leaf(length)` | a card of 2 triangles with the outline cut out |
//! | `crossed(length)` | two cards across each other, 8 triangles that share the line where they meet |
//! | `blade(length, triangles)` | a bent and folded leaf of 2 to 18 triangles, an even number |
//! | `needle(length)` | a folded needle of 2 triangles |
//!
//! # Limits
//! A derivation ends with an error where it makes more modules than the limit, or
//! after [`Rules::MAX_ITERATIONS`] steps. So rules that never end do end.
//!
//! # Grammar
//! ```text
#![doc = include_str!("rules.pest")]
//! ```

mod code;
mod commands;
mod compile;
mod error;
mod expression;
mod places;
mod rules;
mod settings;
mod size;
mod symbols;

pub(crate) use code::Code;
pub(crate) use commands::{Command, POP, PUSH, command_of};
pub(crate) use error::cut;
pub use error::{RulePosition, RulesError};
pub use rules::Rules;
pub(crate) use rules::{Production, Template};
pub use settings::{Bark, Outline, Settings, Shrinks};

use grammar::{Grammar, Rule};

/// What pest makes of the grammar.
mod grammar {
    #![allow(missing_docs)]

    #[derive(pest_derive::Parser)]
    #[grammar = "src/language/rules.pest"]
    pub(super) struct Grammar;
}
