//! The theorem ledger: what runs say of the claims of sections 3-5 of the paper, each with the command
//! that shows it.
//!
//! An entry compares a power (or a constant) that the proof gives with the one that the audit of a
//! scene observes, and says whether the proof is sharp there. It is generated, never written down.

use serde::Serialize;

use crate::theory::audit::{AuditError, SceneAudit, SceneLine};
use fem::contact::BoundaryRule;
use report::{Chapter, Run, StudyDocument, Tone, number};
use scene::setup::Setup;

/// What an entry finds of a proved power or constant.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Agreement {
    /// Attained: no better power, or constant, holds in general.
    Sharp,
    /// The observed quantity is better than proved.
    Slack,
}

impl Agreement {
    fn name(self) -> &'static str {
        match self {
            Self::Sharp => "sharp",
            Self::Slack => "slack",
        }
    }
}

/// An entry.
#[derive(Debug, Clone, Serialize)]
pub struct Entry {
    #[serde(flatten)]
    pub question: &'static Question,
    /// What the runs show; null where nothing could be fitted.
    pub observed: Option<f64>,
    /// The share of the proof's bound that is used, at most.
    pub used: Option<f64>,
    /// Whether the runs confirm it, and every line of theirs holds.
    pub confirmed: bool,
    /// What to type.
    pub command: String,
}

/// A fitted power confirms a proved one within this distance: half of the distance of neighbouring
/// whole powers would not tell them apart, and three meshes bend a logarithmic line by 0.1 to 0.2.
const NEAR: f64 = 0.25;
/// A power counts as better than proved from this excess on.
const BETTER: f64 = 0.5;
/// A ratio within this part of one counts as attained.
const ATTAINED: f64 = 0.02;

/// What an entry reads from an audit.
#[derive(Debug)]
enum Reading {
    /// Power of h of the left side of a line.
    PowerOfH(&'static str),
    PowerOfK(&'static str),
    /// Largest left/right of a line; the proof gives 1.
    Ratio(&'static str),
    /// k over the bound (3.4); the proof gives 1.
    StepOverBound,
}

/// An entry before its runs.
#[derive(Debug, Serialize)]
pub struct Question {
    /// What is claimed.
    pub claim: &'static str,
    /// Under which hypotheses.
    pub hypotheses: &'static str,
    /// What is measured.
    pub quantity: &'static str,
    /// What the proof gives.
    pub proved: f64,
    /// Which of the two the claim is.
    pub claimed: Agreement,
    /// The smallest scene that shows it.
    pub scene: &'static str,
    #[serde(skip)]
    n: &'static [u32],
    #[serde(skip)]
    steps: &'static [u32],
    #[serde(skip)]
    reading: Reading,
}

/// All questions.
pub static QUESTIONS: [Question; 8] = [
    Question {
        claim: "E_j = int (p(u_h) - p(u)) (v - u_h) is quadratic in the errors for a law without jump: the square root of |u_nu - v_nu| in (4.4) and (4.21) is not needed there",
        hypotheses: "(2.8b), (2.8c), the law without jump",
        quantity: "power of h in E_j, (4.16)",
        proved: 2.0,
        claimed: Agreement::Slack,
        scene: "unconstrained",
        n: &[8, 16, 32],
        steps: &[8],
        reading: Reading::PowerOfH("(4.16)"),
    },
    Question {
        claim: "u' of bounded variation in time suffices for order 2; u in W(2,inf) is not needed",
        hypotheses: "q in C2, u' in BV(0,T;V) with a jump at T/3",
        quantity: "power of k in |u - u_h|, (3.17)",
        proved: 2.0,
        claimed: Agreement::Sharp,
        scene: "affine-kink",
        n: &[4],
        steps: &[16, 32, 64, 128],
        reading: Reading::PowerOfK("(4.18)"),
    },
    Question {
        claim: "the last slot enters with weight k/2 and the constants combine: (3.4) is sufficient, and steps beyond it are solved",
        hypotheses: "those of Theorem 6 but for (3.4)",
        quantity: "k over the bound (3.4), solved and audited",
        proved: 1.0,
        claimed: Agreement::Slack,
        scene: "pure-mild",
        n: &[8],
        steps: &[1],
        reading: Reading::StepOverBound,
    },
    Question {
        claim: "no bound on k is needed where B(0) >= 0 and kappa is constant",
        hypotheses: "B(0) >= 0, no projection",
        quantity: "k over the bound (3.4), solved and audited",
        proved: 1.0,
        claimed: Agreement::Slack,
        scene: "positive-memory",
        n: &[8],
        steps: &[1],
        reading: Reading::StepOverBound,
    },
    Question {
        claim: "E_n vanishes to high order for a constant gap: interpolants of locked values are exact",
        hypotheses: "g constant, u_nu in H2 on the contact side",
        quantity: "power of h in E_n, (5.23)",
        proved: 2.0,
        claimed: Agreement::Slack,
        scene: "signorini",
        n: &[8, 16, 32],
        steps: &[4],
        reading: Reading::PowerOfH("(5.23)"),
    },
    Question {
        claim: "E_n is of order h^2 for a concave gap: (5.23) is sharp in its power",
        hypotheses: "g concave and not affine, u_nu in H2 on the contact side",
        quantity: "power of h in E_n, (5.23)",
        proved: 2.0,
        claimed: Agreement::Sharp,
        scene: "pure-concave-gap",
        n: &[8, 16, 32],
        steps: &[4],
        reading: Reading::PowerOfH("(5.23)"),
    },
    Question {
        claim: "relaxed monotonicity (2.8c) is attained: alpha_j is the steepest descent of the law",
        hypotheses: "u affine in space, on the falling branch",
        quantity: "left/right of (4.16)",
        proved: 1.0,
        claimed: Agreement::Sharp,
        scene: "affine",
        n: &[4],
        steps: &[16],
        reading: Reading::Ratio("(4.16)"),
    },
    Question {
        claim: "(4.20) has the right power of h and a constant several times too large",
        hypotheses: "those of Theorem 10",
        quantity: "left/right of (4.20)",
        proved: 1.0,
        claimed: Agreement::Slack,
        scene: "pure-mild",
        n: &[8, 16],
        steps: &[4],
        reading: Reading::Ratio("(4.20)"),
    },
];

/// All entries; `scene` loads a scene by its name.
///
/// # Errors
/// That of `scene`, and [`AuditError`].
pub fn ledger<E>(scene: impl Fn(&str) -> Result<Setup, E>) -> Result<Vec<Entry>, E>
where
    E: From<AuditError>,
{
    QUESTIONS
        .iter()
        .map(|question| {
            let mut setup = scene(question.scene)?;
            if let Some(boundary) = &mut setup.model.boundary {
                boundary.rule = BoundaryRule::Exact;
            }
            let audit = SceneAudit::new(&setup, question.n, question.steps);
            Ok(question.entry(&setup, &audit?))
        })
        .collect()
}

impl Question {
    fn entry(&'static self, setup: &Setup, audit: &SceneAudit) -> Entry {
        let summaries = audit.summaries();
        let find = |name: &str| summaries.iter().find(|s| s.statement.name == name);
        let line = match self.reading {
            Reading::PowerOfH(name) | Reading::PowerOfK(name) | Reading::Ratio(name) => find(name),
            Reading::StepOverBound => None,
        };
        let used = line.and_then(|summary| summary.ratio);
        let observed = match self.reading {
            Reading::PowerOfH(_) => line.and_then(|summary: &SceneLine| summary.power_h[0]),
            Reading::PowerOfK(_) => line.and_then(|summary| summary.power_k[0]),
            Reading::Ratio(_) => used,
            Reading::StepOverBound => {
                let c = &audit.constants;
                let bound = c.m0() / (c.beta_phi * c.history);
                audit.cases.iter().map(|case| case.k / bound).reduce(f64::min)
            }
        };
        let list =
            |numbers: &[u32]| numbers.iter().map(u32::to_string).collect::<Vec<_>>().join(",");
        Entry {
            question: self,
            observed,
            used,
            confirmed: audit.holds() && observed.is_some_and(|observed| self.confirms(observed)),
            command: format!(
                "sweep audit {} --n {} --steps {}",
                setup.scene.name,
                list(self.n),
                list(self.steps)
            ),
        }
    }

    /// Whether the observed number is what the claim says of the proof.
    fn confirms(&self, observed: f64) -> bool {
        match (&self.reading, self.claimed) {
            (Reading::Ratio(_), Agreement::Sharp) => (observed - self.proved).abs() <= ATTAINED,
            (Reading::Ratio(_), Agreement::Slack) => observed < 0.5 * self.proved,
            (_, Agreement::Sharp) => (observed - self.proved).abs() <= NEAR,
            (Reading::StepOverBound, Agreement::Slack) => observed > self.proved,
            (_, Agreement::Slack) => observed >= self.proved + BETTER,
        }
    }
}

/// The ledger as a document.
pub fn document(entries: &[Entry]) -> StudyDocument {
    let mut document = StudyDocument::new(Chapter::Ledger, "What runs say of the claims");
    document.words("Proved is the power, or the constant, that the proof gives; observed is what the smallest scene that shows it has; used is the largest share of the bound.");
    let wrong = entries.iter().filter(|entry| !entry.confirmed);
    let failures: Vec<String> = wrong.map(|entry| entry.question.claim.to_owned()).collect();
    let all = format!("{} claims, every one confirmed.", entries.len());
    document.verdict(!entries.is_empty() && failures.is_empty(), &all, failures);
    let row = |(index, entry): (usize, &Entry)| {
        let question = entry.question;
        let claimed = question.claimed.name();
        let used = entry.used.map_or_else(|| "–".into(), |used| format!("{:.2} %", 100.0 * used));
        let found = match entry.confirmed {
            true => Run::of(claimed, Tone::Pass),
            false => Run::of(format!("{claimed}: not confirmed"), Tone::Miss),
        };
        [
            ("", Run::plain((index + 1).to_string())),
            ("claim", Run::plain(question.claim)),
            ("hypotheses", Run::plain(question.hypotheses)),
            ("quantity", Run::plain(question.quantity)),
            (">proved", number(question.proved)),
            (">observed", number(entry.observed)),
            (">used", Run::plain(used)),
            ("is", found),
        ]
    };
    document.table(
        "Claims on the proofs, each with what a run observes.",
        entries.iter().enumerate().map(row),
    );
    document.words("Each is shown by one command, in the same order:");
    document
        .code(entries.iter().map(|entry| entry.command.as_str()).collect::<Vec<_>>().join("\n"));
    document
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_number_on_the_wrong_side_confirms_nothing() {
        for question in &QUESTIONS {
            let wrong = match (&question.reading, question.claimed) {
                (Reading::Ratio(_), Agreement::Sharp) => 0.9,
                (Reading::Ratio(_), Agreement::Slack) => 0.9,
                (Reading::StepOverBound, _) => 0.99,
                (_, Agreement::Sharp) => question.proved - 0.5,
                (_, Agreement::Slack) => question.proved,
            };
            assert!(!question.confirms(wrong), "{}", question.claim);
            assert!(!question.confirms(f64::NAN), "{}", question.claim);
        }
    }
}
