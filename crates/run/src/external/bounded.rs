//! Bounded reading of another program's files: regular files only, with limits of length and time.

use std::fs::File;
use std::io::{self, Read};
use std::path::Path;
use std::time::Instant;

use files::open_file;

/// The most bytes that a file has with so many for itself and for each of its entries.
pub(crate) fn most_bytes([first, each]: [u64; 2], count: usize) -> u64 {
    first.saturating_add(each.saturating_mul(count as u64))
}

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

/// Opens a regular file of at most `most` bytes.
///
/// # Errors
/// The file system refuses, or the file is longer: both lengths.
pub(crate) fn open_bounded(path: &Path, most: u64, until: Until) -> Result<Timed, String> {
    let file = Timed::open(path, until).map_err(|error| error.to_string())?;
    if file.length > most {
        return Err(format!("{} bytes, but at most {most} can be needed", file.length));
    }
    Ok(file)
}
