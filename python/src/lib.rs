//! The judge, the scenes and the sweep as a Python module: arguments in, dictionaries and text out. The user interface
//! is in `gronwall/*.py`.

mod case;
mod fit;
mod read;
mod verify;

use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

/// Runs a command line of `sweep` (program name first); returns its exit code.
#[pyfunction]
fn sweep(py: Python<'_>, words: Vec<std::ffi::OsString>) -> u8 {
    py.detach(|| gronwall::cli::run_with(words))
}

#[pyfunction]
fn scenes() -> PyResult<Vec<(String, String)>> {
    let registry = gronwall::shipped::scenes();
    let row = |name: &str| Ok((name.to_owned(), registry.load(name).map_err(refused)?.question));
    registry.names().map(row).collect()
}

fn refused(error: impl std::fmt::Display) -> PyErr {
    PyValueError::new_err(error.to_string().trim_end().to_owned())
}

#[pymodule]
fn _native(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add("__version__", env!("CARGO_PKG_VERSION"))?;
    module.add_function(wrap_pyfunction!(sweep, module)?)?;
    module.add_function(wrap_pyfunction!(scenes, module)?)?;
    module.add_function(wrap_pyfunction!(fit::fit, module)?)?;
    module.add_function(wrap_pyfunction!(fit::settles, module)?)?;
    module.add_function(wrap_pyfunction!(read::read, module)?)?;
    module.add_function(wrap_pyfunction!(verify::verify, module)?)
}
