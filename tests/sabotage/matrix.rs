//! Every defect against every gate.

use judge::record::{CaseRecord, Status};
use judge::verdict::{Baseline, Decision, Verdict};

use crate::answers::Answers;
use crate::catalogue::{Defect, Term, through};
use crate::readback::misread;
use crate::suite::{Outcome, Trial};
use crate::tables::misjudged;
use crate::witness::{Testimony, Witnesses};

/// What may object to a program.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Gate {
    Orders,
    Constants,
    Complete,
    Kkt,
    Audit,
    History,
    Gronwall,
    Bound,
    Check,
    Norms,
    Tables,
    Owed,
    Answers,
    Report,
    Fixtures,
    Baseline,
}

impl Gate {
    pub const ALL: [Self; 16] = [
        Self::Orders,
        Self::Constants,
        Self::Complete,
        Self::Kkt,
        Self::Audit,
        Self::History,
        Self::Gronwall,
        Self::Bound,
        Self::Check,
        Self::Norms,
        Self::Tables,
        Self::Owed,
        Self::Answers,
        Self::Report,
        Self::Fixtures,
        Self::Baseline,
    ];

    /// Its name in the table.
    pub fn name(self) -> &'static str {
        match self {
            Self::Orders => "orders",
            Self::Constants => "constants",
            Self::Complete => "complete",
            Self::Kkt => "KKT",
            Self::Audit => "audit",
            Self::History => "history",
            Self::Gronwall => "Gronwall",
            Self::Bound => "bound",
            Self::Check => "check",
            Self::Norms => "norms",
            Self::Tables => "tables",
            Self::Owed => "owed",
            Self::Answers => "answers",
            Self::Report => "report",
            Self::Fixtures => "fixtures",
            Self::Baseline => "baseline",
        }
    }

    /// Whether it needs no number from an earlier run or another program. What is owed is a list of names.
    pub fn is_of_theory(self) -> bool {
        !matches!(self, Self::Fixtures | Self::Baseline)
    }
}

/// What a defect does to the numbers, as the suite measures it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Effect {
    /// A fitted order moves by more than [`MOVED`].
    Order,
    /// Errors change, orders do not.
    Constant,
    /// Errors are the same, the work is not.
    Cost,
    /// There is no result: cases are missing or refused.
    NoResult,
    /// Records are the same; what is made of them is not.
    Judgement,
    /// What another solver answers, or what a report shows of the records, differs.
    Shown,
    /// Nothing in the suite changes.
    Nothing,
}

impl Effect {
    pub fn name(self) -> &'static str {
        match self {
            Self::Order => "order",
            Self::Constant => "constant",
            Self::Cost => "cost",
            Self::NoResult => "no result",
            Self::Judgement => "judgement",
            Self::Shown => "what is shown",
            Self::Nothing => "nothing",
        }
    }
}

/// Orders closer than this are not told apart by a gate whose intervals are up to 0.15 wide on either side.
pub const MOVED: f64 = 0.1;
/// Errors closer than this are the same: four digits above what rounding leaves of the errors of the suite.
const SAME: f64 = 1e-6;

/// One defect through all gates.
pub struct Line {
    pub defect: Defect,
    /// The gates that object, with what they say.
    pub caught: Vec<(Gate, String)>,
    /// The gates of the sweep that object, each with a scene where it does.
    pub scenes: Vec<(Gate, String)>,
    pub effect: Effect,
    /// The largest shift of a fitted order, and the scene.
    pub shift: Option<(f64, String)>,
    /// The ratio of constants farthest from one, and the scene.
    pub ratio: Option<(f64, String)>,
}

impl Line {
    pub fn by(&self, gate: Gate) -> bool {
        self.caught.iter().any(|(by, _)| *by == gate)
    }

    /// By a gate of the sweep on one of these scenes.
    pub fn by_on(&self, gate: Gate, scenes: &[&str]) -> bool {
        self.scenes.iter().any(|(by, scene)| *by == gate && scenes.contains(&scene.as_str()))
    }

    /// Caught without any number of an earlier run or another program.
    pub fn by_theory(&self) -> bool {
        self.caught.iter().any(|(gate, _)| gate.is_of_theory())
    }

    pub fn is_caught(&self) -> bool {
        !self.caught.is_empty()
    }
}

/// The sound program on the suite.
pub struct Reference {
    pub trials: Vec<Trial>,
    pub outcomes: Vec<Outcome>,
    pub witnesses: Witnesses,
    pub answers: Answers,
}

impl Reference {
    pub fn new(trials: Vec<Trial>) -> Self {
        let outcomes = trials.iter().map(|trial| trial.run(&Defect::SOUND)).collect();
        Self { trials, outcomes, witnesses: Witnesses::new(), answers: Answers::new() }
    }

    /// Runs a defect through all gates.
    pub fn line(&self, defect: &Defect) -> Line {
        let mut line = Line {
            defect: defect.clone(),
            caught: Vec::new(),
            scenes: Vec::new(),
            effect: Effect::Nothing,
            shift: None,
            ratio: None,
        };
        let mut found = Found::default();
        for (trial, sound) in self.trials.iter().zip(&self.outcomes) {
            let of_records =
                matches!(defect.term, Term::Judging | Term::Record | Term::Answer | Term::Report);
            let outcome = if !of_records && defect.is_in(trial.is_body()) {
                trial.run(defect)
            } else {
                // The solver is sound: only what is made of its records differs.
                trial.judge(defect, through(&defect.records, sound.records.clone()))
            };
            found.add(trial, &outcome, sound);
            compare(&mut line, &outcome, sound);
        }
        line.effect = found.effect(&line);
        found.gates(&mut line);
        if !matches!(defect.term, Term::Judging | Term::Record | Term::Answer | Term::Report) {
            hear(&mut line, self.witnesses.hear(defect));
        }
        line.caught.extend(misjudged(defect).map(|what| (Gate::Tables, what)));
        let asked = |term| defect.term == term || defect.name == Defect::SOUND.name;
        if asked(Term::Answer) {
            let said = self.answers.misread(defect);
            line.caught.extend(said.map(|what| (Gate::Answers, what)));
        }
        if asked(Term::Report) {
            let files: Vec<String> = misread(defect).into_iter().map(|(file, _)| file).collect();
            line.caught.extend((!files.is_empty()).then(|| (Gate::Report, files.join(", "))));
        }
        line.caught.sort();
        line
    }
}

fn hear(line: &mut Line, said: Testimony) {
    let Testimony { audit, history, gronwall, bound, check, norms, fixtures } = said;
    for (gate, what) in [
        (Gate::Audit, audit),
        (Gate::History, history),
        (Gate::Gronwall, gronwall),
        (Gate::Bound, bound),
        (Gate::Check, check),
        (Gate::Norms, norms),
        (Gate::Fixtures, fixtures),
    ] {
        line.caught.extend(what.map(|what| (gate, what)));
    }
}

/// What the gates of the sweep object to.
#[derive(Default)]
struct Found {
    /// Gate, scene, what is said, in the order of the scenes.
    objections: Vec<(Gate, String, String)>,
    errors_differ: bool,
    work_differs: bool,
    verdicts_differ: bool,
}

impl Found {
    fn add(&mut self, trial: &Trial, outcome: &Outcome, sound: &Outcome) {
        let mut note = |gate: Gate, what: String| {
            self.objections.push((gate, trial.scene.name.clone(), what));
        };
        // What the sound program leaves open by orders alone, no defect is caught by leaving open.
        let is_open = |verdict: &Verdict| verdict.decision == Decision::Unresolved;
        for (verdict, of_sound) in outcome.verdicts.iter().zip(&sound.verdicts) {
            if !verdict.complete {
                note(Gate::Complete, verdict.reason.chars().take(80).collect());
            } else if !(verdict.as_expected() || is_open(verdict) && is_open(of_sound)) {
                let order = verdict
                    .interval
                    .map_or(String::new(), |[lo, hi]| format!(" [{lo:.2}, {hi:.2}]"));
                note(Gate::Orders, format!("{}{order}", verdict.decision.name()));
            }
        }
        for verdict in &outcome.with_constants {
            if let Some(what) = constant_refuted(verdict) {
                note(Gate::Constants, what);
            }
        }
        for record in &outcome.records {
            if let Status::Failed { reason } = &record.status
                && reason.contains("KKT residual")
            {
                note(Gate::Kkt, reason.clone());
            }
        }
        if let Some(what) = left_owing(trial, &outcome.with_constants, &sound.with_constants) {
            note(Gate::Owed, what);
        }
        if let Some(what) = off_baseline(trial, &outcome.records, &sound.records) {
            note(Gate::Baseline, what);
        }
        self.errors_differ |= differ(&outcome.records, &sound.records, |a, b| !same_errors(a, b));
        self.work_differs |= differ(&outcome.records, &sound.records, |a, b| {
            (a.newton_iterations, a.factorizations) != (b.newton_iterations, b.factorizations)
        });
        self.verdicts_differ |= outcome
            .verdicts
            .iter()
            .zip(&sound.verdicts)
            .any(|(a, b)| (a.decision, a.interval) != (b.decision, b.interval));
    }

    fn gates(self, line: &mut Line) {
        for gate in Gate::ALL {
            let first = self.objections.iter().find(|(by, ..)| *by == gate);
            line.caught.extend(first.map(|(_, scene, what)| (gate, format!("{what} on {scene}"))));
        }
        line.scenes = self.objections.into_iter().map(|(gate, scene, _)| (gate, scene)).collect();
    }

    fn effect(&self, line: &Line) -> Effect {
        let moved = line.shift.as_ref().is_some_and(|(shift, _)| shift.abs() > MOVED);
        if line.defect.term == Term::Judging {
            Effect::Judgement
        } else if matches!(line.defect.term, Term::Answer | Term::Report) {
            Effect::Shown
        } else if moved {
            Effect::Order
        } else if self.objections.iter().any(|(gate, ..)| *gate == Gate::Complete) {
            Effect::NoResult
        } else if self.errors_differ
            || line.ratio.as_ref().is_some_and(|(r, _)| r.ln().abs() > SAME)
        {
            Effect::Constant
        } else if self.work_differs {
            Effect::Cost
        } else if self.verdicts_differ {
            Effect::Constant
        } else {
            Effect::Nothing
        }
    }
}

fn constant_refuted(verdict: &Verdict) -> Option<String> {
    if verdict.expect != Decision::Pass {
        return None;
    }
    verdict.constants.iter().find_map(|(name, constant)| {
        let (ratio, tolerance) = (constant.ratio?, constant.tolerance?);
        let off = (ratio - 1.0).abs();
        // Unresolved counts as caught: the sound program passes here.
        let refuted = verdict.decision != Decision::Pass && (off.is_nan() || off > tolerance);
        refuted.then(|| format!("{name} is {ratio:.3} times the predicted one"))
    })
}

fn differ(
    found: &[CaseRecord],
    sound: &[CaseRecord],
    differs: impl Fn(&CaseRecord, &CaseRecord) -> bool,
) -> bool {
    found.len() != sound.len() || found.iter().zip(sound).any(|(a, b)| differs(a, b))
}

fn same_errors(found: &CaseRecord, sound: &CaseRecord) -> bool {
    first_difference(found, sound).is_none()
}

/// The first norm whose error is another one, beyond [`SAME`] and 20 floors of the sound run.
fn first_difference(found: &CaseRecord, sound: &CaseRecord) -> Option<String> {
    sound.errors.iter().find_map(|entry| {
        let (before, now) = (entry.error?, found.norm(&entry.norm).and_then(|entry| entry.error));
        let allowed = (SAME * before).max(20.0 * entry.floor.unwrap_or(0.0));
        let same = now.is_some_and(|now| (now - before).abs() <= allowed);
        (!same).then(|| format!("{} at {}: {now:?}, was {before:.3e}", entry.norm, found.key()))
    })
}

/// What a baseline of the sound records objects to.
fn off_baseline(trial: &Trial, found: &[CaseRecord], sound: &[CaseRecord]) -> Option<String> {
    let run = trial.as_run();
    let baseline = Baseline::of(sound, &[(&run.scene, &run.hash)]);
    let comparison = baseline.compare(std::slice::from_ref(&run), found, &[]);
    comparison.deviations.first().map(|deviation| deviation.reason.clone())
}

/// The first verdict or constant of the sound run that this one leaves owing.
fn left_owing(trial: &Trial, found: &[Verdict], sound: &[Verdict]) -> Option<String> {
    let run = trial.as_run();
    let baseline = Baseline::of(&[], &[(&run.scene, &run.hash)]).owing(sound);
    // A case that is missing is caught as such; its verdict has no constant.
    if !found.iter().all(|verdict| verdict.complete) {
        return None;
    }
    let comparison = baseline.compare(std::slice::from_ref(&run), &[], found);
    comparison.deviations.first().map(|deviation| deviation.reason.clone())
}

/// Takes the largest shift and ratio over the verdicts of a trial.
fn compare(line: &mut Line, outcome: &Outcome, sound: &Outcome) {
    for (found, sound) in outcome.verdicts.iter().zip(&sound.verdicts) {
        if let (Some(now), Some(before)) = (found.observed, sound.observed) {
            let shift = now - before;
            if line.shift.as_ref().is_none_or(|(known, _)| shift.abs() > known.abs()) {
                line.shift = Some((shift, found.scene.clone()));
            }
        }
        for (name, constant) in &found.constants {
            let Some(before) = sound.constants.get(name) else { continue };
            let ratio = constant.value / before.value;
            let far = |ratio: f64| ratio.ln().abs();
            if line.ratio.as_ref().is_none_or(|(known, _)| far(ratio) > far(*known)) {
                line.ratio = Some((ratio, found.scene.clone()));
            }
        }
    }
}
