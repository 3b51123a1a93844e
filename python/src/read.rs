//! The reader of `sweep fit`, for texts.

use judge::fit::Point;
use judge::table::{Group, Quantity, Reading, read as read_text};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use super::refused;

/// What was read in words, and the tables: levels with h, k, error, floor and relative deviation, and the rows that are no levels.
#[pyfunction]
#[pyo3(signature = (text, dimension, ratio, in_time, by, runs, errors))]
#[allow(clippy::too_many_arguments)]
pub fn read<'py>(
    py: Python<'py>,
    text: &str,
    dimension: Option<u32>,
    ratio: Option<f64>,
    in_time: bool,
    by: Vec<String>,
    runs: bool,
    errors: Vec<String>,
) -> PyResult<(Vec<String>, Vec<Bound<'py, PyDict>>)> {
    let reading = Reading { dimension, ratio, in_time, by, runs, errors };
    let tables =
        read_text(text.as_bytes(), &reading).map_err(|why| refused(format!("line {why}")))?;
    let dict = |group: &Group| {
        let found = PyDict::new(py);
        let levels = group.measurements();
        let list = |of: fn(&Point) -> f64| levels.iter().map(|(point, _)| of(point)).collect();
        found.set_item("scene", group.scene.clone())?;
        found.set_item("norm", group.norm.clone())?;
        found.set_item("values", group.quantity == Quantity::Value)?;
        let columns: [(&str, Vec<f64>); 4] = [
            ("h", list(|point| point.h)),
            ("k", list(|point| point.k)),
            ("errors", list(|point| point.error)),
            ("floors", list(|point| point.floor)),
        ];
        for (name, column) in columns {
            found.set_item(name, column)?;
        }
        let sigmas: Vec<Option<f64>> = levels.iter().map(|(_, sigma)| *sigma).collect();
        found.set_item("sigmas", sigmas)?;
        found.set_item("gaps", group.gaps_in_words())?;
        Ok(found)
    };
    let groups = tables.groups.iter().map(dict).collect::<PyResult<_>>()?;
    Ok((tables.said, groups))
}
