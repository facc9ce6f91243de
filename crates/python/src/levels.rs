//! `secateur.Levels`: all levels of a plant that an engine loads.

use std::path::PathBuf;

use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict};
use secateur::chain::{Layout, LevelsOptions, UnknownLayout};
use secateur::{Levels, Plant, WriteOptions};
use serde_json::json;

use crate::watch::Watch;
use crate::{arrays, errors};

#[pyclass(frozen, name = "Levels", module = "secateur")]
pub(crate) struct PyLevels(Levels);

impl PyLevels {
    pub(crate) fn of(plant: &Plant, options: &LevelsOptions, watch: &mut Watch) -> PyResult<Self> {
        let made = plant.levels_watched(options, &mut |progress| watch.show(progress));
        Ok(Self(made.map_err(errors::of_library)?))
    }

    fn levels(&self) -> &Levels {
        &self.0
    }
}

#[pymethods]
impl PyLevels {
    fn __len__(&self) -> usize {
        self.levels().chain.levels.len()
    }

    #[getter]
    fn name(&self) -> &str {
        self.levels().name()
    }

    #[getter]
    fn notes(&self) -> Vec<String> {
        self.levels()
            .chain
            .notes
            .iter()
            .map(ToString::to_string)
            .collect()
    }

    #[getter]
    fn report<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let levels = self.levels().chain.levels.iter();
        let reports: Vec<_> = levels.map(|level| json!(level.report)).collect();
        arrays::to_python(py, &json!(reports))
    }

    #[pyo3(signature = (layout="files"))]
    fn to_bytes<'py>(&self, py: Python<'py>, layout: &str) -> PyResult<Bound<'py, PyDict>> {
        let layout = layout_of(layout)?;
        let made = py.detach(|| self.levels().to_bytes(layout));
        let files = PyDict::new(py);
        for file in made.map_err(errors::of_library)?.files {
            files.set_item(&file.name, PyBytes::new(py, &file.bytes))?;
        }
        Ok(files)
    }

    #[pyo3(signature = (path, layout=None, *, overwrite=false))]
    fn write(
        &self,
        py: Python<'_>,
        path: PathBuf,
        layout: Option<&str>,
        overwrite: bool,
    ) -> PyResult<Vec<PathBuf>> {
        let layout = match layout {
            Some(layout) => layout_of(layout)?,
            None => Layout::of_place(&path),
        };
        let written = py.detach(|| {
            let options = WriteOptions::default().overwrite(overwrite);
            self.levels().prepare(&path, layout, options)?.commit()
        });
        Ok(written.map_err(errors::of_library)?.files)
    }

    fn preview_html(&self, py: Python<'_>) -> PyResult<String> {
        let page = py.detach(|| self.levels().preview_html());
        page.map_err(errors::of_library)
    }

    fn __repr__(&self) -> String {
        format!("<secateur.Levels {}: {}>", self.name(), self.__len__())
    }
}

fn layout_of(name: &str) -> PyResult<Layout> {
    name.parse()
        .map_err(|error: UnknownLayout| errors::usage(error.to_string()))
}
