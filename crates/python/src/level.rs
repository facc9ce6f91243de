//! `secateur.Level`: a plant made lighter, with its figures.

use std::path::PathBuf;

use numpy::{IntoPyArray, PyArray1, PyArray2};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict};
use secateur::{AreaTable, Level, LevelOptions, Plant, WriteOptions};
use serde_json::{Value, json};

use crate::observation::{Look, PyObservation, observed};
use crate::watch::Watch;
use crate::{arrays, errors};

#[pyclass(frozen, name = "Level", module = "secateur")]
pub(crate) struct PyLevel(Level);

impl PyLevel {
    pub(crate) fn of(plant: &Plant, options: &LevelOptions, watch: &mut Watch) -> PyResult<Self> {
        let made = plant.level_watched(options, &mut |progress| watch.show(progress));
        Ok(Self(made.map_err(errors::of_library)?))
    }

    fn plant(&self) -> &Plant {
        self.0.plant()
    }

    fn level(&self) -> &Level {
        &self.0
    }

    /// The level as a GLB.
    pub(crate) fn bytes(&self, py: Python<'_>) -> PyResult<Vec<u8>> {
        let bytes = py.detach(|| self.0.to_bytes());
        bytes.map_err(errors::of_library)
    }

    /// Its figures by the keys of the program's reports.
    fn record(&self) -> Value {
        let level = self.level();
        let mut record = json!(level.record());
        record["resolution"] = level.simplified.resolution.into();
        record["difference"] = json!(level.difference);
        record
    }
}

#[pymethods]
impl PyLevel {
    #[getter]
    fn report<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        arrays::to_python(py, &self.record())
    }

    #[getter]
    fn leaf_count(&self) -> usize {
        self.level().simplified.lod.leaf_count()
    }

    #[getter]
    fn triangle_count(&self) -> u64 {
        let leaves = self.level().simplified.lod.foliage(self.plant().leaves());
        leaves.triangles().len() as u64 + self.level().wood_triangles
    }

    #[getter]
    fn removal_order<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<u32>> {
        let removed = self.level().simplified.passes.order.removed().iter();
        removed
            .map(|leaf| leaf.get())
            .collect::<Vec<u32>>()
            .into_pyarray(py)
    }

    #[getter]
    fn areas<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyArray2<u32>>>> {
        let areas = self.level().simplified.areas.as_ref();
        let rows =
            |areas: &AreaTable| arrays::rows(py, areas.as_slice().to_vec(), areas.leaf_count() + 1);
        areas.map(rows).transpose()
    }

    fn leaf_arrays<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let left = self.level().simplified.lod.foliage(self.plant().leaves());
        arrays::of_foliage(py, &left)
    }

    #[pyo3(signature = (views="dodecahedron", resolution=256, *, alpha="mask", sides="material", leaf_ids=false))]
    fn observe(
        &self,
        py: Python<'_>,
        views: &str,
        resolution: u32,
        alpha: &str,
        sides: &str,
        leaf_ids: bool,
    ) -> PyResult<PyObservation> {
        let look = Look::of(views, resolution, (alpha, sides), leaf_ids)?;
        py.detach(|| observed(self.plant().leaves(), &self.level().simplified.lod, &look))
    }

    fn to_bytes<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        Ok(PyBytes::new(py, &self.bytes(py)?))
    }

    #[pyo3(signature = (path, *, overwrite=false))]
    fn write(&self, py: Python<'_>, path: PathBuf, overwrite: bool) -> PyResult<Vec<PathBuf>> {
        let written = py.detach(|| {
            let options = WriteOptions::default().overwrite(overwrite);
            self.level().prepare(&path, options)?.commit()
        });
        Ok(written.map_err(errors::of_library)?.files)
    }

    fn __repr__(&self) -> String {
        format!(
            "<secateur.Level of {} leaves and {} triangles>",
            self.leaf_count(),
            self.triangle_count()
        )
    }
}
