//! Plants by chance, opened, inspected and made levels of: `examples/odd_plants` makes as many as one likes.

#[path = "../crates/cli/examples/odd_plants/check.rs"]
mod check;
#[path = "../crates/cli/examples/odd_plants/plant/mod.rs"]
pub(crate) mod plant;

use proptest::prelude::*;

use check::{Answers, check};

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(40) })]

    #[test]
    fn odd_plants_give_levels_or_a_sentence(choices in prop::collection::vec(any::<u8>(), 0..40)) {
        check(&choices);
    }
}

/// Not all are refused, and not all are simplified.
#[test]
fn numbered_plants_give_both() {
    let mut all = Answers::default();
    for number in 0..20 {
        let choices = plant::bytes_of(number);
        eprintln!(
            "{}",
            plant::odd_plant(&mut plant::Choices::new(&choices)).about
        );
        all += check(&choices);
    }
    assert!(all.levels > 5 && all.sentences > 5, "{all:?}");
}

/// Plants that were found to panic, to take minutes, or to end in levels without a triangle.
#[test]
fn plants_that_were_mended_stay_so() {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../fuzz/corpus/odd_plants");
    let files = std::fs::read_dir(folder).unwrap();
    let checked = files.map(|file| check(&std::fs::read(file.unwrap().path()).unwrap()));
    assert!(checked.count() >= 4);
}
