//! From trials to a culprit: what takes part wherever something fails, and least often where all is well.

use super::outcome::Outcome;
use super::term::Suspect;
use judge::claim::{Claim, Relation};
use judge::verdict::Decision;

/// Whom the trials convict.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Finding {
    /// One of these alone explains every failure; more than one where no trial tells them apart.
    One(Vec<Suspect>),
    /// No single suspect takes part in every failed trial without one that passes; these two together do.
    Two(Suspect, Suspect),
    /// Trials fail, and no two suspects explain them.
    Unexplained,
    NothingFails,
    /// What the scene predicts, not its solver: the errors are those that the exact solution has.
    Prediction,
}

/// The suspects of which one takes part in every failed trial, and in the fewest that pass; or two of
/// which one does, and neither in any that passes.
///
/// A defect in a term that a solution does not excite passes, so a passed trial speaks against a suspect
/// without acquitting it; a failed trial acquits whatever did not take part. Trials that are unresolved
/// or could not be run say nothing.
pub fn culprit(outcomes: &[Outcome]) -> Finding {
    let with = |decision: Decision| -> Vec<&Outcome> {
        outcomes.iter().filter(|outcome| outcome.decision == decision).collect()
    };
    let (failed, passed) = (with(Decision::Fail), with(Decision::Pass));
    if failed.is_empty() {
        return Finding::NothingFails;
    }
    let bare = |outcome: &&&Outcome| {
        outcome.suspects.iter().all(|&suspect| is_everywhere(suspect) || suspect == Suspect::Space)
    };
    let bare_fails = failed.iter().any(|outcome| bare(&outcome));
    let acquitted = |suspect: Suspect| is_everywhere(suspect) && !bare_fails;
    let takes_part = |outcome: &&Outcome, suspects: &[Suspect]| {
        suspects.iter().any(|suspect| outcome.suspects.contains(suspect))
    };
    let explains = |suspects: &[Suspect]| failed.iter().all(|o| takes_part(o, suspects));
    let passes = |suspects: &[Suspect]| passed.iter().filter(|o| takes_part(o, suspects)).count();
    let single: Vec<(usize, Suspect)> = Suspect::ALL
        .into_iter()
        .filter(|&suspect| explains(&[suspect]) && !acquitted(suspect))
        .map(|suspect| (passes(&[suspect]), suspect))
        .collect();
    let pairs = Suspect::ALL.into_iter().flat_map(|a| Suspect::ALL.map(|b| (a, b)));
    let pair = pairs
        .filter(|&(a, b)| a < b && explains(&[a, b]) && !acquitted(a) && !acquitted(b))
        .map(|(a, b)| (passes(&[a, b]), a, b))
        .min();
    match (single.iter().min(), pair) {
        // Two that are never sound go before one that is: each of the two has failed without the other.
        (Some(&(1.., _)), Some((0, a, b))) => Finding::Two(a, b),
        (Some(&(fewest, _)), _) => {
            let least = single.into_iter().filter(|(passes, _)| *passes == fewest);
            Finding::One(least.map(|(_, suspect)| suspect).collect())
        }
        (None, Some((_, a, b))) => Finding::Two(a, b),
        (None, None) => Finding::Unexplained,
    }
}

/// Whether every run has it: then it explains every failure, and is suspected only if a run with nothing else fails.
fn is_everywhere(suspect: Suspect) -> bool {
    matches!(suspect, Suspect::Elasticity | Suspect::Loads)
}

/// The finding in one sentence.
pub fn sentence(finding: &Finding, outcomes: &[Outcome]) -> String {
    match finding {
        Finding::NothingFails => "not among the terms: every variant shows what it must".into(),
        Finding::Prediction => {
            "not among the terms: the prediction is wrong, the program is sound".into()
        }
        Finding::Unexplained => {
            "not among the terms: the trials that fail have nothing in common".into()
        }
        Finding::Two(a, b) => format!("culprits: {}, and {}", a.words(), b.words()),
        Finding::One(convicted) => match convicted[..] {
            [one] => format!("culprit: {} ({})", one.words(), evidence(one, outcomes)),
            _ => {
                let names: Vec<&str> = convicted.iter().map(|suspect| suspect.words()).collect();
                let head = match convicted.iter().any(|suspect| suspect.is_term()) {
                    true => "culprit",
                    false => "not among the terms",
                };
                format!("{head}: {} (no trial tells them apart)", names.join("; or "))
            }
        },
    }
}

/// What removal restores, or which trials fail.
fn evidence(suspect: Suspect, outcomes: &[Outcome]) -> String {
    let all = outcomes.iter().find(|outcome| outcome.removed.is_none());
    let removed = outcomes.iter().find(|outcome| outcome.removed == Some(suspect));
    if let (Some(all), Some(removed)) = (all, removed)
        && all.decision == Decision::Fail
        && removed.decision == Decision::Pass
    {
        return format!("removing it restores {}; with it {}", removed.shown(), all.shown());
    }
    let failed = |outcome: &&Outcome| outcome.decision == Decision::Fail;
    let names: Vec<&str> =
        outcomes.iter().filter(failed).map(|outcome| outcome.name.as_str()).collect();
    format!("what fails has it: {}", names.join("; "))
}

impl Outcome {
    /// What was observed, in a few words.
    fn shown(&self) -> String {
        let Claim { statement, left, note, .. } = &self.claim;
        match self.claim.relation {
            Relation::Order(..) if !left.is_nan() => {
                statement.source.replacen("order", &format!("order {left:.2}"), 1)
            }
            Relation::AtMost(_) if self.decision == Decision::Pass => "exactness".to_owned(),
            _ => note.clone(),
        }
    }
}

impl Finding {
    /// Their names in JSON.
    pub fn culprits(&self) -> Vec<&'static str> {
        match self {
            Self::One(suspects) => suspects.iter().map(|suspect| suspect.name()).collect(),
            Self::Two(a, b) => vec![a.name(), b.name()],
            Self::Prediction => vec!["prediction"],
            Self::Unexplained | Self::NothingFails => Vec::new(),
        }
    }
}
