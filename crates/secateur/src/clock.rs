//! Which stage a run is in, and how long each took.

use std::ops::ControlFlow;
use std::time::Instant;

use crate::{Error, Progress};

/// Tells the stages and times them.
pub(crate) struct Clock<'a> {
    progress: &'a mut dyn FnMut(Progress) -> ControlFlow<()>,
    stages: Vec<(&'static str, f64)>,
    started: Option<(&'static str, Instant)>,
}

impl<'a> Clock<'a> {
    pub(crate) fn new(progress: &'a mut dyn FnMut(Progress) -> ControlFlow<()>) -> Self {
        Self {
            progress,
            stages: Vec::new(),
            started: None,
        }
    }

    pub(crate) fn begin(&mut self, stage: &'static str) -> Result<(), Error> {
        self.end();
        self.started = Some((stage, Instant::now()));
        match (self.progress)(Progress::Stage(stage)) {
            ControlFlow::Continue(()) => Ok(()),
            ControlFlow::Break(()) => Err(Error::Stopped),
        }
    }

    pub(crate) fn step(&mut self, done: usize, at_most: usize) -> ControlFlow<()> {
        (self.progress)(Progress::Step { done, at_most })
    }

    fn end(&mut self) {
        if let Some((stage, since)) = self.started.take() {
            let seconds = since.elapsed().as_secs_f64();
            tracing::debug!("{stage}: {seconds:.3} s");
            self.stages.push((stage, seconds));
        }
    }

    pub(crate) fn finish(mut self) -> Vec<(&'static str, f64)> {
        self.end();
        self.stages
    }
}
