//! A progress bar on a terminal; each update also asks whether Ctrl-C was pressed.

use std::io::{IsTerminal, stderr};
use std::ops::ControlFlow;

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use secateur::Progress;

use super::args::Common;
use super::interrupt;

/// Shows the progress of a run; hidden in a pipe and with `--quiet`.
pub(crate) struct RunProgress {
    bar: ProgressBar,
}

impl RunProgress {
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

    /// Shows a step of progress; breaks the run off after Ctrl-C.
    pub(crate) fn show(&self, progress: Progress) -> ControlFlow<()> {
        match progress {
            Progress::Stage(stage) => self.bar.set_message(stage.name()),
            Progress::Step { done, at_most } => {
                self.bar.set_length(at_most as u64);
                self.bar.set_position(done as u64);
            }
            Progress::Impostor => self.bar.set_message("impostor"),
            Progress::Finish => self.bar.set_message("finish"),
            _ => {}
        }
        interrupt::flow()
    }
}

impl Drop for RunProgress {
    fn drop(&mut self) {
        self.bar.finish_and_clear();
    }
}
