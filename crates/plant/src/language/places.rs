//! Lines and columns of a rule file.

use super::RulePosition;

/// Bytes between places that are known: counting goes no further than this.
const STRIDE_BYTES: usize = 256;

/// Where each byte of a text stands. The parser's own columns are counted from the
/// start of the line each time, which takes quadratic time on long lines.
#[derive(Default)]
pub(super) struct Places<'a> {
    text: &'a str,
    /// The first character at or after each multiple of the stride, and its place.
    known: Vec<(usize, RulePosition)>,
}

impl<'a> Places<'a> {
    pub(super) fn new(text: &'a str) -> Self {
        let mut known = Vec::with_capacity(text.len() / STRIDE_BYTES + 1);
        let mut place = RulePosition { line: 1, column: 1 };
        for (offset, c) in text.char_indices() {
            if offset >= known.len() * STRIDE_BYTES {
                known.push((offset, place));
            }
            place = after(c, place);
        }
        Self { text, known }
    }

    /// The place of the character that starts at this byte, or of the text's end.
    pub(super) fn at(&self, byte: usize) -> RulePosition {
        let next = self.known.partition_point(|(offset, _)| *offset <= byte);
        let start = RulePosition { line: 1, column: 1 };
        let (offset, place) = match next {
            0 => (0, start),
            _ => self.known[next - 1],
        };
        let between = self.text[offset..byte].chars();
        between.fold(place, |place, c| after(c, place))
    }
}

/// The place after a character at `place`.
fn after(c: char, place: RulePosition) -> RulePosition {
    match c {
        '\n' => RulePosition {
            line: place.line + 1,
            column: 1,
        },
        _ => RulePosition {
            line: place.line,
            column: place.column + 1,
        },
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_are_those_that_the_parser_counts() {
        let texts = [
            "a\u{20ac}\u{e9}".repeat(300),
            "ab\r\n\u{1f333}\n".repeat(200),
            String::new(),
        ];
        for text in &texts {
            let places = Places::new(text);
            let boundaries = (0..=text.len()).filter(|&byte| text.is_char_boundary(byte));
            for byte in boundaries {
                let parser = pest::Position::new(text, byte).expect("a boundary");
                let place = places.at(byte);
                let pair = (place.line as usize, place.column as usize);
                assert_eq!(pair, parser.line_col(), "byte {byte}");
            }
        }
    }
}
