//! A few dozen of the plants of `examples/odd_plants`.

#[path = "../examples/odd_plants/check.rs"]
mod check;
#[path = "../examples/odd_plants/plants.rs"]
mod plants;

use check::{Answers, check};
use plants::odd_plant;

/// As many as take a few seconds.
const COUNT: u64 = 30;

#[test]
fn odd_plants_give_levels_or_a_sentence() {
    let mut all = Answers::default();
    for number in 0..COUNT {
        let plant = odd_plant(number);
        eprintln!("{}", plant.about);
        let answers = check(&plant, number);
        all.levels += answers.levels;
        all.sentences += answers.sentences;
    }
    // Not all are refused, and not all are simplified.
    assert!(all.levels > 30 && all.sentences > 10, "{all:?}");
}
