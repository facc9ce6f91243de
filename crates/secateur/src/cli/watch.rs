//! A progress bar on a terminal, and the ear for Ctrl-C.

use std::io::{IsTerminal, stderr};
use std::ops::ControlFlow;

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use secateur::Progress;

use super::args::Common;
use super::interrupt;

/// A progress bar; without one in a pipe or where quiet is asked for.
pub(crate) struct Watch {
    bar: ProgressBar,
}

impl Watch {
    pub(crate) fn new(common: &Common) -> Self {
        let is_shown = !common.quiet && stderr().is_terminal();
        let target = match is_shown {
            true => ProgressDrawTarget::stderr_with_hz(10),
            false => ProgressDrawTarget::hidden(),
        };
        let bar = ProgressBar::with_draw_target(None, target);
        if let Ok(style) =
            ProgressStyle::with_template("{msg:12} {wide_bar} {pos}/{len} leaves, {eta} left")
        {
            bar.set_style(style);
        }
        Self { bar }
    }

    /// To be called with all progress.
    pub(crate) fn see(&self, progress: Progress) -> ControlFlow<()> {
        match progress {
            Progress::Stage(stage) => self.bar.set_message(stage.name()),
            Progress::Step { done, at_most } => {
                self.bar.set_length(at_most as u64);
                self.bar.set_position(done as u64);
            }
            _ => {}
        }
        interrupt::flow()
    }
}

impl Drop for Watch {
    fn drop(&mut self) {
        self.bar.finish_and_clear();
    }
}
