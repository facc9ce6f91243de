//! Python's exceptions for what the library refuses, by who can help.

use pyo3::PyErr;
use secateur::ErrorKind;
use secateur_cli::RequestError;

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

/// What the library says.
pub(crate) fn of_library(error: impl Into<secateur::Error>) -> PyErr {
    let error = error.into();
    of_kind(error.kind(), error.to_string())
}

/// What is wrong with keywords.
pub(crate) fn of_request(error: RequestError) -> PyErr {
    of_kind(error.kind, error.sentence)
}
