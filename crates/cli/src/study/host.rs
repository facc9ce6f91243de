//! The program as a study knows it.

use std::io::{IsTerminal, stderr};
use std::path::Path;

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use secateur_study::{Host, Provenance};

use super::super::args::Common;
use super::super::escape::escaped;
use super::super::{interrupt, machine, output};

/// A progress bar on a terminal; without one in a pipe or where quiet is asked for.
pub(super) struct Program {
    bar: ProgressBar,
}

impl Program {
    pub(super) fn new(common: &Common) -> Self {
        let is_shown = !common.quiet && stderr().is_terminal();
        let target = match is_shown {
            true => ProgressDrawTarget::stderr_with_hz(10),
            false => ProgressDrawTarget::hidden(),
        };
        let bar = ProgressBar::with_draw_target(None, target);
        let style =
            ProgressStyle::with_template("{wide_msg} {bar:30} {pos}/{len} rows after {elapsed}");
        if let Ok(style) = style {
            bar.set_style(style);
        }
        Self { bar }
    }
}

impl Host for Program {
    fn is_stop_asked(&self) -> bool {
        interrupt::check().is_err()
    }

    fn begin(&self, rows: usize) {
        self.bar.set_length(rows as u64);
        self.bar.reset();
    }

    fn working_on(&self, what: &str) {
        self.bar.set_message(escaped(what));
    }

    fn row_is_done(&self) {
        self.bar.inc(1);
    }

    fn end(&self) {
        self.bar.finish_and_clear();
    }

    fn write_file(&self, path: &Path, bytes: &[u8]) -> Result<(), String> {
        output::write_derived(path, bytes).map_err(|failure| failure.to_string())
    }

    fn peak_rss_bytes(&self) -> Option<u64> {
        machine::peak_rss_bytes()
    }

    fn forget_peak_rss(&self) {
        machine::forget_peak_rss();
    }

    fn provenance(&self) -> Provenance {
        Provenance {
            version: env!("CARGO_PKG_VERSION").to_owned(),
            commit: machine::commit().unwrap_or("unknown").to_owned(),
            machine: machine::name(),
        }
    }
}
