//! Output of a study: JSON, its document on the terminal and, with --out, files.

use std::path::Path;

use super::{CliError, create_dir, print_json, print_text, width};
use report::{Findings, StudyDocument};

/// Prints findings, and writes their files if a directory is given. The exit code: 1 unless every claim holds.
pub(super) fn show(findings: &Findings, out: Option<&Path>, as_json: bool) -> Result<u8, CliError> {
    if let Some(dir) = out {
        create_dir(dir)?;
        findings.write(dir)?;
    }
    if as_json {
        print_json(&findings.json())?;
    } else {
        print_text(&findings.document.text(width(StudyDocument::WIDTH)));
    }
    Ok(u8::from(!findings.holds()))
}
