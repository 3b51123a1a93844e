//! Source: nothing computed is lost, whatever the machine or a solver does.
//! Goal: a full disk, a directory that cannot be, two sweeps into one directory, a solver that panics in one case: each
//!   ends as it should, and what was finished stays.
//! Data: as the sweeps that are killed, and `affine`.

use std::process::Stdio;
use std::sync::Arc;

use fem::contact::{CaseError, CaseInfo, Observer};
use judge::record::{CaseRecord, Status, read};
use run::sweep::{Machine, OutputDirectory, Overrides, Progress, ScenePlan, run_sweep};
use scene::setup::{MeshData, NewtonMarch, Scheme, Setup, Subject};

use crate::program::{Folder, code, ends, stderr, stdout, sweep, timeless};
use crate::resume::{arguments, finish, lines, run_until, scenes};
use crate::shipped::setup;

#[cfg(unix)]
#[test]
fn a_full_disk_keeps_what_was_written_and_says_how_to_go_on() {
    let folder = Folder::new("full");
    let scenes = scenes(&folder);
    finish(&arguments(&scenes, &folder.argument("whole")));
    let expected = timeless(&folder.at("whole/cases.csv"));
    let size = std::fs::metadata(folder.at("whole/cases.csv")).expect("the table").len();
    let provenance = std::fs::metadata(folder.at("whole/provenance.json")).expect("a file").len();
    let out = folder.argument("out");
    let given = arguments(&scenes, &out);
    // Shells count in blocks of 512 bytes or 1,024: room for the provenance, and for part of the table.
    let blocks = provenance.div_ceil(512) + 1;
    assert!(blocks * 1024 < size, "provenance {provenance} bytes, table {size} bytes");
    // A write beyond the limit is an error and no signal.
    let limited = format!("trap '' XFSZ; ulimit -f {blocks}; exec \"$SWEEP\" \"$@\"");
    let output = std::process::Command::new("sh")
        .args(["-c", &limited, "sh"])
        .args(&given)
        .env("SWEEP", env!("CARGO_BIN_EXE_sweep"))
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .output()
        .expect("a shell");
    let said = stderr(&output);
    assert_eq!(code(&output), 2, "{}{said}", stdout(&output));
    assert!(said.contains("cases.csv") && said.contains("go on with: sweep run"), "{said}");
    assert!(!said.contains("panicked"), "{said}");
    let kept = lines(&folder.at("out/cases.csv"));
    assert!(kept > 1 && kept < expected.len(), "{kept} of {} lines", expected.len());
    let mut resuming = given.clone();
    resuming.push("--resume");
    finish(&resuming);
    assert_eq!(timeless(&folder.at("out/cases.csv")), expected);
}

#[test]
fn a_directory_that_cannot_be_is_refused_before_anything_is_computed() {
    let folder = Folder::new("refused");
    let scenes = scenes(&folder);
    let file = folder.file("a-file", "");
    for out in [file.clone(), format!("{file}/below")] {
        let output = ends(2, &arguments(&scenes, &out));
        let said = stderr(&output);
        assert!(said.contains(&out) && said.contains("--out"), "{said}");
        // Progress begins with the number of cases.
        assert!(!said.contains("cases"), "{said}");
    }
}

#[test]
fn two_sweeps_do_not_write_into_one_directory() {
    let folder = Folder::new("two");
    let scenes = scenes(&folder);
    let out = folder.argument("out");
    let given = arguments(&scenes, &out);
    let mut first = run_until(&given, &folder.at("out/cases.csv"), 1, Stdio::null());
    let output = sweep(&given);
    let said = stderr(&output);
    let running = first.try_wait().expect("a status").is_none();
    assert!(running, "the first sweep ended too early for this test");
    assert_eq!(code(&output), 2, "{said}");
    let holder = format!("process {} is writing here", first.id());
    assert!(said.contains(&holder) && said.contains("--out"), "{said}");
    // The first one is not disturbed; its end, even by force, gives the directory back.
    first.kill().expect("SIGKILL");
    first.wait().expect("a status");
    let mut resuming = given.clone();
    resuming.push("--resume");
    finish(&resuming);
    finish(&arguments(&scenes, &folder.argument("whole")));
    assert_eq!(timeless(&folder.at("out/cases.csv")), timeless(&folder.at("whole/cases.csv")));
}

/// Changes the table when all cases are in it.
struct Meddling(std::path::PathBuf);

impl Progress for Meddling {
    fn advanced(&self, share: f64) {
        if share == 1.0 {
            let table = std::fs::read_to_string(&self.0).expect("the table");
            let other = table.replace("converged", "skipped");
            std::fs::write(&self.0, other).expect("written");
        }
    }
}

/// The verdicts are those of the table, and not of what the program remembers of it.
#[test]
fn what_is_judged_is_read_back() {
    let folder = Folder::new("read-back");
    let plan = || {
        let subject = Subject::Contact(Box::new(setup("affine")));
        let overrides = Overrides { n: Some(vec![4]), steps: Some(vec![4, 8]) };
        [ScenePlan::new(subject, &overrides)]
    };
    let out = OutputDirectory::take(&folder.at("out")).expect("a directory");
    let table = folder.at("out/cases.csv");
    let one = Machine::with_jobs(1);
    let found = run_sweep(&plan(), &out, &one, false, &()).expect("a sweep");
    assert_eq!(found, read(&table).expect("the table"));
    let meddled = run_sweep(&plan(), &out, &one, false, &Meddling(table));
    let error = meddled.expect_err("the table was changed").to_string();
    assert!(error.contains("was changed after it was written"), "{error}");
}

/// Panics where there are 16 steps.
struct Panicking;

impl Scheme for Panicking {
    fn march(
        &self,
        setup: &Setup,
        data: &MeshData,
        steps: u32,
        observe: &mut Observer<'_>,
    ) -> Result<CaseInfo, CaseError> {
        assert_ne!(steps, 16, "index out of bounds, say");
        NewtonMarch.march(setup, data, steps, observe)
    }
}

#[test]
fn a_panic_is_the_end_of_its_case_alone() {
    let folder = Folder::new("panic");
    let run = |out: &str, scheme: Arc<dyn Scheme>| -> Vec<CaseRecord> {
        let mut setup = setup("affine");
        setup.scheme = scheme;
        let subject = Subject::Contact(Box::new(setup));
        let plan = ScenePlan::new(subject, &Overrides::default());
        let out = OutputDirectory::take(&folder.at(out)).expect("a directory");
        run_sweep(&[plan], &out, &Machine::with_jobs(2), false, &()).expect("a sweep")
    };
    let sound = run("sound", Arc::new(NewtonMarch));
    let found = run("found", Arc::new(Panicking));
    assert_eq!(sound.len(), found.len());
    for (sound, found) in sound.iter().zip(&found) {
        if found.steps == 16 {
            let Status::Failed { reason } = &found.status else { panic!("{found:?}") };
            assert!(reason.contains("index out of bounds, say"), "{reason}");
            assert!(found.errors.iter().all(|entry| entry.error.is_none()));
        } else {
            assert_eq!(sound.errors, found.errors);
        }
    }
    assert!(found.iter().any(|record| record.steps == 16), "{found:?}");
    // The table of a sweep with a failed case is whole.
    assert_eq!(read(&folder.at("found/cases.csv")).expect("a table").len(), found.len());
}

#[test]
fn nothing_follows_a_record_that_could_not_be_written() {
    let folder = Folder::new("unwritten");
    let plan = |name: &str| {
        let mut setup = setup("affine");
        setup.scene.name = name.to_owned();
        ScenePlan::new(Subject::Contact(Box::new(setup)), &Overrides::default())
    };
    // A name of two lines is no row of the table. One thread: the sound scene comes after.
    let plans = [plan("two\nlines"), plan("sound")];
    let out = OutputDirectory::take(&folder.at("out")).expect("a directory");
    let error = run_sweep(&plans, &out, &Machine::with_jobs(1), false, &()).expect_err("no record");
    assert!(error.to_string().contains("line break"), "{error}");
    assert_eq!(lines(&folder.at("out/cases.csv")), 1, "the header alone");
}
