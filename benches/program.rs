//! The program, timed from file to file as a user runs it.

use std::ffi::OsStr;
use std::path::Path;
use std::process::Command;
use std::time::Instant;

use crate::rows::{Row, Rows, repeats};

/// A run of the program that is timed.
pub(crate) struct TimedRun<'a> {
    pub(crate) case: &'a str,
    /// What is run, as rows say it.
    pub(crate) line: &'a str,
    /// What is run; a place for the report is added.
    pub(crate) arguments: &'a [&'a OsStr],
    /// The stages whose seconds are noted; all where there are none.
    pub(crate) stages: &'a [&'a str],
}

impl TimedRun<'_> {
    /// Runs it again and again and notes seconds and peak memory; the least seconds.
    pub(crate) fn note(&self, rows: &mut Rows, folder: &Path) -> f64 {
        let mut least = f64::INFINITY;
        for repeat in 0..repeats() {
            let report = folder.join("report.json");
            let mut command = Command::new(env!("CARGO_BIN_EXE_secateur"));
            command.args(self.arguments);
            command.args(["--quiet", "--report"]).arg(&report);
            let start = Instant::now();
            let status = command.status().expect("the command starts");
            let wall = start.elapsed().as_secs_f64();
            assert!(status.success(), "{} failed", self.case);
            let text = std::fs::read_to_string(&report).expect("a report");
            let report: serde_json::Value = serde_json::from_str(&text).expect("JSON");
            let adapter = report["adapter"].as_str().unwrap_or("cpu");
            let mut add = |quantity: &str, unit: &str, value: Option<f64>| {
                rows.add(&Row {
                    case: self.case,
                    quantity,
                    unit,
                    value: value.unwrap_or(f64::NAN),
                    repeat,
                    adapter,
                    command: self.line,
                });
            };
            add("wall", "s", Some(wall));
            for (stage, seconds) in report["seconds"].as_object().into_iter().flatten() {
                let is_noted = self.stages.is_empty() || self.stages.contains(&stage.as_str());
                if is_noted && let Some(seconds) = seconds.as_f64() {
                    add(&format!("seconds.{stage}"), "s", Some(seconds));
                }
            }
            let mib = report["peak_rss_bytes"].as_f64().map(|b| b / 1_048_576.0);
            add("peak_rss", "MiB", mib);
            least = least.min(wall);
        }
        least
    }
}
