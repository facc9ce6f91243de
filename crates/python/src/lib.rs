//! The part of Python's package `secateur` that is compiled: thin doors to the library, with numpy arrays and without
//! holding Python's lock while anything is computed. `python/secateur/__init__.pyi` documents it for its users.
//!
//! Options of levels are those of the program, by its own words (`words`): a keyword `max_difference=0.18` is
//! `--max-difference=0.18`, so names, defaults, refusals and bytes are the program's.

mod array_door;
mod arrays;
mod errors;
mod judge;
mod level;
mod levels;
mod observation;
mod plant;
mod program;
mod watch;
mod words;

use pyo3::prelude::*;

#[pymodule(name = "_secateur")]
fn secateur_module(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add("__version__", env!("CARGO_PKG_VERSION"))?;
    module.add_class::<plant::PyPlant>()?;
    module.add_class::<level::PyLevel>()?;
    module.add_class::<levels::PyLevels>()?;
    module.add_class::<observation::PyObservation>()?;
    module.add_function(wrap_pyfunction!(plant::open, module)?)?;
    module.add_function(wrap_pyfunction!(plant::grow, module)?)?;
    module.add_function(wrap_pyfunction!(array_door::from_arrays, module)?)?;
    module.add_function(wrap_pyfunction!(judge::judge, module)?)?;
    module.add_function(wrap_pyfunction!(program::run_program, module)?)
}
