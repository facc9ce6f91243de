//! Why a command ended early.

use std::fmt;
use std::io;
use std::path::Path;

use secateur::{Problem, Remedy, SimplifyError, WriteProblem};

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
            other => other.into(),
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

/// The library's words, and the options of this program that help.
impl From<secateur::Error> for Failure {
    fn from(error: secateur::Error) -> Self {
        if let Some(over) = error.over_memory() {
            return Self(format!("{error} ({})", options_for(over.remedy)));
        }
        let secateur::Error::Gltf(gltf) = &error else {
            return Self(error.to_string());
        };
        Self(match gltf.problem() {
            Problem::Write(WriteProblem::UnrelatedBuffer(_) | WriteProblem::Exists) => {
                format!("{error} with `--overwrite`")
            }
            Problem::NoFoliage { candidates } if !candidates.is_empty() => {
                format!("{error} ({})", to_name(candidates))
            }
            _ => error.to_string(),
        })
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
        Self(error.to_string())
    }
}
