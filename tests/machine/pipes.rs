//! A pipe or a device that an option names is written as it comes: it never becomes a file.

use std::os::unix::fs::FileTypeExt;
use std::process::Command;

use crate::program::{Folder, stderr, sweep};

#[test]
fn a_verdict_is_written_into_a_pipe() {
    let folder = Folder::new("pipe");
    let [pipe, out] = ["pipe", "out"].map(|name| folder.argument(name));
    assert!(Command::new("mkfifo").arg(&pipe).status().expect("mkfifo runs").success());
    let reader = std::thread::spawn({
        let pipe = pipe.clone();
        move || std::fs::read(pipe).expect("a pipe to read")
    });
    let arguments = ["gate", "affine", "--n", "2,4", "--steps", "4", "--quiet"];
    let output = sweep(&[&arguments[..], &["--out", &out, "--json", &pipe]].concat());
    // Asked before the reader is waited for: it would wait for ever at a pipe that is no more.
    let kind = std::fs::metadata(&pipe).expect("the pipe").file_type();
    assert!(kind.is_fifo(), "{}", stderr(&output));
    let read = reader.join().expect("what was written");
    let written = std::fs::read(folder.at("out/verdict.json")).expect("the verdict");
    assert!(!written.is_empty() && read == written, "{}", stderr(&output));
    assert_eq!(folder.names(), ["out", "pipe"]);
}
