//! The program `secateur`, as Python's package brings it along.

use std::ffi::OsString;

use pyo3::prelude::*;

/// Runs the program with these words, the first of which is its name, and gives its exit code.
#[pyfunction]
pub(crate) fn run_program(py: Python<'_>, words: Vec<OsString>) -> u8 {
    py.detach(|| secateur_cli::run_words(words))
}
