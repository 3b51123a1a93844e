//! Runs another program on one case under a time limit.

use files::{open_file, remove_if_there, shortened};
use std::fs::File;
use std::io;
use std::io::{Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, ExitStatus, Stdio};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};
use wait_timeout::ChildExt;

/// Interval for shortening its log.
const LOOK: Duration = Duration::from_millis(100);

/// Why a program gave no answer.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum ProcessError {
    #[error("`{program}` cannot be started: {reason}")]
    Start { program: String, reason: String },
    #[error("the solver was stopped after {0} s: --time-limit gives it longer")]
    TooLong(u64),
    /// It ended with a nonzero status.
    #[error("the solver ended with {status}{said}")]
    Failed { status: String, said: String },
}

/// Runs `words` with `dir` as last argument, in the current working directory. All processes that it starts end with
/// it.
///
/// # Errors
/// [`ProcessError`]; its message includes the last line that the program printed.
pub(crate) fn run(words: &[String], dir: &Path, limit: Duration) -> Result<(), ProcessError> {
    let start = |program: &str, reason| ProcessError::Start { program: program.into(), reason };
    let (program, arguments) = words.split_first().ok_or_else(|| start("", "no command".into()))?;
    let watched = || -> io::Result<(Option<ExitStatus>, Log)> {
        let mut log = Log::new(dir)?;
        let mut command = Command::new(program);
        command.args(arguments).arg(dir).stdin(Stdio::null());
        command.stdout(log.file.try_clone()?).stderr(log.file.try_clone()?);
        let (mut group, begin) = (ProcessGroup::start(&mut command)?, Instant::now());
        let status = loop {
            let left = limit.saturating_sub(begin.elapsed());
            let status = group.wait(left.min(LOOK))?;
            if status.is_some() || left.is_zero() {
                break status;
            }
            log.keep_short()?;
        };
        // Remaining children would write no reliable answer and slow down the next case.
        drop(group);
        log.keep_short()?;
        Ok((status, log))
    };
    match watched().map_err(|error| start(program, error.to_string()))? {
        (None, _) => Err(ProcessError::TooLong(limit.as_secs())),
        (Some(status), _) if status.success() => Ok(()),
        (Some(status), log) => {
            Err(ProcessError::Failed { status: status.to_string(), said: log.last_line() })
        }
    }
}

// A solver and the processes that it starts, as one process group, ended together. A daemon that leaves the group
// is not followed.

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

// Log of a solver: a file of bounded length, and its last lines.

/// The file in the directory of a case.
pub const LOG: &str = "solver.log";
/// Length beyond which a log is cut to its end.
const MOST: u64 = 16 << 20;
/// Length of that end, in which last lines are sought.
const END: u64 = 1 << 16;
/// Characters kept of the last line, for the reason of a failed case.
const WIDTH: usize = 400;

pub(crate) struct Log {
    path: PathBuf,
    file: File,
}

impl Log {
    /// Creates an empty log in `dir`, replacing any older one.
    ///
    /// # Errors
    /// The file system refuses.
    pub(crate) fn new(dir: &Path) -> io::Result<Self> {
        let path = dir.join(LOG);
        remove_if_there(&path).map_err(|error| error.source)?;
        // Appends stay valid when the file is cut.
        let file = File::options().append(true).create_new(true).open(&path)?;
        Ok(Self { path, file })
    }

    /// Cuts a log that has become too long to its end, and notes that in it.
    pub(crate) fn keep_short(&mut self) -> io::Result<()> {
        let length = self.file.metadata()?.len();
        if length <= MOST {
            return Ok(());
        }
        let (end, _) = end_of(&self.path)?;
        self.file.set_len(0)?;
        write!(self.file, "[earlier output left out: the log was {length} bytes long]\n… ")?;
        self.file.write_all(&end)
    }

    /// `: ` and the last nonempty line, truncated; empty if there is none.
    pub(crate) fn last_line(&self) -> String {
        let lines = last_lines(&self.path);
        let last = lines.iter().rfind(|line| !line.trim().is_empty());
        last.map_or(String::new(), |line| format!(": {}", shortened(line.trim(), WIDTH)))
    }
}

/// The last lines of a log; empty if there is none.
pub fn last_lines(log: &Path) -> Vec<String> {
    let Ok((bytes, cut)) = end_of(log) else { return Vec::new() };
    let mut lines: Vec<String> =
        String::from_utf8_lossy(&bytes).lines().map(str::to_owned).collect();
    if let Some(first) = lines.first_mut().filter(|_| cut) {
        *first = format!("… {first}");
    }
    lines
}

/// The last bytes of a file, and whether there are others before them.
fn end_of(path: &Path) -> io::Result<(Vec<u8>, bool)> {
    let mut file = open_file(path)?;
    let before = file.metadata()?.len().saturating_sub(END);
    file.seek(SeekFrom::Start(before))?;
    let mut bytes = Vec::new();
    file.take(END).read_to_end(&mut bytes)?;
    Ok((bytes, before > 0))
}

// Bounded reading of another program's files: regular files only, with limits of length and time.

/// Deadline for reading, if any.
pub(crate) type Until = Option<Instant>;

/// A file under a time limit.
#[derive(Debug)]
pub(crate) struct Timed {
    file: File,
    until: Until,
    /// Length of the file when it was opened.
    pub length: u64,
    pub place: u64,
}

/// Bytes read between two checks of the clock.
const PIECE: usize = 1 << 20;

impl Timed {
    /// Opens a regular file.
    ///
    /// # Errors
    /// As [`open_file`].
    pub(crate) fn open(path: &Path, until: Until) -> io::Result<Self> {
        let file = open_file(path)?;
        let length = file.metadata()?.len();
        Ok(Self { file, until, length, place: 0 })
    }
}

impl Read for Timed {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        if self.until.is_some_and(|until| Instant::now() >= until) {
            let reason =
                "could not be read within the time limit of its case: --time-limit raises it";
            return Err(io::Error::new(io::ErrorKind::TimedOut, reason));
        }
        let most = buffer.len().min(PIECE);
        let count = self.file.read(&mut buffer[..most])?;
        self.place += count as u64;
        Ok(count)
    }
}
