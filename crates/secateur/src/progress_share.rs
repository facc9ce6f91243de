//! How much of the work on a plant is done, as one share over all its stages.

use secateur_simplify::{Progress, Stage};

/// The share when what is read is read.
const READ: f64 = 0.03;

/// The share when the last level of a chain is found: impostors, switches and files are left.
const LEVELS: f64 = 0.85;

/// The share of what is left of a level, or of a run, that a stage takes whose end is not known.
const OF_THE_REST: f64 = 0.15;

/// The share of the work on a level, or on levels, that is done, and what is being done. The share never falls, and
/// stays below 1.
///
/// ```
/// use secateur::{Progress, ProgressShare};
///
/// let mut share = ProgressShare::default();
/// share.see(Progress::Level { done: 3, of: 4 });
/// assert!(share.done() > 0.5);
/// assert_eq!(share.doing(), "level 4 of 4, search");
/// ```
#[derive(Debug)]
pub struct ProgressShare {
    /// The part of the work that one of several levels takes; all of it where there is one.
    span: [f64; 2],
    /// The part of that which the stage takes.
    stage: [f64; 2],
    /// How much of the stage is done.
    steps: f64,
    level: Option<[usize; 2]>,
    doing: &'static str,
}

impl Default for ProgressShare {
    /// Before anything is read.
    fn default() -> Self {
        Self {
            span: [READ, 1.0],
            stage: [0.0; 2],
            steps: 0.0,
            level: None,
            doing: "read",
        }
    }
}

impl ProgressShare {
    /// Takes a step of progress in.
    pub fn see(&mut self, progress: Progress) {
        match progress {
            Progress::Level { done, of } => self.begin_level(done, of),
            // The ends are what stages of a large tree were measured to take.
            Progress::Stage(stage) => self.begin(
                stage.name(),
                match stage {
                    Stage::Resolution => 0.05,
                    Stage::Select => 0.6,
                    Stage::Fit => 0.9,
                    _ => 0.0,
                },
            ),
            Progress::Step { done, at_most } => {
                self.steps = self.steps.max(done as f64 / at_most.max(1) as f64).min(1.0);
            }
            Progress::Impostor => self.begin("impostor", 0.0),
            _ => self.begin("finish", 0.0),
        }
    }

    /// From 0 to less than 1.
    pub fn done(&self) -> f64 {
        let at = |[from, to]: [f64; 2], share: f64| from + (to - from) * share;
        match self.doing {
            "read" => 0.0,
            _ => at(self.span, at(self.stage, self.steps)),
        }
    }

    /// What is being done: a stage by its name, after `level 2 of 4,` where there are several levels.
    pub fn doing(&self) -> String {
        match self.level {
            Some([done, of]) if done < of => format!("level {} of {of}, {}", done + 1, self.doing),
            Some(_) | None => self.doing.to_owned(),
        }
    }

    /// A stage that ends at this share of a run or a level, or somewhat further where that is behind.
    fn begin(&mut self, doing: &'static str, end: f64) {
        let from = match self.doing {
            "read" => 0.0,
            _ => self.stage[1],
        };
        // Within a level of a chain runs follow each other, and how many is not known.
        let known = self.level.map_or(end, |_| 0.0);
        self.stage = [from, known.max(from + OF_THE_REST * (1.0 - from))];
        self.steps = 0.0;
        self.doing = doing;
    }

    fn begin_level(&mut self, done: usize, of: usize) {
        let before = self.done().max(READ);
        let share = |levels: usize| READ + (LEVELS - READ) * levels as f64 / of.max(1) as f64;
        let end = if done < of { share(done + 1) } else { 1.0 };
        // A level may be sought again after the next.
        let from = before.max(share(done.min(of)));
        self.span = [from, end.max(from)];
        self.stage = [0.0; 2];
        self.steps = 0.0;
        self.level = Some([done, of]);
        self.doing = "search";
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The shares after each of these.
    fn shares(events: &[Progress]) -> Vec<f64> {
        let mut share = ProgressShare::default();
        let after = |event: &Progress| {
            share.see(*event);
            share.done()
        };
        events.iter().map(after).collect()
    }

    fn assert_rises_below_one(shares: &[f64]) {
        let falls = shares.windows(2).find(|pair| pair[1] < pair[0]);
        assert_eq!(falls, None, "{shares:?}");
        assert!(*shares.last().unwrap() < 1.0, "{shares:?}");
    }

    #[test]
    fn a_run_is_weighted_by_what_its_stages_cost() {
        let step = |done| Progress::Step { done, at_most: 100 };
        let select = Progress::Stage(Stage::Select);
        let shares = shares(&[
            Progress::Stage(Stage::Resolution),
            select,
            step(50),
            step(100),
            // A second choice of leaves, and fewer steps than were allowed for.
            select,
            step(10),
            Progress::Stage(Stage::Fit),
            Progress::Finish,
            Progress::Finish,
        ]);
        assert_rises_below_one(&shares);
        assert!((0.3..0.5).contains(&shares[2]), "{shares:?}");
        assert!((0.5..0.7).contains(&shares[3]), "{shares:?}");
        assert!((0.9..1.0).contains(&shares[7]), "{shares:?}");
    }

    #[test]
    fn a_chain_goes_on_where_a_level_is_sought_again_or_takes_long() {
        let level = |done| Progress::Level { done, of: 4 };
        let fit = Progress::Stage(Stage::Fit);
        let mut events = vec![level(0)];
        events.extend([fit; 40]);
        events.extend([
            level(1),
            fit,
            level(2),
            fit,
            level(1),
            fit,
            level(2),
            level(3),
        ]);
        events.extend([fit, level(4), Progress::Impostor, Progress::Finish]);
        let all = shares(&events);
        assert_rises_below_one(&all);
        let [first, last] = [all[40], all[events.len() - 3]];
        assert!(
            (0.2..0.25).contains(&first),
            "a quarter of the levels: {first}"
        );
        assert!(last >= LEVELS, "{last}");
        let mut share = ProgressShare::default();
        assert_eq!((share.done(), share.doing()), (0.0, "read".to_owned()));
        share.see(level(1));
        share.see(fit);
        assert_eq!(share.doing(), "level 2 of 4, fit");
    }
}
