//! Files that are either the old one or the new one, never half of it.

use std::ffi::OsString;
use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

/// A file that is written beside its place, and stands there when it is finished. Given up, it leaves nothing. What is no
/// file, a device or a pipe, stays what it is and is written as it comes.
#[derive(Debug)]
pub struct Replacement {
    path: PathBuf,
    /// None where there is no file to replace.
    partial: Option<PathBuf>,
    file: BufWriter<File>,
}

impl Replacement {
    /// Begins the file that is to stand at `path`.
    ///
    /// # Errors
    /// What the file system reports.
    pub fn create(path: &Path) -> io::Result<Self> {
        // A link stays, and what it names is replaced.
        let path = fs::canonicalize(path).unwrap_or_else(|_| path.to_owned());
        if fs::metadata(&path).is_ok_and(|known| !known.is_file()) {
            let file = BufWriter::new(File::options().write(true).open(&path)?);
            return Ok(Self { path, partial: None, file });
        }
        let mut name = path.file_name().map_or_else(OsString::new, OsString::from);
        name.push(format!(".{}.partial", std::process::id()));
        let partial = path.with_file_name(name);
        let file = BufWriter::new(File::create(&partial)?);
        Ok(Self { path, partial: Some(partial), file })
    }

    /// Renames the file over an older one.
    ///
    /// # Errors
    /// What the file system reports; the old file is then still there.
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
    /// After the rename there is nothing to remove; the error to report was the first one.
    fn drop(&mut self) {
        if let Some(partial) = &self.partial {
            let _ = fs::remove_file(partial);
        }
    }
}

/// Puts `bytes` at `path` in one step.
///
/// # Errors
/// What the file system reports; the old file is then still there.
pub fn replace_file(path: &Path, bytes: &[u8]) -> io::Result<()> {
    let mut file = Replacement::create(path)?;
    file.write_all(bytes)?;
    file.finish()
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
        fs::remove_dir_all(&folder).unwrap();
    }

    /// What a link names is replaced, not the link.
    #[cfg(unix)]
    #[test]
    fn links_stay_what_they_are() {
        let folder = std::env::temp_dir().join(format!("gronwall-link-{}", std::process::id()));
        fs::create_dir_all(&folder).unwrap();
        let [file, link] = ["file", "link"].map(|name| folder.join(name));
        fs::write(&file, b"old").unwrap();
        std::os::unix::fs::symlink(&file, &link).unwrap();
        replace_file(&link, b"new").unwrap();
        assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
        assert_eq!(fs::read(&file).unwrap(), b"new");
        fs::remove_dir_all(&folder).unwrap();
    }
}
