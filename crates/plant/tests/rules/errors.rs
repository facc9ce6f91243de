//! One sentence with line and column for whatever is wrong.

use secateur_plant::Rules;

use crate::error;

#[test]
fn syntax_errors_say_what_was_expected() {
    assert_eq!(
        error("axiom: F(1)\nA -> F(1);"),
        "line 2, column 3: expected `(`, `;`, `[`, `]` or a module, found `-`"
    );
    assert_eq!(
        error("axiom: F(1"),
        "line 1, column 11: expected `)`, `,` or an operator, found the end of the file"
    );
    assert_eq!(
        error("let = 3;"),
        "line 1, column 5: expected a name, found `=`"
    );
    assert_eq!(
        error("axiom: A;\nA if -> F(1);"),
        "line 2, column 6: expected an expression, found `-`"
    );
    assert!(error("axiom: F(1 + );").starts_with("line 1, column 14: expected"));
    assert!(error("let let = 1;").starts_with("line 1, column 5: expected a name, found `let`"));
    assert!(error("\u{e9}").starts_with("line 1, column 1: expected"));
}

#[test]
fn symbols_and_names_must_be_known() {
    assert!(error("axiom: F(1) Q;").starts_with("line 1, column 13: unknown symbol `Q`"));
    assert!(error("axiom: A; A -> F(x);").starts_with("line 1, column 18: unknown name `x`"));
    assert!(error("axiom: F(iteration);").ends_with("only productions have an iteration"));
    assert!(error("axiom: F(sin);").contains("`sin(...)`"));
    assert!(error("axiom: F(sinus(1));").contains("unknown function `sinus`: there are abs, "));
    assert!(error("let a = b; let b = 1; axiom: F(a);").contains("unknown name `b`"));
    assert!(error("let a = 1; let a = 2; axiom: ;").ends_with("the name `a` is taken"));
    assert!(error("let sin = 1; axiom: ;").ends_with("`sin` is the name of a function"));
    assert!(error("axiom: A(1); A(x) with x = 2 -> ;").ends_with("the name `x` is taken"));
    assert!(error("axiom: ; ignore Q;").contains("unknown symbol `Q`"));
}

#[test]
fn numbers_of_parameters_must_fit() {
    assert_eq!(
        error("axiom: F(1, 2, 3);"),
        "line 1, column 8: `F` takes 1 or 2 parameters, not 3"
    );
    assert_eq!(
        error("axiom: A(1, 2); A(x) -> ;"),
        "line 1, column 8: `A` takes 1 parameter, not 2"
    );
    assert_eq!(
        error("axiom: +;"),
        "line 1, column 8: `+` takes 1 parameter, not 0"
    );
    assert!(error("axiom: F(min(1));").ends_with("`min` takes 2 arguments, not 1"));
}

#[test]
fn brackets_must_match() {
    assert_eq!(
        error("axiom: F(1) [ F(1);"),
        "line 1, column 13: `[` without a `]` after it"
    );
    assert_eq!(
        error("axiom: A;\nA -> F(1) ] [;"),
        "line 2, column 11: `]` without a `[` before it"
    );
    let deep = format!("axiom: F({}1{});", "(".repeat(30), ")".repeat(30));
    assert!(error(&deep).ends_with("more than 24 parentheses within one another"));
}

#[test]
fn growth_without_end_meets_a_limit_that_is_stated() {
    assert_eq!(
        error("modules = 1000; axiom: A;\nA -> A A;"),
        "line 2, column 8: the rules make more than 1000 modules, the limit, at iteration 8: do \
         they end?"
    );
    assert_eq!(
        error("axiom: A(0); A(x) -> A(x);"),
        format!(
            "line 1, column 14: the rules do not end: this production still matches after {} \
             iterations",
            Rules::MAX_ITERATIONS
        )
    );
    assert!(error("modules = 0; axiom: ;").contains("write a number from 1 to 24000000"));
    assert!(error("iterations = -1; axiom: ;").contains("expected 0 to 100000 iterations, not -1"));
}

#[test]
fn weights_must_sum_to_more_than_nothing() {
    assert_eq!(
        error("axiom: A;\n  A weight 0 -> F(1);"),
        "line 2, column 3: the weights of the productions that match `A` sum to 0, not to a \
         positive number"
    );
    assert!(error("axiom: A; A weight 0 - 1 -> ;").contains("is negative: -1"));
    assert!(error("axiom: A; A weight uniform(0, 1) -> ;").contains("a weight cannot draw lots"));
    assert!(error("axiom: A; A if normal(0, 1) > 0 -> ;").contains("a condition cannot draw lots"));
}

#[test]
fn a_file_must_have_one_axiom() {
    assert!(error("").ends_with("the file has no axiom: write `axiom: ...;`"));
    assert!(error("axiom: ; axiom: ;").ends_with("`axiom` is given twice"));
    let long = " ".repeat((1 << 20) + 1);
    assert!(error(&long).contains("more than 1048576 bytes"));
}

#[test]
fn settings_must_be_known_and_in_range() {
    assert!(error("set colour = 1; axiom: ;").contains("unknown setting `colour`: there are"));
    assert!(error("set leaf_width = 0; axiom: ;").contains("expected a number from 0.001 to 10"));
    assert!(error("set leaf_width = wide; axiom: ;").contains("expected a number"));
    assert!(error("set leaf_outline = square; axiom: ;").contains("expected one of plain, ovate"));
    assert!(error("set leaf_colour = 1, 1; axiom: ;").contains("`leaf_colour` takes 3 values"));
    assert!(error("set leaf_width = 1, 1; axiom: ;").contains("takes 1 value, not 2"));
}
