//! Output of a study: JSON, its document on the terminal and, with --out, files.

use std::path::Path;

use super::{CliError, create_dir, print_json, print_text, width, write_json};
use report::{Findings, StudyDocument};
use serde::Serialize;

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

/// Writes SCENE-STUDY.json, the document of a study and its pictures if a directory is given.
pub(super) fn write(
    study: &impl Serialize,
    document: &StudyDocument,
    out: Option<&Path>,
) -> Result<(), CliError> {
    let Some(dir) = out else { return Ok(()) };
    create_dir(dir)?;
    write_json(&dir.join(format!("{}.json", document.stem())), study)?;
    Ok(document.write(dir)?)
}
