//! Runs the cases of many scenes on a few threads, longest first, and records each as it ends.

use std::path::PathBuf;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

use super::plan::{CasePlan, ScenePlan, TIME_REFERENCE, without_panic};
use super::{
    OutputDirectory, Provenance, ResumeError, resume, run_abstract_case, run_contact_case,
};
use crate::norms::ReferenceRun;
use crate::record::{CaseRecord, Journal, RecordError, counted};
use crate::report::{ReportError, remove_earlier};
use crate::scene::Norm;
use crate::setup::{MeshData, Setup, Subject, reference_run};

/// Why a sweep ended without records.
#[derive(Debug, thiserror::Error)]
pub enum SweepError {
    /// The records cannot be written or read.
    #[error(transparent)]
    Record(#[from] RecordError),
    /// The old records cannot be resumed.
    #[error(transparent)]
    Resume(#[from] ResumeError),
    /// A file of the directory cannot be written or removed.
    #[error("{}: {reason}", path.display())]
    Directory { path: PathBuf, reason: String },
    /// What an earlier report left cannot be removed.
    #[error(transparent)]
    Report(#[from] ReportError),
    /// The threads could not be started.
    #[error("starting {}: {reason}", counted(*jobs, "thread"))]
    Threads { jobs: usize, reason: String },
}

/// Hears of the sweep while it runs.
pub trait Progress: Sync {
    /// The sweep begins, with `total` cases of which `done` are already recorded.
    fn begin(&self, total: usize, done: usize);
    /// A case or reference run starts.
    fn started(&self, what: &str);
    /// It ended.
    fn finished(&self, what: &str, record: Option<&CaseRecord>);
}

/// Nobody listens.
impl Progress for () {
    fn begin(&self, _: usize, _: usize) {}
    fn started(&self, _: &str) {}
    fn finished(&self, _: &str, _: Option<&CaseRecord>) {}
}

/// A piece of work.
enum Job {
    /// The reference run of a scene.
    Reference(usize),
    /// A case: scene and index.
    Case(usize, usize),
}

/// What the jobs of one scene share.
struct Shared<'a> {
    plan: &'a ScenePlan,
    reference: OnceLock<Result<Arc<ReferenceRun>, String>>,
    meshes: Vec<(u32, OnceLock<Result<MeshData, String>>)>,
}

/// Runs `plans` with `jobs` threads; with `keep`, complete cases in `out` are not run again.
/// Returns all records, sorted by scene, n and steps.
///
/// # Errors
/// Files only: a case that fails is a record. Where a record cannot be written no further case begins.
pub fn run_sweep(
    plans: &[ScenePlan],
    out: &OutputDirectory,
    jobs: usize,
    keep: bool,
    progress: &dyn Progress,
) -> Result<Vec<CaseRecord>, SweepError> {
    let known = if keep { resume(out.path(), plans)? } else { Vec::new() };
    run_more(plans, known, out, jobs, progress)
}

/// Runs the cases of `plans` that `known` does not hold. Returns all records, sorted likewise.
///
/// # Errors
/// As [`run_sweep`].
pub fn run_more(
    plans: &[ScenePlan],
    known: Vec<CaseRecord>,
    out: &OutputDirectory,
    jobs: usize,
    progress: &dyn Progress,
) -> Result<Vec<CaseRecord>, SweepError> {
    let journal = prepare(plans, out, &known)?;
    let total = plans.iter().map(|plan| plan.cases.len()).sum();
    progress.begin(total, known.len());
    let shared: Vec<Shared<'_>> = plans.iter().map(Shared::new).collect();
    let sweep = Sweep {
        shared: &shared,
        journal: Mutex::new(journal),
        records: Mutex::new(known),
        failure: Mutex::new(None),
        progress,
    };
    let (first, second) = sweep.jobs();
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(jobs)
        .build()
        .map_err(|error| SweepError::Threads { jobs, reason: error.to_string() })?;
    for wave in [first, second] {
        let next = AtomicUsize::new(0);
        pool.scope(|scope| {
            for _ in 0..jobs {
                scope.spawn(|_| {
                    while let Some(job) = wave.get(next.fetch_add(1, Ordering::Relaxed)) {
                        // What cannot be recorded need not be computed.
                        if sweep.failed() {
                            break;
                        }
                        sweep.execute(job);
                    }
                });
            }
        });
    }
    if let Some(error) = sweep.failure.into_inner().unwrap_or_else(PoisonError::into_inner) {
        return Err(error.into());
    }
    let mut records = sweep.records.into_inner().unwrap_or_else(PoisonError::into_inner);
    records.sort_by_key(CaseRecord::key);
    Ok(records)
}

/// Writes the provenance, and the journal with the records that are kept.
fn prepare(
    plans: &[ScenePlan],
    out: &OutputDirectory,
    known: &[CaseRecord],
) -> Result<Journal, SweepError> {
    let out = out.path();
    let refused = |(path, reason)| SweepError::Directory { path, reason };
    let table = out.join("cases.csv");
    // Killed at any point, the directory must hold no table without its provenance, and nothing of
    // an old table beside a new one: page, pictures, verdicts and the old table go first, the new
    // one comes last.
    remove_earlier(out)?;
    let old = [Some(out.join("verdict.json")), known.is_empty().then(|| table.clone())];
    for path in old.into_iter().flatten().filter(|path| path.exists()) {
        std::fs::remove_file(&path).map_err(|e| refused((path, e.to_string())))?;
    }
    Provenance::of_run(plans).write(out).map_err(refused)?;
    crate::record::write_sorted(&table, known)?;
    Ok(Journal::open(&table)?)
}

struct Sweep<'a> {
    shared: &'a [Shared<'a>],
    journal: Mutex<Journal>,
    records: Mutex<Vec<CaseRecord>>,
    failure: Mutex<Option<RecordError>>,
    progress: &'a dyn Progress,
}

impl Sweep<'_> {
    /// Reference runs and cases with an exact solution; then the cases that need a reference.
    fn jobs(&self) -> (Vec<Job>, Vec<Job>) {
        let records = self.records.lock().unwrap_or_else(PoisonError::into_inner);
        let (mut first, mut second) = (Vec::new(), Vec::new());
        for (s, shared) in self.shared.iter().enumerate() {
            let plan = shared.plan;
            let open: Vec<usize> = (0..plan.cases.len())
                .filter(|&c| !records.iter().any(|record| is_case(plan, &plan.cases[c], record)))
                .collect();
            if plan.subject.has_exact() {
                first.extend(open.into_iter().map(|c| Job::Case(s, c)));
            } else if !open.is_empty() {
                first.push(Job::Reference(s));
                second.extend(open.into_iter().map(|c| Job::Case(s, c)));
            }
        }
        for wave in [&mut first, &mut second] {
            wave.sort_by(|a, b| self.cost(b).total_cmp(&self.cost(a)));
        }
        (first, second)
    }

    /// Predicted cost, for the order only: a factorization a step, n³ each in the plane.
    fn cost(&self, job: &Job) -> f64 {
        let run = |n: u32, steps: u32| f64::from(n).powi(3) * (f64::from(steps) + 1.0);
        match *job {
            Job::Reference(s) => {
                self.shared[s].plan.reference.map_or(0.0, |r| run(r.n as u32, r.steps as u32))
            }
            Job::Case(s, c) => {
                let case = &self.shared[s].plan.cases[c];
                let timed = case.norms.contains(&Norm::VTimeMax);
                let factor = if timed { 1 + TIME_REFERENCE } else { 1 };
                // An abstract case costs its direct history, next to nothing beside a mesh.
                case.n.map_or(0.0, |n| run(n, case.steps * factor))
            }
        }
    }

    fn execute(&self, job: &Job) {
        match *job {
            Job::Reference(s) => {
                let what = format!("{} reference", self.shared[s].plan.scene().name);
                self.progress.started(&what);
                if let Subject::Contact(setup) = &self.shared[s].plan.subject {
                    // Its failure is that of each case.
                    let _ = self.shared[s].reference(setup);
                }
                self.progress.finished(&what, None);
            }
            Job::Case(s, c) => {
                let shared = &self.shared[s];
                let case = &shared.plan.cases[c];
                let name = &shared.plan.scene().name;
                let what = match case.n {
                    Some(n) => format!("{name} n={n} N={}", case.steps),
                    None => format!("{name} N={}", case.steps),
                };
                self.progress.started(&what);
                let record = shared.case(case);
                self.progress.finished(&what, Some(&record));
                self.keep(record);
            }
        }
    }

    /// A record could not be written.
    fn failed(&self) -> bool {
        self.failure.lock().unwrap_or_else(PoisonError::into_inner).is_some()
    }

    fn keep(&self, record: CaseRecord) {
        let mut journal = self.journal.lock().unwrap_or_else(PoisonError::into_inner);
        // The failed write may have left half a line: a line after it would make the table unreadable.
        if self.failed() {
            return;
        }
        if let Err(error) = journal.append(&record) {
            self.failure.lock().unwrap_or_else(PoisonError::into_inner).get_or_insert(error);
        }
        self.records.lock().unwrap_or_else(PoisonError::into_inner).push(record);
    }
}

impl<'a> Shared<'a> {
    fn new(plan: &'a ScenePlan) -> Self {
        let mut ns: Vec<u32> = plan.cases.iter().filter_map(|case| case.n).collect();
        ns.sort_unstable();
        ns.dedup();
        let meshes = ns.into_iter().map(|n| (n, OnceLock::new())).collect();
        Self { plan, reference: OnceLock::new(), meshes }
    }

    fn reference(&self, setup: &Setup) -> &Result<Arc<ReferenceRun>, String> {
        self.reference.get_or_init(|| {
            let Some(reference) = self.plan.reference else {
                return Err("the scene has neither an exact solution nor a reference".into());
            };
            let (n, steps) = (reference.n as u32, reference.steps as u32);
            let every = (steps / self.plan.kept_steps()).max(1);
            without_panic(|| {
                reference_run(setup, n, steps, every)
                    .map(Arc::new)
                    .map_err(|error| error.to_string())
            })
        })
    }

    fn mesh(&self, setup: &Setup, n: u32) -> Result<&MeshData, String> {
        let Some((_, cell)) = self.meshes.iter().find(|(own, _)| *own == n) else {
            return Err(format!("no mesh n = {n} in the plan"));
        };
        let data = cell.get_or_init(|| {
            let reference = match setup.exact {
                Some(_) => None,
                None => Some(self.reference(setup).clone()?),
            };
            MeshData::new(setup, n, reference).map_err(|error| error.to_string())
        });
        data.as_ref().map_err(Clone::clone)
    }

    fn case(&self, case: &CasePlan) -> CaseRecord {
        self.plan.record(case, || match (&self.plan.subject, case.n) {
            (Subject::Contact(setup), Some(n)) => {
                self.mesh(setup, n).map(|data| run_contact_case(setup, data, case))
            }
            (Subject::Contact(_), None) => Err("a body needs a mesh: no n".into()),
            (Subject::Abstract(setup), _) => Ok(run_abstract_case(setup, case)),
        })
    }
}

fn is_case(plan: &ScenePlan, case: &CasePlan, record: &CaseRecord) -> bool {
    record.scene == plan.scene().name && record.n == case.n && record.steps == case.steps
}
