//! Progress told to Python, and whether to go on asked of it, while its lock is free.

use std::ops::ControlFlow;
use std::time::{Duration, Instant};

use pyo3::prelude::*;
use secateur::Progress;

/// How often Python is asked at most: often enough for Ctrl-C, and seldom enough to cost nothing.
const BETWEEN: Duration = Duration::from_millis(50);

/// Who is told of progress, and what ends the work.
pub(crate) struct Watch {
    progress: Option<Py<PyAny>>,
    cancel: Option<Py<PyAny>>,
    stage: &'static str,
    steps: Option<(usize, usize)>,
    asked: Option<Instant>,
    raised: Option<PyErr>,
}

impl Watch {
    /// `progress(stage, done, of)` is called, and `cancel.is_set()` asked, where they are given.
    pub(crate) fn new(progress: Option<Py<PyAny>>, cancel: Option<Py<PyAny>>) -> Self {
        Self {
            progress,
            cancel,
            stage: "read",
            steps: None,
            asked: None,
            raised: None,
        }
    }

    /// Tells Python of a step, unless it was told a moment ago; breaks off after Ctrl-C, `cancel.set()`, or an exception
    /// of the callback.
    pub(crate) fn show(&mut self, progress: Progress) -> ControlFlow<()> {
        let before = self.stage;
        match progress {
            Progress::Stage(stage) => (self.stage, self.steps) = (stage.name(), None),
            Progress::Step { done, at_most } => self.steps = Some((done, at_most)),
            Progress::Impostor => (self.stage, self.steps) = ("impostor", None),
            Progress::Finish => (self.stage, self.steps) = ("finish", None),
            _ => {}
        }
        let is_recent = self.asked.is_some_and(|asked| asked.elapsed() < BETWEEN);
        if is_recent && before == self.stage {
            return ControlFlow::Continue(());
        }
        let asked = Python::attach(|py| self.ask(py));
        self.asked = Some(Instant::now());
        match asked {
            Ok(true) => ControlFlow::Continue(()),
            Ok(false) => ControlFlow::Break(()),
            Err(raised) => {
                self.raised = Some(raised);
                ControlFlow::Break(())
            }
        }
    }

    /// Whether Python lets it go on.
    fn ask(&self, py: Python<'_>) -> PyResult<bool> {
        py.check_signals()?;
        if let Some(progress) = &self.progress {
            let (done, of) = self.steps.unzip();
            progress.call1(py, (self.stage, done.unwrap_or(0), of))?;
        }
        match &self.cancel {
            Some(cancel) => Ok(!cancel.bind(py).call_method0("is_set")?.is_truthy()?),
            None => Ok(true),
        }
    }

    /// Why the work ended: what Python raised meanwhile, else this.
    pub(crate) fn reason(self, otherwise: PyErr) -> PyErr {
        self.raised.unwrap_or(otherwise)
    }
}
