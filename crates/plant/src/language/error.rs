//! What is wrong with a rule file, and where.

use std::borrow::Cow;
use std::fmt;

use pest::iterators::Pair;

use super::Rule;

/// A place in a rule file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct RulePosition {
    /// The line, from 1.
    pub line: u32,
    /// The column in characters, from 1.
    pub column: u32,
}

impl fmt::Display for RulePosition {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "line {}, column {}", self.line, self.column)
    }
}

/// Where a pair starts, for errors: counted from the start of its line.
pub(super) fn place_of(pair: &Pair<'_, Rule>) -> RulePosition {
    let (line, column) = pair.line_col();
    RulePosition {
        line: line as u32,
        column: column as u32,
    }
}

/// Why rules cannot be read, derived or drawn.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{place}: {message}")]
pub struct RulesError {
    /// Where in the file.
    pub place: RulePosition,
    /// What is wrong there, and what was expected; one sentence without an end.
    pub message: String,
}

impl RulesError {
    pub(crate) fn at(place: RulePosition, message: impl Into<String>) -> Self {
        Self {
            place,
            message: message.into(),
        }
    }

    /// What the parser expected where it could not go on.
    pub(super) fn of_syntax(error: &pest::error::Error<Rule>, text: &str) -> Self {
        let place = match error.line_col {
            pest::error::LineColLocation::Pos(at) | pest::error::LineColLocation::Span(at, _) => at,
        };
        let place = RulePosition {
            line: place.0 as u32,
            column: place.1 as u32,
        };
        let pest::error::ErrorVariant::ParsingError { positives, .. } = &error.variant else {
            return Self::at(place, "this cannot be read");
        };
        let mut expected: Vec<&str> = positives.iter().map(|&rule| label(rule)).collect();
        expected.sort_unstable();
        expected.dedup();
        let found = found_at(error, text);
        let message = match expected.as_slice() {
            [] => format!("{found} was not expected here"),
            [only] => format!("expected {only}, found {found}"),
            [most @ .., last] => format!("expected {} or {last}, found {found}", most.join(", ")),
        };
        Self::at(place, message)
    }
}

/// The most characters of a name that an error repeats.
const MAX_NAME_CHARACTERS: usize = 80;

/// A name as errors repeat it: cut where it is long.
pub(crate) fn cut(name: &str) -> Cow<'_, str> {
    match name.char_indices().nth(MAX_NAME_CHARACTERS) {
        Some((end, _)) => Cow::Owned(format!("{}\u{2026}", &name[..end])),
        None => Cow::Borrowed(name),
    }
}

fn found_at(error: &pest::error::Error<Rule>, text: &str) -> String {
    let at = match error.location {
        pest::error::InputLocation::Pos(at) | pest::error::InputLocation::Span((at, _)) => at,
    };
    let rest = &text[at..];
    let is_word = |c: char| c.is_ascii_alphanumeric() || c == '_';
    let end = rest.find(|c| !is_word(c)).unwrap_or(rest.len());
    let end = end.min(24);
    match rest.chars().next() {
        None => "the end of the file".to_owned(),
        Some('\n' | '\r') => "the end of the line".to_owned(),
        Some(_) if end > 0 => format!("`{}`", &rest[..end]),
        Some(c) => format!("`{}`", c.escape_debug()),
    }
}

/// A rule of the grammar in words.
fn label(rule: Rule) -> &'static str {
    match rule {
        Rule::EOI
        | Rule::file
        | Rule::constant
        | Rule::declaration
        | Rule::ignored
        | Rule::iterations
        | Rule::modules
        | Rule::setting
        | Rule::axiom
        | Rule::let_word
        | Rule::symbol_word
        | Rule::ignore_word
        | Rule::iterations_word
        | Rule::modules_word
        | Rule::set_word
        | Rule::axiom_word => "a statement",
        Rule::production | Rule::left_context | Rule::head => "a production",
        Rule::name | Rule::binding | Rule::variable => "a name",
        Rule::number => "a number",
        Rule::symbol | Rule::module | Rule::word => "a module",
        Rule::value
        | Rule::expression
        | Rule::conjunction
        | Rule::negation
        | Rule::comparison
        | Rule::sum
        | Rule::product
        | Rule::signed
        | Rule::power
        | Rule::call
        | Rule::primary
        | Rule::not_word
        | Rule::minus => "an expression",
        Rule::comparing
        | Rule::adding
        | Rule::multiplying
        | Rule::raising
        | Rule::and_word
        | Rule::or_word => "an operator",
        Rule::condition | Rule::if_word => "`if`",
        Rule::weight | Rule::weight_word => "`weight`",
        Rule::bindings | Rule::with_word => "`with`",
        Rule::open => "`(`",
        Rule::close => "`)`",
        Rule::push => "`[`",
        Rule::pop => "`]`",
        Rule::comma => "`,`",
        Rule::colon => "`:`",
        Rule::semicolon => "`;`",
        Rule::equals => "`=`",
        Rule::arrow => "`->`",
        Rule::left_of => "`<`",
        Rule::right_context | Rule::right_of => "`>`",
        Rule::statement | Rule::letter | Rule::keyword | Rule::WHITESPACE | Rule::COMMENT => {
            "a statement"
        }
    }
}
