//! A solver and the processes that it starts, as one process group, ended together. A daemon that leaves the group is
//! not followed.

use std::io;
use std::process::{Child, Command, ExitStatus};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use wait_timeout::ChildExt;

/// The running groups, by leader.
struct Running {
    leaders: Vec<u32>,
    /// The program is ending: nothing more is started.
    over: bool,
}

static RUNNING: Mutex<Running> = Mutex::new(Running { leaders: Vec::new(), over: false });

fn running() -> MutexGuard<'static, Running> {
    RUNNING.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Leader of a process group. Dropping it ends the whole group.
pub(crate) struct ProcessGroup {
    child: Child,
}

impl ProcessGroup {
    pub(crate) fn start(command: &mut Command) -> io::Result<Self> {
        leading(command);
        // Locked during the start, so that ending all groups includes this one.
        let mut running = running();
        if running.over {
            drop(running);
            stay();
        }
        let child = command.spawn()?;
        running.leaders.push(child.id());
        Ok(Self { child })
    }

    /// The status of the leader, if it ends within `limit`.
    pub(crate) fn wait(&mut self, limit: Duration) -> io::Result<Option<ExitStatus>> {
        let status = self.child.wait_timeout(limit)?;
        let over = running().over;
        if over {
            stay();
        }
        Ok(status)
    }
}

/// The program is ending: the fate of a solver is no result and must not be recorded.
fn stay() -> ! {
    loop {
        std::thread::park();
    }
}

impl Drop for ProcessGroup {
    fn drop(&mut self) {
        let leader = self.child.id();
        let child = &mut self.child;
        // A leader that is not waited for stays a member of its group.
        end(&[leader], || _ = child.try_wait());
        let _ = child.kill();
        let _ = child.wait();
        running().leaders.retain(|running_leader| *running_leader != leader);
    }
}

/// Ends all running solvers and lets none begin; called when the program ends.
pub fn end_solvers() {
    let mut running = running();
    running.over = true;
    let leaders = std::mem::take(&mut running.leaders);
    drop(running);
    end(&leaders, || ());
}

/// Asks the groups to end, and kills what is left of them after a while.
#[cfg(unix)]
fn end(leaders: &[u32], mut meanwhile: impl FnMut()) {
    use nix::sys::signal::{Signal, killpg};
    use nix::unistd::Pid;
    /// Time for a solver to clean up after being asked to end.
    const GRACE: Duration = Duration::from_millis(500);
    /// Polling interval of a wait.
    const PAUSE: Duration = Duration::from_millis(10);
    // Whether the group existed: without a signal that is asked alone.
    let sent = |group: &Pid, signal: Option<Signal>| killpg(*group, signal).is_ok();
    // 0 and 1 would be this program's group, or every process.
    let groups =
        leaders.iter().filter_map(|&leader| i32::try_from(leader).ok().filter(|&id| id > 1));
    let mut left: Vec<Pid> = groups.map(Pid::from_raw).collect();
    left.retain(|group| sent(group, Some(Signal::SIGTERM)));
    let begin = std::time::Instant::now();
    while !left.is_empty() && begin.elapsed() < GRACE {
        meanwhile();
        left.retain(|group| sent(group, None));
        if !left.is_empty() {
            std::thread::sleep(PAUSE);
        }
    }
    for group in left {
        sent(&group, Some(Signal::SIGKILL));
    }
}

#[cfg(unix)]
fn leading(command: &mut Command) {
    std::os::unix::process::CommandExt::process_group(command, 0);
}

/// Other systems have no groups: only the leader is ended.
#[cfg(not(unix))]
fn leading(_: &mut Command) {}

#[cfg(not(unix))]
fn end(_: &[u32], _: impl FnMut()) {}
