//! Schedule: of the ready tasks, those that share data with the longest one begin next, the longest first, while the
//! predicted bytes of running tasks and kept data stay below the limit. What they share is then dropped before the next
//! is made.

use std::collections::BTreeMap;
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};

/// Shared by several tasks of a scene: its reference run (no n) or the exact solution on a mesh.
pub(super) type Kept = (usize, Option<u32>);

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
    pub(super) shares: Vec<(Kept, f64)>,
}

/// A task that may begin, and what has to be dropped before.
#[derive(Debug, PartialEq)]
pub(super) struct Start {
    pub(super) task: usize,
    pub(super) dropped: Vec<Kept>,
}

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
    held: BTreeMap<Kept, f64>,
    /// Number of unfinished tasks that share it.
    users: BTreeMap<Kept, usize>,
}

impl Schedule {
    /// The schedule of tasks; each fits below the limit alone.
    pub(super) fn new(tasks: Vec<Task>, limit: f64) -> Self {
        let mut waiting: Vec<usize> = (0..tasks.len()).collect();
        // Of a scene with a reference run all share that, of another those on one mesh.
        let mut longest: BTreeMap<Kept, f64> = BTreeMap::new();
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
                return Some(Start { task, dropped });
            }
            state = self.changed.wait(state).unwrap_or_else(PoisonError::into_inner);
        }
    }

    /// Ends a task; returns what is no longer needed and has to be dropped.
    pub(super) fn end(&self, task: usize) -> Vec<Kept> {
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
        let used = |kept: &Kept| {
            active().any(|index| self.tasks[index].shares.iter().any(|(other, _)| other == kept))
        };
        let idle = state.held.iter().filter(|(kept, _)| !used(kept)).map(|(_, bytes)| bytes);
        active().map(|index| self.tasks[index].bytes).sum::<f64>() + idle.sum::<f64>()
    }

    fn lock(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn task(rank: f64, bytes: f64) -> Task {
        Task { rank, bytes, ..Task::default() }
    }

    fn next(schedule: &Schedule) -> Option<usize> {
        schedule.begin(|| false).map(|start| start.task)
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
        let on = |kept: &[Kept], rank| {
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
        assert_eq!(tight.begin(|| false), Some(Start { task: 2, dropped: vec![] }));
        tight.end(2);
        let tight = Schedule::new(apart(), 5.0);
        assert_eq!(next(&tight), Some(0));
        tight.end(0);
        assert_eq!(tight.begin(|| false), Some(Start { task: 1, dropped: vec![mesh] }));
    }
}
