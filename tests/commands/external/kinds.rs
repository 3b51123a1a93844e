//! What is no file is refused at once: a pipe without a writer is not waited for, and a device is not read.

use std::os::unix::fs::symlink;
use std::os::unix::net::UnixListener;
use std::process::Command;
use std::sync::mpsc::channel;
use std::time::Duration;

use run::external::read_displacements;

use crate::program::{Folder, code, command, stderr, stdout};

/// No assertion about speed: what hangs does so for ever.
const LONG: Duration = Duration::from_secs(120);

fn pipe(path: &str) {
    assert!(Command::new("mkfifo").arg(path).status().expect("mkfifo runs").success());
}

/// Makes one of these at the path: what it is called in messages.
fn make(kind: usize, path: &str) -> &'static str {
    match kind {
        0 => {
            pipe(path);
            "it is a pipe"
        }
        1 => {
            std::fs::create_dir(path).expect("a directory");
            "it is a directory"
        }
        2 => {
            drop(UnixListener::bind(path).expect("a socket"));
            "it is a socket"
        }
        _ => {
            symlink("/dev/zero", path).expect("a link");
            "it is a device"
        }
    }
}

/// Reads the answer in a folder; the test fails if that takes for ever.
fn said(folder: &Folder) -> String {
    let (tell, told) = channel();
    let dir = folder.at(".");
    std::thread::spawn(move || {
        let outcome = read_displacements(&dir, [3, 2, 2], None);
        // Nobody listens any more where the test has failed.
        let _ = tell.send(outcome.expect_err("no answer").to_string());
    });
    told.recv_timeout(LONG).expect("an end of reading")
}

#[test]
fn an_answer_that_is_no_file_is_refused() {
    for kind in 0..4 {
        for name in ["displacement.npy", "displacement.csv"] {
            let folder = Folder::new("kinds");
            let words = make(kind, &folder.argument(name));
            let found = said(&folder);
            assert!(found.contains(words) && found.contains(name), "{found}");
        }
    }
}

/// The program to its end, which must come.
fn ended(arguments: &[&str]) -> std::process::Output {
    let mut program = command(arguments);
    let (tell, told) = channel();
    std::thread::spawn(move || _ = tell.send(program.output().expect("the binary runs")));
    told.recv_timeout(LONG).expect("an end of the program")
}

#[test]
fn a_solver_that_leaves_a_pipe_makes_a_failed_case() {
    let folder = Folder::new("kinds-solver");
    let out = folder.argument("out");
    for (name, more) in [("displacement.npy", &[][..]), ("displacement.csv", &["--pressure"])] {
        let solver = format!("sh {}", folder.file("pipe.sh", &format!("mkfifo \"$1/{name}\"\n")));
        let arguments =
            ["verify", "signorini", "--n", "4", "--steps", "2", "--out", &out, "--solver", &solver];
        let output = ended(&[&arguments[..], more].concat());
        let said = stdout(&output) + &stderr(&output);
        assert!(code(&output) == 2 && said.contains("it is a pipe"), "{said}");
    }
}

#[test]
fn scenes_and_meshes_that_are_no_files_are_refused() {
    let folder = Folder::new("kinds-scene");
    let scene = folder.argument("pipe.toml");
    pipe(&scene);
    let output = ended(&["check", &scene]);
    assert_eq!(code(&output), 2);
    assert!(stderr(&output).contains("it is a pipe"), "{}", stderr(&output));
    // A device has the length 0, and no end.
    let text = super::text("frustum").replace("frustum.msh", "zero.msh");
    let scene = folder.file("frustum.toml", &text);
    symlink("/dev/zero", folder.at("zero.msh")).expect("a link");
    let output = ended(&["check", &scene]);
    assert_eq!(code(&output), 2);
    assert!(stderr(&output).contains("it is a device"), "{}", stderr(&output));
}
