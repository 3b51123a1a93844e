//! A Python function under the sweep of a scene.
//!
//! The sweep runs on a separate thread. The function is called on the thread of `verify`, so that it may use
//! thread-bound objects, and Ctrl-C ends it at once.

use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use gronwall::{Sweep, Swept};
use judge::record::CaseRecord;
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict};
use run::external::{Answer, Given, InProcess, Solve, by_density};
use run::sweep::Progress;
use scene::setup::MeshData;

use super::case::{case, numbers};
use super::refused;

/// Interval of checks for Ctrl-C while no Python runs.
const LOOK: Duration = Duration::from_millis(20);
/// Time for a stopped sweep to end; it finishes its current case, which may take longer.
const PATIENCE: Duration = Duration::from_millis(500);

/// Runs the cases of a scene through `solve(case)`; returns records and verdicts as JSON. `solve` takes a dictionary of
/// bytes and numbers and returns bytes: displacements of all levels and, with `pressure`, ξ + λ. An exception from it,
/// or Ctrl-C, ends the sweep and is raised here.
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
    density: bool,
    out: Option<PathBuf>,
) -> PyResult<String> {
    let registry = gronwall::shipped::scenes();
    let mut scene = registry.load(scene).map_err(refused)?;
    if density {
        scene = by_density(scene).map_err(refused)?;
    }
    let mut sweep = Sweep::of(scene);
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
    let swept = answered(py, sweep, |case| answer(py, &solve, case, pressure))?;
    let document = judge::verdict::document(
        &serde_json::Value::Null,
        &swept.verdicts,
        &swept.records,
        None,
        None,
    );
    serde_json::to_string(&document).map_err(|error| PyRuntimeError::new_err(error.to_string()))
}

/// Messages of the sweep's thread.
enum Said {
    /// A case, and where to send its answer.
    Case(Py<PyDict>, Sender<Answer>),
    Ended(Result<Swept, String>),
}

/// Runs the sweep, answering its cases on this thread.
fn answered(
    py: Python<'_>,
    sweep: Sweep,
    mut answer: impl FnMut(Py<PyDict>) -> PyResult<Answer>,
) -> PyResult<Swept> {
    let (say, said) = channel();
    let (said, stop) = (Mutex::new(said), Arc::new(AtomicBool::new(false)));
    let sweep = sweep.solver(InProcess(Caller(say.clone()))).progress(Stop(stop.clone()));
    std::thread::Builder::new()
        .name("sweep".into())
        .spawn(move || say.send(Said::Ended(sweep.run().map_err(|error| error.to_string()))))?;
    let stopped = |error: PyErr| {
        stop.store(true, Ordering::Relaxed);
        py.detach(|| wait(&said));
        error
    };
    loop {
        match py.detach(|| next(&said, LOOK)) {
            // The receiver is gone only if the sweep is stopped.
            Ok(Said::Case(case, reply)) => drop(reply.send(answer(case).map_err(stopped)?)),
            Ok(Said::Ended(swept)) => return swept.map_err(refused),
            Err(RecvTimeoutError::Timeout) => py.check_signals().map_err(stopped)?,
            Err(RecvTimeoutError::Disconnected) => {
                return Err(PyRuntimeError::new_err("the sweep has ended without an answer"));
            }
        }
    }
}

fn next(said: &Mutex<Receiver<Said>>, limit: Duration) -> Result<Said, RecvTimeoutError> {
    said.lock().unwrap_or_else(PoisonError::into_inner).recv_timeout(limit)
}

/// Waits for the end of a stopped sweep; its remaining cases get no answer.
fn wait(said: &Mutex<Receiver<Said>>) {
    let until = Instant::now() + PATIENCE;
    while let Ok(Said::Case(..)) = next(said, until.saturating_duration_since(Instant::now())) {}
}

struct Stop(Arc<AtomicBool>);

impl Progress for Stop {
    fn begin(&self, _: usize, _: usize) {}
    fn doubted(&self, _: &str) {}
    fn started(&self, _: &str) {}
    fn finished(&self, _: &str, _: Option<&CaseRecord>) {}
    fn stopped(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }
}

/// Sends every case to the thread that called `verify`.
struct Caller(Sender<Said>);

impl Solve for Caller {
    fn solve(&self, given: &Given, data: &MeshData) -> Result<Answer, String> {
        let ended = || "the sweep was stopped".to_owned();
        let case = Python::try_attach(|py| case(py, given, data).map(Bound::unbind));
        let case = case.ok_or_else(ended)?.map_err(|error| error.to_string())?;
        let (reply, answer) = channel();
        self.0.send(Said::Case(case, reply)).map_err(|_| ended())?;
        answer.recv().map_err(|_| ended())
    }
}

fn answer(py: Python<'_>, solve: &Py<PyAny>, case: Py<PyDict>, pressure: bool) -> PyResult<Answer> {
    let bytes = solve.call1(py, (case,))?;
    if !pressure {
        let displacement = bytes.extract::<Bound<'_, PyBytes>>(py)?;
        return Ok(Answer { displacement: numbers(&displacement), pressure: None });
    }
    let (displacement, pressure) = bytes.extract::<(Bound<'_, PyBytes>, Bound<'_, PyBytes>)>(py)?;
    Ok(Answer { displacement: numbers(&displacement), pressure: Some(numbers(&pressure)) })
}
