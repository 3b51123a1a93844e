//! Runs the cases of many scenes in parallel, longest first and within memory, and records each as it ends.

use std::collections::BTreeSet;
use std::path::Path;
use std::sync::{Mutex, MutexGuard, PoisonError};

use super::Build;
use super::memory_limit::MemoryLimit;
use super::needs::needs;
use super::plan::{CasePlan, ScenePlan};
use super::schedule::{Schedule, Task};
use super::shared::Shared;
use super::{Cost, OutputDirectory, Provenance, ResumeError, Resumed, resume};
use rayon::prelude::*;

use files::{FileError, ListError, counted, make_directory, remove_if_there, remove_listed};
use judge::record::{CaseRecord, Journal, Key, RecordError, read_finished};
use judge::verdict::{failures, restore_reasons};
use scene::setup::Subject;

/// Why a sweep ended without records.
#[derive(Debug, thiserror::Error)]
pub enum SweepError {
    #[error(transparent)]
    Record(#[from] RecordError),
    #[error(transparent)]
    Resume(#[from] ResumeError),
    #[error(transparent)]
    Io(#[from] FileError),
    /// Files of an earlier report cannot be removed.
    #[error(transparent)]
    Listed(#[from] ListError),
    #[error("starting {}: {reason}", counted(*jobs, "thread"))]
    Threads { jobs: usize, reason: String },
}

/// Resources and circumstances of a sweep.
#[derive(Debug, Clone, PartialEq)]
pub struct Machine {
    /// Cases in parallel.
    pub jobs: usize,
    /// Memory that cases may be predicted to take together.
    pub memory: MemoryLimit,
    /// Build and command options, for the provenance.
    pub build: Build,
    pub options: String,
}

impl Machine {
    /// So many cases in parallel, without a memory limit.
    pub fn with_jobs(jobs: usize) -> Self {
        let build = Build::unknown();
        Self { jobs, memory: MemoryLimit::NONE, build, options: String::new() }
    }
}

/// Observer of a running sweep.
pub trait Progress: Sync {
    /// The sweep begins, with `total` cases of which `done` are already recorded.
    fn begin(&self, _total: usize, _done: usize) {}
    /// Records of an earlier sweep are discarded, and their cases run again.
    fn doubted(&self, _why: &str) {}
    fn started(&self, _what: &str) {}
    fn finished(&self, _what: &str, _record: Option<&CaseRecord>) {}
    /// The done share of all work, in unknowns times steps.
    fn advanced(&self, _share: f64) {}
    /// Whether no further case shall begin.
    fn stopped(&self) -> bool {
        false
    }
}

/// Ignores everything.
impl Progress for () {}

enum Job {
    /// The reference run of a scene.
    Reference(usize),
    /// A case: scene and index.
    Case(usize, usize),
}

/// Runs `plans` on `machine`; with `keep`, complete cases in `out` are not run again. Returns all records as they are read
/// back from `cases.csv`, sorted by scene, n and steps: what is judged is what was written.
///
/// # Errors
/// Files only: a case that fails is a record. If a record cannot be written no further case begins.
pub fn run_sweep(
    plans: &[ScenePlan],
    out: &OutputDirectory,
    machine: &Machine,
    keep: bool,
    progress: &dyn Progress,
) -> Result<Vec<CaseRecord>, SweepError> {
    let Resumed { records, doubts } = match keep {
        true => resume(out.path(), plans)?,
        false => Resumed::default(),
    };
    doubts.iter().for_each(|doubt| progress.doubted(doubt));
    run_more(plans, records, out, machine, progress)
}

/// Runs the cases of `plans` missing in `known`. Returns all records likewise.
pub fn run_more(
    plans: &[ScenePlan],
    known: Vec<CaseRecord>,
    out: &OutputDirectory,
    machine: &Machine,
    progress: &dyn Progress,
) -> Result<Vec<CaseRecord>, SweepError> {
    let table = out.path().join("cases.csv");
    replace_records(out.path(), &Provenance::of_run(plans, machine), !known.is_empty())?;
    judge::record::write_sorted(&table, &known)?;
    let journal = Journal::open(&table)?;
    let total = plans.iter().map(|plan| plan.cases.len()).sum();
    progress.begin(total, known.len());
    let shared: Vec<Shared<'_>> = plans.iter().map(Shared::new).collect();
    let sweep = Sweep {
        shared: &shared,
        kept: Mutex::new(Kept { journal, records: known, failure: None }),
        progress,
    };
    let jobs = machine.jobs;
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(jobs)
        .build()
        .map_err(|error| SweepError::Threads { jobs, reason: error.to_string() })?;
    let (work, tasks) = pool.install(|| sweep.work(&machine.memory));
    let shares: Vec<f64> = tasks.iter().map(|task| task.work).collect();
    let all: f64 = shares.iter().sum();
    let done = Mutex::new(0.0);
    let schedule = Schedule::new(tasks, machine.memory.bytes());
    pool.scope(|scope| {
        for _ in 0..jobs {
            scope.spawn(|_| {
                // Cases that cannot be recorded need not be computed.
                while let Some(start) = schedule.begin(|| sweep.failed() || progress.stopped()) {
                    start.dropped.into_iter().for_each(|(s, n)| shared[s].let_go(n));
                    sweep.execute(&work[start.task]);
                    let mut done = done.lock().unwrap_or_else(PoisonError::into_inner);
                    *done += shares[start.task];
                    progress.advanced(*done / all);
                    drop(done);
                    schedule.end(start.task).into_iter().for_each(|(s, n)| shared[s].let_go(n));
                }
            });
        }
    });
    let kept = sweep.kept.into_inner().unwrap_or_else(PoisonError::into_inner);
    let Kept { journal, records, failure } = kept;
    failure.map_or(Ok(()), Err)?;
    journal.in_place()?;
    let mut written = read_finished(&table)?;
    // The table has no column for reasons.
    restore_reasons(&mut written, &failures(&records));
    Ok(written)
}

/// Begins a directory of other records, whose table the caller writes last. If killed at any point, the directory must
/// have no table without its provenance, and no mixture of old and new files: pages, pictures, verdicts and the old table
/// are removed first, but not a table that is `kept` until it is replaced.
pub fn replace_records(out: &Path, provenance: &Provenance, kept: bool) -> Result<(), SweepError> {
    make_directory(out)?;
    remove_listed(out)?;
    let removed = if kept { &["verdict.json"][..] } else { &["verdict.json", "cases.csv"] };
    for name in removed {
        remove_if_there(&out.join(name))?;
    }
    Ok(provenance.write(out)?)
}

struct Sweep<'a> {
    shared: &'a [Shared<'a>],
    kept: Mutex<Kept>,
    progress: &'a dyn Progress,
}

struct Kept {
    journal: Journal,
    records: Vec<CaseRecord>,
    /// Why a record could not be written.
    failure: Option<RecordError>,
}

impl Sweep<'_> {
    /// The unrecorded cases, with the reference runs that they need. A case that exceeds the memory limit is recorded
    /// as failed.
    fn work(&self, limit: &MemoryLimit) -> (Vec<Job>, Vec<Task>) {
        let open: Vec<Vec<usize>> = self.shared.iter().map(|shared| self.open(shared)).collect();
        let needs: Vec<_> = self
            .shared
            .par_iter()
            .zip(&open)
            .map(|(shared, open)| {
                let cases: Vec<CasePlan> =
                    open.iter().map(|&c| shared.plan.cases[c].clone()).collect();
                needs(shared.plan, &cases, limit)
            })
            .collect();
        let (mut work, mut tasks) = (Vec::new(), Vec::new());
        for (s, (open, (reference, needs))) in open.into_iter().zip(needs).enumerate() {
            let plan = self.shared[s].plan;
            let mut cases = Vec::new();
            for (c, need) in open.into_iter().zip(needs) {
                match need {
                    Ok(need) => cases.push((c, need)),
                    Err(reason) => {
                        let refused = || Err(reason.to_string());
                        self.finish(plan, &plan.cases[c], plan.record(&plan.cases[c], refused));
                    }
                }
            }
            let mut shares = Vec::new();
            let after = reference.filter(|_| !cases.is_empty()).map(|need| {
                shares.push(((s, None), need.kept_bytes));
                let longest = cases.iter().map(|(_, case)| case.work).fold(0.0, f64::max);
                work.push(Job::Reference(s));
                tasks.push(Task { shares: shares.clone(), ..task(need, need.work + longest) });
                tasks.len() - 1
            });
            for (c, need) in cases {
                let of_mesh = plan.cases[c].n.map(|n| ((s, Some(n)), need.kept_bytes));
                let shares = shares.iter().copied().chain(of_mesh).collect();
                work.push(Job::Case(s, c));
                tasks.push(Task { after, shares, ..task(need, need.work) });
            }
        }
        (work, tasks)
    }

    fn open(&self, shared: &Shared<'_>) -> Vec<usize> {
        let recorded: BTreeSet<Key> = self.kept().records.iter().map(CaseRecord::key).collect();
        let keys = shared.plan.keys().into_iter().enumerate();
        keys.filter(|(_, key)| !recorded.contains(key)).map(|(c, _)| c).collect()
    }

    fn execute(&self, job: &Job) {
        match *job {
            Job::Reference(s) => {
                let what = format!("{} reference", self.shared[s].plan.scene().name);
                self.progress.started(&what);
                // Its failure becomes that of each case.
                if let Subject::Contact(setup) = &self.shared[s].plan.subject {
                    let _ = self.shared[s].reference(setup);
                }
                self.progress.finished(&what, None);
            }
            Job::Case(s, c) => {
                let shared = &self.shared[s];
                let case = &shared.plan.cases[c];
                self.progress.started(&in_words(shared.plan, case));
                self.finish(shared.plan, case, shared.record(case));
            }
        }
    }

    fn failed(&self) -> bool {
        self.kept().failure.is_some()
    }

    fn kept(&self) -> MutexGuard<'_, Kept> {
        self.kept.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn finish(&self, plan: &ScenePlan, case: &CasePlan, record: CaseRecord) {
        self.progress.finished(&in_words(plan, case), Some(&record));
        let mut kept = self.kept();
        // The failed write may have left half a line; a line after it would make the table unreadable.
        if kept.failure.is_none() {
            kept.failure = kept.journal.append(&record).err();
            kept.records.push(record);
        }
    }
}

fn task(need: Cost, rank: f64) -> Task {
    Task { rank, work: need.work, bytes: need.memory_bytes, ..Task::default() }
}

fn in_words(plan: &ScenePlan, case: &CasePlan) -> String {
    let name = &plan.scene().name;
    match case.n {
        Some(n) => format!("{name} n={n} N={}", case.steps),
        None => format!("{name} N={}", case.steps),
    }
}
