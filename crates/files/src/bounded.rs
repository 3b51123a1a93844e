//! Bounded reading: devices and pipes in place of files are refused, or read up to a limit.

use std::fs::File;
use std::io::{self, Read};
use std::path::Path;

use super::FileError;

/// Size limit of files in a directory of records: 4 GiB, a table of ten million rows.
const MOST: u64 = 1 << 32;

/// Opens a regular file for reading; anything else is refused at once.
///
/// # Errors
/// The file system refuses, or something else is there in place of a file.
pub fn open_file(path: &Path) -> io::Result<File> {
    // Checked before opening, since that alone has effects on some devices, and again after, against races.
    refuse_others(&std::fs::metadata(path)?)?;
    let mut options = File::options();
    options.read(true);
    #[cfg(unix)]
    {
        use std::os::unix::fs::OpenOptionsExt;
        options.custom_flags(nix::libc::O_NONBLOCK);
    }
    let file = options.open(path)?;
    refuse_others(&file.metadata()?)?;
    Ok(file)
}

/// The bytes of a file of at most 4 GiB.
pub fn read_file(path: &Path) -> Result<Vec<u8>, FileError> {
    read_file_up_to(path, MOST)
}

/// The bytes of a file of at most `most`.
///
/// # Errors
/// As [`open_file`], and [`io::ErrorKind::FileTooLarge`].
pub fn read_file_up_to(path: &Path, most: u64) -> Result<Vec<u8>, FileError> {
    open_file(path).and_then(|file| up_to(file, most)).map_err(FileError::at(path))
}

/// The text of a file of at most 4 GiB.
///
/// # Errors
/// As [`read_file`], and [`io::ErrorKind::InvalidData`] if it is not UTF-8.
pub fn read_text(path: &Path) -> Result<String, FileError> {
    let not_text = |error| io::Error::new(io::ErrorKind::InvalidData, error);
    String::from_utf8(read_file(path)?).map_err(not_text).map_err(FileError::at(path))
}

/// At most `most` bytes of a file or pipe named by a user.
///
/// # Errors
/// The file system refuses; [`io::ErrorKind::FileTooLarge`].
pub fn read_at_most(path: &Path, most: u64) -> Result<Vec<u8>, FileError> {
    File::open(path).and_then(|file| up_to(file, most)).map_err(FileError::at(path))
}

/// The bytes of a source, at most `most`.
///
/// # Errors
/// The source's; [`io::ErrorKind::FileTooLarge`].
pub fn up_to(source: impl Read, most: u64) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    source.take(most + 1).read_to_end(&mut bytes)?;
    if bytes.len() as u64 > most {
        let reason = format!("more than {} MiB", most >> 20);
        return Err(io::Error::new(io::ErrorKind::FileTooLarge, reason));
    }
    Ok(bytes)
}

fn refuse_others(found: &std::fs::Metadata) -> io::Result<()> {
    if found.is_file() {
        return Ok(());
    }
    let reason = format!("it is {}, but a file is needed", kind(found));
    Err(io::Error::new(io::ErrorKind::InvalidInput, reason))
}

fn kind(found: &std::fs::Metadata) -> &'static str {
    if found.is_dir() {
        return "a directory";
    }
    #[cfg(unix)]
    {
        use std::os::unix::fs::FileTypeExt;
        let kind = found.file_type();
        if kind.is_fifo() {
            return "a pipe";
        }
        if kind.is_socket() {
            return "a socket";
        }
        if kind.is_char_device() || kind.is_block_device() {
            return "a device";
        }
    }
    "no regular file"
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_has_no_end_is_refused() {
        let zero = Path::new("/dev/zero");
        if zero.exists() {
            assert_eq!(read_file(zero).unwrap_err().source.kind(), io::ErrorKind::InvalidInput);
            let error = read_at_most(zero, 1 << 20).unwrap_err();
            assert_eq!(error.source.to_string(), "more than 1 MiB");
        }
        assert!(
            read_text(&Path::new(env!("CARGO_MANIFEST_DIR")).join("src/bounded.rs"))
                .is_ok_and(|text| text.contains("comes to an end"))
        );
        assert_eq!(
            read_file(Path::new("none")).unwrap_err().source.kind(),
            io::ErrorKind::NotFound
        );
    }
}
