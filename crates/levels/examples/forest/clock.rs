//! How long frames take.

use std::fs;
use std::time::Instant;

/// Ticks of /proc/self/stat a second, on all Linux systems that this is for.
const TICKS_A_SECOND: f64 = 100.0;

/// Seconds of a frame or several: by the clock, and of all cores that worked for this program,
/// which other programs on the machine change less. None where the system does not tell.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Seconds {
    pub(crate) wall: f64,
    pub(crate) cores: Option<f64>,
}

pub(crate) fn timed<T>(work: impl FnOnce() -> T) -> (T, Seconds) {
    let (start, before) = (Instant::now(), core_seconds());
    let result = work();
    let seconds = Seconds {
        wall: start.elapsed().as_secs_f64(),
        cores: core_seconds()
            .zip(before)
            .map(|(after, before)| after - before),
    };
    (result, seconds)
}

/// User and system time of this process so far.
fn core_seconds() -> Option<f64> {
    let stat = fs::read_to_string("/proc/self/stat").ok()?;
    // The name of the program, in brackets, may hold spaces.
    let after_name = stat.rsplit_once(')')?.1;
    let fields: Vec<&str> = after_name.split_whitespace().collect();
    let ticks: f64 = fields.get(11)?.parse::<f64>().ok()? + fields.get(12)?.parse::<f64>().ok()?;
    Some(ticks / TICKS_A_SECOND)
}
