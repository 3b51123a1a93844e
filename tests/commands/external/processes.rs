//! A solver ends with all that it has started, however it ends, and its log is no longer than it can be shown.

use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use run::external::encode;

use super::verify;
use crate::program::{Folder, code, command, stderr, stdout};

/// No assertion about speed: what should end has ended long before.
const LONG: Duration = Duration::from_secs(120);

fn eventually(what: &str, mut holds: impl FnMut() -> bool) {
    let begin = Instant::now();
    while !holds() {
        assert!(begin.elapsed() < LONG, "not within two minutes: {what}");
        std::thread::sleep(Duration::from_millis(20));
    }
}

/// The process whose id a script has written, if it is more than an entry that nobody has asked for yet.
fn runs(pid: &Path) -> bool {
    let pid = std::fs::read_to_string(pid).expect("an id");
    let state = Command::new("ps").args(["-o", "stat=", "-p", pid.trim()]).output().expect("ps");
    let state = String::from_utf8_lossy(&state.stdout).trim().to_owned();
    !state.is_empty() && !state.starts_with('Z')
}

/// A script that starts a process which would go on for ten minutes, and does `then`.
fn with_a_child(folder: &Folder, name: &str, child: &str, then: &str) -> String {
    let pid = folder.argument("pid");
    let text = format!("{child} &\necho $! > {pid}.new\nmv {pid}.new {pid}\n{then}\n");
    format!("sh {}", folder.file(name, &text))
}

#[test]
fn children_end_with_a_solver_that_is_stopped_or_leaves_them_behind() {
    let folder = Folder::new("external-children");
    let zero = encode(&[3, 25, 2], &[0.0; 150]);
    std::fs::write(folder.at("zero.npy"), zero).expect("a file");
    let answer = format!("cp {} \"$1/displacement.npy\"", folder.argument("zero.npy"));
    let deaf = "sh -c 'trap \"\" TERM; sleep 600 & wait; wait'";
    for (child, then, says) in [
        ("sleep 600", "wait", "stopped after 1 s"),
        (deaf, "wait", "stopped after 1 s"),
        ("sleep 600", answer.as_str(), "1 case, 0 failed"),
        ("sleep 600", "exit 3", "status: 3"),
    ] {
        let solver = with_a_child(&folder, "starts.sh", child, then);
        // An answer takes no second, but a machine may be busy.
        let limit = if says.starts_with("stopped") { "1" } else { "60" };
        let output = verify(&folder, &solver, &["--time-limit", limit]);
        let said = stdout(&output) + &stderr(&output);
        assert!(said.contains(says), "{child}, {then}: {said}");
        eventually("the child of the solver ends", || !runs(&folder.at("pid")));
        std::fs::remove_file(folder.at("pid")).expect("an id");
    }
}

/// Ended when a test fails.
struct Program(Child);

impl Drop for Program {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

#[test]
fn what_ends_the_program_ends_its_solvers() {
    for signal in ["TERM", "INT", "HUP"] {
        let folder = Folder::new("external-signal");
        let solver = with_a_child(&folder, "starts.sh", "sleep 600", "wait");
        let (out, pid) = (folder.argument("out"), folder.at("pid"));
        let arguments =
            ["verify", "signorini", "--n", "4", "--steps", "2", "--out", &out, "--solver", &solver];
        let mut program = command(&arguments);
        program.stdout(Stdio::null()).stderr(Stdio::null());
        let mut program = Program(program.spawn().expect("a process"));
        eventually("the solver starts a child", || pid.exists());
        let id = program.0.id().to_string();
        let sent = Command::new("kill").args(["-s", signal, &id]).status().expect("kill");
        assert!(sent.success());
        let mut status = None;
        eventually("the program ends", || {
            status = program.0.try_wait().expect("a status");
            status.is_some()
        });
        assert!(!status.is_some_and(|status| status.success()), "{signal}: {status:?}");
        eventually("the child of its solver ends", || !runs(&pid));
        // A solver that was ended so has not failed.
        let records = std::fs::read_to_string(folder.at("out/cases.csv")).unwrap_or_default();
        assert!(!records.contains("failed"), "{signal}: {records}");
    }
}

#[test]
fn a_log_is_kept_short_and_shown_by_its_end() {
    let folder = Folder::new("external-log");
    let log = folder.at("out/cases/signorini/n4-N2/solver.log");
    let length = || std::fs::metadata(&log).expect("a log").len();
    let script = |name: &str, text: &str| format!("sh {}", folder.file(name, text));
    // Without an end.
    let endless = script("endless.sh", "exec yes 'still at it'\n");
    let output = verify(&folder, &endless, &["--time-limit", "2"]);
    let said = stdout(&output) + &stderr(&output);
    assert!(code(&output) == 2 && said.contains("stopped after 2 s"), "{said}");
    assert!(length() <= 17 << 20, "{} bytes", length());
    // 40 MB, of which what is kept says that there was more.
    let text = "yes 'still at it' | head -c 40000000\nsleep 1\necho out of memory >&2\nexit 3\n";
    let output = verify(&folder, &script("much.sh", text), &[]);
    let said = stdout(&output) + &stderr(&output);
    assert!(code(&output) == 2 && said.contains("out of memory"), "{said}");
    let kept = std::fs::read_to_string(&log).expect("a log");
    assert!(kept.len() <= 17 << 20 && kept.contains("earlier output left out"), "{}", kept.len());
    // A line of 5 MB with an end that says why.
    let text =
        "head -c 5000000 /dev/zero | tr '\\0' x\necho\necho the matrix is singular\nexit 3\n";
    let output = verify(&folder, &script("line.sh", text), &[]);
    let said = stdout(&output) + &stderr(&output);
    assert!(said.contains("the matrix is singular") && said.contains("bytes more)"), "{said}");
    assert!(code(&output) == 2 && said.len() < 10_000, "{} letters", said.len());
    for file in ["index.html", "verdict.json"] {
        let page = std::fs::metadata(folder.at("out").join(file)).expect("a page").len();
        assert!(page < 1 << 20, "{file}: {page} bytes");
    }
    // A log that was something else before is a file now.
    std::fs::remove_file(&log).expect("a log");
    assert!(Command::new("mkfifo").arg(&log).status().expect("mkfifo runs").success());
    let output = verify(&folder, &script("short.sh", "echo hello\nexit 3\n"), &[]);
    assert!(stdout(&output).contains("hello"), "{}", stdout(&output));
}

/// A cell of a table, the name of an array: as long as a solver likes, and cut where it is quoted.
#[test]
fn what_a_reason_quotes_of_an_answer_is_cut() {
    let folder = Folder::new("external-quotes");
    let text = "{ echo n,vertex,ux,uy; printf '0,0,'; head -c 15000 /dev/zero | tr '\\0' x; echo ,0; } > \"$1/displacement.csv\"\n";
    let output = verify(&folder, &format!("sh {}", folder.file("cell.sh", text)), &[]);
    let said = stdout(&output) + &stderr(&output);
    assert!(code(&output) == 2 && said.contains("bytes more)"), "{} letters", said.len());
    // Shown as the case ends and in the list of failures; the whole cell alone would be longer each time.
    assert!(said.len() < 15_000, "{} letters", said.len());
}
