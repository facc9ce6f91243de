//! What the time of a chain goes to, stage by stage: all of it, as one stage is always running.

use std::cell::Cell;
use web_time::Instant;

/// A stage of the making of a chain.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum ChainStage {
    /// The plant is got ready: its pieces, its colours, and where it is looked at from.
    Prepare,
    /// Leaves and wood of a level that is tried become fewer.
    Simplify,
    /// Levels are held against the plant.
    Difference,
    /// Textures are made for levels, and coverage is counted.
    Textures,
    /// Impostors are baked and compared.
    Impostors,
    /// Finished levels get the rest of their figures.
    Figures,
}

impl ChainStage {
    const ALL: [Self; 6] = [
        Self::Prepare,
        Self::Simplify,
        Self::Difference,
        Self::Textures,
        Self::Impostors,
        Self::Figures,
    ];

    /// The name of its entry in reports.
    fn name(self) -> &'static str {
        match self {
            Self::Prepare => "prepare",
            Self::Simplify => "simplify",
            Self::Difference => "difference",
            Self::Textures => "textures",
            Self::Impostors => "impostors",
            Self::Figures => "figures",
        }
    }
}

/// Times the stages, from its making on.
#[derive(Debug)]
pub(super) struct StageClock {
    /// Seconds by stage, in the order of [`ChainStage::ALL`].
    seconds: Cell<[f64; ChainStage::ALL.len()]>,
    /// The stage that is running, and since when.
    running: Cell<(ChainStage, Instant)>,
}

impl StageClock {
    /// A clock in the first stage.
    pub(super) fn start() -> Self {
        Self {
            seconds: Cell::default(),
            running: Cell::new((ChainStage::Prepare, Instant::now())),
        }
    }

    /// Does some work of a stage; what was running before goes on after it.
    pub(super) fn time<T>(&self, stage: ChainStage, work: impl FnOnce() -> T) -> T {
        let before = self.switch(stage);
        let made = work();
        self.switch(before);
        made
    }

    /// Ends the stage that is running, begins another, and tells which ended.
    fn switch(&self, stage: ChainStage) -> ChainStage {
        let now = Instant::now();
        let (before, since) = self.running.replace((stage, now));
        let mut seconds = self.seconds.get();
        seconds[before as usize] += (now - since).as_secs_f64();
        self.seconds.set(seconds);
        before
    }

    /// Seconds of each stage so far, by its name.
    pub(super) fn seconds(&self) -> Vec<(&'static str, f64)> {
        self.switch(self.running.get().0);
        let names = ChainStage::ALL.map(ChainStage::name);
        names.into_iter().zip(self.seconds.get()).collect()
    }
}
