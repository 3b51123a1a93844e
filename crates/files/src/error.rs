use std::io;
use std::path::{Path, PathBuf};

/// A file or folder that cannot be read or written.
#[derive(Debug, thiserror::Error)]
#[error("{}: {source}", path.display())]
pub struct FileError {
    pub path: PathBuf,
    pub source: io::Error,
}

impl FileError {
    /// What becomes of an error at a path.
    pub fn at(path: &Path) -> impl Fn(io::Error) -> Self + '_ {
        |source| Self { path: path.to_owned(), source }
    }
}

/// What was read, or None if there is no such file.
///
/// # Errors
/// All others.
pub fn if_there<T>(read: Result<T, FileError>) -> Result<Option<T>, FileError> {
    match read {
        Err(error) if error.source.kind() == io::ErrorKind::NotFound => Ok(None),
        other => other.map(Some),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::read_file;

    #[test]
    fn only_what_is_not_there_is_none() {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR"));
        assert!(if_there(read_file(&folder.join("none"))).unwrap().is_none());
        assert!(if_there(read_file(&folder.join("Cargo.toml"))).unwrap().is_some());
        let error = if_there(read_file(folder)).unwrap_err();
        let expected = format!("{}: it is a directory, but a file is needed", folder.display());
        assert_eq!(error.to_string(), expected);
    }
}
