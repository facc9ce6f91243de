//! Expressions: precedence, functions, lots.

use proptest::prelude::*;

use crate::{error, word};

fn value(expression: &str) -> f64 {
    let word = word(&format!("axiom: V({expression}); symbol V(x);"));
    word["V(".len()..word.len() - 1].parse().unwrap()
}

#[test]
fn operators_bind_as_in_arithmetic() {
    for (expression, expected) in [
        ("1 + 2 * 3", 7.0),
        ("(1 + 2) * 3", 9.0),
        ("10 - 4 - 3", 3.0),
        ("24 / 4 / 2", 3.0),
        ("-2 ^ 2", -4.0),
        ("(-2) ^ 2", 4.0),
        ("2 ^ -1", 0.5),
        ("2 * 3 ^ 2", 18.0),
        ("1.5e2 + .0".trim_end_matches(" + .0"), 150.0),
        ("1 - -1", 2.0),
        ("1 < 2 and 2 < 1", 0.0),
        ("1 < 2 or 2 < 1", 1.0),
        ("not 1 > 2", 1.0),
        ("1 + 1 == 2", 1.0),
        ("1 != 1", 0.0),
        ("0 and 0 or 1", 1.0),
        ("2 >= 2 and 2 <= 2", 1.0),
    ] {
        assert_eq!(value(expression), expected, "{expression}");
    }
}

#[test]
fn functions_do_what_their_names_say() {
    for (expression, expected) in [
        ("abs(-3)", 3.0),
        ("sqrt(16)", 4.0),
        ("exp(0)", 1.0),
        ("log(1)", 0.0),
        ("sin(90)", 1.0),
        ("cos(0)", 1.0),
        ("tan(0)", 0.0),
        ("asin(1)", 90.0),
        ("acos(1)", 0.0),
        ("atan(0)", 0.0),
        ("atan2(1, 0)", 90.0),
        ("floor(-1.5)", -2.0),
        ("ceil(-1.5)", -1.0),
        ("round(2.5)", 3.0),
        ("min(1, 2)", 1.0),
        ("max(1, 2)", 2.0),
        ("pow(2, 10)", 1024.0),
        ("mod(-1, 3)", 2.0),
        ("clamp(7, 0, 5)", 5.0),
        ("clamp(-7, 0, 5)", 0.0),
        ("select(1 > 2, 3, 4)", 4.0),
        ("select(2, 3, 4)", 3.0),
        ("uniform(2, 2)", 2.0),
        ("normal(3, 0)", 3.0),
    ] {
        assert_eq!(value(expression), expected, "{expression}");
    }
}

#[test]
fn what_is_no_number_is_said_where_it_happens() {
    let at = |expression: &str| error(&format!("axiom: F({expression});"));
    assert_eq!(at("1 / (1 - 1)"), "line 1, column 12: division by zero");
    assert_eq!(at("mod(1, 0)"), "line 1, column 10: division by zero");
    for bad in [
        "sqrt(-1)",
        "log(0)",
        "(-2) ^ 0.5",
        "10 ^ 999",
        "exp(1000)",
        "1e300 * 1e300",
    ] {
        assert!(
            at(bad).ends_with("the result is not a finite number"),
            "{bad}"
        );
    }
    assert!(at("normal(0, -1)").ends_with("normal has a negative deviation"));
    assert!(at("clamp(0, 2, 1)").ends_with("clamp has a lower bound above its upper one"));
    assert!(at("1e999").ends_with("the number is too large"));
}

proptest! {
    #[test]
    fn sums_and_products_are_those_of_the_machine(a in -1e6..1e6, b in -1e6..1e6, c in 1.0..1e6) {
        prop_assert_eq!(value(&format!("({a}) + ({b}) * ({c})")), a + b * c);
        prop_assert_eq!(value(&format!("({a}) - ({b}) / ({c})")), a - b / c);
    }
}
