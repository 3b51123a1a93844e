//! Studies of other commands in the directory of a report: their pictures, and their numbers as they wrote them.
//! They belong to it, and are not its own.

pub(super) mod practice;
pub(super) mod theory;

use std::fs;
use std::io;
use std::path::Path;

use serde::de::DeserializeOwned;

use super::{Picture, ReportError};
use files::read_text;
use practice::{Extremes, Trade};
use theory::{Audit, Bound, Claim, Gronwall};

/// A number of a study. JSON has neither infinity nor NaN, so any may be absent.
pub(super) type Number = Option<f64>;

/// What a file is called, its command, and what it shows.
const PICTURES: [(&str, &str, &str); 12] = [
    ("-bound.svg", "sweep bound", "contraction factor of Λ against k, with the bounds of (3.4)"),
    ("-audit.svg", "sweep audit", "shares of the bounds of the proofs against h"),
    (
        "-gronwall-envelope.svg",
        "sweep gronwall",
        "measured error and the envelopes of (3.24) over t",
    ),
    ("-gronwall-effectivity-t.svg", "sweep gronwall", "bound over measured error, over t"),
    ("-gronwall-effectivity-k.svg", "sweep gronwall", "bound over measured error, over k"),
    ("-gronwall-horizon.svg", "sweep gronwall --horizons", "error and bounds over the horizon"),
    (
        "-gronwall-effectivity-horizon.svg",
        "sweep gronwall --horizons",
        "bound over measured error, over the horizon",
    ),
    ("-trade.svg", "sweep trade", "error against CPU seconds, with the Pareto front"),
    ("-trade-memory.svg", "sweep trade", "error against predicted memory, with the Pareto front"),
    ("-contact.svg", "sweep solve --pictures", "contact state of Γ3 over time, exact and discrete"),
    ("-body.svg", "sweep solve --pictures", "deformed body at the last time level"),
    ("extremes.svg", "sweep extremes", "every rung of the ladders against its expectation"),
];

/// All studies of a directory, each kind in the order of file names.
#[derive(Default)]
pub(super) struct Studies {
    pub(super) pictures: Vec<Picture>,
    pub(super) bounds: Vec<Bound>,
    pub(super) gronwall: Vec<Gronwall>,
    pub(super) audits: Vec<Audit>,
    pub(super) ledger: Vec<Claim>,
    pub(super) trades: Vec<Trade>,
    pub(super) extremes: Option<Extremes>,
}

/// Whether a file of this name is the picture of a study.
pub(super) fn is_study(file: &str) -> bool {
    PICTURES.iter().any(|(end, ..)| file.ends_with(end))
}

impl Studies {
    /// The studies in a directory.
    ///
    /// # Errors
    /// A file that cannot be read, and one that is not what its command writes.
    pub(super) fn read(dir: &Path) -> Result<Self, ReportError> {
        let names = names(dir)?;
        Ok(Self {
            pictures: pictures(dir, &names)?,
            bounds: documents(dir, &names, "-bound.json", "bound SCENE")?,
            gronwall: documents(dir, &names, "-gronwall.json", "gronwall SCENE")?,
            audits: documents(dir, &names, "-audit.json", "audit SCENE")?,
            ledger: documents(dir, &named(&names, "ledger.json"), "", "audit --ledger")?
                .into_iter()
                .flat_map(|claims: Vec<Claim>| claims)
                .collect(),
            trades: documents(dir, &names, "-trade.json", "trade SCENE")?,
            extremes: documents(dir, &named(&names, "extremes.json"), "", "extremes")?.pop(),
        })
    }

    /// Takes out the pictures whose names begin with `scene` and go on with `-kind`.
    pub(super) fn take(&mut self, scene: &str, kind: &str) -> Vec<Picture> {
        let of = |name: &str| name.strip_prefix(scene).is_some_and(|rest| rest.starts_with(kind));
        self.taken(|name| is_study(name) && of(name))
    }

    /// Takes out the pictures of a kind, whatever their scene.
    pub(super) fn rest_of(&mut self, kind: &str) -> Vec<Picture> {
        self.taken(|name| is_study(name) && name.contains(kind))
    }

    fn taken(&mut self, wanted: impl Fn(&str) -> bool) -> Vec<Picture> {
        let all = std::mem::take(&mut self.pictures);
        let (taken, left) = all.into_iter().partition(|(name, ..)| wanted(name));
        self.pictures = left;
        taken
    }
}

fn failed(path: &Path, source: io::Error) -> ReportError {
    ReportError::Io { path: path.into(), source }
}

/// Names in a directory, sorted.
fn names(dir: &Path) -> Result<Vec<String>, ReportError> {
    let mut names = Vec::new();
    for entry in fs::read_dir(dir).map_err(|source| failed(dir, source))? {
        let name = entry.map_err(|source| failed(dir, source))?.file_name();
        names.extend(name.into_string().ok());
    }
    names.sort();
    Ok(names)
}

fn named(names: &[String], name: &str) -> Vec<String> {
    names.iter().filter(|own| *own == name).cloned().collect()
}

/// The files with an ending, in the order of the list of kinds, then of names.
fn pictures(dir: &Path, names: &[String]) -> Result<Vec<Picture>, ReportError> {
    let mut found = Vec::new();
    for (end, command, shows) in PICTURES {
        for name in names.iter().filter(|name| name.ends_with(end)) {
            let path = dir.join(name);
            let svg = read_text(&path).map_err(|source| failed(&path, source))?;
            // A file of another program that is called alike has no place on the page.
            if svg.trim_start().starts_with("<svg") {
                let of = &name[..name.len() - end.len()];
                let of = if of.is_empty() { String::new() } else { format!("{of}: ") };
                found.push((name.clone(), format!("{of}{shows} ({command})."), svg));
            }
        }
    }
    Ok(found)
}

/// The documents that a command wrote.
fn documents<T: DeserializeOwned>(
    dir: &Path,
    names: &[String],
    end: &str,
    command: &str,
) -> Result<Vec<T>, ReportError> {
    let read = |name: &String| {
        let path = dir.join(name);
        let text = read_text(&path).map_err(|source| failed(&path, source))?;
        serde_json::from_str(&text).map_err(|error| ReportError::Study {
            path,
            line: error.line(),
            reason: without_place(&error.to_string()),
            command: command.to_owned(),
        })
    };
    names.iter().filter(|name| name.ends_with(end)).map(read).collect()
}

/// The message of the parser without " at line … column …", which stands before it.
fn without_place(message: &str) -> String {
    message.rsplit_once(" at line ").map_or(message, |(what, _)| what).to_owned()
}
