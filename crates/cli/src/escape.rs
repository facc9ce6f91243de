//! Text of files on its way to a terminal or a spreadsheet: names in a file are not to be trusted.

/// The text with every control character but the line feed, and every character that changes the
/// direction of writing, as its escape: `\u{1b}`. A terminal would obey them.
pub(crate) fn escaped(text: &str) -> String {
    let obeys = |c: char| {
        (c.is_control() && c != '\n')
            || matches!(c, '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}')
    };
    let mut safe = String::with_capacity(text.len());
    for c in text.chars() {
        match obeys(c) {
            true => safe.extend(c.escape_unicode()),
            false => safe.push(c),
        }
    }
    safe
}

/// A cell of a spreadsheet as text, not as a formula: with an apostrophe before what a spreadsheet
/// would compute. Numbers stay as they are.
pub(crate) fn cell(text: &str) -> String {
    let is_formula = text.starts_with(['=', '+', '-', '@', '\t', '\r']);
    match is_formula && text.parse::<f64>().is_err() {
        true => format!("'{text}"),
        false => text.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_terminal_is_told_nothing() {
        let hostile = "a\u{1b}]0;x\u{7}b\u{9b}31m\u{202e}c\nd\r";
        let expected = "a\\u{1b}]0;x\\u{7}b\\u{9b}31m\\u{202e}c\nd\\u{d}";
        assert_eq!(escaped(hostile), expected);
        assert_eq!(escaped("Blätter 葉"), "Blätter 葉");
    }

    #[test]
    fn a_spreadsheet_computes_nothing() {
        for formula in ["=1+1", "+cmd", "-x", "@sum", "\t=1"] {
            assert_eq!(cell(formula), format!("'{formula}"));
        }
        for plain in ["-1.5", "+3", "oak", ""] {
            assert_eq!(cell(plain), plain);
        }
    }
}
