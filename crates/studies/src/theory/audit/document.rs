//! An audit as JSON, as a table of all runs, and in words.

use serde_json::{Value, json};

use super::case::{CaseAudit, CaseLine};
use super::constants::{AuditConstants, c_j_source};
use super::lines::{LineStanding, Relation};
use super::scene::{SceneAudit, SceneLine};
use crate::table;
use fem::contact::BoundaryRule;
use report::{Chapter, Row, Run, StudyDocument, Tone, digits, held, number, precise};

impl SceneAudit {
    /// The rule's word in scene files.
    pub(crate) fn rule_name(&self) -> &'static str {
        match self.rule {
            BoundaryRule::Vertex => "vertex",
            BoundaryRule::Gauss => "gauss",
            BoundaryRule::Exact => "exact",
        }
    }

    /// The theorems whose lines are audited.
    pub(crate) fn theorem(&self) -> &'static str {
        if self.unconstrained { "Theorems 10 and 11 (K = X)" } else { "Theorem 10" }
    }

    /// The audit as JSON, with a sentence for each violation and each line without a defined constant.
    ///
    /// # Errors
    /// The writer's.
    pub fn json(&self) -> Result<Value, serde_json::Error> {
        let mut constants = serde_json::to_value(&self.constants)?;
        constants["m0"] = json!(self.constants.m0());
        let of_run = |row: &CaseLine| {
            json!({
                "line": row.statement.name, "left": row.left, "right": row.right, "ratio": row.ratio,
                "accuracy": row.accuracy, "holds": row.standing() == LineStanding::Holds,
            })
        };
        let case = |case: &CaseAudit| {
            json!({
                "n": case.n, "steps": case.steps, "h": case.h, "k": case.k,
                "lines": case.rows.iter().map(of_run).collect::<Vec<_>>(),
            })
        };
        let line = |line: &SceneLine| {
            json!({
                "line": line.statement.name, "says": line.statement.says,
                "relation": line.statement.relation.sign(), "left": line.left, "right": line.right,
                "ratio": line.ratio, "tightness": line.tightness(), "difference": line.tightest.map(|at| at.excess()),
                "accuracy": line.tightest.map(|at| at.accuracy), "power_h": line.power_h, "power_k": line.power_k,
                "holds": line.standing == LineStanding::Holds,
                "defined": line.standing != LineStanding::Undefined,
            })
        };
        Ok(json!({
            "scene": self.scene,
            "fingerprint": self.fingerprint,
            "theorem": self.theorem(),
            "rule": self.rule_name(),
            "holds": self.holds(),
            "constants": constants,
            "lines": self.summaries().iter().map(line).collect::<Vec<_>>(),
            "cases": self.cases.iter().map(case).collect::<Vec<_>>(),
            "violations": self.violations(),
            "undefined": self.undefined(),
        }))
    }

    /// One sentence for each violated line and run: line, level, grid, both sides.
    pub fn violations(&self) -> Vec<String> {
        let rows = self.cases.iter().flat_map(|case| case.rows.iter().map(move |row| (case, row)));
        rows.filter_map(|(case, row)| {
            let (level, v) = row.violation?;
            let sign = row.statement.relation.sign();
            let difference = match row.statement.relation {
                Relation::AtMost => "exceeds by",
                Relation::Equal => "differs by",
            };
            Some(format!(
                "{} at level {} of n = {}, N = {} (h = {:.4e}, k = {:.4e}): {:.9e} {sign} {:.9e} does not hold; it {difference} {:.3e}, allowed {:.1e}",
                row.statement.name,
                level,
                case.n,
                case.steps,
                case.h,
                case.k,
                v.left,
                v.right,
                v.excess(),
                v.accuracy
            ))
        })
        .collect()
    }

    /// One sentence for each line whose bound is not defined.
    pub fn undefined(&self) -> Vec<String> {
        let m0 = self.constants.m0();
        let why = match m0 <= 0.0 {
            true => format!("m0 = {} is not positive, (2.9) is violated", digits(m0, 5)),
            false => "a constant in it is infinite".to_owned(),
        };
        let summaries = self.summaries().into_iter();
        let undefined = summaries.filter(|line| line.standing == LineStanding::Undefined);
        let names = undefined.map(|line| line.statement.name);
        names.map(|name| format!("{name} has no defined constant: {why}")).collect()
    }

    /// `SCENE-audit.csv`.
    ///
    /// # Errors
    /// The writer's.
    pub fn csv(&self) -> Result<Vec<u8>, csv::Error> {
        let exponential = |value: f64| format!("{value:e}");
        let row = |case: &CaseAudit, row: &CaseLine| {
            let (standing, worst) = (row.standing(), row.violation);
            let excess = worst.map(|(_, v)| v.excess());
            let right = Some(row.right).filter(|_| standing != LineStanding::Undefined);
            [
                ("scene", self.scene.clone()),
                ("rule", self.rule_name().to_owned()),
                ("n", case.n.to_string()),
                ("steps", case.steps.to_string()),
                ("h", case.h.to_string()),
                ("k", case.k.to_string()),
                ("line", row.statement.name.to_owned()),
                ("says", row.statement.says.to_owned()),
                ("relation", row.statement.relation.sign().to_owned()),
                ("left", exponential(row.left)),
                ("right", right.map_or_else(String::new, exponential)),
                ("ratio", row.ratio.map_or_else(String::new, exponential)),
                ("accuracy", exponential(row.accuracy)),
                ("holds", (standing == LineStanding::Holds).to_string()),
                ("worst_level", worst.map_or_else(String::new, |(level, _)| level.to_string())),
                ("worst_excess", excess.map_or_else(String::new, exponential)),
            ]
        };
        let rows = self.cases.iter().flat_map(|case| case.rows.iter().map(move |r| (case, r)));
        table::csv(rows.map(|(case, line)| row(case, line)))
    }

    /// The audit as a document.
    pub fn document(&self) -> StudyDocument {
        let lines = self.summaries();
        let title = format!("Checklist: {}", self.scene);
        let mut document =
            StudyDocument::new(Chapter::Audit, title).of_scene(&self.scene, &self.fingerprint);
        let grid = |of: fn(&CaseAudit) -> u32| {
            let mut all: Vec<u32> = self.cases.iter().map(of).collect();
            all.sort_unstable();
            all.dedup();
            all.iter().map(u32::to_string).collect::<Vec<_>>().join(", ")
        };
        let held_lines = lines.iter().filter(|line| line.standing == LineStanding::Holds).count();
        let all = format!("{held_lines} of {} lines hold in all runs.", lines.len());
        let mut failures = self.violations();
        failures.extend(self.undefined());
        if !failures.is_empty() {
            failures.push(all.clone());
        }
        let holds = self.holds() && held_lines == lines.len() && failures.is_empty();
        document.verdict(holds, &all, failures);
        document.words(format!(
            "{}; boundary rule {}; runs with n = {} and N = {}.",
            self.theorem(),
            self.rule_name(),
            grid(|case| case.n),
            grid(|case| case.steps)
        ));
        document.table(
            "The lines of the proof, the tightest first: both sides where they are tightest over all levels and runs; left − right, of an \
             identity its magnitude; what rounding and quadrature allow; the tightness, left/right or, of an identity, difference over \
             accuracy; the powers of h and k with which the sides fall.",
            by_tightness(&lines).into_iter().map(line),
        );
        document.table("Constants of the bounds.", self.constants.rows());
        document
    }
}

/// The lines from what fails to what is furthest from it; those of one tightness in the order of the proof.
fn by_tightness(lines: &[SceneLine]) -> Vec<&SceneLine> {
    let rank = |line: &SceneLine| match line.standing {
        LineStanding::Holds => line.tightness().unwrap_or(f64::NEG_INFINITY),
        LineStanding::Violated | LineStanding::Undefined => f64::INFINITY,
    };
    let mut sorted: Vec<&SceneLine> = lines.iter().collect();
    sorted.sort_by(|a, b| rank(b).total_cmp(&rank(a)));
    sorted
}

impl SceneLine {
    /// The tightness: left/right, of an identity the difference over the accuracy.
    fn tightness(&self) -> Option<f64> {
        self.tightest?.tightness()
    }
}

impl AuditConstants {
    fn rows(&self) -> [Row<'static, 2>; 11] {
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
            ("c_φ", c.c_phi),
            ("‖R‖‖q‖", c.history),
            ("m0", c.m0()),
        ];
        named.map(|(name, value)| [("constant", Run::formula(name)), (">value", precise(value, 7))])
    }
}

/// What a line says, with the signs of sums and integrals; the rest is letters.
fn in_signs(says: &str) -> String {
    let signs = [("sum_j", "Σ_j"), ("sum w", "Σ w"), ("int lambda", "∫ lambda"), ("Au", "A u")];
    signs.iter().fold(says.to_owned(), |text, (from, to)| text.replace(from, to))
}

fn line(line: &SceneLine) -> Row<'static, 11> {
    let sign = if line.statement.relation == Relation::Equal { "=" } else { "≤" };
    let short = |value: Option<f64>| Run::plain(value.map_or_else(|| "–".into(), |v| digits(v, 3)));
    let powers = |[left, right]: [Option<f64>; 2]| {
        let text = |power: Option<f64>| power.map_or_else(|| "–".into(), |p| format!("{p:.2}"));
        Run::plain(format!("{}, {}", text(left), text(right)))
    };
    // Without a level at which the sides are seen, the largest of the finest run.
    let (left, right) = line.tightest.map_or((line.left, line.right), |at| (at.left, at.right));
    let so_it = match line.standing {
        LineStanding::Undefined => Run::of("is not defined", Tone::Miss),
        standing => held(standing == LineStanding::Holds),
    };
    [
        ("line", Run::plain(line.statement.name)),
        ("says", Run::formula(&in_signs(line.statement.says))),
        (">left", number(left)),
        ("", Run::plain(sign)),
        (">right", number(Some(right).filter(|right| right.is_finite()))),
        (">difference", short(line.tightest.map(|at| at.excess()))),
        (">accuracy", short(line.tightest.map(|at| at.accuracy))),
        (">tightness", short(line.tightness())),
        ("powers of h", powers(line.power_h)),
        ("powers of k", powers(line.power_k)),
        ("so it", so_it),
    ]
}
