//! An audit as JSON, CSV and a picture.

use serde_json::{Value, json};

use super::case::{CaseAudit, Row};
use super::lines::{Relation, Standing};
use super::scene::{SceneAudit, Summary};
use fem::contact::BoundaryRule;
use report::{Axis, Chart, Mark, Part, ReportError, Scale, Series};

/// Columns of `SCENE-audit.csv`: a row a run and line.
const COLUMNS: [&str; 16] = [
    "scene",
    "rule",
    "n",
    "steps",
    "h",
    "k",
    "line",
    "says",
    "relation",
    "left",
    "right",
    "ratio",
    "accuracy",
    "holds",
    "worst_level",
    "worst_excess",
];

/// Ratios of these inequalities are drawn: the bounds of the proof.
const DRAWN: [&str; 7] = ["(4.7)", "(4.14)", "(4.16)", "(4.17)", "(4.19)", "(4.20)", "(5.23)"];

impl SceneAudit {
    /// The rule's word in scene files.
    pub fn rule_name(&self) -> &'static str {
        match self.rule {
            BoundaryRule::Vertex => "vertex",
            BoundaryRule::Gauss => "gauss",
            BoundaryRule::Exact => "exact",
        }
    }

    /// The theorems whose lines are audited.
    pub fn theorem(&self) -> &'static str {
        if self.unconstrained { "Theorems 10 and 11 (K = X)" } else { "Theorem 10" }
    }

    /// Where c_j² comes from.
    pub fn c_j_source(&self) -> &'static str {
        if self.constants.c_j_proved {
            "proved upper bound"
        } else {
            "extrapolated from meshes, no upper bound"
        }
    }

    /// The audit as JSON; numbers that are not finite are null.
    pub fn json(&self) -> Value {
        let c = &self.constants;
        let summaries = self.summaries();
        json!({
            "scene": self.scene,
            "theorem": self.theorem(),
            "rule": self.rule_name(),
            "holds": self.holds(),
            "constants": {
                "m_A": c.m_a, "L_A": c.l_a, "alpha_phi": c.alpha_phi, "beta_phi": c.beta_phi,
                "alpha_j": c.alpha_j, "c_j_squared": c.c_j_squared, "c_j_source": self.c_j_source(),
                "c0": c.c0, "c1": c.c1, "c_phi": c.c_phi, "history": c.history, "m0": c.m0(),
            },
            "lines": summaries.iter().map(summary).collect::<Vec<_>>(),
            "cases": self.cases.iter().map(case).collect::<Vec<_>>(),
            "violations": self.violations(),
            "undefined": self.undefined(),
        })
    }

    /// One sentence a violated line and run: line, level, grid, both sides.
    pub fn violations(&self) -> Vec<String> {
        let rows = self.cases.iter().flat_map(|case| case.rows.iter().map(move |row| (case, row)));
        rows.filter_map(|(case, row)| {
            let v = row.violation?;
            let (sign, difference) = match row.relation {
                Relation::AtMost => ("<=", "exceeds by"),
                Relation::Equal => ("=", "differs by"),
            };
            Some(format!(
                "{} at level {} of n = {}, N = {} (h = {:.4e}, k = {:.4e}): {:.9e} {sign} {:.9e} does not hold; it {difference} {:.3e}, allowed {:.1e}",
                row.statement.name,
                v.level,
                case.n,
                case.steps,
                case.h,
                case.k,
                v.left,
                v.right,
                excess(row.relation, v.left, v.right),
                v.accuracy
            ))
        })
        .collect()
    }

    /// One sentence a line whose bound is not defined.
    pub fn undefined(&self) -> Vec<String> {
        let m0 = self.constants.m0();
        let why = match m0 <= 0.0 {
            true => format!("m0 = {m0:.4} is not positive, (2.9) is violated"),
            false => "a constant in it is infinite".to_owned(),
        };
        let summaries = self.summaries();
        let undefined = summaries.iter().filter(|summary| summary.standing == Standing::Undefined);
        let sentence = |summary: &Summary| {
            format!("{} has no defined constant: {why}", summary.statement.name)
        };
        undefined.map(sentence).collect()
    }

    /// `SCENE-audit.csv`.
    ///
    /// # Errors
    /// The writer's.
    pub fn csv(&self) -> Result<Vec<u8>, csv::Error> {
        let mut writer = csv::Writer::from_writer(Vec::new());
        writer.write_record(COLUMNS)?;
        for case in &self.cases {
            for row in &case.rows {
                let worst = row.violation;
                writer.write_record([
                    self.scene.clone(),
                    self.rule_name().to_owned(),
                    case.n.to_string(),
                    case.steps.to_string(),
                    case.h.to_string(),
                    case.k.to_string(),
                    row.statement.name.to_owned(),
                    row.statement.says.to_owned(),
                    relation(row.relation).to_owned(),
                    format!("{:e}", row.left),
                    match row.standing() {
                        Standing::Undefined => String::new(),
                        _ => format!("{:e}", row.right),
                    },
                    row.ratio.map_or(String::new(), |ratio| format!("{ratio:e}")),
                    format!("{:e}", row.accuracy),
                    (row.standing() == Standing::Holds).to_string(),
                    worst.map_or(String::new(), |v| v.level.to_string()),
                    worst.map_or(String::new(), |v| {
                        format!("{:e}", excess(row.relation, v.left, v.right))
                    }),
                ])?;
            }
        }
        writer.into_inner().map_err(|error| error.into_error().into())
    }

    /// Ratios left/right of the bounds against h, at the smallest k; none with fewer than two meshes.
    ///
    /// # Errors
    /// The drawing library's.
    pub fn svg(&self) -> Result<Option<String>, ReportError> {
        let steps = self.cases.iter().map(|case| case.steps).max().unwrap_or(0);
        let line: Vec<&CaseAudit> = self.cases.iter().filter(|case| case.steps == steps).collect();
        if line.len() < 2 {
            return Ok(None);
        }
        let question = format!(
            "Share of each bound that is used, largest over the levels (N = {steps}, rule {})",
            self.rule_name()
        );
        let x = Axis::new("mesh size h (length)", Scale::Log);
        let y = Axis::new("left side / right side", Scale::Log);
        let mut chart = Chart::new(&format!("{}: {}", self.scene, self.theorem()), &question, x, y);
        for name in DRAWN {
            let points: Vec<(f64, f64)> = line
                .iter()
                .filter_map(|case| {
                    let row = case.rows.iter().find(|row| row.statement.name == name)?;
                    Some((case.h, row.ratio.filter(|ratio| *ratio > 0.0)?))
                })
                .collect();
            if points.len() > 1 {
                let parts = vec![Part::Line(points.clone()), Part::Points(points)];
                chart.series.push(Series::new(name, parts));
            }
        }
        chart.horizontals = vec![Mark { at: 1.0, label: "the bound is attained".into() }];
        chart.svg()
    }
}

fn excess(of: Relation, left: f64, right: f64) -> f64 {
    match of {
        Relation::AtMost => left - right,
        Relation::Equal => (left - right).abs(),
    }
}

fn relation(relation: Relation) -> &'static str {
    match relation {
        Relation::AtMost => "<=",
        Relation::Equal => "=",
    }
}

fn summary(summary: &Summary) -> Value {
    json!({
        "line": summary.statement.name,
        "says": summary.statement.says,
        "relation": relation(summary.relation),
        "left": summary.left,
        "right": summary.right,
        "ratio": summary.ratio,
        "power_h": summary.power_h,
        "power_k": summary.power_k,
        "holds": summary.standing == Standing::Holds,
        "defined": summary.standing != Standing::Undefined,
    })
}

fn case(case: &CaseAudit) -> Value {
    json!({
        "n": case.n, "steps": case.steps, "h": case.h, "k": case.k,
        "lines": case.rows.iter().map(row).collect::<Vec<_>>(),
    })
}

fn row(row: &Row) -> Value {
    json!({
        "line": row.statement.name,
        "left": row.left,
        "right": row.right,
        "ratio": row.ratio,
        "accuracy": row.accuracy,
        "holds": row.standing() == Standing::Holds,
    })
}
