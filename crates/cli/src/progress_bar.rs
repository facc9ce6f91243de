//! How far a command is: a bar on a terminal, and elsewhere a line now and then. Each update also asks whether
//! Ctrl-C was pressed.

use std::io::{IsTerminal, Write, stderr};
use std::ops::ControlFlow;
use std::sync::mpsc::{RecvTimeoutError, Sender, channel};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use secateur::{Progress, ProgressShare};

use super::args::Common;
use super::escape::escaped;
use super::interrupt;

/// The time between two lines, and before the first.
const BETWEEN_LINES: Duration = Duration::from_secs(10);

/// Steps of the bar.
const LENGTH: u64 = 1000;

/// Shows the progress of a run; nothing with `--quiet`.
pub(crate) struct RunProgress {
    share: Arc<Mutex<ProgressShare>>,
    shown: Shown,
}

enum Shown {
    Nowhere,
    Bar(ProgressBar),
    /// Lines from a thread of their own, which ends when nothing can be sent any more.
    Lines(Option<(Sender<()>, JoinHandle<()>)>),
}

impl RunProgress {
    /// Of the work on something with this name.
    pub(crate) fn new(common: &Common, name: &str) -> Self {
        match (common.quiet, stderr().is_terminal()) {
            (true, _) => Self::with(|_| Shown::Nowhere),
            (false, true) => Self::with(|_| Shown::Bar(bar(name))),
            (false, false) => Self::lines(name, BETWEEN_LINES, stderr()),
        }
    }

    fn with(shown: impl FnOnce(&Arc<Mutex<ProgressShare>>) -> Shown) -> Self {
        let share = Arc::new(Mutex::new(ProgressShare::default()));
        Self {
            shown: shown(&share),
            share,
        }
    }

    fn lines(name: &str, between: Duration, mut to: impl Write + Send + 'static) -> Self {
        let name = escaped(name);
        Self::with(|share| {
            let (share, start) = (Arc::clone(share), Instant::now());
            let (sender, ends) = channel();
            let tell = move || {
                while ends.recv_timeout(between) == Err(RecvTimeoutError::Timeout) {
                    let (percent, doing) = {
                        let share = locked(&share);
                        ((100.0 * share.done()).floor(), share.doing())
                    };
                    let seconds = start.elapsed().as_secs();
                    // Where it is closed there is no one to tell.
                    let _ = writeln!(
                        to,
                        "secateur: {name}: {percent} % after {seconds} s, {doing}"
                    );
                }
            };
            // Without a thread to spare the work goes on untold.
            let thread = std::thread::Builder::new().spawn(tell);
            Shown::Lines(thread.ok().map(|thread| (sender, thread)))
        })
    }

    /// Shows a step of progress; breaks the run off after Ctrl-C.
    pub(crate) fn show(&self, progress: Progress) -> ControlFlow<()> {
        let mut share = locked(&self.share);
        share.see(progress);
        if let Shown::Bar(bar) = &self.shown {
            bar.set_position((share.done() * LENGTH as f64) as u64);
            bar.set_message(share.doing());
        }
        interrupt::flow()
    }
}

/// No time that is left is told: what a search takes is not known before.
fn bar(name: &str) -> ProgressBar {
    let bar = ProgressBar::with_draw_target(Some(LENGTH), ProgressDrawTarget::stderr_with_hz(10));
    let style =
        ProgressStyle::with_template("{prefix} {wide_bar} {percent} % after {elapsed}, {msg}");
    if let Ok(style) = style {
        bar.set_style(style);
    }
    bar.set_prefix(escaped(name));
    bar.set_message(ProgressShare::default().doing());
    bar.enable_steady_tick(Duration::from_millis(500));
    bar
}

fn locked(share: &Mutex<ProgressShare>) -> MutexGuard<'_, ProgressShare> {
    // A share is whole after each step.
    share.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Drop for RunProgress {
    fn drop(&mut self) {
        match &mut self.shown {
            Shown::Nowhere => {}
            Shown::Bar(bar) => bar.finish_and_clear(),
            Shown::Lines(thread) => {
                if let Some((sender, thread)) = thread.take() {
                    drop(sender);
                    let _ = thread.join();
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use secateur::Stage;

    /// What was written, to be read beside.
    #[derive(Clone, Default)]
    struct Written(Arc<Mutex<Vec<u8>>>);

    impl Write for Written {
        fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
            self.0.lock().unwrap().write(bytes)
        }

        fn flush(&mut self) -> std::io::Result<()> {
            Ok(())
        }
    }

    impl Written {
        fn lines(&self) -> Vec<String> {
            let text = String::from_utf8(self.0.lock().unwrap().clone()).unwrap();
            text.lines().map(str::to_owned).collect()
        }

        /// Waits for a line that holds this.
        fn wait_for(&self, part: &str) -> String {
            for _ in 0..2000 {
                let lines = self.lines();
                if let Some(line) = lines.into_iter().find(|line| line.contains(part)) {
                    return line;
                }
                std::thread::sleep(Duration::from_millis(5));
            }
            panic!("no line holds `{part}`: {:?}", self.lines());
        }
    }

    /// A base of a few milliseconds instead of ten seconds.
    #[test]
    fn without_a_terminal_a_line_comes_at_times() {
        let written = Written::default();
        let progress = RunProgress::lines("oak", Duration::from_millis(3), written.clone());
        assert!(
            written
                .wait_for("read")
                .starts_with("secateur: oak: 0 % after 0 s")
        );
        let _ = progress.show(Progress::Level { done: 3, of: 4 });
        let _ = progress.show(Progress::Stage(Stage::Fit));
        let half = written.wait_for("level 4 of 4, fit");
        assert!(half.contains(": 64 % after"), "{half}");
        drop(progress);
        let count = written.lines().len();
        std::thread::sleep(Duration::from_millis(20));
        assert_eq!(written.lines().len(), count, "a line after the end");
    }

    #[test]
    fn what_is_soon_over_says_nothing() {
        let written = Written::default();
        drop(RunProgress::lines("oak", BETWEEN_LINES, written.clone()));
        assert_eq!(written.lines(), [""; 0]);
    }
}
