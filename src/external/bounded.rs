//! Files of another program, read if they are no longer than what they are to hold can be.

use std::fs::File;
use std::io::Read;
use std::path::{Component, Path};

/// The most bytes of a file with so many parts.
#[derive(Debug, Clone, Copy)]
pub struct Bound {
    /// For what is there once.
    pub first: u64,
    /// For each part.
    pub each: u64,
}

impl Bound {
    /// Of a file with `count` parts.
    pub fn of(self, count: usize) -> u64 {
        self.first.saturating_add(self.each.saturating_mul(count as u64))
    }
}

/// Opens a file, if it is not longer than `most` bytes.
///
/// # Errors
/// What the file system says, or both lengths.
pub fn open_bounded(path: &Path, most: u64) -> Result<File, String> {
    let file = File::open(path).map_err(|error| error.to_string())?;
    let length = file.metadata().map_err(|error| error.to_string())?.len();
    if length > most {
        return Err(format!("{length} bytes, where at most {most} can be needed"));
    }
    Ok(file)
}

/// Reads a file, if it is not longer than `most` bytes.
///
/// # Errors
/// Those of [`open_bounded`].
pub fn read_bounded(path: &Path, most: u64) -> Result<Vec<u8>, String> {
    let mut bytes = Vec::new();
    // A file may grow meanwhile, and a pipe has no length.
    open_bounded(path, most)?
        .take(most)
        .read_to_end(&mut bytes)
        .map_err(|error| error.to_string())?;
    Ok(bytes)
}

/// Whether a name that a file gives is that of a file below its directory.
pub fn is_below(file: &str) -> bool {
    let within = |part| matches!(part, Component::Normal(_) | Component::CurDir);
    !file.is_empty() && Path::new(file).components().all(within)
}
