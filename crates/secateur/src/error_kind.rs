//! Who can help where something failed: exit codes of the program, and exceptions of Python's package.

use secateur_gltf::{Problem, WriteProblem};
use secateur_simplify::Error as SimplifyError;

use crate::Error;

/// Who can help where something failed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum ErrorKind {
    /// The input does not allow it: a file is not what it should be, or cannot become what is asked for.
    Input,
    /// A wrong request: a value is out of its range.
    Usage,
    /// The machine does not allow it: memory, disk, GPU.
    Machine,
    /// The caller stopped it.
    Interrupted,
}

impl Error {
    /// Who can help.
    pub fn kind(&self) -> ErrorKind {
        if self.over_memory().is_some() {
            return ErrorKind::Machine;
        }
        match self {
            Self::Gltf(error) => match error.problem() {
                Problem::Memory(_) | Problem::Write(WriteProblem::Io(_)) => ErrorKind::Machine,
                _ => ErrorKind::Input,
            },
            Self::Simplify(error) => of_run(error),
            #[cfg(feature = "scene")]
            Self::Part { source, .. } => of_run(source),
            #[cfg(feature = "scene")]
            Self::Stand(_) => ErrorKind::Input,
            Self::Cameras(_) => ErrorKind::Input,
            Self::Threads(_) => ErrorKind::Machine,
            #[cfg(feature = "plant")]
            Self::Grow(_) => ErrorKind::Usage,
            #[cfg(feature = "scene")]
            Self::Levels(error) => match error {
                crate::chain::ChainError::Options(_) => ErrorKind::Usage,
                _ => ErrorKind::Input,
            },
            #[cfg(feature = "scene")]
            Self::Preview(_) => ErrorKind::Input,
            #[cfg(feature = "eval")]
            Self::Measure(_) => ErrorKind::Input,
        }
    }
}

fn of_run(error: &SimplifyError) -> ErrorKind {
    match error {
        SimplifyError::Memory(_) | SimplifyError::Gpu(_) => ErrorKind::Machine,
        SimplifyError::Target(..) | SimplifyError::Setting(..) => ErrorKind::Usage,
        SimplifyError::Stopped => ErrorKind::Interrupted,
        _ => ErrorKind::Input,
    }
}
