//! Circumstances of a set of records, beside program version and scenes; no record depends on them.

use std::borrow::Cow;

use serde::{Deserialize, Serialize};

/// Build of a program, passed to the library.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Build {
    /// The commit, "unknown" outside of a clone, "development build" without release optimisation.
    pub commit: Cow<'static, str>,
    pub compiler: Cow<'static, str>,
    pub target: Cow<'static, str>,
    pub optimisation: Cow<'static, str>,
}

impl Build {
    /// The build of a program that does not state it.
    pub(crate) fn unknown() -> Self {
        let [commit, compiler, target, optimisation] = [const { Cow::Borrowed("unknown") }; 4];
        Self { commit, compiler, target, optimisation }
    }
}

/// Commit, compiler, processor, threads and options of a run. Paths are omitted, since they mean nothing elsewhere.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Circumstances {
    #[serde(flatten)]
    pub build: Build,
    /// "unknown" if the system does not tell.
    pub processor: String,
    /// Cases in parallel.
    pub threads: usize,
    /// Non-default options of the command, without paths.
    pub options: String,
}

impl Circumstances {
    /// The circumstances of a program on this machine.
    pub fn new(build: &Build, threads: usize, options: &str) -> Self {
        let processor = std::fs::read_to_string("/proc/cpuinfo");
        Self {
            build: build.clone(),
            processor: processor.ok().and_then(|text| model(&text)).unwrap_or("unknown".into()),
            threads,
            options: options.to_owned(),
        }
    }
}

/// The first processor of Linux' list.
fn model(cpuinfo: &str) -> Option<String> {
    let line = cpuinfo.lines().find(|line| line.starts_with("model name"))?;
    Some(line.split_once(':')?.1.trim().to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_processor_is_named_by_its_line() {
        let text = "processor\t: 0\nmodel name\t: Some CPU @ 2 GHz\nflags\t: a b\n";
        assert_eq!(model(text).as_deref(), Some("Some CPU @ 2 GHz"));
        assert_eq!(model("processor\t: 0\nHardware\t: board\n"), None);
    }
}
