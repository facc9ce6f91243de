//! What the machine is, for reports.

use schemars::JsonSchema;
use serde::Serialize;

/// The largest resident set of this process so far in bytes, where the system
/// tells.
pub(crate) fn peak_rss_bytes() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find(|l| l.starts_with("VmHWM:"))?;
    let kibibytes: u64 = line.split_whitespace().nth(1)?.parse().ok()?;
    Some(kibibytes * 1024)
}

/// Lets [`peak_rss_bytes`] count anew from now, where the system can, and without what was
/// used before and is free.
pub(crate) fn forget_peak_rss() {
    give_back_free_memory();
    // Linux: proc(5), "5 (since Linux 4.0): reset the peak resident set size".
    let _ = std::fs::write("/proc/self/clear_refs", "5");
}

/// The allocator of glibc keeps what is free for later, which the system counts as used.
pub(crate) fn give_back_free_memory() {
    #[cfg(all(target_os = "linux", target_env = "gnu"))]
    // SAFETY: it touches nothing but what is free, and locks each arena meanwhile.
    unsafe {
        libc::malloc_trim(0);
    }
}

/// Processor, cores and system.
#[derive(Serialize, JsonSchema)]
pub(crate) struct Machine {
    /// The processor's name, where the system tells.
    cpu: Option<String>,
    cores: Option<usize>,
    /// Threads that the program used.
    threads: usize,
    os: &'static str,
    arch: &'static str,
}

/// The machine that this runs on.
pub(crate) fn describe() -> Machine {
    Machine {
        cpu: cpu_model(),
        cores: std::thread::available_parallelism().ok().map(|n| n.get()),
        threads: rayon::current_num_threads(),
        os: std::env::consts::OS,
        arch: std::env::consts::ARCH,
    }
}

fn cpu_model() -> Option<String> {
    let info = std::fs::read_to_string("/proc/cpuinfo").ok()?;
    let line = info.lines().find(|l| l.starts_with("model name"))?;
    Some(line.split_once(':')?.1.trim().to_owned())
}

/// Processor and threads in a few words.
pub(crate) fn name() -> String {
    let cpu = cpu_model().unwrap_or_else(|| std::env::consts::ARCH.to_owned());
    let threads = rayon::current_num_threads();
    format!("{cpu}, {threads} threads, {}", std::env::consts::OS)
}

/// The commit this was built from: what `SECATEUR_COMMIT` said during the build,
/// else what git said, if it was there.
pub(crate) fn commit() -> Option<&'static str> {
    option_env!("SECATEUR_COMMIT")
}

#[cfg(all(test, target_os = "linux", target_env = "gnu"))]
mod tests {
    use super::*;

    /// Blocks of a size that is never given back by itself, and one that stays behind them.
    #[test]
    fn what_was_freed_before_is_not_counted() {
        const MIB: u64 = 1 << 20;
        let mut blocks: Vec<Vec<u8>> = (0..8192).map(|_| vec![1; 64 << 10]).collect();
        let held = peak_rss_bytes().unwrap();
        let last = blocks.pop();
        drop(blocks);
        forget_peak_rss();
        let after = peak_rss_bytes().unwrap();
        assert!(after + 400 * MIB < held, "{after} of {held} bytes");
        drop(last);
    }
}
