//! Running the program, and trees to run it on.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::sync::OnceLock;

use secateur::plant_to_glb;
use secateur_plant::{GrowOptions, Species, grow};
use serde_json::Value;

/// The number of leaves of the tree that [`oak`] writes.
pub(crate) const OAK_LEAVES: u64 = 240;

/// A small oak as GLB.
pub(crate) fn oak() -> &'static [u8] {
    static OAK: OnceLock<Vec<u8>> = OnceLock::new();
    OAK.get_or_init(|| {
        let options = GrowOptions {
            leaves: OAK_LEAVES as u32,
            seed: 5,
        };
        plant_to_glb(&grow(Species::Oak, &options).unwrap())
    })
}

/// A folder of its own with an oak in it, `oak.glb`.
pub(crate) struct Bench {
    folder: tempfile::TempDir,
    /// Whether `lods` and `measure` are for a small screen.
    is_for_small_screen: bool,
}

impl Bench {
    pub(crate) fn new() -> Self {
        let bench = Self {
            folder: tempfile::tempdir().unwrap(),
            is_for_small_screen: false,
        };
        bench.put("oak.glb", oak());
        bench
    }

    /// A folder in which `lods` is for a screen of a sixteenth of the usual pixels, and `measure` finds the difference of
    /// few pixels: for speed, where no looks are asked for.
    pub(crate) fn for_small_screen() -> Self {
        Self {
            is_for_small_screen: true,
            ..Self::new()
        }
    }

    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    pub(crate) fn put(&self, name: &str, bytes: &[u8]) {
        std::fs::write(self.path(name), bytes).unwrap();
    }

    pub(crate) fn read(&self, name: &str) -> Vec<u8> {
        std::fs::read(self.path(name)).unwrap()
    }

    pub(crate) fn json(&self, name: &str) -> Value {
        serde_json::from_slice(&self.read(name)).unwrap()
    }

    /// Everything in the folder, sorted.
    pub(crate) fn names(&self) -> Vec<String> {
        let entries = std::fs::read_dir(self.folder.path()).unwrap();
        let name = |entry: std::io::Result<std::fs::DirEntry>| {
            entry.unwrap().file_name().to_string_lossy().into_owned()
        };
        let mut names: Vec<String> = entries.map(name).collect();
        names.sort();
        names
    }

    /// Runs `secateur` in this folder.
    pub(crate) fn run(&self, arguments: &[&str]) -> Ran {
        let more = match arguments.first() {
            Some(&"lods") if self.is_for_small_screen => &["--screen-height=270"][..],
            Some(&"measure") if self.is_for_small_screen => &["--pixels-high=16"],
            _ => &[],
        };
        let output = Command::new(env!("CARGO_BIN_EXE_secateur"))
            .args(arguments)
            .args(more)
            .current_dir(self.folder.path())
            .output()
            .unwrap();
        Ran::of(arguments, output)
    }

    /// Runs it where the system finds other programs in these folders alone.
    pub(crate) fn run_on_path(&self, folders: &[PathBuf], arguments: &[&str]) -> Ran {
        let output = Command::new(env!("CARGO_BIN_EXE_secateur"))
            .args(arguments)
            .env("PATH", std::env::join_paths(folders).unwrap())
            .current_dir(self.folder.path())
            .output()
            .unwrap();
        Ran::of(arguments, output)
    }

    /// Runs a line of shell in this folder, in which `$SECATEUR` is the program.
    #[cfg(unix)]
    pub(crate) fn run_in_shell(&self, line: &str) -> Ran {
        let output = Command::new("sh")
            .args(["-c", line])
            .env("SECATEUR", env!("CARGO_BIN_EXE_secateur"))
            .current_dir(self.folder.path())
            .output()
            .unwrap();
        Ran::of(&[line], output)
    }

    /// `secateur simplify` with few, small views, for speed.
    pub(crate) fn simplify(&self, arguments: &[&str]) -> Ran {
        let few = ["--views", "6", "--resolution", "64"];
        self.run(&[&["simplify"], arguments, &few].concat())
    }
}

/// What a run left behind.
#[derive(Debug)]
pub(crate) struct Ran {
    command: String,
    pub(crate) code: Option<i32>,
    pub(crate) stdout: String,
    pub(crate) stderr: String,
}

impl Ran {
    pub(crate) fn of(arguments: &[&str], output: Output) -> Self {
        Self {
            command: arguments.join(" "),
            code: output.status.code(),
            stdout: String::from_utf8(output.stdout).unwrap(),
            stderr: String::from_utf8(output.stderr).unwrap(),
        }
    }

    /// The program did what it was asked to.
    #[track_caller]
    pub(crate) fn succeeded(self) -> Self {
        assert_eq!(self.code, Some(0), "{}: {}", self.command, self.stderr);
        self
    }

    /// The program was used wrongly: it says so with all these parts, and how to learn more.
    #[track_caller]
    pub(crate) fn misused_saying(self, parts: &[&str]) {
        let Self {
            command, stderr, ..
        } = &self;
        assert_eq!(self.code, Some(2), "{command}: {stderr}");
        assert_eq!(self.stdout, "", "{command}");
        for part in [parts, &["--help"]].concat() {
            assert!(stderr.contains(part), "{command}: {stderr} has no `{part}`");
        }
    }

    /// The input does not allow it: it gave up with one sentence that has all these parts.
    #[track_caller]
    pub(crate) fn failed_saying(self, parts: &[&str]) {
        self.failed_with(1, parts);
    }

    /// The machine does not allow it: likewise.
    #[track_caller]
    pub(crate) fn lacked_saying(self, parts: &[&str]) {
        self.failed_with(4, parts);
    }

    /// The program gave up with this exit code and one sentence that has all these parts.
    #[track_caller]
    pub(crate) fn failed_with(self, code: i32, parts: &[&str]) {
        let Self {
            command, stderr, ..
        } = &self;
        assert_eq!(self.code, Some(code), "{command}: {stderr}");
        assert_eq!(self.stdout, "", "{command}");
        // A slow machine may say how far it was.
        let errors = stderr.lines().filter(|line| !line.contains(" % after "));
        let errors: Vec<&str> = errors.collect();
        assert_eq!(errors.len(), 1, "{command}: one sentence, not {stderr}");
        assert!(errors[0].starts_with("secateur: error: "), "{stderr}");
        for part in parts {
            assert!(stderr.contains(part), "{command}: {stderr} has no `{part}`");
        }
    }
}

/// Stages of a record add up to all of its time.
#[track_caller]
pub(crate) fn assert_stages_add_up(record: &Value) {
    let seconds = record["seconds"].as_object().unwrap();
    let total = seconds["total"].as_f64().unwrap();
    let stages = seconds.iter().filter(|(stage, _)| *stage != "total");
    let of_stages: f64 = stages.map(|(_, took)| took.as_f64().unwrap()).sum();
    assert!((of_stages / total - 1.0).abs() < 0.05, "{seconds:?}");
}

/// A real tree of ../shared, where there is one.
pub(crate) fn shared_tree(name: &str) -> Option<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/trees");
    let path = folder.join(name);
    if path.is_file() {
        return Some(path.canonicalize().unwrap());
    }
    eprintln!("SKIPPED {name}: ../shared/trees is not there");
    None
}

/// Whether a GPU can be asked for; without one the tests that need it must
/// not be asked for either.
pub(crate) fn has_gpu() -> bool {
    static FOUND: OnceLock<bool> = OnceLock::new();
    #[cfg(feature = "gpu")]
    let found = *FOUND.get_or_init(|| {
        use secateur_raster::gpu::{Device, Preference};
        Device::find(Preference::Any).is_ok()
    });
    #[cfg(not(feature = "gpu"))]
    let found = *FOUND.get_or_init(|| false);
    let is_required = std::env::var("SECATEUR_REQUIRE_GPU").is_ok_and(|v| v == "1");
    assert!(found || !is_required, "there is no GPU adapter");
    if !found {
        eprintln!("SKIPPED: there is no GPU adapter");
    }
    found
}
