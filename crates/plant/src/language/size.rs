//! Files that are too large or too deep, refused before they are parsed.

use super::{RulePosition, Rules, RulesError};

/// The most parentheses within one another.
const MAX_NESTING: usize = 24;

/// Refuses what would nest too deeply for the parser's own stack.
pub(super) fn check_size(text: &str) -> Result<(), RulesError> {
    let start = RulePosition { line: 1, column: 1 };
    if text.len() > Rules::MAX_BYTES {
        let message = format!("the file has more than {} bytes", Rules::MAX_BYTES);
        return Err(RulesError::at(start, message));
    }
    let mut depth = 0usize;
    for (line, number) in text.lines().zip(1..) {
        let code = line.split('#').next().unwrap_or_default();
        for (c, column) in code.chars().zip(1..) {
            match c {
                '(' => depth += 1,
                ')' => depth = depth.saturating_sub(1),
                ';' => depth = 0,
                _ => {}
            }
            if depth > MAX_NESTING {
                let place = RulePosition {
                    line: number,
                    column,
                };
                let message = format!("more than {MAX_NESTING} parentheses within one another");
                return Err(RulesError::at(place, message));
            }
        }
    }
    Ok(())
}
