//! Runs the cases of many scenes in parallel, longest first and within memory, and records each as it ends.

use super::admission::{MemoryLimit, needs};
use super::plan::{CasePlan, ScenePlan, without_panic};
use super::{
    Build, Cost, OutputDirectory, Provenance, Resumed, resume, run_abstract_case, run_contact_case,
};
use fem::norms::ReferenceRun;
use files::{FileError, ListError, counted, make_directory, remove_if_there, remove_listed};
use judge::record::{CaseRecord, Journal, Key, RecordError, read_finished};
use judge::verdict::{failures, restore_reasons};
use rayon::prelude::*;
use scene::setup::{MeshData, Setup, Subject, reference_run};
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, OnceLock, PoisonError};

/// Why a sweep ended without records.
#[derive(Debug, thiserror::Error)]
pub enum SweepError {
    #[error(transparent)]
    Record(#[from] RecordError),
    /// The records of a directory that is resumed belong to something else.
    #[error("{}: {what}; run without --resume to start anew, or choose another --out", dir.display())]
    Different { dir: PathBuf, what: String },
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

/// The reference run of a scene, or a case of it by its index.
type Job = (usize, Option<usize>);

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
    let Resumed { records: known, doubts } = match keep {
        true => resume(out.path(), plans)?,
        false => Resumed::default(),
    };
    doubts.iter().for_each(|doubt| progress.doubted(doubt));
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
                let over = || sweep.kept().failure.is_some() || progress.stopped();
                while let Some((task, dropped)) = schedule.begin(over) {
                    dropped.into_iter().for_each(|(s, n)| shared[s].let_go(n));
                    match work[task] {
                        (s, None) => {
                            let what = format!("{} reference", shared[s].plan.scene().name);
                            progress.started(&what);
                            // Its failure becomes that of each case.
                            if let Subject::Contact(setup) = &shared[s].plan.subject {
                                let _ = shared[s].reference(setup);
                            }
                            progress.finished(&what, None);
                        }
                        (s, Some(c)) => {
                            let plan = shared[s].plan;
                            progress.started(&in_words(plan, &plan.cases[c]));
                            sweep.finish(plan, &plan.cases[c], shared[s].record(&plan.cases[c]));
                        }
                    }
                    let mut done = done.lock().unwrap_or_else(PoisonError::into_inner);
                    *done += shares[task];
                    progress.advanced(*done / all);
                    drop(done);
                    schedule.end(task).into_iter().for_each(|(s, n)| shared[s].let_go(n));
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
        let recorded: BTreeSet<Key> = self.kept().records.iter().map(CaseRecord::key).collect();
        let unrecorded = |shared: &Shared<'_>| {
            let keys = shared.plan.keys().into_iter().enumerate();
            keys.filter(|(_, key)| !recorded.contains(key)).map(|(c, _)| c).collect()
        };
        let open: Vec<Vec<usize>> = self.shared.iter().map(unrecorded).collect();
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
                work.push((s, None));
                tasks.push(Task { shares: shares.clone(), ..task(need, need.work + longest) });
                tasks.len() - 1
            });
            for (c, need) in cases {
                let of_mesh = plan.cases[c].n.map(|n| ((s, Some(n)), need.kept_bytes));
                let shares = shares.iter().copied().chain(of_mesh).collect();
                work.push((s, Some(c)));
                tasks.push(Task { after, shares, ..task(need, need.work) });
            }
        }
        (work, tasks)
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

// Schedule: of the ready tasks, those that share data with the longest one begin next, the longest first, while the
// predicted bytes of running tasks and kept data stay below the limit. What they share is then dropped before the
// next is made.

/// Shared by several tasks of a scene: its reference run (no n) or the exact solution on a mesh.
pub(super) type Holding = (usize, Option<u32>);

#[derive(Debug, Clone, Default)]
pub(super) struct Task {
    /// Unknowns times steps, including what waits for it.
    pub(super) rank: f64,
    /// Those of the task alone.
    pub(super) work: f64,
    /// Predicted peak bytes while it runs, including what it shares.
    pub(super) bytes: f64,
    /// The task that must have ended before.
    pub(super) after: Option<usize>,
    /// What it shares with others, and the bytes of each while kept.
    pub(super) shares: Vec<(Holding, f64)>,
}

/// A task that may begin, and what has to be dropped before.
pub(super) type Start = (usize, Vec<Holding>);

pub(super) struct Schedule {
    tasks: Vec<Task>,
    limit: f64,
    state: Mutex<State>,
    changed: Condvar,
}

struct State {
    /// Longest first.
    waiting: Vec<usize>,
    running: Vec<usize>,
    ended: Vec<bool>,
    /// Kept for tasks that have not begun, with its bytes.
    held: BTreeMap<Holding, f64>,
    /// Number of unfinished tasks that share it.
    users: BTreeMap<Holding, usize>,
}

impl Schedule {
    /// The schedule of tasks; each fits below the limit alone.
    pub(super) fn new(tasks: Vec<Task>, limit: f64) -> Self {
        let mut waiting: Vec<usize> = (0..tasks.len()).collect();
        // Of a scene with a reference run all share that, of another those on one mesh.
        let mut longest: BTreeMap<Holding, f64> = BTreeMap::new();
        for task in &tasks {
            if let Some((widest, _)) = task.shares.first() {
                let rank = longest.entry(*widest).or_insert(0.0);
                *rank = rank.max(task.rank);
            }
        }
        let rank = |task: &Task| {
            let group = task.shares.first().map(|(widest, _)| *widest);
            (group.map_or(task.rank, |group| longest[&group]), group, task.rank)
        };
        waiting.sort_by(|&a, &b| {
            let ((of_a, group_a, a), (of_b, group_b, b)) = (rank(&tasks[a]), rank(&tasks[b]));
            of_b.total_cmp(&of_a).then(group_a.cmp(&group_b)).then(b.total_cmp(&a))
        });
        let mut users = BTreeMap::new();
        for (kept, _) in tasks.iter().flat_map(|task| &task.shares) {
            *users.entry(*kept).or_insert(0) += 1;
        }
        let state = State {
            waiting,
            running: Vec::new(),
            ended: vec![false; tasks.len()],
            held: BTreeMap::new(),
            users,
        };
        Self { tasks, limit, state: Mutex::new(state), changed: Condvar::new() }
    }

    /// The next task; waits until one may begin. None if there is none left, or `stopped` says so.
    pub(super) fn begin(&self, stopped: impl Fn() -> bool) -> Option<Start> {
        let mut state = self.lock();
        loop {
            if stopped() || state.waiting.is_empty() {
                return None;
            }
            let ready =
                |&task: &usize| self.tasks[task].after.is_none_or(|first| state.ended[first]);
            let mut dropped = Vec::new();
            let fits = |task: &usize| ready(task) && self.bytes(&state, *task) <= self.limit;
            let mut at = state.waiting.iter().position(fits);
            if at.is_none() && state.running.is_empty() {
                // Nothing runs whose end could free memory: kept data are dropped, to be made again later.
                at = state.waiting.iter().position(ready);
                dropped = state.held.keys().copied().collect();
                state.held.clear();
            }
            if let Some(at) = at {
                let task = state.waiting.remove(at);
                state.running.push(task);
                return Some((task, dropped));
            }
            state = self.changed.wait(state).unwrap_or_else(PoisonError::into_inner);
        }
    }

    /// Ends a task; returns what is no longer needed and has to be dropped.
    pub(super) fn end(&self, task: usize) -> Vec<Holding> {
        let mut state = self.lock();
        state.running.retain(|&running| running != task);
        state.ended[task] = true;
        let mut dropped = Vec::new();
        for &(kept, bytes) in &self.tasks[task].shares {
            let users = state.users.entry(kept).or_insert(1);
            *users -= 1;
            if *users == 0 {
                state.held.remove(&kept);
                dropped.push(kept);
            } else {
                // A shorter case that ends later does not reduce what a longer one keeps.
                let held = state.held.entry(kept).or_insert(0.0);
                *held = held.max(bytes);
            }
        }
        drop(state);
        self.changed.notify_all();
        dropped
    }

    /// Bytes with `task` beside the running ones; kept data that one of them uses are in its bytes.
    fn bytes(&self, state: &State, task: usize) -> f64 {
        let active = || state.running.iter().copied().chain([task]);
        let used = |kept: &Holding| {
            active().any(|index| self.tasks[index].shares.iter().any(|(other, _)| other == kept))
        };
        let idle = state.held.iter().filter(|(kept, _)| !used(kept)).map(|(_, bytes)| bytes);
        active().map(|index| self.tasks[index].bytes).sum::<f64>() + idle.sum::<f64>()
    }

    fn lock(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

// Data shared by the cases of one scene: its reference run, and a mesh with its exact solution for each n.

/// Made at first use, dropped after the last one.
type Slot<T> = Mutex<Arc<OnceLock<Result<T, String>>>>;

pub(crate) struct Shared<'a> {
    pub(super) plan: &'a ScenePlan,
    reference: Slot<Arc<ReferenceRun>>,
    meshes: Vec<(u32, Slot<MeshData>)>,
}

impl<'a> Shared<'a> {
    pub(super) fn new(plan: &'a ScenePlan) -> Self {
        let ns: BTreeSet<u32> = plan.cases.iter().filter_map(|case| case.n).collect();
        let meshes = ns.into_iter().map(|n| (n, Slot::default())).collect();
        Self { plan, reference: Slot::default(), meshes }
    }

    pub(super) fn record(&self, case: &CasePlan) -> CaseRecord {
        self.plan.record(case, || match &self.plan.subject {
            Subject::Abstract(setup) => Ok(run_abstract_case(setup, case)),
            Subject::Contact(setup) => {
                let n = case.n.ok_or("a body needs a mesh, but n is missing")?;
                self.on_mesh(setup, n, |data| run_contact_case(setup, data, case))
            }
        })
    }

    pub(super) fn reference(&self, setup: &Setup) -> Result<Arc<ReferenceRun>, String> {
        let run = || {
            let Some(reference) = self.plan.reference else {
                return Err("the scene has neither an exact solution nor a reference".into());
            };
            let every = (reference.steps / self.plan.kept_steps()).max(1);
            without_panic(|| {
                reference_run(setup, reference.n, reference.steps, every)
                    .map(Arc::new)
                    .map_err(|error| error.to_string())
            })
        };
        content(&self.reference).get_or_init(run).clone()
    }

    /// Applies `run` to mesh n with its exact solution.
    pub(super) fn on_mesh<T>(
        &self,
        setup: &Setup,
        n: u32,
        run: impl FnOnce(&MeshData) -> T,
    ) -> Result<T, String> {
        let Some((_, slot)) = self.meshes.iter().find(|(mesh, _)| *mesh == n) else {
            return Err(format!("no mesh n = {n} in the plan"));
        };
        let cell = content(slot);
        let data = cell.get_or_init(|| {
            let reference = match setup.exact {
                Some(_) => None,
                None => Some(self.reference(setup)?),
            };
            MeshData::new(setup, n, reference).map_err(|error| error.to_string())
        });
        data.as_ref().map(run).map_err(Clone::clone)
    }

    /// Drops mesh n, or the reference run.
    pub(super) fn let_go(&self, n: Option<u32>) {
        match n {
            None => empty(&self.reference),
            Some(n) => {
                self.meshes.iter().filter(|(mesh, _)| *mesh == n).for_each(|(_, slot)| empty(slot))
            }
        }
    }
}

/// The present content of a slot, made or not.
fn content<T>(slot: &Slot<T>) -> Arc<OnceLock<Result<T, String>>> {
    slot.lock().unwrap_or_else(PoisonError::into_inner).clone()
}

fn empty<T>(slot: &Slot<T>) {
    *slot.lock().unwrap_or_else(PoisonError::into_inner) = Arc::default();
}

#[cfg(test)]
mod tests {
    use super::*;

    fn task(rank: f64, bytes: f64) -> Task {
        Task { rank, bytes, ..Task::default() }
    }

    fn next(schedule: &Schedule) -> Option<usize> {
        schedule.begin(|| false).map(|(task, _)| task)
    }

    #[test]
    fn longest_first_where_all_fits() {
        let schedule = Schedule::new(vec![task(1.0, 1.0), task(3.0, 1.0), task(2.0, 1.0)], 9.0);
        let order: Vec<_> = (0..4).map(|_| next(&schedule)).collect();
        assert_eq!(order, [Some(1), Some(2), Some(0), None]);
        assert_eq!(Schedule::new(vec![task(1.0, 1.0)], 9.0).begin(|| true), None);
    }

    #[test]
    fn a_task_that_does_not_fit_lets_others_pass_and_waits() {
        let schedule = Schedule::new(vec![task(3.0, 5.0), task(2.0, 4.0), task(1.0, 3.0)], 8.0);
        assert_eq!(next(&schedule), Some(0));
        // 5 + 4 is above 8, 5 + 3 is not.
        assert_eq!(next(&schedule), Some(2));
        std::thread::scope(|scope| {
            let waiting = scope.spawn(|| next(&schedule));
            std::thread::sleep(std::time::Duration::from_millis(20));
            assert!(!waiting.is_finished());
            schedule.end(0);
            assert_eq!(waiting.join().ok(), Some(Some(1)));
        });
    }

    /// In pairs of a scene and a mesh: what shares a reference run, and what shares a mesh, is not left for longer tasks.
    #[test]
    fn what_shares_data_with_the_longest_comes_next() {
        let on = |kept: &[Holding], rank| {
            let shares = kept.iter().map(|kept| (*kept, 1.0)).collect();
            Task { shares, ..task(rank, 1.0) }
        };
        let (reference, fine, coarse) = ((0, None), (0, Some(16)), (0, Some(8)));
        let tasks = vec![
            on(&[(1, Some(8))], 6.0),
            on(&[reference], 9.0),
            on(&[(1, Some(4))], 2.0),
            on(&[reference, coarse], 1.0),
            on(&[(1, Some(8))], 3.0),
            on(&[reference, fine], 5.0),
            task(4.0, 1.0),
        ];
        let schedule = Schedule::new(tasks, 9.0);
        let order: Vec<_> = (0..7).filter_map(|_| next(&schedule)).collect();
        assert_eq!(order, [1, 5, 3, 0, 4, 6, 2]);
    }

    #[test]
    fn what_waits_for_another_begins_after_it() {
        let waits = Task { after: Some(1), ..task(9.0, 1.0) };
        let schedule = Schedule::new(vec![waits, task(2.0, 1.0), task(1.0, 1.0)], 9.0);
        assert_eq!([next(&schedule), next(&schedule)], [Some(1), Some(2)]);
        schedule.end(1);
        assert_eq!(next(&schedule), Some(0));
    }

    #[test]
    fn the_most_that_is_kept_counts_whichever_case_ends_last() {
        let mesh = (0, Some(8));
        let on = |rank, kept| Task { shares: vec![(mesh, kept)], ..task(rank, 5.0) };
        let other = || Task { after: Some(1), ..task(5.0, 7.0) };
        let tasks = || vec![on(4.0, 2.0), on(3.0, 4.0), other(), on(1.0, 4.0)];
        for ends in [[0, 1], [1, 0]] {
            let schedule = Schedule::new(tasks(), 10.0);
            assert_eq!([next(&schedule), next(&schedule)], [Some(0), Some(1)]);
            ends.into_iter().for_each(|task| assert_eq!(schedule.end(task), []));
            // 4 are kept, and 7 + 4 are above 10: the last task on the mesh passes.
            assert_eq!(next(&schedule), Some(3), "{ends:?}");
        }
    }

    #[test]
    fn what_is_kept_counts_until_nobody_needs_it() {
        let (mesh, other) = ((0, Some(8)), (1, Some(8)));
        let on = |kept, rank, bytes| Task { shares: vec![(kept, 2.0)], ..task(rank, bytes) };
        let apart = || {
            let last = Task { after: Some(1), ..on(mesh, 2.0, 5.0) };
            vec![on(mesh, 4.0, 5.0), on(other, 3.0, 4.0), last]
        };
        let schedule = Schedule::new(apart(), 6.0);
        assert_eq!(next(&schedule), Some(0));
        assert_eq!(schedule.end(0), []);
        // 2 bytes are kept for task 2: task 1 fits beside them, and frees its data at its end.
        assert_eq!(next(&schedule), Some(1));
        assert_eq!(schedule.end(1), [other]);
        assert_eq!(next(&schedule), Some(2));
        assert_eq!(schedule.end(2), [mesh]);
        // With a limit of 5 they are dropped, since nothing else could free memory.
        let tasks = vec![on(mesh, 4.0, 5.0), on(other, 3.0, 4.0), on(mesh, 2.0, 5.0)];
        let tight = Schedule::new(tasks, 5.0);
        assert_eq!(next(&tight), Some(0));
        tight.end(0);
        // The other task on the mesh needs no more than its bytes.
        assert_eq!(tight.begin(|| false), Some((2, vec![])));
        tight.end(2);
        let tight = Schedule::new(apart(), 5.0);
        assert_eq!(next(&tight), Some(0));
        tight.end(0);
        assert_eq!(tight.begin(|| false), Some((1, vec![mesh])));
    }
}
