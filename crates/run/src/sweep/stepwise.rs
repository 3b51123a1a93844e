//! Sweeps that end when their claims are settled: cheapest cases first, and one more for each open claim.

use super::judging::line_cases;
use super::plan::{CasePlan, ScenePlan};
use judge::fit::FEWEST;
use judge::record::{CaseRecord, Key};
use judge::verdict::{Decision, MeshAndSteps, Verdict};
use scene::setup::SetupError;
use scene::{Direction, Expectation};

/// Cases of plans that are held back until a claim asks for them.
pub struct Stepwise {
    scenes: Vec<Waiting>,
}

struct Waiting {
    /// Every case in the order of the plan; and for each claim its cases, cheapest first.
    all: Vec<CasePlan>,
    claims: Vec<Claim>,
    /// Why nothing is held back.
    whole: Option<&'static str>,
}

#[derive(Clone)]
struct Claim {
    cases: Vec<MeshAndSteps>,
    /// The verdict before the last cases were added, and the decision that settled it.
    before: Option<Verdict>,
    settled: Option<Decision>,
}

/// Cases of a scene that were not run.
#[derive(serde::Serialize)]
pub struct NotRun {
    pub scene: String,
    pub cases: Vec<MeshAndSteps>,
    /// Their predicted CPU seconds in total.
    pub seconds: f64,
}

impl NotRun {
    /// The keys of the cases.
    pub fn keys(&self) -> impl Iterator<Item = Key> {
        self.cases.iter().map(|case| case.key(&self.scene))
    }
}

impl Stepwise {
    /// Leaves each plan the three cheapest cases of every claim, and those `recorded` as asked for already.
    pub fn hold(plans: &mut [ScenePlan], recorded: impl Fn(&str, &MeshAndSteps) -> bool) -> Self {
        let hold = |plan: &mut ScenePlan| {
            let waiting = Waiting::of(plan);
            if waiting.whole.is_none() {
                let first = waiting.first();
                let name = plan.scene().name.clone();
                plan.cases.retain(|case| {
                    let case = case.place();
                    first.contains(&case) || recorded(&name, &case)
                });
            }
            waiting
        };
        Self { scenes: plans.iter_mut().map(hold).collect() }
    }

    /// Brings the claims to their state when the last of these records was asked for: a failure confirmed by an earlier
    /// run needs no further case. `judged` gives the verdicts of a plan on the records of its cases.
    pub fn replay(
        &mut self,
        plans: &mut [ScenePlan],
        records: &[CaseRecord],
        judged: impl Fn(&ScenePlan, &[CaseRecord]) -> Vec<Verdict>,
    ) {
        for (waiting, plan) in self.scenes.iter_mut().zip(plans) {
            waiting.replay(plan, |plan| {
                let keys = plan.keys();
                let record = records.iter().filter(|record| keys.contains(&record.key()));
                judged(plan, &record.cloned().collect::<Vec<_>>())
            });
        }
    }

    /// Adds the next case of every open claim to the plans. Returns which plans got one: the others need not be judged
    /// again. `verdicts` are those of all plans, in their order.
    pub fn go_on(&mut self, plans: &mut [ScenePlan], verdicts: &[Verdict]) -> Vec<bool> {
        let of_scene = |(waiting, plan): (&mut Waiting, &mut ScenePlan)| {
            if waiting.whole.is_some() {
                return false;
            }
            let verdict = verdicts.iter().filter(|verdict| verdict.scene == plan.scene().name);
            let next = waiting.next(verdict, &plan.cases);
            // In the order of the whole plan; additions come last.
            let (planned, all) = (places(&plan.cases), places(&waiting.all));
            let mut cases =
                those(&waiting.all, |case| next.contains(case) || planned.contains(case));
            cases.extend(those(&plan.cases, |case| !all.contains(case)));
            plan.cases = cases;
            !next.is_empty()
        };
        self.scenes.iter_mut().zip(plans).map(of_scene).collect()
    }

    /// Cases that no claim has asked for.
    ///
    /// # Errors
    /// A mesh whose cost cannot be predicted.
    pub fn not_run(&self, plans: &[ScenePlan]) -> Result<Vec<NotRun>, SetupError> {
        let mut found = Vec::new();
        for (waiting, plan) in self.scenes.iter().zip(plans) {
            let planned = places(&plan.cases);
            let held = those(&waiting.all, |case| !planned.contains(case));
            if !held.is_empty() {
                let scene = plan.scene().name.clone();
                let seconds = plan.costs_of(&held)?.cases.iter().map(|cost| cost.seconds).sum();
                found.push(NotRun { scene, cases: places(&held), seconds });
            }
        }
        Ok(found)
    }

    /// Scenes that are run whole, with the reason.
    pub fn whole<'a>(
        &'a self,
        plans: &'a [ScenePlan],
    ) -> impl Iterator<Item = (&'a str, &'static str)> {
        let reason = |(waiting, plan): (&'a Waiting, &'a ScenePlan)| {
            Some((plan.scene().name.as_str(), waiting.whole?))
        };
        self.scenes.iter().zip(plans).filter_map(reason)
    }
}

impl Waiting {
    fn of(plan: &ScenePlan) -> Self {
        let scene = plan.scene();
        let joint = scene.predicts.iter().any(|written| written.variable == Direction::Joint);
        let whole = match scene.expect {
            _ if !scene.judge || scene.predicts.is_empty() => Some("nothing is judged"),
            // The most expensive run would be repeated with every added case.
            _ if plan.reference.is_some() => Some("its truth is a reference run"),
            Expectation::Unresolved => Some("it has to stay open with all of them"),
            _ if joint => Some("a claim rests on the whole grid"),
            Expectation::Pass | Expectation::Fail => None,
        };
        let claim = |written| {
            let line = line_cases(plan, written).into_iter();
            let mut cases: Vec<MeshAndSteps> = line.map(CasePlan::place).collect();
            cases.sort_unstable();
            Claim { cases, before: None, settled: None }
        };
        Self { all: plan.cases.clone(), claims: scene.predicts.iter().map(claim).collect(), whole }
    }

    /// The cheapest cases of every claim, needed for any verdict.
    fn first(&self) -> Vec<MeshAndSteps> {
        self.claims.iter().flat_map(|claim| claim.cases.iter().copied().take(FEWEST)).collect()
    }

    /// The next case of every open claim.
    fn next<'a>(
        &mut self,
        verdicts: impl Iterator<Item = &'a Verdict>,
        asked: &[CasePlan],
    ) -> Vec<MeshAndSteps> {
        let claims = self.claims.iter_mut().zip(verdicts);
        claims.filter_map(|(claim, verdict)| claim.next(verdict, asked)).collect()
    }

    /// Replays from the first cases, as long as the plan has what the claims ask for.
    fn replay(&mut self, plan: &mut ScenePlan, judged: impl Fn(&ScenePlan) -> Vec<Verdict>) {
        if self.whole.is_some() {
            return;
        }
        let first = self.first();
        let known = std::mem::take(&mut plan.cases);
        plan.cases = those(&known, |case| first.contains(case));
        let recorded = places(&known);
        while plan.cases.len() < known.len() {
            let claims = self.claims.clone();
            let next = self.next(judged(plan).iter(), &plan.cases);
            if !next.iter().all(|case| recorded.contains(case)) {
                // Asked for again, with the rest of the plan.
                self.claims = claims;
                break;
            }
            if next.is_empty() {
                break;
            }
            let planned = places(&plan.cases);
            plan.cases = those(&known, |case| next.contains(case) || planned.contains(case));
        }
        plan.cases = known;
    }
}

impl Claim {
    /// The next case that the claim needs, if its new verdict is open.
    fn next(&mut self, verdict: &Verdict, asked: &[CasePlan]) -> Option<MeshAndSteps> {
        let settled = verdict.settled(self.before.as_ref());
        // Other claims may have added a case since: a decision that it does not change stays settled.
        let settled = settled || self.settled == Some(verdict.decision);
        self.settled = settled.then_some(verdict.decision);
        self.before = Some(verdict.clone());
        let asked = places(asked);
        self.cases.iter().find(|case| !asked.contains(case)).copied().filter(|_| !settled)
    }
}

fn places(cases: &[CasePlan]) -> Vec<MeshAndSteps> {
    cases.iter().map(CasePlan::place).collect()
}

/// The cases whose places are wanted, in their order.
fn those(cases: &[CasePlan], wanted: impl Fn(&MeshAndSteps) -> bool) -> Vec<CasePlan> {
    cases.iter().filter(|case| wanted(&case.place())).cloned().collect()
}
