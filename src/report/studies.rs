//! Pictures that other commands wrote into the directory of a report: they belong to it, and are not its own.

use std::fs;
use std::io;
use std::path::Path;

use super::{Picture, ReportError};

/// What a file is called, its command, and what it shows.
const STUDIES: [(&str, &str, &str); 11] = [
    ("-bound.svg", "sweep bound", "contraction factor of Λ against k, with the bounds of (3.4)"),
    ("-audit.svg", "sweep audit", "shares of the bounds of the proofs against h"),
    (
        "gronwall-envelope.svg",
        "sweep gronwall",
        "measured error and the envelopes of (3.24) over t",
    ),
    ("gronwall-effectivity-t.svg", "sweep gronwall", "bound over measured error, over t"),
    ("gronwall-effectivity-k.svg", "sweep gronwall", "bound over measured error, over k"),
    ("gronwall-horizon.svg", "sweep gronwall --horizons", "error and bounds over the horizon"),
    (
        "gronwall-effectivity-horizon.svg",
        "sweep gronwall --horizons",
        "bound over measured error, over the horizon",
    ),
    ("-trade.svg", "sweep trade", "error against CPU seconds, with the Pareto front"),
    ("-contact.svg", "sweep solve --pictures", "contact state of Γ3 over time, exact and discrete"),
    ("-body.svg", "sweep solve --pictures", "deformed body at the last time level"),
    ("extremes.svg", "sweep extremes", "every rung of the ladders against its expectation"),
];

/// Whether a file of this name is that of a study.
pub(super) fn is_study(file: &str) -> bool {
    STUDIES.iter().any(|(end, ..)| file.ends_with(end))
}

/// The pictures of studies in a directory, in the order of the list, then of names.
pub(super) fn studies(dir: &Path) -> Result<Vec<Picture>, ReportError> {
    let failed = |path: &Path, source: io::Error| ReportError::Io { path: path.into(), source };
    let entries = fs::read_dir(dir).map_err(|source| failed(dir, source))?;
    let mut names = Vec::new();
    for entry in entries {
        let name = entry.map_err(|source| failed(dir, source))?.file_name();
        names.extend(name.into_string().ok());
    }
    names.sort();
    let mut found = Vec::new();
    for (end, command, shows) in STUDIES {
        for name in names.iter().filter(|name| name.ends_with(end)) {
            let path = dir.join(name);
            let svg = fs::read_to_string(&path).map_err(|source| failed(&path, source))?;
            // A file of another program that is called alike has no place on the page.
            if svg.trim_start().starts_with("<svg") {
                let of = name[..name.len() - end.len()].trim_end_matches('-');
                let of = if of.is_empty() { String::new() } else { format!("{of}: ") };
                found.push((name.clone(), format!("{of}{shows} ({command})."), svg));
            }
        }
    }
    Ok(found)
}
