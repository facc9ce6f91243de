//! Python's exceptions for what the library refuses, by who can help.

use pyo3::PyErr;
use secateur::chain::ChainError;
use secateur::cli::RequestError;
use secateur::{ErrorKind, GltfError};

mod classes {
    pyo3::import_exception!(secateur._errors, InputError);
    pyo3::import_exception!(secateur._errors, UsageError);
    pyo3::import_exception!(secateur._errors, MachineError);
    pyo3::import_exception!(secateur._errors, Cancelled);
}

/// The exception of a kind, with its sentence.
pub(crate) fn of_kind(kind: ErrorKind, sentence: String) -> PyErr {
    match kind {
        ErrorKind::Input => classes::InputError::new_err(sentence),
        ErrorKind::Usage => classes::UsageError::new_err(sentence),
        ErrorKind::Machine => classes::MachineError::new_err(sentence),
        ErrorKind::Interrupted => classes::Cancelled::new_err(sentence),
    }
}

/// A keyword or an array that is wrong.
pub(crate) fn usage(sentence: impl Into<String>) -> PyErr {
    of_kind(ErrorKind::Usage, sentence.into())
}

pub(crate) fn of_library(error: impl Into<secateur::Error>) -> PyErr {
    let error = error.into();
    of_kind(error.kind(), error.to_string())
}

pub(crate) fn of_gltf(error: GltfError) -> PyErr {
    of_kind((&error).into(), error.to_string())
}

pub(crate) fn of_levels(error: ChainError) -> PyErr {
    of_kind((&error).into(), error.to_string())
}

pub(crate) fn of_request(error: RequestError) -> PyErr {
    of_kind(error.kind, error.sentence)
}
