//! A scene audited: all its runs, and for each line the worst ratio and the powers of h and k with
//! which both sides fall.

use rayon::prelude::*;

use super::case::{AuditError, CaseAudit, CaseLine, audit_case, is_tighter, is_unconstrained};
use super::constants::AuditConstants;
use super::lines::{Line, LineStanding, Relation, Statement};
use algebra::linalg::larger;
use fem::contact::BoundaryRule;
use fem::space::Element;
use judge::fit::{Sample, power_law};
use scene::setup::{MeshData, Setup, SetupError};
use scene::{Extension, TimeRule};

/// An audited scene.
#[derive(Debug, Clone)]
pub struct SceneAudit {
    /// Name of the scene.
    pub scene: String,
    /// Fingerprint of the scene's text.
    pub fingerprint: String,
    /// The boundary rule of the runs.
    pub rule: BoundaryRule,
    /// Whether K = X, so that Theorem 11 applies too.
    pub unconstrained: bool,
    /// The constants in the bounds.
    pub constants: AuditConstants,
    /// The runs, by n and steps.
    pub cases: Vec<CaseAudit>,
}

/// A line over all runs of a scene.
#[derive(Debug, Clone)]
pub struct SceneLine {
    /// The line of the proof.
    pub statement: Statement,
    /// Largest |left| and |right| of the finest run.
    pub left: f64,
    /// Largest |right| of the finest run.
    pub right: f64,
    /// The worst ratio of all runs, as in [`CaseLine::ratio`].
    pub ratio: Option<f64>,
    /// The line where it is tightest, over all levels and runs.
    pub tightest: Option<Line>,
    /// Powers of h with which left and right fall, at the smallest k; none below the accuracy.
    pub power_h: [Option<f64>; 2],
    /// Powers of k, at the smallest h.
    pub power_k: [Option<f64>; 2],
    /// Over all runs.
    pub standing: LineStanding,
}

impl SceneAudit {
    /// Audits the runs of `setup` on the meshes `ns` with the numbers of steps `steps`, its boundary
    /// rule being that of the model.
    ///
    /// # Errors
    /// [`AuditError`]: no exact solution, a run without result.
    pub fn new(setup: &Setup, ns: &[u32], steps: &[u32]) -> Result<Self, AuditError> {
        covered(setup)?;
        if setup.scene.dimension != 2 {
            return Err(AuditError::Dimension { scene: setup.scene.name.clone() });
        }
        let constants = AuditConstants::new(setup)?;
        let mut cases = Vec::new();
        for &n in ns {
            let data = MeshData::new(setup, n, None)?;
            let audited: Result<Vec<CaseAudit>, AuditError> = steps
                .par_iter()
                .map(|&steps| audit_case(setup, &data, steps, &constants))
                .collect();
            cases.extend(audited?);
        }
        Ok(Self {
            scene: setup.scene.name.clone(),
            fingerprint: setup.scene.source.hash.clone(),
            rule: setup.rule(),
            unconstrained: is_unconstrained(setup),
            constants,
            cases,
        })
    }

    /// True if every line holds in every run, and there is a run.
    pub fn holds(&self) -> bool {
        let rows = |case: &CaseAudit| {
            let holds = |row: &CaseLine| row.standing() == LineStanding::Holds;
            !case.rows.is_empty() && case.rows.iter().all(holds)
        };
        !self.cases.is_empty() && self.cases.iter().all(rows)
    }

    /// The lines in the order of the proof.
    pub fn summaries(&self) -> Vec<SceneLine> {
        let finest = self.cases.iter().max_by(|a, b| (a.n, a.steps).cmp(&(b.n, b.steps)));
        let Some(finest) = finest else { return Vec::new() };
        finest.rows.iter().map(|row| self.summary(row, finest)).collect()
    }

    fn summary(&self, row: &CaseLine, finest: &CaseAudit) -> SceneLine {
        let same = |other: &&CaseLine| other.statement == row.statement;
        let of_case = self.cases.iter().map(|case| (case, case.rows.iter().find(same)));
        let all: Vec<(&CaseAudit, &CaseLine)> =
            of_case.filter_map(|(case, row)| Some((case, row?))).collect();
        // What stands on the right of an identity has no volume integral in it.
        let floors: [fn(&CaseLine) -> f64; 2] = match row.statement.relation {
            Relation::Equal => [|row| row.accuracy, |row| row.rounding],
            Relation::AtMost => [|row| row.accuracy; 2],
        };
        let power = |along_h: bool, i: usize| {
            let sides: [fn(&CaseLine) -> f64; 2] = [|row| row.left, |row| row.right];
            let line = all.iter().filter(|(case, _)| {
                if along_h { case.steps == finest.steps } else { case.n == finest.n }
            });
            let samples: Vec<Sample> = line
                .filter_map(|(case, row)| {
                    let (step, error) = (if along_h { case.h } else { case.k }, sides[i](row));
                    // An undefined bound has no power.
                    (error.is_finite() && error > SEEN * floors[i](row))
                        .then_some(Sample { step, error })
                })
                .collect();
            power_law(&samples).ok().map(|law| law.order)
        };
        let known = all.iter().filter_map(|(_, row)| row.tightest);
        SceneLine {
            tightest: known.reduce(|a, b| if is_tighter(&b, &a) { b } else { a }),
            statement: row.statement,
            left: row.left,
            right: row.right,
            ratio: all.iter().filter_map(|(_, row)| row.ratio).reduce(larger),
            power_h: [power(true, 0), power(true, 1)],
            power_k: [power(false, 0), power(false, 1)],
            standing: all.iter().map(|(_, row)| row.standing()).fold(LineStanding::Holds, Ord::max),
        }
    }
}

/// What the lines leave out of account.
fn covered(setup: &Setup) -> Result<(), SetupError> {
    let others = [
        (Extension::Friction, "its lines are those of the normal law alone"),
        (Extension::SingularKernel, "its sums are those of kernels with a value at s = t"),
    ];
    for (extension, why) in others {
        setup.scene.without(&[extension], "sweep audit", why)?;
    }
    let message =
        "`sweep audit` knows the sums of the trapezoidal rule alone, which is that of the theorems";
    let other = setup.scene.time.rule != TimeRule::Trapezoid;
    setup.scene.refuse_if(other, "time.rule", message, "remove `rule`")?;
    let quadratic = setup.body.data.is_interpolated() && setup.body.element != Element::P1;
    let message = "`sweep audit` knows interpolants of u as linear functions alone";
    let hint = "remove `interpolated`, or take P1";
    Ok(setup.scene.refuse_if(quadratic, "discretization.element", message, hint)?)
}

/// A side counts in a fitted power if it is above so many times its accuracy.
const SEEN: f64 = 10.0;
