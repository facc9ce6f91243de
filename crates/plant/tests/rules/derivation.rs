//! Derivation, on systems small enough to be done by hand.

use secateur_plant::{Random, Rules};

use crate::word;

#[test]
fn all_modules_are_rewritten_at_once() {
    // Lindenmayer's algae: A -> A B, B -> A has the lengths of Fibonacci.
    let algae = |n| word(&format!("iterations = {n}; axiom: A; A -> A B; B -> A;"));
    assert_eq!(algae(0), "A");
    assert_eq!(algae(3), "A B A A B");
    assert_eq!(algae(4), "A B A A B A B A");
}

#[test]
fn conditions_see_parameters_and_derivation_ends_by_itself() {
    // Doubles while below 10: 1, 2, 4, 8, 16, then no production matches.
    assert_eq!(word("axiom: A(1); A(x) if x < 10 -> A(2 * x);"), "A(16)");
    // The example of section 1.10.1 (1.8) of the book, after its three steps.
    let text = "
        iterations = 3;
        axiom: B(2) A(4, 4);
        A(x, y) if y <= 3 -> A(x * 2, x + y);
        A(x, y) if y > 3 -> B(x) A(x / y, 0);
        B(x) if x < 1 -> C;
        B(x) if x >= 1 -> B(x - 1);
        symbol C;
    ";
    assert_eq!(word(text), "C B(2) A(4,3)");
}

#[test]
fn the_iteration_can_be_asked_for() {
    let text = "iterations = 4; axiom: A; A if iteration == 2 -> B(iteration); symbol B(i);";
    assert_eq!(word(text), "B(2)");
}

#[test]
fn the_same_symbol_with_more_parameters_is_another() {
    let text = "iterations = 1; axiom: A A(1) A(1, 2); A(x) -> B; symbol A, A(x, y), B;";
    assert_eq!(word(text), "A B A(1,2)");
}

#[test]
fn a_module_can_vanish_between_its_neighbours() {
    let text = "axiom: A(1); A(x) if x == 1 -> B(1) A(2) B(3); A(x) if x == 2 -> ; symbol B(x);";
    assert_eq!(word(text), "B(1) B(3)");
    assert_eq!(word("axiom: A A; A -> ;"), "");
}

#[test]
fn weights_say_how_often_a_production_is_taken() {
    let many = "A ".repeat(1000);
    let text = format!(
        "axiom: {many}; A weight 3 -> B(1); A weight 1 -> B(2); A weight 0 -> B(3); symbol B(x);"
    );
    let word = word(&text);
    let count = |module| word.split(' ').filter(|m| *m == module).count();
    // Of 1000 draws at 3/4, four deviations are 55.
    assert!(count("B(1)").abs_diff(750) < 55, "{}", count("B(1)"));
    assert_eq!(count("B(1)") + count("B(2)"), 1000);
}

#[test]
fn a_signal_moves_to_the_right_and_to_the_left() {
    // Section 1.8 of the book: b < a -> b, and b -> a, step by step.
    let right = |n| {
        word(&format!(
            "iterations = {n}; axiom: B A A A; B < A > -> B; B -> A;"
        ))
    };
    assert!(
        std::panic::catch_unwind(|| right(1)).is_err(),
        "> needs a head"
    );
    let right = |n| {
        word(&format!(
            "iterations = {n}; axiom: B A A A; B < A -> B; B -> A;"
        ))
    };
    assert_eq!(right(1), "A B A A");
    assert_eq!(right(3), "A A A B");
    let left = |n| {
        word(&format!(
            "iterations = {n}; axiom: A A A B; A > B -> B; B -> A;"
        ))
    };
    assert_eq!(left(1), "A A B A");
    assert_eq!(left(3), "B A A A");
}

#[test]
fn contexts_skip_branches_and_look_through_what_is_ignored() {
    // The example of section 1.8: in ABC[DE][SG[HI[JK]L]MNO] the production
    // BC < S > G[H]M sees through branches. Here: C before S across [D E], and
    // M after G across [H [J] L].
    let text = "
        iterations = 1;
        axiom: A B C [ D E ] [ +(5) S G [ H [ J ] L ] M N ];
        ignore +;
        B C < S > G M -> X;
        symbol A, B, C, D, E, G, H, J, L, M, N, X;
    ";
    assert_eq!(word(text), "A B C [ D E ] [ +(5) X G [ H [ J ] L ] M N ]");
    // The end of a branch has nothing after it, though more is on the parent axis.
    let end = "iterations = 1; axiom: [ A ] B; A > B -> X; symbol B, X;";
    assert_eq!(word(end), "[ A ] B");
    let start = "iterations = 1; axiom: B [ A ]; B < A -> X; symbol B, X;";
    assert_eq!(word(start), "B [ X ]");
}

#[test]
fn contexts_lend_their_parameters_and_are_of_the_step_before() {
    // Each takes the sum of its neighbours, all at once.
    let text = "
        iterations = 1;
        axiom: A(1) A(10) A(100);
        A(a) < A(b) > A(c) -> A(a + c);
        A(b) > A(c) weight 0 -> A(c);
    ";
    // Only one production matches the ends, with a weight of 0: that is an error.
    assert!(std::panic::catch_unwind(|| word(text)).is_err());
    let text = text.replace("weight 0 ", "if b == 1 ");
    assert_eq!(word(&text), "A(10) A(101) A(100)");
}

#[test]
fn names_of_with_hold_for_the_whole_successor() {
    let text = "iterations = 1; axiom: A; A with x = uniform(0, 1), y = 2 * x -> B(x, y, x); \
                symbol B(a, b, c);";
    let word = word(text);
    let numbers: Vec<f64> = word
        .trim_matches(|c: char| !c.is_ascii_digit())
        .split(',')
        .map(|n| n.parse().unwrap())
        .collect();
    assert_eq!(numbers[1], 2.0 * numbers[0]);
    assert_eq!(numbers[2], numbers[0]);
}

#[test]
fn equal_seeds_derive_equal_words() {
    let text = "let a = normal(0, 1); axiom: A(5); \
                A(n) if n > 0 -> +(a) F(uniform(1, 2)) [ A(n - 1) ] A(n - 1);";
    let rules = Rules::parse(text).unwrap();
    let of = |seed| {
        let word = rules.derive(1.0, &mut Random::new(seed)).unwrap();
        word.to_text(&rules)
    };
    assert_eq!(of(1), of(1));
    assert_ne!(of(1), of(2));
}

#[test]
fn work_is_linear_in_modules_where_most_are_finished() {
    // 20,000 steps of a stem whose leaves have productions that no longer match:
    // if each step looked at all of them, this would be 200 million looks.
    let text = "axiom: S(20000); S(n) if n > 0 -> L(1) S(n - 1); L(x) if x > 1 -> L(x - 1);";
    assert_eq!(word(text).split(' ').count(), 20_001);
}
