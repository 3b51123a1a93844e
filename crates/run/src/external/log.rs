//! Log of a solver: a file of bounded length, and its last lines.

use std::fs::File;
use std::io::{self, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use files::{open_file, remove_if_there, shortened};

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

    /// A handle for the solver to write to.
    pub(crate) fn handle(&self) -> io::Result<File> {
        self.file.try_clone()
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
