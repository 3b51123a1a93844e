//! Pictures of single cases that `sweep solve --pictures` left in the directory of a report.

use std::fs;
use std::path::Path;

use super::ReportError;
use super::document::Figure;
use files::{FileError, read_text};

/// Endings of file names, and what the files show.
const ENDINGS: [(&str, &str); 2] = [
    ("-contact.svg", "contact state of Γ3 over time, exact and discrete"),
    ("-body.svg", "deformed body at the last time level"),
];

/// The names of the files in a directory, sorted.
pub(super) fn names(dir: &Path) -> Result<Vec<String>, ReportError> {
    let mut names: Vec<String> = Vec::new();
    for entry in fs::read_dir(dir).map_err(FileError::at(dir))? {
        let name = entry.map_err(FileError::at(dir))?.file_name();
        names.extend(name.into_string().ok());
    }
    names.sort();
    Ok(names)
}

/// The pictures in a directory, by kind, then by file name.
pub(super) fn of_cases(dir: &Path) -> Result<Vec<Figure>, ReportError> {
    let names = names(dir)?;
    let mut found = Vec::new();
    for (ending, shows) in ENDINGS {
        for name in &names {
            let Some(case) = name.strip_suffix(ending) else { continue };
            let svg = read_text(&dir.join(name))?;
            // Foreign files with such a name are ignored.
            if svg.trim_start().starts_with("<svg") {
                let case = if case.is_empty() { String::new() } else { format!("{case}: ") };
                let caption = format!("{case}{shows} (sweep solve --pictures).");
                found.push(Figure::new(name, caption, svg));
            }
        }
    }
    Ok(found)
}
