//! Why a command ended early.

use std::fmt;
use std::io;
use std::path::Path;

use secateur::{ErrorKind, Problem, Remedy, SimplifyError, WriteProblem};
use serde::Serialize;

/// One sentence for standard error, and who can help.
#[derive(Debug)]
pub(crate) struct Failure {
    pub(crate) kind: ErrorKind,
    sentence: String,
}

/// A failure for programs: the line on standard error with `--format json`.
#[derive(Serialize)]
struct FailureLine<'a> {
    schema_version: u32,
    error: &'a str,
    kind: &'static str,
    exit_code: u8,
}

impl Failure {
    /// What a kind of failure is, in a sentence.
    pub(crate) fn of(kind: ErrorKind, sentence: impl Into<String>) -> Self {
        let sentence = sentence.into();
        Self { kind, sentence }
    }

    /// The input does not allow it.
    pub(crate) fn input(sentence: impl Into<String>) -> Self {
        Self::of(ErrorKind::Input, sentence)
    }

    /// Options contradict each other.
    pub(crate) fn usage(sentence: impl Into<String>) -> Self {
        Self::of(ErrorKind::Usage, sentence)
    }

    /// The machine does not allow it.
    pub(crate) fn machine(sentence: impl Into<String>) -> Self {
        Self::of(ErrorKind::Machine, sentence)
    }

    /// What the parser of the command line says, without how the program is called.
    pub(crate) fn of_parser(error: &clap::Error) -> Self {
        let text = error.to_string();
        let text = text.strip_prefix("error: ").unwrap_or(&text);
        let text = text.split("\n\n").next().unwrap_or(text);
        Self::usage(text)
    }

    /// What the operating system said about a file.
    pub(crate) fn of_file(path: &Path, what: &str, error: &io::Error) -> Self {
        let kind = match error.kind() {
            io::ErrorKind::NotFound | io::ErrorKind::InvalidData | io::ErrorKind::IsADirectory => {
                ErrorKind::Input
            }
            _ => ErrorKind::Machine,
        };
        Self::of(kind, format!("{}: {what}: {error}", path.display()))
    }

    /// Why something can't be done with a file, with the file.
    pub(crate) fn of_plant(path: &Path, error: secateur::Error) -> Self {
        let path = path.display().to_string();
        let mut failure = Self::from(error);
        if !failure.sentence.starts_with(&path) {
            failure.sentence = format!("{path}: {}", failure.sentence);
        }
        failure
    }

    /// A library error about a file that it does not name itself.
    pub(crate) fn about<E: Into<secateur::Error>>(path: &Path) -> impl Fn(E) -> Self {
        let path = path.to_owned();
        move |error| {
            let error = error.into();
            let is_about_the_plant = matches!(
                error,
                secateur::Error::Simplify(
                    SimplifyError::NoLeaf
                        | SimplifyError::NothingSeen { .. }
                        | SimplifyError::TooDeep(_)
                        | SimplifyError::OutOfRange { .. }
                        | SimplifyError::NoSkeleton { .. }
                ) | secateur::Error::Part { .. }
            );
            let has_no_skeleton = matches!(
                error,
                secateur::Error::Simplify(SimplifyError::NoSkeleton { .. })
            );
            let mut failure = Self::from(error);
            if is_about_the_plant {
                failure.sentence = format!("{}: {}", path.display(), failure.sentence);
            }
            if has_no_skeleton {
                failure.sentence += ": `secateur grow` writes one";
            }
            failure
        }
    }

    /// The exit code of the program.
    pub(crate) fn exit_code(&self) -> u8 {
        match self.kind {
            ErrorKind::Input => 1,
            ErrorKind::Usage => 2,
            ErrorKind::Machine => 4,
            ErrorKind::Interrupted => INTERRUPTED,
        }
    }

    /// The failure as a line of JSON.
    pub(crate) fn as_json(&self) -> String {
        let line = FailureLine {
            schema_version: super::record::SCHEMA_VERSION,
            error: &self.to_string(),
            kind: match self.kind {
                ErrorKind::Input => "input",
                ErrorKind::Usage => "usage",
                ErrorKind::Machine => "machine",
                ErrorKind::Interrupted => "interrupted",
            },
            exit_code: self.exit_code(),
        };
        serde_json::to_string(&line).expect("records have text keys")
    }
}

/// The exit code after Ctrl-C, as shells have it: 128 and the number of the signal.
pub(crate) const INTERRUPTED: u8 = 130;

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        // A message of another library may run over several lines.
        let mut lines = self.sentence.split('\n').map(str::trim);
        let mut lines = lines.by_ref().filter(|line| !line.is_empty());
        f.write_str(lines.next().unwrap_or("failed"))?;
        lines.try_for_each(|line| write!(f, " {line}"))
    }
}

/// The library's words, and the options of this program that help.
impl From<secateur::Error> for Failure {
    fn from(error: secateur::Error) -> Self {
        let sentence = match (&error, error.over_memory()) {
            (_, Some(over)) => format!("{error} ({})", options_for(over.remedy)),
            (secateur::Error::Gltf(gltf), None) => match gltf.problem() {
                Problem::Write(WriteProblem::UnrelatedBuffer(_) | WriteProblem::Exists) => {
                    format!("{error} with `--overwrite`")
                }
                Problem::NoFoliage { candidates } if !candidates.is_empty() => {
                    format!("{error} ({})", to_name(candidates))
                }
                _ => error.to_string(),
            },
            _ => error.to_string(),
        };
        Self::of(error.kind(), sentence)
    }
}

impl From<SimplifyError> for Failure {
    fn from(error: SimplifyError) -> Self {
        secateur::Error::from(error).into()
    }
}

impl From<secateur::GltfError> for Failure {
    fn from(error: secateur::GltfError) -> Self {
        secateur::Error::from(error).into()
    }
}

/// Options that name foliage by these selectors.
pub(crate) fn to_name(candidates: &[String]) -> String {
    let options = candidates.iter().map(|one| format!("`--foliage {one}`"));
    options.collect::<Vec<_>>().join(" or ")
}

fn options_for(remedy: Remedy) -> &'static str {
    match remedy {
        Remedy::SmallerFile | Remedy::SmallerImages => "`--memory`",
        Remedy::LessFoliage => "`--memory`, `--foliage`",
        Remedy::FewerPixels => "`--memory`, `--resolution`, `--views`",
        Remedy::LessGrowth => "`--memory`, `--resize`, `--max-coverage`, `--resolution`, `--views`",
        Remedy::NoFit => "`--memory`, `--fit=none`",
    }
}

impl From<secateur::CommitError> for Failure {
    fn from(error: secateur::CommitError) -> Self {
        Self::machine(error.to_string())
    }
}
