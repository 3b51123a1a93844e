//! `--until-resolved`: skips cases that no claim needs, and reports them.

use std::collections::BTreeMap;
use std::path::Path;

use super::CliError;
use super::explain::duration;
use super::extension::earlier;
use super::progress::note;
use files::counted;
use judge::verdict::MeshAndSteps;
use run::sweep::{CasePlan, NotRun, ScenePlan, Stepwise, planned};

/// Holds back cases that may not be needed, except those requested earlier by `resumed` records.
pub(super) fn hold(plans: &mut [ScenePlan], resumed: Option<&Path>) -> Result<Stepwise, CliError> {
    let known = resumed.map(earlier).transpose()?.flatten();
    let asked: BTreeMap<String, Vec<CasePlan>> = plans
        .iter()
        .map(ScenePlan::scene)
        .filter_map(|scene| Some((scene, known.as_ref()?)))
        .filter(|(scene, known)| known.scenes.contains_key(&scene.name))
        .map(|(scene, known)| (scene.name.clone(), planned(scene, known)))
        .collect();
    let recorded = |scene: &str, case: &MeshAndSteps| {
        let same_case = |other: &CasePlan| (other.n, other.steps) == (case.n, case.steps);
        asked.get(scene).is_some_and(|cases| cases.iter().any(same_case))
    };
    let stepwise = Stepwise::hold(plans, recorded);
    let mut whole: BTreeMap<&str, Vec<&str>> = BTreeMap::new();
    stepwise.whole(plans).for_each(|(scene, why)| whole.entry(why).or_default().push(scene));
    for (why, scenes) in &whole {
        note(&format!("until resolved: all cases are run of {}: {why}", scenes.join(", ")));
    }
    Ok(stepwise)
}

/// The skipped cases in a line.
pub(super) fn in_words(left: &[NotRun], run: usize) -> String {
    let cases: usize = left.iter().map(|skipped| skipped.cases.len()).sum();
    let seconds: f64 = left.iter().map(|skipped| skipped.seconds).sum();
    format!(
        "until resolved: {cases} of {} not run, about {} of CPU time: no claim of {} asks for them",
        counted(cases + run, "case"),
        duration(seconds),
        counted(left.len(), "scene")
    )
}
