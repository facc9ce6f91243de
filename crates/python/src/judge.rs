//! `secateur.judge`: two files of a plant side by side.

use pyo3::prelude::*;
use secateur::{Document, Error, JudgeOptions, Memory, Plant, judge_document};
use serde_json::{Value, json};

use crate::level::PyLevel;
use crate::plant::{PyPlant, of_any};
use crate::{arrays, errors};

#[pyfunction]
#[pyo3(signature = (plant, other, *, pixels_high=vec![540.0]))]
pub(crate) fn judge<'py>(
    py: Python<'py>,
    plant: &Bound<'py, PyAny>,
    other: &Bound<'py, PyAny>,
    pixels_high: Vec<f64>,
) -> PyResult<Bound<'py, PyAny>> {
    if let Some(px) = pixels_high.iter().find(|px| !(8.0..=1e5).contains(*px)) {
        return Err(errors::usage(format!(
            "pixels_high has {px}; write heights from 8 to 100000"
        )));
    }
    let plant = of_any(plant)?;
    let other = document(other)?;
    let record = py.detach(|| judged(plant.get().plant(), other, &pixels_high));
    arrays::to_python(py, &record.map_err(errors::of_library)?)
}

/// The file of a level, a plant, a path or bytes.
fn document(other: &Bound<'_, PyAny>) -> PyResult<Document> {
    let Ok(level) = other.cast::<PyLevel>() else {
        let plant: Py<PyPlant> = of_any(other)?;
        return Ok(plant.get().plant().tree().document().clone());
    };
    let bytes = level.get().bytes(other.py())?;
    Document::from_bytes_within("the level", bytes, None, Memory::Auto).map_err(errors::of_library)
}

/// The figures by the keys of `secateur measure`.
fn judged(plant: &Plant, other: Document, pixels_high: &[f64]) -> Result<Value, Error> {
    let judged = judge_document(plant, other, &JudgeOptions::default())?;
    let mut record = json!(judged.figures()?);
    let seen = judged.differences_at(pixels_high);
    record["warnings"] = judged.warnings(&seen).into();
    for (key, value) in json!(seen).as_object().into_iter().flatten() {
        record[key] = value.clone();
    }
    Ok(record)
}
