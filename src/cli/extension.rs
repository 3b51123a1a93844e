//! `--extend`: adds cases to a sweep, and finds them again for `--resume`.

use std::path::Path;

use super::CliError;
use judge::verdict::Verdict;
use run::sweep::{Provenance, ScenePlan, Step, extend};

/// Adds the cases that open verdicts ask for, with a message; true if there are any.
pub(crate) fn extended(
    plans: &mut [ScenePlan],
    verdicts: &[Verdict],
    budget: f64,
) -> Result<bool, CliError> {
    let mut added = false;
    for step in extend(plans, verdicts, budget)? {
        match step {
            Step::Add { scene, case, seconds, why } => {
                added = true;
                super::progress::note(&format!(
                    "extend: {scene}: adds {case}, about {seconds:.2} s of CPU time; {why}"
                ));
            }
            Step::Leave { scene, why } => super::progress::note(&format!("extend: {scene}: {why}")),
        }
    }
    Ok(added)
}

/// The provenance of the records in `out`, if there are any.
pub(crate) fn earlier(out: &Path) -> Result<Option<Provenance>, CliError> {
    Ok(Provenance::read(out)?)
}

/// Adds the earlier extensions of the records in `out` to the plans.
pub(crate) fn restore_added(plans: &mut [ScenePlan], out: &Path) -> Result<(), CliError> {
    let known = earlier(out)?;
    for plan in plans {
        let added = known.as_ref().and_then(|known| known.added_cases.get(&plan.scene().name));
        added.into_iter().flatten().for_each(|added| plan.add(added.clone()));
    }
    Ok(())
}
