//! Simplifies odd plants, and makes levels of them: each gives a plant or one sentence, and none a panic.
//!
//! cargo run --release -p secateur-levels --example odd_plants -- COUNT [FIRST]
//!
//! FIRST is the number of the first plant, by default 0; the same number is the same plant.

mod check;
mod plants;

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::process::ExitCode;

use check::{Answers, check};
use plants::odd_plant;

fn main() -> ExitCode {
    let mut arguments = std::env::args().skip(1).map(|a| a.parse::<u64>());
    let (Some(Ok(count)), Ok(first)) = (arguments.next(), arguments.next().unwrap_or(Ok(0))) else {
        eprintln!("usage: odd_plants COUNT [FIRST]");
        return ExitCode::from(2);
    };
    let mut all = Answers::default();
    let mut failed = 0;
    for number in first..first.saturating_add(count) {
        let plant = odd_plant(number);
        match catch_unwind(AssertUnwindSafe(|| check(&plant, number))) {
            Ok(answers) => {
                all.levels += answers.levels;
                all.sentences += answers.sentences;
            }
            Err(_) => {
                println!("{}", plant.about);
                failed += 1;
            }
        }
    }
    println!(
        "{count} plants: {} levels, {} sentences, {failed} failed",
        all.levels, all.sentences
    );
    ExitCode::from(u8::from(failed > 0))
}
