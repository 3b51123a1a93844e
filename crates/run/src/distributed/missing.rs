//! Missing cases of a merge or report, in words.

use std::path::Path;

use super::error::DistributedError;
use super::names::CASES;
use super::plan::{SweepPlan, id, rows};
use files::counted;
use judge::record::Key;

/// Missing cases that are named before the rest is counted.
pub(crate) const NAMED: usize = 10;

/// Requested cases that are in no part, or have lost rows.
#[derive(Debug, Default, Clone, PartialEq)]
pub struct Missing {
    pub number: usize,
    /// The first of them, with their job if there is a plan.
    pub first: Vec<(String, Option<usize>)>,
    /// How to obtain them.
    pub(crate) way: WayOn,
}

/// How missing cases come to be.
#[derive(Debug, Default, Clone, Copy, PartialEq, Eq)]
pub(crate) enum WayOn {
    /// Run their jobs of a plan.
    Plan,
    /// Run them on the grids of scenes; there is no plan.
    #[default]
    Grids,
    /// Resume an unfinished sweep.
    Resume,
}

impl Missing {
    /// Cases that an unfinished sweep still owes.
    pub fn of_sweep(missing: &[Key]) -> Self {
        let first = missing.iter().take(NAMED).map(|key| (id(key), None)).collect();
        Self { number: missing.len(), first, way: WayOn::Resume }
    }
}

impl std::fmt::Display for Missing {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let name = |(id, job): &(String, Option<usize>)| match job {
            Some(job) => format!("{id} (job {job})"),
            None => id.clone(),
        };
        let named: Vec<String> = self.first.iter().map(name).collect();
        write!(f, "{} missing: {}", counted(self.number, "case"), named.join(", "))?;
        if self.number > self.first.len() {
            write!(f, " and {} more", self.number - self.first.len())?;
        }
        f.write_str(match self.way {
            WayOn::Plan => "; run them with `sweep case --job JOB`, or merge with --incomplete: their verdicts fail then",
            WayOn::Grids => "; they are on the grids of the scenes' files: give the plan with --plan if another grid was run, or merge with --incomplete: their verdicts fail then",
            WayOn::Resume => "; run the command that made these records again, `sweep run` with --resume",
        })
    }
}

/// The ids of the first missing cases with their jobs.
pub(crate) fn with_jobs(
    missing: &[Key],
    plan: Option<(&SweepPlan, &Path)>,
) -> Result<Vec<(String, Option<usize>)>, DistributedError> {
    let mut named: Vec<(String, Option<usize>)> =
        missing.iter().map(|key| (id(key), None)).collect();
    let Some((_, dir)) = plan.filter(|_| !named.is_empty()) else { return Ok(named) };
    for row in rows(&dir.join(CASES))? {
        let row = row?;
        named.iter_mut().filter(|(id, _)| *id == row.id).for_each(|(_, job)| *job = Some(row.job));
    }
    Ok(named)
}
