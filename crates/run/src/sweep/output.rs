//! The directory of a sweep, locked by one process.

use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::{self, Read, Write};
use std::path::{Path, PathBuf};

use files::{FileError, make_directory};

/// Why a directory cannot be written to.
#[derive(Debug, thiserror::Error)]
pub enum OutputError {
    #[error("{0}; choose another directory with --out")]
    Io(#[from] FileError),
    #[error(
        "{}: {holder} is writing here; wait until it has finished, or choose another directory with --out",
        path.display()
    )]
    Held { path: PathBuf, holder: String },
}

/// A locked directory. The system releases the lock when the process ends, however it ends.
#[derive(Debug)]
pub struct OutputDirectory {
    path: PathBuf,
    _lock: File,
}

/// The locked file; it contains the process number, for the message of another process.
const LOCK: &str = ".lock";

impl OutputDirectory {
    /// Creates the directory if necessary, and locks it.
    ///
    /// # Errors
    /// [`OutputError`]. A file system without locks is accepted.
    pub fn take(path: &Path) -> Result<Self, OutputError> {
        let refused = FileError::at(path);
        make_directory(path)?;
        let file = path.join(LOCK);
        // The target of a link is not ours.
        if fs::symlink_metadata(&file).is_ok_and(|known| known.is_symlink()) {
            fs::remove_file(&file).map_err(&refused)?;
        }
        let open =
            OpenOptions::new().read(true).write(true).create(true).truncate(false).open(file);
        let mut lock = open.map_err(&refused)?;
        match lock.try_lock() {
            Ok(()) => {
                let number = format!("process {}", std::process::id());
                let written = lock.set_len(0).and_then(|()| lock.write_all(number.as_bytes()));
                written.map_err(&refused)?;
            }
            Err(TryLockError::WouldBlock) => {
                let mut holder = String::new();
                if lock.read_to_string(&mut holder).is_err() || holder.is_empty() {
                    holder = "another sweep".into();
                }
                return Err(OutputError::Held { path: path.to_owned(), holder });
            }
            Err(TryLockError::Error(error)) if error.kind() == io::ErrorKind::Unsupported => {}
            Err(TryLockError::Error(error)) => return Err(refused(error).into()),
        }
        Ok(Self { path: path.to_owned(), _lock: lock })
    }

    /// Where it is.
    pub fn path(&self) -> &Path {
        &self.path
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_directory_is_held_once_and_given_back() {
        let path = std::env::temp_dir().join(format!("gronwall-output-{}", std::process::id()));
        let held = OutputDirectory::take(&path).unwrap();
        let second = OutputDirectory::take(&path).unwrap_err().to_string();
        assert!(second.contains(&format!("process {}", std::process::id())), "{second}");
        assert!(second.contains("--out"), "{second}");
        drop(held);
        drop(OutputDirectory::take(&path).unwrap());
        // A file in its place.
        let file = path.join("file");
        fs::write(&file, "").unwrap();
        assert!(matches!(OutputDirectory::take(&file), Err(OutputError::Io(_))));
        fs::remove_dir_all(&path).unwrap();
    }
}
