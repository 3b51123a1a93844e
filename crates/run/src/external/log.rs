//! What a solver prints: kept in a file that does not grow for ever, shown by its last lines.

use std::fs::File;
use std::io::{self, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use files::{open_file, remove_if_there, shortened};

/// The file in the directory of a case.
pub const LOG: &str = "solver.log";
/// A longer log loses all but its end.
const MOST: u64 = 16 << 20;
/// That end, and what is looked at for last lines.
const END: u64 = 1 << 16;
/// Characters of the last line, which stands in the reason of a failed case.
const WIDTH: usize = 400;

/// The log of a solver that runs.
pub(crate) struct Log {
    path: PathBuf,
    file: File,
}

impl Log {
    /// An empty one in `dir`, in place of an older one of any kind.
    ///
    /// # Errors
    /// The file system's.
    pub(crate) fn new(dir: &Path) -> io::Result<Self> {
        let path = dir.join(LOG);
        remove_if_there(&path)?;
        // What is appended comes after the end, wherever that is by then.
        let file = File::options().append(true).create_new(true).open(&path)?;
        Ok(Self { path, file })
    }

    /// For the solver to write to.
    ///
    /// # Errors
    /// The system's.
    pub(crate) fn handle(&self) -> io::Result<File> {
        self.file.try_clone()
    }

    /// Lets all but the end go of a log that has become too long, and says so in it.
    ///
    /// # Errors
    /// The file system's.
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

    /// `: ` and the last line with something in it, cut if it is long; empty where there is none.
    pub(crate) fn last_line(&self) -> String {
        let lines = last_lines(&self.path);
        let last = lines.iter().rfind(|line| !line.trim().is_empty());
        last.map_or(String::new(), |line| format!(": {}", shortened(line.trim(), WIDTH)))
    }
}

/// The end of what a solver printed, as it stands in its log; nothing where there is none.
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
