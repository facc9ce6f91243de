//! Leaves as numpy arrays, and records as dictionaries.

use numpy::{IntoPyArray, PyArray2, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use secateur::{Foliage, LeafId};
use serde_json::Value;

/// A record as Python's own dictionaries, lists, numbers and texts.
pub(crate) fn to_python<'py>(py: Python<'py>, record: &Value) -> PyResult<Bound<'py, PyAny>> {
    let json = py.import("json")?;
    json.call_method1("loads", (record.to_string(),))
}

/// A vector as an array of rows; it is moved, not copied.
pub(crate) fn rows<T: numpy::Element>(
    py: Python<'_>,
    values: Vec<T>,
    width: usize,
) -> PyResult<Bound<'_, PyArray2<T>>> {
    let height = values.len() / width.max(1);
    values.into_pyarray(py).reshape([height, width])
}

/// `positions`, `triangles`, `leaf_ids` and `uv` of leaves; each triangle has corners of its own.
pub(crate) fn of_foliage<'py>(py: Python<'py>, foliage: &Foliage) -> PyResult<Bound<'py, PyDict>> {
    let triangles = foliage.triangles();
    let corners = || triangles.iter().flat_map(|triangle| triangle.corners);
    let positions: Vec<f32> = corners().flat_map(|at| at.as_vec3().to_array()).collect();
    let uv: Vec<f32> = triangles
        .iter()
        .flat_map(|triangle| triangle.uvs)
        .flat_map(|uv| uv.as_vec2().to_array())
        .collect();
    let numbers: Vec<u32> = (0..3 * triangles.len() as u32).collect();
    let ids = (0..foliage.leaves().len()).map(LeafId::from_index);
    let leaf_ids: Vec<u32> = ids
        .flat_map(|id| std::iter::repeat_n(id.get(), foliage.triangles_of(id).len()))
        .collect();
    let arrays = PyDict::new(py);
    arrays.set_item("positions", rows(py, positions, 3)?)?;
    arrays.set_item("triangles", rows(py, numbers, 3)?)?;
    arrays.set_item("leaf_ids", leaf_ids.into_pyarray(py))?;
    arrays.set_item("uv", rows(py, uv, 2)?)?;
    Ok(arrays)
}
