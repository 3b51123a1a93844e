//! `typeset DIR [DATE]`: the report that `sweep report` wrote into DIR, as a PDF on standard output. `sweep report DIR
//! --pdf FILE` runs it; a program of its own, so that typesetting is built without the solver and the solver without it.

use std::ffi::OsString;
use std::io::Write;
use std::path::Path;
use std::process::ExitCode;

fn main() -> ExitCode {
    let arguments: Vec<OsString> = std::env::args_os().skip(1).collect();
    let (dir, date) = match &arguments[..] {
        [dir] => (dir, None),
        [dir, date] => (dir, Some(date.to_string_lossy())),
        _ => {
            return refused(
                "usage: typeset DIR [DATE]: the report in DIR as a PDF on standard output",
            );
        }
    };
    let written = gronwall_report::pdf(Path::new(dir), date.as_deref())
        .map_err(|error| error.to_string())
        .and_then(|bytes| std::io::stdout().write_all(&bytes).map_err(|error| error.to_string()));
    match written {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => refused(&error),
    }
}

fn refused(why: &str) -> ExitCode {
    // Who closed standard error reads the code alone.
    let _ = writeln!(std::io::stderr(), "{why}");
    ExitCode::from(2)
}
