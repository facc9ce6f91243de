//! Why a command ended early.

use std::fmt;
use std::io;
use std::path::Path;

use secateur::{Problem, SimplifyError, WriteProblem};

/// One sentence for standard error; the exit code is then 1.
#[derive(Debug)]
pub(crate) struct Failure(pub(crate) String);

impl Failure {
    /// What the operating system said about a file.
    pub(crate) fn of_file(path: &Path, what: &str, error: &io::Error) -> Self {
        Self(format!("{}: {what}: {error}", path.display()))
    }

    /// A library error about a file that it does not name itself.
    pub(crate) fn about<E: Into<secateur::Error>>(path: &Path) -> impl Fn(E) -> Self {
        let path = path.to_owned();
        move |error| match error.into() {
            error @ secateur::Error::Simplify(SimplifyError::NoSkeleton { .. }) => Self(format!(
                "{}: {error}: `secateur grow` writes one",
                path.display()
            )),
            error @ secateur::Error::Simplify(
                SimplifyError::NoLeaf
                | SimplifyError::NothingSeen { .. }
                | SimplifyError::TooDeep(_)
                | SimplifyError::OutOfRange { .. },
            ) => Self(format!("{}: {error}", path.display())),
            other => Self(other.to_string()),
        }
    }
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        // A message of another library may run over several lines.
        let mut lines = self.0.split('\n').map(str::trim).filter(|l| !l.is_empty());
        f.write_str(lines.next().unwrap_or("failed"))?;
        lines.try_for_each(|line| write!(f, " {line}"))
    }
}

impl From<secateur::Error> for Failure {
    fn from(error: secateur::Error) -> Self {
        Self(error.to_string())
    }
}

impl From<SimplifyError> for Failure {
    fn from(error: SimplifyError) -> Self {
        Self(error.to_string())
    }
}

impl From<secateur::GltfError> for Failure {
    fn from(error: secateur::GltfError) -> Self {
        let is_unrelated = matches!(
            error.problem(),
            Problem::Write(WriteProblem::UnrelatedBuffer(_) | WriteProblem::Exists)
        );
        let what_to_do = if is_unrelated {
            " with `--overwrite`"
        } else {
            ""
        };
        Self(format!("{error}{what_to_do}"))
    }
}

impl From<secateur::CommitError> for Failure {
    fn from(error: secateur::CommitError) -> Self {
        Self(error.to_string())
    }
}
