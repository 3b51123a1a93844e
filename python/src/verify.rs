//! A Python function under the sweep of a scene.
//!
//! The sweep runs on a thread of its own. The function is called on that of `verify`, as any other call: it may rely on
//! what belongs to its thread, and Ctrl-C ends it where it stands.

use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use gronwall::external::{Answer, Given, InProcess, Solve};
use gronwall::record::CaseRecord;
use gronwall::setup::MeshData;
use gronwall::sweep::Progress;
use gronwall::{Sweep, Swept};
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict};

use super::case::{case, numbers};
use super::refused;

/// How often Ctrl-C is looked for while no Python runs.
const LOOK: Duration = Duration::from_millis(20);
/// How long the sweep may take to end once it is stopped. It ends with the case that it is at, which may be longer.
const PATIENCE: Duration = Duration::from_millis(500);

/// Runs the cases of a scene through `solve(case)`; records and verdicts as JSON. `solve` gets a dictionary of bytes and
/// numbers and gives bytes back: displacements of all levels and, with `pressure`, ξ + λ.
///
/// What it raises ends the sweep and is raised here, and so does Ctrl-C.
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
    let document = gronwall::verdict::document(
        &serde_json::Value::Null,
        &swept.verdicts,
        &swept.records,
        None,
    );
    serde_json::to_string(&document).map_err(|error| PyRuntimeError::new_err(error.to_string()))
}

/// What the thread of the sweep says to that of `verify`.
enum Said {
    /// Here is a case; where its answer is to go.
    Case(Py<PyDict>, Sender<Answer>),
    /// That was all.
    Ended(Result<Swept, String>),
}

/// The sweep, with answers of this thread to its cases.
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
            // Nobody listens any more only where the sweep is stopped.
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

/// Waits for the end of a sweep that is stopped; cases that it still has get no answer.
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

/// Has every case answered by the thread that `verify` was called on.
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
