//! A Python function under the sweep of a scene.

use std::path::PathBuf;
use std::sync::{Arc, Mutex};

use gronwall::Sweep;
use gronwall::external::{Answer, Array, Given, InProcess, Solve};
use gronwall::setup::MeshData;
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict};

use super::refused;

/// Runs the cases of a scene through `solve(case)`; records and verdicts as JSON. `solve` gets a dictionary of bytes and
/// numbers and gives bytes back: displacements of all levels and, with `pressure`, ξ + λ.
///
/// What it raises ends the sweep and is raised here.
#[pyfunction]
#[allow(clippy::too_many_arguments)]
pub fn verify(
    py: Python<'_>,
    scene: &str,
    solve: Py<PyAny>,
    n: Option<Vec<u32>>,
    steps: Option<Vec<u32>>,
    pressure: bool,
    orders_only: bool,
    out: Option<PathBuf>,
) -> PyResult<String> {
    let registry = gronwall::shipped::scenes();
    let mut sweep = Sweep::of(registry.load(scene).map_err(refused)?);
    let raised = Arc::new(Mutex::new(None));
    sweep = sweep.solver(InProcess(Function { solve, raised: raised.clone(), pressure }));
    if let Some(n) = n {
        sweep = sweep.n(&n);
    }
    if let Some(steps) = steps {
        sweep = sweep.steps(&steps);
    }
    if let Some(out) = out {
        sweep = sweep.out(out);
    }
    if !pressure {
        sweep = sweep.without_pressures();
    }
    if orders_only {
        sweep = sweep.orders_only();
    }
    let swept = py.detach(|| sweep.run());
    if let Some(error) = raised.lock().ok().and_then(|mut raised| raised.take()) {
        return Err(error);
    }
    let swept = swept.map_err(refused)?;
    let document = gronwall::verdict::document(
        &serde_json::Value::Null,
        &swept.verdicts,
        &swept.records,
        None,
    );
    serde_json::to_string(&document).map_err(|error| PyRuntimeError::new_err(error.to_string()))
}

struct Function {
    solve: Py<PyAny>,
    raised: Arc<Mutex<Option<PyErr>>>,
    pressure: bool,
}

impl Solve for Function {
    fn solve(&self, given: &Given, data: &MeshData) -> Result<Answer, String> {
        let stopped = || "the solver has raised an exception".to_owned();
        if self.raised.lock().map_err(|_| stopped())?.is_some() {
            return Err(stopped());
        }
        Python::attach(|py| {
            self.answer(py, given, data).map_err(|error| {
                if let Ok(mut raised) = self.raised.lock() {
                    raised.get_or_insert(error);
                }
                stopped()
            })
        })
    }
}

impl Function {
    fn answer(&self, py: Python<'_>, given: &Given, data: &MeshData) -> PyResult<Answer> {
        let bytes = self.solve.call1(py, (case(py, given, data)?,))?;
        if !self.pressure {
            let displacement = bytes.extract::<Bound<'_, PyBytes>>(py)?;
            return Ok(Answer { displacement: numbers(&displacement), pressure: None });
        }
        let (displacement, pressure) =
            bytes.extract::<(Bound<'_, PyBytes>, Bound<'_, PyBytes>)>(py)?;
        let pressure = Some(numbers(&pressure));
        Ok(Answer { displacement: numbers(&displacement), pressure })
    }
}

/// Doubles in the byte order of this machine.
fn numbers(bytes: &Bound<'_, PyBytes>) -> Vec<f64> {
    let chunks = bytes.as_bytes().chunks_exact(8);
    chunks.map(|chunk| f64::from_ne_bytes(chunk.try_into().unwrap_or_default())).collect()
}

/// The case: arrays as pairs of bytes and shape.
fn case<'py>(py: Python<'py>, given: &Given, data: &MeshData) -> PyResult<Bound<'py, PyDict>> {
    let (space, case) = (&*data.space, PyDict::new(py));
    let (mesh, d) = (&space.mesh, space.mesh.dimension);
    let doubles = |name: &str, shape: &[usize], values: &mut dyn Iterator<Item = f64>| {
        let bytes: Vec<u8> = values.flat_map(f64::to_ne_bytes).collect();
        case.set_item(name, (PyBytes::new(py, &bytes), shape.to_vec(), "f8"))
    };
    let indices = |name: &str, shape: &[usize], values: &mut dyn Iterator<Item = u32>| {
        let bytes: Vec<u8> = values.map(i64::from).flat_map(i64::to_ne_bytes).collect();
        case.set_item(name, (PyBytes::new(py, &bytes), shape.to_vec(), "i8"))
    };
    let (vertices, cells, facets) = (mesh.vertices(), mesh.cell_count(), mesh.facet_side.len());
    doubles(
        "points",
        &[vertices, d],
        &mut (0..vertices).flat_map(|v| mesh.vertex(v as u32).iter().copied()),
    )?;
    let clamped = |v: usize| u32::from(Given::clamped(space, v));
    indices("clamped", &[vertices], &mut (0..vertices).map(clamped))?;
    indices("cells", &[cells, d + 1], &mut (0..cells).flat_map(|c| mesh.cell(c).iter().copied()))?;
    let region = |c: usize| space.regions.get(c).map_or(0, |&region| region as u32);
    indices("regions", &[cells], &mut (0..cells).map(region))?;
    indices("facets", &[facets, d], &mut (0..facets).flat_map(|f| mesh.facet(f).iter().copied()))?;
    indices("facet_sides", &[facets], &mut mesh.facet_side.iter().map(|&side| side as u32))?;
    case.set_item("sides", mesh.sides.clone())?;
    let (rows, contact) = (given.contact.len(), &given.contact);
    indices("contact_vertices", &[rows], &mut contact.iter().map(|row| row.vertex))?;
    doubles(
        "contact_normals",
        &[rows, d],
        &mut contact.iter().flat_map(|row| row.normal[..d].iter().copied()),
    )?;
    doubles("contact_numbers", &[rows, 4], &mut contact.iter().flat_map(|row| row.numbers))?;
    indices("contact_clamped", &[rows], &mut contact.iter().map(|row| u32::from(row.clamped)))?;
    doubles("times", &[given.times.len()], &mut given.times.iter().copied())?;
    let array =
        |name: &str, array: &Array| doubles(name, &array.shape, &mut array.numbers.iter().copied());
    given.kernels.iter().try_for_each(|kernels| array("kernels", kernels))?;
    array("loads", &given.loads)?;
    case.set_item("json", given.document.to_string())?;
    Ok(case)
}
