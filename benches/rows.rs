//! Raw rows: one figure a line, with all that is needed to get it again.

use std::fs;
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::{SystemTime, UNIX_EPOCH};

/// A CSV file of figures under `benches/results/<date>-<machine>/`.
pub(crate) struct Rows {
    file: fs::File,
    folder: PathBuf,
    commit: String,
    machine: String,
}

/// One measured value: its case and quantity, and how it was measured.
pub(crate) struct Row<'a> {
    pub(crate) case: &'a str,
    pub(crate) quantity: &'a str,
    pub(crate) unit: &'a str,
    pub(crate) value: f64,
    pub(crate) repeat: usize,
    pub(crate) adapter: &'a str,
    pub(crate) command: &'a str,
}

impl Rows {
    pub(crate) fn create(bench: &str) -> Self {
        let machine = machine();
        let folder =
            repository()
                .join("benches/results")
                .join(format!("{}-{}", date(), slug(&machine)));
        fs::create_dir_all(&folder).expect("benches/results can be written");
        let path = folder.join(format!("{bench}.csv"));
        eprintln!("rows go to {}", path.display());
        let mut file = fs::File::create(path).expect("the rows can be written");
        writeln!(
            file,
            "bench,case,quantity,unit,value,repeat,adapter,commit,machine,command"
        )
        .expect("the rows can be written");
        Self {
            file,
            folder,
            commit: commit(),
            machine,
        }
    }

    /// Where the rows go.
    #[allow(dead_code, reason = "not every bench writes more than rows")]
    pub(crate) fn folder(&self) -> &Path {
        &self.folder
    }

    pub(crate) fn add(&mut self, row: &Row<'_>) {
        let quoted = |text: &str| format!("\"{}\"", text.replace('"', "'"));
        println!(
            "{:<34} {:<28} {:>12.4} {:<8} {}",
            row.case, row.quantity, row.value, row.unit, row.adapter
        );
        writeln!(
            self.file,
            "{},{},{},{},{},{},{},{},{},{}",
            env!("CARGO_CRATE_NAME"),
            quoted(row.case),
            row.quantity,
            row.unit,
            row.value,
            row.repeat,
            quoted(row.adapter),
            self.commit,
            quoted(&self.machine),
            quoted(row.command)
        )
        .expect("the rows can be written");
    }

    /// A figure of the processor that was taken once.
    #[allow(dead_code, reason = "not every bench takes such figures")]
    pub(crate) fn note(
        &mut self,
        case: &str,
        quantity: &str,
        unit: &str,
        value: f64,
        command: &str,
    ) {
        self.add(&Row {
            case,
            quantity,
            unit,
            value,
            repeat: 0,
            adapter: "cpu",
            command,
        });
    }
}

pub(crate) fn repository() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// Real trees, which are not part of the repository.
#[allow(dead_code, reason = "not every bench uses them")]
pub(crate) fn shared_tree(name: &str) -> Option<PathBuf> {
    let path = repository().join("../shared/trees").join(name);
    if path.exists() {
        return Some(path);
    }
    eprintln!("SKIPPED: {name} is not beside the repository");
    None
}

/// The part of the bench that the command line asks for: all without.
#[allow(dead_code, reason = "not every bench has parts")]
pub(crate) struct Wanted(Option<String>);

#[allow(dead_code, reason = "not every bench has parts")]
impl Wanted {
    pub(crate) fn from_command_line() -> Self {
        Self::of(std::env::args().skip(1).find(|a| !a.starts_with('-')))
    }

    pub(crate) fn of(part: Option<String>) -> Self {
        Self(part)
    }

    pub(crate) fn has(&self, case: &str) -> bool {
        self.0.as_ref().is_none_or(|part| case.contains(part))
    }

    /// Whether a case whose name begins so may be asked for.
    pub(crate) fn may_have(&self, beginning: &str) -> bool {
        let may =
            |part: &String| part.starts_with(beginning) || beginning.starts_with(part.as_str());
        self.0
            .as_ref()
            .is_none_or(|part| may(part) || !part.contains(", "))
    }
}

/// Of a power law y = c x^e through points (x, y), by least squares of the
/// logarithms.
#[allow(dead_code, reason = "not every bench fits")]
pub(crate) fn exponent(points: impl Iterator<Item = (f64, f64)>) -> f64 {
    let points: Vec<(f64, f64)> = points.map(|(x, y)| (x.ln(), y.ln())).collect();
    let n = points.len() as f64;
    let mean = |f: fn(&(f64, f64)) -> f64| points.iter().map(f).sum::<f64>() / n;
    let (x, y) = (mean(|p| p.0), mean(|p| p.1));
    let covariance: f64 = points.iter().map(|p| (p.0 - x) * (p.1 - y)).sum();
    let variance: f64 = points.iter().map(|p| (p.0 - x).powi(2)).sum();
    covariance / variance
}

/// How often each case is measured.
#[allow(dead_code, reason = "not every bench repeats")]
pub(crate) fn repeats() -> usize {
    let asked = std::env::var("REPEATS").ok().and_then(|r| r.parse().ok());
    asked.unwrap_or(3)
}

fn commit() -> String {
    let output = |args: &[&str]| {
        let run = Command::new("git")
            .args(args)
            .current_dir(repository())
            .output();
        run.map_or(String::new(), |o| {
            String::from_utf8_lossy(&o.stdout).trim().to_owned()
        })
    };
    let changed =
        if output(&["status", "--porcelain", "crates", "shaders", "benches/*.rs"]).is_empty() {
            ""
        } else {
            "+changes"
        };
    format!("{}{changed}", output(&["rev-parse", "--short", "HEAD"]))
}

fn machine() -> String {
    let cores = std::thread::available_parallelism().map_or(0, usize::from);
    let info = fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let model = info
        .lines()
        .find_map(|line| line.strip_prefix("model name")?.split_once(": "))
        .map_or(std::env::consts::ARCH, |(_, model)| model);
    format!("{cores} x {model}")
}

fn slug(text: &str) -> String {
    let words = text.split(|c: char| !c.is_ascii_alphanumeric() && c != '.');
    let words: Vec<String> = words
        .filter(|w| !w.is_empty() && !["R", "TM", "CPU", "Processor"].contains(w))
        .map(str::to_lowercase)
        .collect();
    words.join("-")
}

/// Today in UTC as year-month-day (days to civil date, after the proleptic
/// Gregorian calendar's 400-year cycle).
fn date() -> String {
    let seconds = SystemTime::now().duration_since(UNIX_EPOCH);
    let days = seconds.map_or(0, |s| s.as_secs() / 86_400) + 719_468;
    let era = days / 146_097;
    let of_era = days % 146_097;
    let year_of_era = (of_era - of_era / 1460 + of_era / 36_524 - of_era / 146_096) / 365;
    let of_year = of_era - (365 * year_of_era + year_of_era / 4 - year_of_era / 100);
    let shifted_month = (5 * of_year + 2) / 153;
    let day = of_year - (153 * shifted_month + 2) / 5 + 1;
    let month = if shifted_month < 10 {
        shifted_month + 3
    } else {
        shifted_month - 9
    };
    let year = year_of_era + era * 400 + u64::from(month <= 2);
    format!("{year}-{month:02}-{day:02}")
}
