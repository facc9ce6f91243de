//! Keywords of Python as words of the command line.

use pyo3::prelude::*;
use pyo3::types::{PyBool, PyDict, PyString};

use crate::errors::usage;

/// `--name=value` for each keyword: `True` is the bare option, `None` and `False` leave it out, sequences are joined by
/// commas; `occluder` is given once for each of its files.
pub(crate) fn words(options: Option<&Bound<'_, PyDict>>) -> PyResult<Vec<String>> {
    let mut words = Vec::new();
    for (name, value) in options.into_iter().flatten() {
        let name: String = name.extract()?;
        let option = format!("--{}", name.replace('_', "-"));
        if value.is_none() {
            continue;
        }
        if let Ok(flag) = value.cast::<PyBool>() {
            if flag.is_true() {
                words.push(option);
            }
            continue;
        }
        let values = match is_sequence(&value) {
            true => value
                .try_iter()?
                .map(|item| text(&item?))
                .collect::<PyResult<Vec<String>>>()?,
            false => vec![text(&value)?],
        };
        if values.is_empty() {
            return Err(usage(format!(
                "{name} is empty; leave it out, or name values"
            )));
        }
        match name.as_str() {
            "occluder" => words.extend(values.iter().map(|value| format!("{option}={value}"))),
            _ => words.push(format!("{option}={}", values.join(","))),
        }
    }
    Ok(words)
}

/// Lists, tuples and arrays, but no text and no path.
fn is_sequence(value: &Bound<'_, PyAny>) -> bool {
    let has = |name| value.hasattr(name).unwrap_or(false);
    !value.is_instance_of::<PyString>() && !has("__fspath__") && has("__len__") && has("__iter__")
}

/// A number, a name or a path as it is written on the command line.
fn text(value: &Bound<'_, PyAny>) -> PyResult<String> {
    match value.hasattr("__fspath__")? {
        true => value.call_method0("__fspath__")?.extract(),
        false => Ok(value.str()?.to_str()?.to_owned()),
    }
}
