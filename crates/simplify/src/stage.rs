//! Which stage a run is in, and how long each took.

use std::fmt;
use std::ops::ControlFlow;

use web_time::Instant;

use crate::Error;

/// A stage of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Stage {
    /// The resolution of the driving views is chosen.
    Resolution,
    /// Leaves become coarser, and the method chooses which go.
    Select,
    /// The views are drawn, for a method that does not know what they show.
    Observe,
    /// Sizes of what is left are fitted.
    Fit,
    /// The result is drawn again another way.
    Audit,
}

impl Stage {
    /// The name of its entry in reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::Resolution => "resolution",
            Self::Select => "simplify",
            Self::Observe => "areas",
            Self::Fit => "fit",
            Self::Audit => "audit",
        }
    }
}

impl fmt::Display for Stage {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// Where a run stands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Progress {
    /// This stage begins; the one before it has ended.
    Stage(Stage),
    /// A step was made: one leaf less; or, in [`Stage::Fit`], some were tried in other
    /// sizes, which may end early.
    Step {
        /// Steps made in this stage so far.
        done: usize,
        /// Steps to do at most.
        at_most: usize,
    },
    /// The next level of a chain is sought; at the end all are found. The same one may be sought again after others.
    Level {
        /// Levels that were sought before it.
        done: usize,
        /// Levels to seek in all.
        of: usize,
    },
    /// An impostor is about to be baked or looked at, while a chain of levels is made; how many more there will be
    /// is not known.
    Impostor,
    /// A level of a chain is about to be finished: its sizes, its figures, the switch to it or its textures. Told
    /// several times a level.
    Finish,
}

impl Progress {
    /// Hands this to the observer, which may break the run off.
    ///
    /// # Errors
    /// [`Error::Stopped`] if it does.
    pub fn tell(self, observer: &mut Observer<'_>) -> Result<(), Error> {
        match observer(self) {
            ControlFlow::Continue(()) => Ok(()),
            ControlFlow::Break(()) => Err(Error::Stopped),
        }
    }
}

/// Sees all progress of a run, and may break it off.
pub type Observer<'a> = dyn FnMut(Progress) -> ControlFlow<()> + 'a;

/// Tells the stages and times them.
pub(crate) struct Clock<'a> {
    observer: &'a mut Observer<'a>,
    stages: Vec<(Stage, f64)>,
    started: Option<(Stage, Instant)>,
}

impl<'a> Clock<'a> {
    pub(crate) fn new(observer: &'a mut Observer<'a>) -> Self {
        Self {
            observer,
            stages: Vec::new(),
            started: None,
        }
    }

    pub(crate) fn begin(&mut self, stage: Stage) -> Result<(), Error> {
        self.end();
        self.started = Some((stage, Instant::now()));
        Progress::Stage(stage).tell(self.observer)
    }

    pub(crate) fn step(&mut self, done: usize, at_most: usize) -> ControlFlow<()> {
        (self.observer)(Progress::Step { done, at_most })
    }

    fn end(&mut self) {
        if let Some((stage, since)) = self.started.take() {
            let seconds = since.elapsed().as_secs_f64();
            tracing::debug!("{stage}: {seconds:.3} s");
            self.stages.push((stage, seconds));
        }
    }

    pub(crate) fn finish(mut self) -> Vec<(Stage, f64)> {
        self.end();
        self.stages
    }
}
