//! A solver and the processes that it starts, as one process group, ended together. A daemon that leaves the group is
//! not followed.

use std::io;
use std::process::{Child, Command, ExitStatus};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use wait_timeout::ChildExt;

/// Time for a solver to clean up after being asked to end.
const GRACE: Duration = Duration::from_millis(500);
/// Polling interval of a wait.
const PAUSE: Duration = Duration::from_millis(10);

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
fn end(leaders: &[u32], mut meanwhile: impl FnMut()) {
    let mut left: Vec<u32> =
        leaders.iter().copied().filter(|&leader| signal(leader, Signal::End)).collect();
    let begin = Instant::now();
    while !left.is_empty() && begin.elapsed() < GRACE {
        meanwhile();
        left.retain(|&leader| signal(leader, Signal::None));
        if !left.is_empty() {
            std::thread::sleep(PAUSE);
        }
    }
    for leader in left {
        signal(leader, Signal::Kill);
    }
}

#[derive(Debug, Clone, Copy)]
enum Signal {
    /// Asks whether the group exists.
    None,
    End,
    Kill,
}

#[cfg(unix)]
fn leading(command: &mut Command) {
    std::os::unix::process::CommandExt::process_group(command, 0);
}

/// Whether the group existed.
#[cfg(unix)]
fn signal(leader: u32, what: Signal) -> bool {
    use nix::sys::signal::{Signal as Own, killpg};
    use nix::unistd::Pid;
    let sent = match what {
        Signal::None => None,
        Signal::End => Some(Own::SIGTERM),
        Signal::Kill => Some(Own::SIGKILL),
    };
    // 0 and 1 would be this program's group, or every process.
    i32::try_from(leader).is_ok_and(|id| id > 1 && killpg(Pid::from_raw(id), sent).is_ok())
}

/// Other systems have no groups: only the leader is ended.
#[cfg(not(unix))]
fn leading(_: &mut Command) {}

#[cfg(not(unix))]
fn signal(_: u32, _: Signal) -> bool {
    false
}
