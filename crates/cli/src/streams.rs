//! `-`: a plant from standard input, a result to standard output.

use std::fs;
use std::io::{self, Read, Write};
use std::path::{Path, PathBuf};
use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, Ordering};

use secateur::{Document, GltfError, Memory, Opening, Plant};
use serde_json::Value;

use super::failure::Failure;
use super::interrupt;

/// What errors call a plant that came by standard input.
const NAME: &str = "standard input";

/// Whether a result went to standard output, which then takes nothing else.
static IS_STDOUT_TAKEN: AtomicBool = AtomicBool::new(false);

/// Whether a path stands for standard input or output.
pub(crate) fn is_stream(path: &Path) -> bool {
    path.as_os_str() == "-"
}

/// Whether a result went to standard output.
pub(crate) fn is_stdout_taken() -> bool {
    IS_STDOUT_TAKEN.load(Ordering::Relaxed)
}

/// All of standard input; it is read once.
pub(crate) fn stdin(memory: Memory) -> Result<&'static [u8], Failure> {
    static BYTES: OnceLock<Vec<u8>> = OnceLock::new();
    if let Some(bytes) = BYTES.get() {
        return Ok(bytes);
    }
    let most = memory.bytes();
    let mut bytes = Vec::new();
    let read = interrupt::reading(|| io::stdin().lock().take(most).read_to_end(&mut bytes));
    read.map_err(|e| Failure::input(format!("{NAME}: cannot be read: {e}")))?;
    if bytes.len() as u64 == most {
        return Err(Failure::machine(format!(
            "{NAME}: has more than the {most} bytes of memory that are allowed: allow more (`--memory`)"
        )));
    }
    Ok(BYTES.get_or_init(|| bytes))
}

/// The document in a file or from standard input.
pub(crate) fn document(path: &Path, memory: Memory) -> Result<Document, Failure> {
    match is_stream(path) {
        true => {
            let bytes = stdin(memory)?.to_vec();
            Ok(Document::from_bytes_within(NAME, bytes, None, memory)?)
        }
        false => Ok(interrupt::reading(|| Document::open_within(path, memory))?),
    }
}

/// The plant in a file or from standard input.
pub(crate) fn plant(path: &Path, opening: &Opening) -> Result<Plant, Failure> {
    Ok(opened(path, opening)??)
}

/// The plant in a file or from standard input, or why the bytes are none.
pub(crate) fn opened(path: &Path, opening: &Opening) -> Result<Result<Plant, GltfError>, Failure> {
    match is_stream(path) {
        true => {
            let bytes = stdin(opening.memory)?.to_vec();
            Ok(Plant::from_bytes(NAME, bytes, opening))
        }
        false => Ok(interrupt::reading(|| Plant::open_with(path, opening))),
    }
}

/// Where a single file goes: its own place, or a folder of its own on the way to standard output.
pub(crate) struct Outlet {
    path: PathBuf,
    on_the_way: Option<tempfile::TempDir>,
}

impl Outlet {
    /// The outlet of an output as it was named.
    pub(crate) fn of(output: &Path) -> Result<Self, Failure> {
        if !is_stream(output) {
            return Ok(Self {
                path: output.to_owned(),
                on_the_way: None,
            });
        }
        let folder = tempfile::tempdir()
            .map_err(|e| Failure::machine(format!("there is no room for temporary files: {e}")))?;
        Ok(Self {
            path: folder.path().join("out.glb"),
            on_the_way: Some(folder),
        })
    }

    /// Where the file is to be written.
    pub(crate) fn path(&self) -> &Path {
        &self.path
    }

    pub(crate) fn is_stdout(&self) -> bool {
        self.on_the_way.is_some()
    }

    /// A record whose paths are those that the caller named.
    pub(crate) fn renamed(&self, record: Value) -> Value {
        match self.is_stdout() {
            true => renamed(record, &self.path.display().to_string(), "-"),
            false => record,
        }
    }

    /// Sends the file, once it is whole, to standard output if that was named.
    pub(crate) fn send(self) -> Result<(), Failure> {
        let Some(folder) = &self.on_the_way else {
            return Ok(());
        };
        let beside = fs::read_dir(folder.path()).map_or(0, Iterator::count);
        if beside > 1 {
            return Err(Failure::input(
                "the result needs images in files beside it, which standard output cannot take: name a file",
            ));
        }
        let bytes =
            fs::read(&self.path).map_err(|e| Failure::of_file(&self.path, "cannot be read", &e))?;
        IS_STDOUT_TAKEN.store(true, Ordering::Relaxed);
        let mut stdout = io::stdout().lock();
        let sent = stdout.write_all(&bytes).and_then(|()| stdout.flush());
        sent.map_err(|e| Failure::machine(format!("standard output cannot be written: {e}")))
    }
}

/// A record in which paths begin otherwise.
pub(crate) fn renamed(record: Value, from: &str, to: &str) -> Value {
    match record {
        Value::String(text) => Value::String(text.replace(from, to)),
        Value::Array(items) => items
            .into_iter()
            .map(|item| renamed(item, from, to))
            .collect(),
        Value::Object(entries) => entries
            .into_iter()
            .map(|(key, value)| (key, renamed(value, from, to)))
            .collect(),
        other => other,
    }
}
