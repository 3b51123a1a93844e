//! What `check` and `solve` say of an abstract scene.

use std::time::Instant;

use nalgebra::DVector;

use super::solve::words::in_words;
use super::{CliError, print_json, print_text};
use exact::{Finding, Status};
use files::digits;
use scene::setup::{AbstractSetup, abstract_regularity};
use studies::theory::bound::sampled::{Constant, table_of_finite};
use vhi::{StepBounds, StepSolver};

/// A number of a scene, and where it comes from.
pub(super) fn fact(subject: &str, value: f64, how: &str) -> Finding {
    Finding::new(subject, Status::Fact, value, format!("{} ({how})", digits(value, 7)))
}

/// The bounds of the step size: (3.4), sharpened, and that of solvability.
pub(super) fn step_facts(bounds: &StepBounds) -> [Finding; 3] {
    let (limit, sharpened, solvable) =
        (bounds.limit(), bounds.sharpened_limit(), bounds.solvable_limit());
    [
        fact("step bound (3.4)", limit, "k below this: one solution per step"),
        fact("sharpened step bound", sharpened, "half weight, terms apart"),
        fact("solvable step bound", solvable, "k below this: each step monotone"),
    ]
}

/// The constants of a table as findings, m0 as it is given.
pub(super) fn of_table(rows: Vec<Constant>, m0: &Finding) -> Vec<Finding> {
    let one = |row: Constant| match &*row.name {
        "m0" => m0.clone(),
        name => {
            // Samples are taken by `bound`, not here.
            let how = row.how.words().split(',').next().unwrap_or_default();
            let how = match &*row.note {
                "" => how.to_owned(),
                note if note.starts_with(how) => note.to_owned(),
                note => format!("{how}: {note}"),
            };
            fact(name, row.value, &how)
        }
    };
    rows.into_iter().map(one).collect()
}

/// Hypotheses of the abstract theory with their constants.
pub(crate) fn findings(setup: &AbstractSetup) -> Vec<Finding> {
    let c = &setup.constants;
    let status = if c.m0 > 0.0 { Status::Verified } else { Status::Weak };
    let m0 = Finding::new("m0 > 0 (2.9)", status, c.m0, format!("m0 = {}", digits(c.m0, 7)));
    let mut findings = of_table(table_of_finite(c, &setup.model), &m0);
    if c.power > 0.0 {
        let note = format!("the same of b in kernels (t-s)^-{} b", c.power);
        findings.push(fact("|b|", c.singular.all, &note));
    }
    findings.extend(step_facts(&c.step_bounds(setup.model.time_rule.as_ref())));
    findings.extend(abstract_regularity(&setup.scene, &setup.problem));
    findings
}

pub(crate) fn solve(
    setup: &AbstractSetup,
    steps: u32,
    solver: &dyn StepSolver,
    contraction_bound: Option<f64>,
    json: bool,
) -> Result<u8, CliError> {
    let start = Instant::now();
    let run = setup
        .run(steps, solver)
        .map_err(|error| CliError::about(format!("{} steps = {steps}", setup.scene.name), error))?;
    let document = serde_json::json!({
        "norm": setup.model.norm(&DVector::from_column_slice(&run.u)),
        "u": run.u,
        "history": run.history,
        "pressure": run.pressure,
        "V_max": run.error,
        "newton_iterations": run.info.newton_iterations,
        "fixed_point_iterations": run.info.fixed_point_iterations,
        "convex_problems": run.info.convex_problems,
        "contraction": contraction_bound.map(|_| run.info.contraction),
        "contraction_bound": contraction_bound,
        "kkt_residual": run.info.kkt_residual,
        "seconds": start.elapsed().as_secs_f64(),
        "dofs": setup.scene.dimension,
    });
    if json {
        print_json(&document)?;
    } else {
        let case = format!("{}, N = {steps}", setup.scene.name);
        print_text(&in_words(&case, &document, setup.scene.dimension));
    }
    Ok(0)
}
