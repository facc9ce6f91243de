//! `secateur.Observation`: what views show of leaves, exactly as the driver counts it.

use numpy::{IntoPyArray, PyArray1, PyArray2, PyArray3, PyArrayMethods};
use pyo3::prelude::*;
use secateur::{
    Alpha, AreaTable, Foliage, Lod, Sides, ViewSet, Views, Vmi, as_seen, observe, sphere_of,
};
use secateur_raster::measure::lg::LgTable;
use secateur_raster::{CpuRasteriser, MAX_RESOLUTION, Scene, cpu};

use crate::{arrays, errors};

/// From where leaves are looked at, and how.
pub(crate) struct Look {
    views: Views,
    resolution: u32,
    alpha: Alpha,
    sides: Sides,
    has_images: bool,
}

impl Look {
    pub(crate) fn of(
        views: &str,
        resolution: u32,
        (alpha, sides): (&str, &str),
        has_images: bool,
    ) -> PyResult<Self> {
        let one_of = |what: &str, value: &str, known: &str| {
            errors::usage(format!("{what} is `{value}`, which is none of {known}"))
        };
        if !(1..=MAX_RESOLUTION).contains(&resolution) {
            let known = format!("1 to {MAX_RESOLUTION}");
            return Err(one_of("resolution", &resolution.to_string(), &known));
        }
        Ok(Self {
            views: Views::by_name(views).ok_or_else(|| {
                let known = "dodecahedron, icosahedron, 32, 60, 92, 8, 6";
                one_of("views", views, known)
            })?,
            resolution,
            alpha: match alpha {
                "mask" => Alpha::Mask,
                "ignore" => Alpha::Ignore,
                other => return Err(one_of("alpha", other, "mask, ignore")),
            },
            sides: match sides {
                "material" => Sides::Material,
                "both" => Sides::Both,
                other => return Err(one_of("sides", other, "material, both")),
            },
            has_images,
        })
    }
}

#[pyclass(frozen, name = "Observation", module = "secateur")]
pub(crate) struct PyObservation {
    areas: AreaTable,
    vmi: Vmi,
    eyes: ViewSet,
    resolution: u32,
    images: Option<Vec<u32>>,
}

/// What the views about the original leaves show of a level of them.
pub(crate) fn observed(original: &Foliage, lod: &Lod, look: &Look) -> PyResult<PyObservation> {
    let seen = as_seen(original, look.alpha, look.sides);
    let sphere = sphere_of(original).map_err(errors::of_library)?;
    let views = look.views.around(sphere);
    let resolution = look.resolution;
    let areas = observe(&seen, lod, &views, resolution, &CpuRasteriser);
    let areas = areas.map_err(errors::of_library)?;
    let images = look.has_images.then(|| {
        let left = lod.foliage(&seen);
        let (foliage, lod) = match lod.is_of_originals() {
            true => (&*seen, lod.clone()),
            false => (&left, Lod::original(left.leaves().len())),
        };
        let scene = Scene {
            foliage,
            lod: &lod,
            views: &views,
            resolution,
        };
        let draw = |view| cpu::draw_leaf_ids(&scene, view).leaf_ids;
        views.views().iter().flat_map(draw).collect()
    });
    Ok(PyObservation {
        vmi: Vmi::of(&areas, &LgTable::new()),
        areas,
        eyes: views,
        resolution,
        images,
    })
}

#[pymethods]
impl PyObservation {
    #[getter]
    fn areas<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<u32>>> {
        arrays::rows(
            py,
            self.areas.as_slice().to_vec(),
            self.areas.leaf_count() + 1,
        )
    }

    #[getter]
    fn areas_sha256(&self) -> String {
        self.areas.sha256()
    }

    #[getter]
    fn vmi_bits<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        self.vmi.bits().into_pyarray(py)
    }

    #[getter]
    fn eyes<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let views = self.eyes.views().iter();
        let eyes = views.flat_map(|view| view.eye().to_array()).collect();
        arrays::rows(py, eyes, 3)
    }

    #[getter]
    fn leaf_ids<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyArray3<u32>>>> {
        let side = self.resolution as usize;
        let stack = |ids: &Vec<u32>| {
            let ids = ids.clone().into_pyarray(py);
            ids.reshape([self.eyes.len(), side, side])
        };
        self.images.as_ref().map(stack).transpose()
    }

    fn vmi_error_percent(&self, other: &Self) -> PyResult<f64> {
        let is_comparable =
            self.vmi.bits().len() == other.vmi.bits().len() && self.resolution == other.resolution;
        match is_comparable {
            true => Ok(self.vmi.error_percent(&other.vmi)),
            false => Err(errors::usage(
                "observations are compared in the same views at the same resolution",
            )),
        }
    }
}
