//! What can be wrong with a glTF file, in one sentence each.

use std::fmt;

use super::chain_problem::ChainProblem;
use super::write_problem::WriteProblem;
use secateur_model::Remedy;

/// What to do where a file takes too much memory.
pub(crate) const ALLOW_MORE: Remedy = Remedy::SmallerFile;

/// A glTF file that can't be used, and why.
///
/// Prints as one sentence: the file, the place in its JSON, what is wrong and,
/// where something can be done about it, what to do.
#[derive(Debug)]
pub struct GltfError {
    file: String,
    fault: Box<Fault>,
}

impl GltfError {
    pub(crate) fn new(file: &str, fault: impl Into<Fault>) -> Self {
        Self {
            file: file.to_owned(),
            fault: Box::new(fault.into()),
        }
    }

    /// The file, as it was named when it was opened.
    pub fn file(&self) -> &str {
        &self.file
    }

    /// Where in the JSON, such as `accessors[3]`; empty where it is the whole
    /// file.
    pub fn place(&self) -> &str {
        &self.fault.place
    }

    /// What is wrong there, without file and place.
    pub fn problem(&self) -> &Problem {
        &self.fault.problem
    }
}

impl fmt::Display for GltfError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.file, self.fault)
    }
}

impl std::error::Error for GltfError {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        self.fault.problem.source()
    }
}

/// A problem and its place, not yet with the file's name.
#[derive(Debug)]
pub(crate) struct Fault {
    place: String,
    problem: Problem,
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if !self.place.is_empty() {
            write!(f, "{}: ", self.place)?;
        }
        self.problem.fmt(f)
    }
}

impl From<Problem> for Fault {
    fn from(problem: Problem) -> Self {
        Self {
            place: String::new(),
            problem,
        }
    }
}

/// Says where a problem is.
pub(crate) trait At<T> {
    /// Adds the place, such as `accessors[3]`.
    fn at(self, place: impl FnOnce() -> String) -> Result<T, Fault>;
}

impl<T> At<T> for Result<T, Problem> {
    fn at(self, place: impl FnOnce() -> String) -> Result<T, Fault> {
        self.map_err(|problem| Fault {
            place: place(),
            problem,
        })
    }
}

/// What is wrong with a glTF file.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Problem {
    /// The file can't be read.
    #[error("cannot be read: {0}")]
    Unreadable(#[source] std::io::Error),
    /// Neither GLB nor a JSON object with an `asset`.
    #[error("is not glTF: {0}")]
    NotGltf(String),
    /// The file ends before its own header says it does.
    #[error("is truncated: its header speaks of {expected} bytes, it has {found}")]
    Truncated {
        /// Bytes of the whole file by its header.
        expected: u64,
        /// Bytes that the file has.
        found: u64,
    },
    /// The chunks of a GLB don't fit together.
    #[error("is a damaged GLB: {0}")]
    DamagedGlb(String),
    /// The file is of another version than glTF 2.0.
    #[error("is glTF {0}; only version 2.0 can be read")]
    Version(String),
    /// The file needs an extension that is not supported.
    #[error("needs the extension {0}, which is not supported")]
    UnknownExtension(String),
    /// A property is missing.
    #[error("has no `{0}`")]
    Missing(&'static str),
    /// A property has the wrong type or an impossible value.
    #[error("`{property}` is {found}, not {expected}")]
    BadProperty {
        /// The property's name in the JSON.
        property: &'static str,
        /// What it should be.
        expected: &'static str,
        /// What is there, shortened.
        found: String,
    },
    /// An index points past the end of a list.
    #[error("`{list}[{index}]` does not exist: there are {count}")]
    NoSuch {
        /// The list's name in the JSON.
        list: &'static str,
        /// The index that was asked for.
        index: usize,
        /// Entries in the list.
        count: usize,
    },
    /// A URI that leaves the file's own folder.
    #[error(
        "the URI `{0}` is not a file in the glTF's own folder; put the file there and name it without a path outside"
    )]
    ForeignUri(String),
    /// A URI whose file is, or goes through, a symbolic link to outside.
    #[error(
        "the file `{0}` is reached through a symbolic link that leads out of the glTF's own folder; put the file itself there in place of the link"
    )]
    LinkOutside(String),
    /// A URI that isn't one.
    #[error("the URI `{uri}` is malformed: {why}")]
    BadUri {
        /// The start of the URI.
        uri: String,
        /// What is wrong with it.
        why: String,
    },
    /// A file named by a URI is not there or can't be read.
    #[error("the file `{uri}` cannot be read: {error}")]
    MissingFile {
        /// The URI as the file writes it, shortened.
        uri: String,
        /// What the operating system says.
        #[source]
        error: std::io::Error,
    },
    /// A buffer without bytes: no URI and no GLB chunk.
    #[error("has neither a URI nor a GLB chunk to take its bytes from")]
    NoBytes,
    /// A buffer shorter than it says.
    #[error("says it has {expected} bytes; only {found} are there")]
    ShortBuffer {
        /// The `byteLength` of the buffer.
        expected: u64,
        /// Bytes that its source has.
        found: u64,
    },
    /// A range of bytes that lies outside its container.
    #[error("asks for bytes {start}..{end} of {container}, which has {length}")]
    OutOfRange {
        /// The first byte of the range.
        start: u128,
        /// One past the last byte.
        end: u128,
        /// What should contain them.
        container: String,
        /// How many bytes the container has.
        length: u64,
    },
    /// A number of elements so large that its bytes can't be counted, or more
    /// than the limit for elements that take no space in the file.
    #[error(
        "asks for {count} elements of {element_bytes} bytes; at most {limit} bytes are allowed without data in the file"
    )]
    TooManyZeros {
        /// How many elements the accessor claims.
        count: u64,
        /// Bytes that one element takes.
        element_bytes: usize,
        /// The most bytes of such elements.
        limit: u64,
    },
    /// A stride that doesn't suit the element.
    #[error(
        "`byteStride` is {stride}, elements of {element_bytes} bytes need {element_bytes} to 252"
    )]
    BadStride {
        /// The stride in the file, in bytes.
        stride: u64,
        /// Bytes that one element takes.
        element_bytes: usize,
    },
    /// An accessor that can't serve as what it is used for.
    #[error("is {found}, which cannot be used as {role}")]
    WrongKind {
        /// Such as `VEC3 of FLOAT`.
        found: String,
        /// What it should be used as, such as `POSITION`.
        role: String,
    },
    /// Two accessors of one primitive that disagree.
    #[error("{attribute} has {found} elements where {other} has {expected}")]
    CountMismatch {
        /// The name of the attribute that differs.
        attribute: String,
        /// How many elements it has.
        found: usize,
        /// The one it is compared with.
        other: String,
        /// The count of that.
        expected: usize,
    },
    /// An index of a primitive names a vertex that doesn't exist.
    #[error("index {position} names vertex {vertex}, of {count}")]
    NoSuchVertex {
        /// Where in the list of indices.
        position: usize,
        /// The vertex that it names.
        vertex: u32,
        /// How many vertices the primitive has.
        count: usize,
    },
    /// Sparse indices outside the accessor or not increasing.
    #[error(
        "sparse index {index} does not come after the one before it, or is outside the accessor's {count} elements"
    )]
    BadSparseIndex {
        /// The index of the sparse accessor that is out of range.
        index: u64,
        /// Elements of the accessor.
        count: usize,
    },
    /// A number that is NaN or infinite.
    #[error("{what} {index} is not a finite number")]
    NotFinite {
        /// What the number is part of, such as `position`.
        what: &'static str,
        /// Which of them, from 0.
        index: usize,
    },
    /// A meshopt-compressed view that can't be decoded.
    #[error("its meshopt-compressed data cannot be decoded: {0}")]
    Meshopt(&'static str),
    /// A Draco-compressed primitive that can't be decoded.
    #[error(
        "its Draco-compressed geometry cannot be decoded ({0}); decode it first: npx @gltf-transform/cli copy IN.glb OUT.glb"
    )]
    Draco(String),
    /// A node reached twice.
    #[error("is the child of two nodes, or of itself")]
    NodeTwice,
    /// A plant of a stand that bones move.
    #[error("has a skin, and plants of a stand are at rest: write it without bones")]
    Skinned,
    /// A node hierarchy deeper than the limit.
    #[error("lies deeper than {0} nodes")]
    TooDeep(usize),
    /// More geometry than the limits allow.
    #[error("holds more than {limit} {what}")]
    TooMuch {
        /// What there is too much of.
        what: &'static str,
        /// How much of it is allowed.
        limit: u64,
    },
    /// No foliage was named and none was found.
    #[error("no foliage was found{}", to_name(.candidates))]
    NoFoliage {
        /// Selectors that could be used.
        candidates: Vec<String>,
    },
    /// A selector that matches nothing.
    #[error("`{selector}` matches nothing; there are {known}", known = .known.join(", "))]
    SelectorMatchesNothing {
        /// The selector as it was written.
        selector: String,
        /// What there is to select.
        known: Vec<String>,
    },
    /// Cameras are asked for, and the scene has none.
    #[error("has no camera in its scene to look from")]
    NoCamera,
    /// A camera of parallel rays.
    #[error("is orthographic; only perspective cameras can be looked through")]
    Orthographic,
    /// A camera's node turns it into nothing.
    #[error("its transform leaves its camera no direction to look in")]
    NoView,
    /// An animation that moves a camera cannot be read.
    #[error("{0}")]
    BadAnimation(&'static str),
    /// What should hide leaves has no triangle.
    #[error("has no triangle that could hide a leaf")]
    NoOccluder,
    /// The foliage has no triangle.
    #[error("its foliage has no triangle")]
    EmptyFoliage,
    /// What the file holds, or claims to hold, takes more memory than is allowed.
    #[error("{0}")]
    Memory(#[from] secateur_model::OverMemory),
    /// The output cannot be written.
    #[error("{0}")]
    Write(#[from] WriteProblem),
    /// The levels are no chain.
    #[error("{0}")]
    Chain(#[from] ChainProblem),
    /// The skeleton is none, or one of another foliage.
    #[error("{0}")]
    Skeleton(secateur_model::SkeletonError),
    /// The triangles are no foliage.
    #[error("{0}")]
    Foliage(#[from] secateur_model::FoliageError),
}

/// How to name foliage, as the end of a sentence.
fn to_name(candidates: &[String]) -> String {
    match candidates {
        [] => ": the file has no triangles to choose from".to_owned(),
        some => format!("; name it by a selector: {}", some.join(" or ")),
    }
}

/// A JSON value as text, shortened so that an error stays one sentence.
pub(crate) fn shortened(text: &str) -> String {
    const LONGEST: usize = 60;
    match text.char_indices().nth(LONGEST) {
        Some((end, _)) => format!("{}...", &text[..end]),
        None => text.to_owned(),
    }
}
