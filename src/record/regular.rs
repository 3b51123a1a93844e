//! Files that are files: a pipe without a writer is never opened to wait for one, and a device has no end.

use std::fs::File;
use std::io;
use std::path::Path;

/// Opens a regular file to read it; what is none is refused at once.
///
/// # Errors
/// What the file system says, or what stands there in place of a file.
pub fn open_file(path: &Path) -> io::Result<File> {
    // Asked first, as opening alone does things to some devices; and asked again, as another program may be at work.
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

fn refuse_others(found: &std::fs::Metadata) -> io::Result<()> {
    if found.is_file() {
        return Ok(());
    }
    let reason = format!("it is {}, where a file is wanted", kind(found));
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
