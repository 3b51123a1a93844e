//! A scene audited: its runs, for each inequality the place where it comes nearest to failing, and the powers of h and k with
//! which both sides fall; as JSON, as a table of all runs, and in words.

use rayon::prelude::*;
use serde_json::{Value, json};

use super::constants::{AuditConstants, c_j_source};
use super::level::{AuditError, Auditor};
use crate::table;
use algebra::linalg::larger;
use fem::contact::{BoundaryRule, CaseError, Discretization};
use judge::claim::{Claim, Standing};
use judge::fit::{Sample, power_law};
use report::{Chapter, Row, Run, StudyDocument, Tone, digits, held, number, precise};
use run::sweep::{Runs, run_cost};
use scene::setup::{MeshData, Setup, SetupError};
use scene::{Extension, TimeRule};

/// A side counts in a fitted power if it is above so many times its accuracy.
const SEEN: f64 = 10.0;

/// An inequality over all levels of a run.
#[derive(Debug, Clone, Copy)]
pub struct CaseLine {
    /// Where it comes nearest to failing, or fails by most.
    pub worst: Claim,
    /// Largest |left| and |right|, and the largest accuracy.
    pub largest: [f64; 2],
    pub accuracy: f64,
}

/// An inequality over all runs, with the powers of h and of k of its two sides.
type Line = (CaseLine, [[Option<f64>; 2]; 2]);

/// An audited run.
#[derive(Debug, Clone)]
pub struct CaseAudit {
    /// Cells per unit length.
    pub n: u32,
    /// N.
    pub steps: u32,
    /// h.
    pub h: f64,
    /// k.
    pub k: f64,
    /// The inequalities in the order of their numbers.
    pub rows: Vec<CaseLine>,
}

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

impl CaseLine {
    /// The inequalities of a run from the claims of its levels.
    pub fn of_levels(claims: &[Claim]) -> Vec<Self> {
        let mut rows: Vec<Self> = Vec::new();
        for claim in claims {
            let Claim { left, right, accuracy, .. } = *claim;
            let known = rows.iter_mut().find(|row| row.worst.statement == claim.statement);
            let Some(row) = known else {
                rows.push(Self { worst: *claim, largest: [left.abs(), right.abs()], accuracy });
                continue;
            };
            if claim.is_worse_than(&row.worst) {
                row.worst = *claim;
            }
            row.largest = [larger(row.largest[0], left.abs()), larger(row.largest[1], right.abs())];
            row.accuracy = larger(row.accuracy, accuracy);
        }
        rows
    }

    fn holds(&self) -> bool {
        self.worst.standing() == Standing::Passes
    }
}

/// Runs a case of `setup` by its scheme and audits every level.
///
/// # Errors
/// [`AuditError`].
pub fn audit_case(
    setup: &Setup,
    data: &MeshData,
    steps: u32,
    constants: &AuditConstants,
) -> Result<CaseAudit, AuditError> {
    let mut auditor = Auditor::new(setup, data, steps, constants)?;
    let n = data.space.mesh.n;
    let run = setup
        .scheme
        .march(setup, data, steps, &mut |view| auditor.observe(view).map_err(CaseError::from));
    run.map_err(|source| AuditError::Run { n, steps, source })?;
    let (h, k) = (data.space.mesh.h(), setup.grid(steps).largest_step());
    Ok(CaseAudit { n, steps, h, k, rows: CaseLine::of_levels(&auditor.claims()) })
}

/// The runs of [`SceneAudit::new`], `jobs` of a mesh at a time.
pub fn audit_runs<'a>(setup: &'a Setup, ns: &[u32], steps: &[u32], jobs: usize) -> Runs<'a> {
    let grid = ns.iter().flat_map(|&n| steps.iter().map(move |&steps| (n, steps))).collect();
    let others = steps.len().min(jobs).saturating_sub(1) as f64;
    // The scene's own, and that of the memory alone.
    let truths = if setup.model.memory.is_empty() { 1.0 } else { 2.0 };
    let beside = move |space: &Discretization, steps: u32| {
        // The others march as well, with fewer steps or as many; beside each stands what the rule remembers of u and u^{kh}, and
        // once what the truths keep: points, and moments of all levels.
        let run = run_cost(setup, space, steps);
        let strains = 3.0 * space.geometry.points() as f64;
        let moments = 2.0 * strains + 2.0 * space.nodes.cells.len() as f64;
        others * run.march_bytes
            + (1.0 + others) * (1.0 + strains / space.dofs() as f64) * run.history_bytes
            + truths * (run.load_bytes + 8.0 * moments * (f64::from(steps) + 1.0))
    };
    Runs { setup, grid, beside: Box::new(beside) }
}

impl SceneAudit {
    /// Audits the runs of `setup` on the meshes `ns` with the numbers of steps `steps`, by the boundary rule of the model.
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
            let run = |&steps: &u32| audit_case(setup, &data, steps, &constants);
            cases.extend(steps.par_iter().map(run).collect::<Result<Vec<_>, AuditError>>()?);
        }
        let contact = setup.body.contact.as_ref();
        Ok(Self {
            scene: setup.scene.name.clone(),
            fingerprint: setup.scene.source.hash.clone(),
            rule: setup.rule(),
            unconstrained: contact.is_none_or(|contact| contact.gap.is_none()),
            constants,
            cases,
        })
    }

    /// True if every inequality holds in every run, and there is a run.
    pub fn holds(&self) -> bool {
        let holds =
            |case: &CaseAudit| !case.rows.is_empty() && case.rows.iter().all(CaseLine::holds);
        !self.cases.is_empty() && self.cases.iter().all(holds)
    }

    /// The inequalities in the order of their numbers.
    fn lines(&self) -> Vec<Line> {
        let finest = self.cases.iter().max_by_key(|case| (case.n, case.steps));
        let Some(finest) = finest else { return Vec::new() };
        let line = |of_finest: &CaseLine| {
            let same = |row: &&CaseLine| row.worst.statement == of_finest.worst.statement;
            let rows =
                self.cases.iter().filter_map(|case| Some((case, case.rows.iter().find(same)?)));
            let rows: Vec<(&CaseAudit, &CaseLine)> = rows.collect();
            // At the smallest k, or at the smallest h.
            let power = |of_h: bool, side: usize| {
                let along = |case: &CaseAudit| {
                    if of_h { case.steps == finest.steps } else { case.n == finest.n }
                };
                let seen = |row: &CaseLine| {
                    row.largest[side].is_finite() && row.largest[side] > SEEN * row.accuracy
                };
                let line = rows.iter().filter(|(case, row)| along(case) && seen(row));
                let sample = |(case, row): &(&CaseAudit, &CaseLine)| Sample {
                    step: if of_h { case.h } else { case.k },
                    error: row.largest[side],
                };
                power_law(&line.map(sample).collect::<Vec<_>>()).ok().map(|law| law.order)
            };
            let claims: Vec<Claim> = rows.iter().map(|(_, row)| row.worst).collect();
            let over_all = CaseLine { worst: CaseLine::of_levels(&claims)[0].worst, ..*of_finest };
            (over_all, [[power(true, 0), power(true, 1)], [power(false, 0), power(false, 1)]])
        };
        finest.rows.iter().map(line).collect()
    }

    /// One sentence for each inequality and run that fails.
    pub fn violations(&self) -> Vec<String> {
        let rows = self.cases.iter().flat_map(|case| &case.rows);
        let failing = rows.filter(|row| row.worst.standing() == Standing::Fails);
        failing.filter_map(|row| row.worst.reason()).collect()
    }

    /// One sentence for each inequality without a defined constant.
    pub fn undefined(&self) -> Vec<String> {
        let m0 = self.constants.m0();
        let why = match m0 <= 0.0 {
            true => format!("m0 = {} is not positive, (2.9) is violated", digits(m0, 5)),
            false => "a constant in it is infinite".to_owned(),
        };
        let lines = self.lines().into_iter().map(|(line, _)| line.worst);
        let undefined = lines.filter(|worst| worst.standing() == Standing::Unresolved);
        undefined
            .map(|worst| format!("{} has no defined constant: {why}", worst.statement.source))
            .collect()
    }

    /// The rule's word in scene files.
    fn rule_name(&self) -> &'static str {
        match self.rule {
            BoundaryRule::Vertex => "vertex",
            BoundaryRule::Gauss => "gauss",
            BoundaryRule::Exact => "exact",
        }
    }

    /// The theorems whose inequalities are audited.
    fn theorem(&self) -> &'static str {
        if self.unconstrained { "Theorems 10 and 11 (K = X)" } else { "Theorem 10" }
    }

    /// The audit as JSON.
    ///
    /// # Errors
    /// The writer's.
    pub fn json(&self) -> Result<Value, serde_json::Error> {
        let mut constants = serde_json::to_value(&self.constants)?;
        constants["m0"] = json!(self.constants.m0());
        let line = |(row, [power_h, power_k]): &Line| {
            let mut line = json!(row.worst);
            (line["power_h"], line["power_k"]) = (json!(power_h), json!(power_k));
            line
        };
        let case = |case: &CaseAudit| {
            let lines: Vec<Claim> = case.rows.iter().map(|row| row.worst).collect();
            json!({ "n": case.n, "steps": case.steps, "h": case.h, "k": case.k, "lines": lines })
        };
        Ok(json!({
            "scene": self.scene,
            "fingerprint": self.fingerprint,
            "theorem": self.theorem(),
            "rule": self.rule_name(),
            "holds": self.holds(),
            "constants": constants,
            "lines": self.lines().iter().map(line).collect::<Vec<_>>(),
            "cases": self.cases.iter().map(case).collect::<Vec<_>>(),
            "violations": self.violations(),
            "undefined": self.undefined(),
        }))
    }

    /// `SCENE-audit.csv`.
    ///
    /// # Errors
    /// The writer's.
    pub fn csv(&self) -> Result<Vec<u8>, csv::Error> {
        let exponential = |value: f64| format!("{value:e}");
        let row = |case: &CaseAudit, row: &CaseLine| {
            let (worst, largest) = (&row.worst, row.largest);
            let right = Some(largest[1]).filter(|_| worst.standing() != Standing::Unresolved);
            let fails = worst.standing() == Standing::Fails;
            let if_failing = |text: String| if fails { text } else { String::new() };
            [
                ("scene", self.scene.clone()),
                ("rule", self.rule_name().to_owned()),
                ("n", case.n.to_string()),
                ("steps", case.steps.to_string()),
                ("h", case.h.to_string()),
                ("k", case.k.to_string()),
                ("line", worst.statement.source.to_owned()),
                ("says", worst.statement.says.to_owned()),
                ("relation", "<=".to_owned()),
                ("left", exponential(largest[0])),
                ("right", right.map_or_else(String::new, exponential)),
                ("ratio", worst.tightness().map_or_else(String::new, exponential)),
                ("accuracy", exponential(row.accuracy)),
                ("holds", row.holds().to_string()),
                ("worst_level", if_failing(worst.place.level.to_string())),
                ("worst_excess", if_failing(exponential(worst.excess()))),
            ]
        };
        let rows = self.cases.iter().flat_map(|case| case.rows.iter().map(move |r| (case, r)));
        table::csv(rows.map(|(case, line)| row(case, line)))
    }

    /// The audit as a document.
    pub fn document(&self) -> StudyDocument {
        let mut lines = self.lines();
        let title = format!("Checklist: {}", self.scene);
        let mut document =
            StudyDocument::new(Chapter::Audit, title).of_scene(&self.scene, &self.fingerprint);
        let grid = |of: fn(&CaseAudit) -> u32| {
            let mut all: Vec<u32> = self.cases.iter().map(of).collect();
            all.sort_unstable();
            all.dedup();
            all.iter().map(u32::to_string).collect::<Vec<_>>().join(", ")
        };
        let held_lines = lines.iter().filter(|(line, _)| line.holds()).count();
        let all = format!("{held_lines} of {} inequalities hold in all runs.", lines.len());
        let mut failures = self.violations();
        failures.extend(self.undefined());
        if !failures.is_empty() {
            failures.push(all.clone());
        }
        document.verdict(self.holds() && failures.is_empty(), &all, failures);
        document.words(format!(
            "{}; boundary rule {}; runs with n = {} and N = {}.",
            self.theorem(),
            self.rule_name(),
            grid(|case| case.n),
            grid(|case| case.steps)
        ));
        // What fails first; of one tightness in the order of their numbers.
        let rank = |line: &CaseLine| match line.worst.standing() {
            Standing::Passes => line.worst.tightness().unwrap_or(f64::NEG_INFINITY),
            _ => f64::INFINITY,
        };
        lines.sort_by(|(a, _), (b, _)| rank(b).total_cmp(&rank(a)));
        document.table(
            "The inequalities of the proof, the tightest first: both sides where they are tightest over all levels and runs; left − right; \
             what rounding allows; the tightness, left/right; the powers of h and k with which the sides fall.",
            lines.iter().map(line),
        );
        document.table("Constants of the bounds.", self.constants.rows());
        document
    }
}

impl AuditConstants {
    fn rows(&self) -> [Row<'static, 2>; 10] {
        let c = self;
        let c_j = format!("c_j², {}", c_j_source(c.c_j_proved));
        let named = [
            ("m_A", c.m_a),
            ("L_A", c.l_a),
            ("α_φ", c.alpha_phi),
            ("β_φ", c.beta_phi),
            ("α_j", c.alpha_j),
            (&c_j, c.c_j_squared),
            ("c0", c.c0),
            ("c1", c.c1),
            ("‖R‖‖q‖", c.history),
            ("m0", c.m0()),
        ];
        named.map(|(name, value)| [("constant", Run::formula(name)), (">value", precise(value, 7))])
    }
}

fn line((line, [power_h, power_k]): &Line) -> Row<'static, 11> {
    let worst = &line.worst;
    // The signs of sums and integrals; the rest is letters.
    let signs = [("sum_j", "Σ_j"), ("Au", "A u")];
    let says = signs
        .iter()
        .fold(worst.statement.says.to_owned(), |text, (from, to)| text.replace(from, to));
    let short = |value: Option<f64>| Run::plain(value.map_or_else(|| "–".into(), |v| digits(v, 3)));
    let powers = |[left, right]: [Option<f64>; 2]| {
        let text = |power: Option<f64>| power.map_or_else(|| "–".into(), |p| format!("{p:.2}"));
        Run::plain(format!("{}, {}", text(left), text(right)))
    };
    let so_it = match worst.standing() {
        Standing::Unresolved => Run::of("is not defined", Tone::Miss),
        standing => held(standing == Standing::Passes),
    };
    [
        ("line", Run::plain(worst.statement.source)),
        ("says", Run::formula(&says)),
        (">left", number(worst.left)),
        ("", Run::plain("≤")),
        (">right", number(Some(worst.right).filter(|right| right.is_finite()))),
        (">difference", short(Some(worst.excess()).filter(|by| by.is_finite()))),
        (">accuracy", short(Some(worst.accuracy))),
        (">tightness", short(worst.tightness())),
        ("powers of h", powers(*power_h)),
        ("powers of k", powers(*power_k)),
        ("so it", so_it),
    ]
}

/// What the inequalities leave out of account.
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
    Ok(setup.scene.refuse_if(other, "time.rule", message, "remove `rule`")?)
}
