//! Reading takes time in proportion to the file, whatever is long in it, and
//! errors stay short.

use std::time::{Duration, Instant};

use secateur_plant::Rules;

use crate::error;

/// Much more than any of these files takes on a slow machine, and much less than
/// reading one in quadratic time takes on a fast one.
const PLENTY: Duration = Duration::from_secs(60);

/// `piece` until the file is as large as one may be, after `start`.
fn largest(start: &str, piece: &str, end: &str) -> String {
    let room = Rules::MAX_BYTES - start.len() - end.len();
    format!("{start}{}{end}", piece.repeat(room / piece.len()))
}

fn reads_in_time(what: &str, text: &str) {
    let start = Instant::now();
    let outcome = Rules::parse(text);
    let took = start.elapsed();
    assert!(took < PLENTY, "{what}: {took:?}");
    assert!(outcome.is_ok(), "{what}: {outcome:?}");
}

/// Each module and number has a place, and a place has a column: counted from the
/// start of its line, this line would take minutes.
#[test]
fn a_file_of_one_line_is_read_in_linear_time() {
    reads_in_time("modules", &largest("axiom: ", "f(1)", ";"));
    reads_in_time("operators", &largest("axiom: f(1", "+1", ");"));
    reads_in_time(
        "letters of two bytes",
        &largest("#", "\u{e9}", "\naxiom: ;"),
    );
}

/// Productions see all constants, but need no copy of them.
#[test]
fn many_constants_and_many_productions_are_read_in_linear_time() {
    let constants: String = (0..9000).map(|k| format!("let c{k}=1;")).collect();
    let start = format!("axiom: A;{constants}");
    reads_in_time("productions", &largest(&start, "A->;", ""));
}

/// Nor is each of many ignored symbols sought among all of them.
#[test]
fn many_symbols_and_many_to_ignore_are_read_in_linear_time() {
    let symbols: Vec<String> = (0..9000).map(|k| format!("S{k}")).collect();
    let start = format!("axiom: ;symbol {};ignore", symbols.join(","));
    reads_in_time("ignored", &largest(&start, " S8999", ";"));
}

#[test]
fn long_names_are_cut_in_errors() {
    let long = "q".repeat(100_000);
    for text in [
        format!("axiom: {long};"),
        format!("axiom: F({long});"),
        format!("axiom: F({long}(1));"),
        format!("axiom: ; ignore {long};"),
        format!("axiom: {long}(1); symbol {long};"),
        format!("let {long} = 1; let {long} = 1;"),
        format!("axiom: ; set {long} = 1;"),
        format!("axiom: {long}; {long} weight 0 -> ;"),
    ] {
        let said = error(&text);
        assert!(said.contains(&format!("`{}…`", "q".repeat(80))), "{said}");
        assert!(!said.contains(&"q".repeat(81)), "{} characters", said.len());
    }
}

/// Columns count characters, not bytes, also where a line is long.
#[test]
fn places_in_long_lines_are_exact() {
    let long = format!("axiom: {};# \u{e9}\u{e9}\r\nQ", "f(1)".repeat(1000));
    assert!(error(&long).starts_with("line 2, column 2: expected"));
    let long = format!(
        "set leaves = {}1; axiom: {}Q;",
        " ".repeat(333),
        "f(1)".repeat(1000)
    );
    assert!(error(&long).starts_with("line 1, column 4357: unknown symbol `Q`"));
}
