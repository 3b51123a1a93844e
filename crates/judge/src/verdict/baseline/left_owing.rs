//! Compares what a run settled with what its scenes owe, so that a gate which judges less than before fails.

use super::compare::{Comparison, Deviation, DeviationKind};
use super::{Baseline, Owed, Recorded};
use crate::verdict::Verdict;
use files::counted;

impl Baseline {
    /// Records what these verdicts settle as owed.
    #[must_use]
    pub fn owing(mut self, verdicts: &[Verdict]) -> Self {
        for (scene, recorded) in &mut self.scenes {
            recorded.owes = Some(Owed::of_scene(scene, verdicts));
        }
        self
    }
}

/// Every item counts once, in any order; settled items that are not owed are reported as well.
pub(super) fn left_owing(scene: &str, owes: &[Owed], mut settled: Vec<Owed>) -> Vec<Deviation> {
    let mut found = Vec::new();
    let mut say = |owed: &Owed, what: String| found.push(deviation(scene, owed, &what));
    for owed in owes {
        let Some(at) = settled.iter().position(|other| other.is_of(owed)) else {
            say(owed, "the verdict is recorded but was not judged".into());
            continue;
        };
        let judged = settled.remove(at);
        for name in owed.constants.iter().filter(|name| !judged.constants.contains(name)) {
            say(owed, format!("the constant {name} is recorded but was not decided"));
        }
        for name in judged.constants.iter().filter(|name| !owed.constants.contains(name)) {
            say(owed, format!("the constant {name} was decided but is not recorded"));
        }
    }
    for other in &settled {
        say(other, "the verdict was judged but is not recorded".into());
    }
    found
}

fn deviation(scene: &str, owed: &Owed, what: &str) -> Deviation {
    let reason = format!("{scene}: {}: {what}", owed.name());
    let of_scene = Deviation::of(DeviationKind::Owed, scene, reason);
    Deviation { norm: Some(owed.norm.clone()), variable: Some(owed.variable), ..of_scene }
}

impl Comparison {
    /// Counts what a scene owes on its default grids, and says what the verdicts leave of it.
    pub(super) fn owe(
        &mut self,
        scene: &str,
        recorded: &Recorded,
        verdicts: &[Verdict],
    ) -> Vec<Deviation> {
        let Some(owes) = &recorded.owes else {
            self.owed_not_said.push(scene.to_owned());
            return Vec::new();
        };
        self.owed.verdicts += owes.len();
        self.owed.constants += owes.iter().map(|owed| owed.constants.len()).sum::<usize>();
        left_owing(scene, owes, Owed::of_scene(scene, verdicts))
    }

    /// What was owed, and whether the baseline recorded it.
    pub(super) fn owed_in_words(&self) -> Vec<String> {
        let mut lines = Vec::new();
        if !self.owed_not_said.is_empty() {
            let scenes = counted(self.owed_not_said.len(), "scene");
            lines.push(format!(
                "baseline: has no verdicts and constants of {scenes}, the first is {}; sweep baseline records them",
                self.owed_not_said[0]
            ));
        }
        if self.owed.verdicts > 0 {
            let left = self.deviations.iter().filter(|d| d.kind == DeviationKind::Owed).count();
            let found = match left {
                0 => "all judged".to_owned(),
                left => format!("{left} not as recorded"),
            };
            let verdicts = counted(self.owed.verdicts, "verdict");
            let constants = counted(self.owed.constants, "compared constant");
            lines.push(format!("baseline: {verdicts} and {constants} recorded, {found}"));
        }
        lines
    }
}
