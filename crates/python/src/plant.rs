//! `secateur.Plant`: a file, bytes, arrays or a species, opened to be made lighter.

use std::path::PathBuf;
use std::str::FromStr;
use std::sync::{Mutex, PoisonError};

use pyo3::prelude::*;
use pyo3::pybacked::PyBackedBytes;
use pyo3::types::PyDict;
use secateur::plant::{GrowOptions, Species};
use secateur::{GltfError, Lod, Memory, Opening, Plant, Selector, WoodMode, plant_into_glb};
use secateur_cli::{LevelRequest, levels_options};
use serde_json::json;

use crate::level::PyLevel;
use crate::levels::PyLevels;
use crate::observation::{Look, PyObservation, observed};
use crate::watch::Watch;
use crate::words::words;
use crate::{arrays, errors};

/// Where a plant comes from.
pub(crate) enum Source {
    File(PathBuf),
    /// A name, and a GLB.
    Bytes(String, Vec<u8>),
}

impl Source {
    fn open(&self, opening: &Opening) -> Result<Plant, GltfError> {
        match self {
            Self::File(path) => Plant::open_with(path, opening),
            Self::Bytes(name, bytes) => Plant::from_bytes(name, bytes.clone(), opening),
        }
    }
}

/// A plant, with its wood as most levels have it, and as others that were asked for have it.
#[pyclass(frozen, name = "Plant", module = "secateur")]
pub(crate) struct PyPlant {
    source: Source,
    opening: Opening,
    plant: Plant,
    others: Mutex<Vec<(WoodMode, Plant)>>,
}

impl PyPlant {
    /// A plant of a source, opened without Python's lock.
    pub(crate) fn of(py: Python<'_>, source: Source, opening: Opening) -> PyResult<Self> {
        let plant = py.detach(|| source.open(&opening));
        Ok(Self {
            plant: plant.map_err(errors::of_library)?,
            others: Mutex::new(Vec::new()),
            source,
            opening,
        })
    }

    pub(crate) fn plant(&self) -> &Plant {
        &self.plant
    }

    /// The plant with its wood treated so; it is opened once for each way.
    fn with_wood(&self, wood: WoodMode) -> Result<Plant, GltfError> {
        if wood == self.opening.wood {
            return Ok(self.plant.clone());
        }
        let mut others = self.others.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some((_, plant)) = others.iter().find(|(other, _)| *other == wood) {
            return Ok(plant.clone());
        }
        let opening = Opening {
            wood,
            ..self.opening.clone()
        };
        let plant = self.source.open(&opening)?;
        others.push((wood, plant.clone()));
        Ok(plant)
    }
}

#[pymethods]
impl PyPlant {
    #[getter]
    fn leaf_count(&self) -> usize {
        self.plant.leaves().leaves().len()
    }

    #[getter]
    fn triangle_count(&self) -> u64 {
        self.plant.triangle_count()
    }

    #[getter]
    fn wood_triangle_count(&self) -> u64 {
        self.plant.wood_triangle_count()
    }

    #[getter]
    fn inspection<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        arrays::to_python(py, &json!(self.plant.inspection()))
    }

    fn leaf_arrays<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        arrays::of_foliage(py, self.plant.leaves())
    }

    #[pyo3(signature = (*, progress=None, cancel=None, **options))]
    fn level(
        &self,
        py: Python<'_>,
        progress: Option<Py<PyAny>>,
        cancel: Option<Py<PyAny>>,
        options: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<PyLevel> {
        let words = words(options)?;
        let mut watch = Watch::new(progress, cancel);
        let made = py.detach(|| {
            let request =
                LevelRequest::of(&words, self.opening.memory).map_err(errors::of_request)?;
            let plant = self.with_wood(request.wood).map_err(errors::of_library)?;
            PyLevel::of(
                &plant.within(request.surroundings),
                &request.options,
                &mut watch,
            )
        });
        made.map_err(|error| watch.reason(error))
    }

    #[pyo3(signature = (*, progress=None, cancel=None, **options))]
    fn levels(
        &self,
        py: Python<'_>,
        progress: Option<Py<PyAny>>,
        cancel: Option<Py<PyAny>>,
        options: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<PyLevels> {
        let words = words(options)?;
        let mut watch = Watch::new(progress, cancel);
        let made = py.detach(|| {
            let (options, surroundings) =
                levels_options(&words, self.opening.memory).map_err(errors::of_request)?;
            PyLevels::of(
                &self.plant.clone().within(surroundings),
                &options,
                &mut watch,
            )
        });
        made.map_err(|error| watch.reason(error))
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
        let leaves = self.plant.leaves();
        py.detach(|| observed(leaves, &Lod::original(leaves.leaves().len()), &look))
    }

    fn __repr__(&self) -> String {
        format!(
            "<secateur.Plant of {} leaves and {} triangles>",
            self.leaf_count(),
            self.triangle_count()
        )
    }
}

#[pyfunction]
#[pyo3(signature = (source, *, foliage=None, not_plant=None, vertex_alpha="auto", wind=false, memory="auto", name="plant.glb"))]
#[expect(clippy::too_many_arguments, reason = "they are keywords of Python")]
pub(crate) fn open(
    py: Python<'_>,
    source: &Bound<'_, PyAny>,
    foliage: Option<Vec<String>>,
    not_plant: Option<Vec<String>>,
    vertex_alpha: &str,
    wind: bool,
    memory: &str,
    name: &str,
) -> PyResult<PyPlant> {
    let selectors = |texts: Option<Vec<String>>| -> PyResult<Vec<Selector>> {
        let texts = texts.into_iter().flatten();
        texts.map(|text| option(&text)).collect()
    };
    let opening = Opening {
        foliage: selectors(foliage)?,
        not_plant: selectors(not_plant)?,
        vertex_alpha: option(vertex_alpha)?,
        wind,
        memory: option::<Memory>(memory)?,
        ..Opening::default()
    };
    let source = match source.extract::<PyBackedBytes>() {
        Ok(bytes) => Source::Bytes(name.to_owned(), bytes.to_vec()),
        Err(_) => Source::File(source.extract()?),
    };
    PyPlant::of(py, source, opening)
}

#[pyfunction]
#[pyo3(signature = (species, leaves=None, seed=1))]
pub(crate) fn grow(
    py: Python<'_>,
    species: &str,
    leaves: Option<u32>,
    seed: u64,
) -> PyResult<PyPlant> {
    let species: Species = option(species)?;
    let leaves = leaves.unwrap_or_else(|| species.default_leaves());
    let grown = py.detach(|| secateur::plant::grow(species, &GrowOptions { leaves, seed }));
    let grown = grown.map_err(|error| errors::usage(error.to_string()))?;
    let name = format!("{}.glb", species.name());
    PyPlant::of(
        py,
        Source::Bytes(name, plant_into_glb(grown)),
        Opening::default(),
    )
}

/// A plant as it is, or opened from a path or bytes.
pub(crate) fn of_any(source: &Bound<'_, PyAny>) -> PyResult<Py<PyPlant>> {
    if let Ok(plant) = source.cast::<PyPlant>() {
        return Ok(plant.clone().unbind());
    }
    let plant = open(
        source.py(),
        source,
        None,
        None,
        "auto",
        false,
        "auto",
        "plant.glb",
    )?;
    Py::new(source.py(), plant)
}

/// A value by its spelling.
fn option<T: FromStr<Err: std::fmt::Display>>(text: &str) -> PyResult<T> {
    text.parse()
        .map_err(|error: T::Err| errors::usage(error.to_string()))
}
