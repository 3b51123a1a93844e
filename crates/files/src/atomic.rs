//! Atomic replacement of files.

use std::ffi::{OsStr, OsString};
use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use std::time::Duration;

use super::{FileError, fnv_1a, if_there};

/// A file written beside its target and renamed over it when finished; dropped unfinished, it is removed.
#[derive(Debug)]
pub struct Replacement {
    path: PathBuf,
    /// None if the target is not a regular file.
    partial: Option<PathBuf>,
    file: BufWriter<File>,
}

impl Replacement {
    /// Begins a file of a directory of records. A link at its place is replaced, and its target left alone.
    pub fn create(path: &Path) -> io::Result<Self> {
        let partial = path.with_file_name(partial_name(path.file_name().unwrap_or_default()));
        // Removes an older file of this number, or a link, without writing to its target.
        let _ = fs::remove_file(&partial);
        let file = BufWriter::new(File::create_new(&partial)?);
        Ok(Self { path: path.to_owned(), partial: Some(partial), file })
    }

    /// Begins a file named by a user. A link is followed and its target replaced; a device or pipe is written directly.
    /// What the file system reports.
    pub(crate) fn named(path: &Path) -> io::Result<Self> {
        let path = fs::canonicalize(path).unwrap_or_else(|_| path.to_owned());
        if fs::metadata(&path).is_ok_and(|known| !known.is_file()) {
            let file = BufWriter::new(File::options().write(true).open(&path)?);
            return Ok(Self { path, partial: None, file });
        }
        Self::create(&path)
    }

    /// Renames the file over an older one.
    ///
    /// # Errors
    /// The file system refuses; the old file is then still there.
    pub fn finish(mut self) -> io::Result<()> {
        self.file.flush()?;
        match &self.partial {
            None => Ok(()),
            Some(partial) => {
                self.file.get_ref().sync_all()?;
                fs::rename(partial, &self.path)
            }
        }
    }
}

impl Write for Replacement {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.file.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.file.flush()
    }
}

impl Drop for Replacement {
    /// After the rename there is nothing to remove; the first error was reported.
    fn drop(&mut self) {
        if let Some(partial) = &self.partial {
            let _ = fs::remove_file(partial);
        }
    }
}

/// Replaces `path` by `bytes` atomically, as [`Replacement::create`].
///
/// # Errors
/// The file system refuses; the old file is then still there.
pub fn replace_file(path: &Path, bytes: &[u8]) -> Result<(), FileError> {
    finished(Replacement::create(path), bytes).map_err(FileError::at(path))
}

/// Writes `bytes` to a path named by a user, as `Replacement::named`.
///
/// # Errors
/// The file system refuses; an old file is then still there.
pub fn write_named(path: &Path, bytes: &[u8]) -> Result<(), FileError> {
    finished(Replacement::named(path), bytes).map_err(FileError::at(path))
}

fn finished(file: io::Result<Replacement>, bytes: &[u8]) -> io::Result<()> {
    let mut file = file?;
    file.write_all(bytes)?;
    file.finish()
}

/// Whether two paths are one file or directory, which exists.
pub fn same_file(a: &Path, b: &Path) -> bool {
    matches!((fs::canonicalize(a), fs::canonicalize(b)), (Ok(a), Ok(b)) if a == b)
}

/// Removes a file, or a link but not its target, if it exists.
pub fn remove_if_there(path: &Path) -> Result<(), FileError> {
    if_there(fs::remove_file(path).map_err(FileError::at(path))).map(|_| ())
}

/// Ending of unfinished files, after the number of the writing process.
const PARTIAL: &str = ".partial";
/// Limit of file names, in bytes.
const LONGEST_NAME: usize = 255;
/// Files are written in seconds; an older unfinished one was abandoned.
const GIVEN_UP: Duration = Duration::from_secs(3600);

fn partial_name(name: &OsStr) -> OsString {
    let end = format!(".{}{PARTIAL}", std::process::id());
    let mut partial = match name.len() + end.len() > LONGEST_NAME {
        true => {
            let bytes = name.as_encoded_bytes().iter().copied();
            OsString::from(format!("{:016x}", fnv_1a(bytes)))
        }
        false => name.to_owned(),
    };
    partial.push(end);
    partial
}

/// Creates a directory and its parents, and removes unfinished files of killed processes.
///
/// # Errors
/// The file system refuses the directory. An unfinished file that cannot be removed stays.
pub fn make_directory(path: &Path) -> Result<(), FileError> {
    let refused = FileError::at(path);
    fs::create_dir_all(path).map_err(&refused)?;
    for entry in fs::read_dir(path).map_err(&refused)? {
        let entry = entry.map_err(&refused)?;
        if is_left_over(&entry) {
            // Another process may have removed it.
            let _ = fs::remove_file(entry.path());
        }
    }
    Ok(())
}

/// Whether a file was left unfinished by a killed process.
fn is_left_over(entry: &fs::DirEntry) -> bool {
    let name = entry.file_name();
    let written_by = || name.to_str()?.strip_suffix(PARTIAL)?.rsplit_once('.')?.1.parse().ok();
    let Some(process): Option<u32> = written_by() else { return false };
    let Ok(known) = entry.metadata() else { return false };
    let processes = Path::new("/proc");
    match processes.join("self").exists() {
        true => known.is_file() && !processes.join(process.to_string()).exists(),
        // The list of processes is unknown on this system.
        false => {
            let age = known.modified().ok().and_then(|written| written.elapsed().ok());
            known.is_file() && age.is_some_and(|age| age > GIVEN_UP)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn replaces_and_leaves_nothing_behind() {
        let folder = std::env::temp_dir().join(format!("gronwall-atomic-{}", std::process::id()));
        fs::create_dir_all(&folder).unwrap();
        let path = folder.join("a.txt");
        replace_file(&path, b"one").unwrap();
        replace_file(&path, b"two").unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"two");
        assert_eq!(fs::read_dir(&folder).unwrap().count(), 1);
        assert!(replace_file(&folder.join("no/such/folder.txt"), b"").is_err());
        assert!(replace_file(&folder, b"").is_err() && folder.is_dir());
        let long = folder.join("x".repeat(LONGEST_NAME));
        replace_file(&long, b"long").unwrap();
        assert_eq!(fs::read(&long).unwrap(), b"long");
        fs::remove_dir_all(&folder).unwrap();
    }

    #[cfg(unix)]
    #[test]
    fn links_are_replaced_in_a_directory_and_followed_where_they_are_named() {
        let folder = std::env::temp_dir().join(format!("gronwall-link-{}", std::process::id()));
        fs::create_dir_all(&folder).unwrap();
        let [file, link] = ["file", "link"].map(|name| folder.join(name));
        fs::write(&file, b"old").unwrap();
        std::os::unix::fs::symlink(&file, &link).unwrap();
        write_named(&link, b"new").unwrap();
        assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
        assert_eq!(fs::read(&file).unwrap(), b"new");
        replace_file(&link, b"put").unwrap();
        assert!(fs::symlink_metadata(&link).unwrap().is_file());
        assert_eq!([fs::read(&file).unwrap(), fs::read(&link).unwrap()], [b"new", b"put"]);
        fs::remove_dir_all(&folder).unwrap();
    }

    #[test]
    fn unfinished_files_of_processes_that_are_gone_are_removed() {
        let folder = std::env::temp_dir().join(format!("gronwall-left-{}", std::process::id()));
        fs::create_dir_all(&folder).unwrap();
        let running = format!("a.csv.{}.partial", std::process::id());
        // No process has a number that long.
        let gone = "a.csv.4294967295.partial";
        let kept = ["a.csv", "a.partial", "b.x1.partial", &running];
        for name in kept.iter().chain([&gone]) {
            fs::write(folder.join(name), "").unwrap();
        }
        make_directory(&folder).unwrap();
        assert!(kept.iter().all(|name| folder.join(name).exists()));
        assert_eq!(folder.join(gone).exists(), !Path::new("/proc/self").exists());
        fs::remove_dir_all(&folder).unwrap();
    }
}
