//! Ends from outside: a batch system's SIGTERM, a terminal that is closed, a directory that is removed.

use std::process::{Command, Stdio};

use crate::program::{Folder, code, stderr};
use crate::resume::{arguments, interrupt_after, run_until, scenes};

#[test]
fn the_end_by_any_signal_says_how_to_go_on() {
    let folder = Folder::new("signals");
    let scenes = scenes(&folder);
    for (signal, expected) in [("-TERM", 143), ("-HUP", 129)] {
        let name = format!("out{signal}");
        let (out, table) = (folder.argument(&name), folder.at(&name).join("cases.csv"));
        let (code, said) = interrupt_after(&arguments(&scenes, &out), &table, 2, signal);
        assert_eq!(code, Some(expected), "{said}");
        assert!(said.contains("go on with: sweep run") && said.contains("--resume"), "{said}");
    }
}

/// `nohup` starts a program that is to outlive its terminal.
#[cfg(target_os = "linux")]
#[test]
fn a_hangup_that_is_ignored_stays_so() {
    let folder = Folder::new("nohup");
    let scenes = scenes(&folder);
    let out = folder.argument("out");
    let shell = "trap '' HUP; exec \"$SWEEP\" \"$@\"";
    let mut child = Command::new("sh")
        .args(["-c", shell, "sh"])
        .args(arguments(&scenes, &out))
        .env("SWEEP", env!("CARGO_BIN_EXE_sweep"))
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .expect("a shell");
    let table = folder.at("out/cases.csv");
    while crate::resume::lines(&table) < 2 && child.try_wait().expect("a status").is_none() {
        std::thread::sleep(std::time::Duration::from_millis(1));
    }
    let sent = Command::new("kill").args(["-HUP", &child.id().to_string()]).status();
    assert!(sent.expect("kill runs").success());
    // Too few points for verdicts: unresolved, and not 129.
    assert_eq!(child.wait().expect("a status").code(), Some(1));
}

#[test]
fn a_directory_that_is_removed_midway_is_no_success() {
    let folder = Folder::new("removed");
    let scenes = scenes(&folder);
    let out = folder.argument("out");
    let child =
        run_until(&arguments(&scenes, &out), &folder.at("out/cases.csv"), 2, Stdio::piped());
    std::fs::remove_dir_all(folder.at("out")).expect("removed");
    let output = child.wait_with_output().expect("a status");
    assert_eq!(code(&output), 2, "{}", stderr(&output));
    let said = stderr(&output);
    assert!(said.contains("removed or replaced") && !said.contains("are kept"), "{said}");
    assert!(!folder.at("out").exists(), "a part of a report stands where the directory was");
}
