//! Who can help where something failed: exit codes of the program, and exceptions of Python's package.

use secateur_gltf::{GltfError, Problem, WriteProblem};
use secateur_simplify::Error as SimplifyError;

use crate::Error;

/// Who can help where something failed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum ErrorKind {
    /// The input does not allow it: a file is not what it should be, or cannot become what is asked for.
    Input,
    /// It was asked for wrongly: a value is out of its range.
    Usage,
    /// The machine does not allow it: memory, disk, GPU.
    Machine,
    /// The caller stopped it.
    Interrupted,
}

impl Error {
    /// Who can help.
    pub fn kind(&self) -> ErrorKind {
        match self {
            Self::Gltf(error) => error.into(),
            Self::Simplify(error) => error.into(),
            Self::Cameras(_) => ErrorKind::Input,
            #[cfg(feature = "scene")]
            Self::Preview(_) => ErrorKind::Input,
            #[cfg(feature = "eval")]
            Self::Measure(_) => ErrorKind::Input,
        }
    }
}

impl From<&GltfError> for ErrorKind {
    fn from(error: &GltfError) -> Self {
        match error.problem() {
            Problem::Memory(_) | Problem::Write(WriteProblem::Io(_)) => Self::Machine,
            _ => Self::Input,
        }
    }
}

impl From<&SimplifyError> for ErrorKind {
    fn from(error: &SimplifyError) -> Self {
        match error {
            SimplifyError::Memory(_) | SimplifyError::Gpu(_) => Self::Machine,
            SimplifyError::Target(..) | SimplifyError::Setting(..) => Self::Usage,
            SimplifyError::Stopped => Self::Interrupted,
            _ => Self::Input,
        }
    }
}

#[cfg(feature = "scene")]
impl From<&crate::chain::ChainError> for ErrorKind {
    fn from(error: &crate::chain::ChainError) -> Self {
        use crate::chain::ChainError;
        match error {
            ChainError::Simplify(error) => error.into(),
            ChainError::Gltf(error) => error.into(),
            ChainError::Wanted(_) => Self::Usage,
            _ => Self::Input,
        }
    }
}
