//! Simplifies odd plants, and makes levels of them: each gives a plant or one sentence, and none a panic.
//!
//! cargo run --release -p secateur-cli --example odd_plants -- COUNT [FIRST]
//!
//! FIRST is the number of the first plant, by default 0; the same number is the same plant.

mod check;
mod plant;

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::process::ExitCode;
use std::time::{Duration, Instant};

use check::{Answers, check};
use plant::{Choices, bytes_of, odd_plant};

/// How long a plant may take.
const LONGEST: Duration = Duration::from_secs(60);

fn main() -> ExitCode {
    let mut arguments = std::env::args().skip(1).map(|a| a.parse::<u64>());
    let (Some(Ok(count)), Ok(first)) = (arguments.next(), arguments.next().unwrap_or(Ok(0))) else {
        eprintln!("usage: odd_plants COUNT [FIRST]");
        return ExitCode::from(2);
    };
    let (mut all, mut failed) = (Answers::default(), 0);
    let mut longest = Duration::ZERO;
    for number in first..first.saturating_add(count) {
        let choices = bytes_of(number);
        let start = Instant::now();
        let answers = catch_unwind(AssertUnwindSafe(|| check(&choices)));
        let took = start.elapsed();
        longest = longest.max(took);
        match answers {
            Ok(answers) if took <= LONGEST => all += answers,
            Ok(_) | Err(_) => {
                let about = odd_plant(&mut Choices::new(&choices)).about;
                println!("plant {number} failed after {took:.1?}: {about}");
                failed += 1;
            }
        }
    }
    println!(
        "{count} plants: {} levels, {} sentences, {failed} failed, at most {longest:.1?} each",
        all.levels, all.sentences
    );
    ExitCode::from(u8::from(failed > 0))
}
