//! A solver with all that it starts: a group of processes, which is ended as one.
//!
//! A process that leaves its group on purpose, as a daemon does, is not followed.

use std::io;
use std::process::{Child, Command, ExitStatus};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use wait_timeout::ChildExt;

/// What a solver has to end what it has begun, once it is asked to.
const GRACE: Duration = Duration::from_millis(500);
/// How often it is asked for.
const PAUSE: Duration = Duration::from_millis(10);

/// The groups that run, by the process that leads each.
struct Running {
    leaders: Vec<u32>,
    /// The program is about to end: nothing more is started.
    over: bool,
}

static RUNNING: Mutex<Running> = Mutex::new(Running { leaders: Vec::new(), over: false });

fn running() -> MutexGuard<'static, Running> {
    RUNNING.lock().unwrap_or_else(PoisonError::into_inner)
}

/// A process that leads a group of its own. Dropped, it is ended with all of the group.
pub(crate) struct Group {
    child: Child,
}

impl Group {
    /// Starts a command as a group.
    ///
    /// # Errors
    /// As [`Command::spawn`].
    pub(crate) fn start(command: &mut Command) -> io::Result<Self> {
        leading(command);
        // Locked while it starts: what ends all groups must know it.
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
    ///
    /// # Errors
    /// The system's.
    pub(crate) fn wait(&mut self, limit: Duration) -> io::Result<Option<ExitStatus>> {
        let status = self.child.wait_timeout(limit)?;
        let over = running().over;
        if over {
            stay();
        }
        Ok(status)
    }
}

/// The program is being ended: what becomes of a solver now is no result, and nobody is to record it as one.
fn stay() -> ! {
    loop {
        std::thread::park();
    }
}

impl Drop for Group {
    fn drop(&mut self) {
        let leader = self.child.id();
        let child = &mut self.child;
        // A leader that nobody waits for stays a member of its group.
        end(&[leader], || _ = child.try_wait());
        let _ = child.kill();
        let _ = child.wait();
        running().leaders.retain(|own| *own != leader);
    }
}

/// Ends all solvers that run, and lets none begin: called by what ends the program.
pub fn end_solvers() {
    let mut running = running();
    running.over = true;
    let leaders = std::mem::take(&mut running.leaders);
    drop(running);
    end(&leaders, || ());
}

/// Asks the groups to end, and ends what is left of them after a while.
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

/// What a group is told.
#[derive(Debug, Clone, Copy)]
enum Signal {
    /// Nothing: asks whether there is anybody.
    None,
    /// The process is asked to end.
    End,
    /// Nothing, it is ended.
    Kill,
}

#[cfg(unix)]
fn leading(command: &mut Command) {
    std::os::unix::process::CommandExt::process_group(command, 0);
}

/// Whether there was anybody to tell.
#[cfg(unix)]
fn signal(leader: u32, what: Signal) -> bool {
    use nix::sys::signal::{Signal as Own, killpg};
    use nix::unistd::Pid;
    let own = match what {
        Signal::None => None,
        Signal::End => Some(Own::SIGTERM),
        Signal::Kill => Some(Own::SIGKILL),
    };
    // 0 and 1 would be this program's own group, or everybody.
    i32::try_from(leader).is_ok_and(|id| id > 1 && killpg(Pid::from_raw(id), own).is_ok())
}

/// Other systems have no groups here: the leader is ended alone.
#[cfg(not(unix))]
fn leading(_: &mut Command) {}

#[cfg(not(unix))]
fn signal(_: u32, _: Signal) -> bool {
    false
}
