//! What made a set of records, beside program version and scenes: nothing in the records depends on it.

use serde::{Deserialize, Serialize};

/// What a program was built from, and how: a program tells a library.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Build {
    /// The commit, "unknown" outside of a clone, "development build" without optimisation for release.
    pub commit: &'static str,
    /// Version of the compiler.
    pub compiler: &'static str,
    /// What it compiled for.
    pub target: &'static str,
    /// Its optimisation level.
    pub optimisation: &'static str,
}

impl Build {
    /// The build of a program that does not tell it.
    pub const UNKNOWN: Self =
        Self { commit: "unknown", compiler: "unknown", target: "unknown", optimisation: "unknown" };
}

/// Commit, compiler, processor, threads and options of a run. Without paths: they say nothing elsewhere.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Circumstances {
    /// The commit that the program was built at, "unknown" outside of a clone, "development build" without optimisation
    /// for release.
    pub commit: String,
    /// Version of the compiler.
    pub compiler: String,
    /// What it compiled for.
    pub target: String,
    /// Its optimisation level.
    pub optimisation: String,
    /// Name of the processor, "unknown" where the system does not say it.
    pub processor: String,
    /// Cases at a time.
    pub threads: usize,
    /// Options of the command, but for paths; empty where all was left as it is.
    pub options: String,
}

impl Circumstances {
    /// The circumstances of a program on this machine.
    pub fn new(build: &Build, threads: usize, options: &str) -> Self {
        let processor = std::fs::read_to_string("/proc/cpuinfo");
        Self {
            commit: build.commit.to_owned(),
            compiler: build.compiler.to_owned(),
            target: build.target.to_owned(),
            optimisation: build.optimisation.to_owned(),
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
