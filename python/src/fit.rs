//! The judge for one table.

use judge::fit::{
    Claim, Exclusion, FitError, Further, Known, Level, LevelError, TOLERANCE, infer, zeros_in_words,
};
use judge::verdict::Decision;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use super::refused;

/// The judgement of a table: order, interval, slopes, coarse levels left out, where a floor begins; for a claimed order
/// also decision, reason and what would help.
#[pyfunction]
#[pyo3(signature = (sizes, errors, floors, sigmas, order, at_least, exact, tolerance, log, reference))]
#[allow(clippy::too_many_arguments)]
pub fn fit<'py>(
    py: Python<'py>,
    sizes: Vec<f64>,
    errors: Vec<f64>,
    floors: Vec<f64>,
    sigmas: Vec<Option<f64>>,
    order: Option<f64>,
    at_least: bool,
    exact: bool,
    tolerance: Option<f64>,
    log: f64,
    reference: Option<f64>,
) -> PyResult<Bound<'py, PyDict>> {
    let level = |i: usize| {
        let level = Level::new(sizes[i], errors[i])?.with_floor(floors[i])?;
        sigmas[i].map_or(Ok(level), |sigma| level.with_sigma(sigma))
    };
    let at = |i: usize| {
        let named =
            |why: LevelError| refused(format!("level {}, h = {:?}: {why}", i + 1, sizes[i]));
        level(i).map_err(named)
    };
    let levels: Vec<Level> = (0..sizes.len()).map(at).collect::<PyResult<_>>()?;
    // Options are looked at where nothing is predicted as well.
    let tolerance = tolerance.unwrap_or(TOLERANCE);
    let asked = Claim { order: order.unwrap_or(1.0), at_least, exact, tolerance, log };
    let asked = asked.checked().map_err(refused)?;
    let claim = order.map(|_| asked);
    let found = PyDict::new(py);
    let steps = |serving: bool| -> Vec<f64> {
        let all = levels.iter().filter(|level| level.screened().is_ok() == serving);
        all.map(Level::size).collect()
    };
    // By the steps that serve, coarse to fine as the caller sorts them.
    let further = Further::after("h", &steps(true), &steps(false), reference);
    let posterior = match infer(&levels, &Known { log, reference, ..Known::default() }) {
        Ok(posterior) => posterior,
        // Too few levels are a property of the table; other errors are the author's.
        Err(error @ FitError::TooFew { .. }) => {
            let zeros = levels.iter().filter(|l| l.screened() == Err(Exclusion::Zero)).count();
            found.set_item("reason", format!("{error}{}", zeros_in_words(zeros)))?;
            found.set_item("decision", claim.map(|_| "unresolved"))?;
            found.set_item("next", claim.map(|_| further.text))?;
            return Ok(found);
        }
        Err(error) => return Err(refused(error)),
    };
    found.set_item("order", posterior.order)?;
    found.set_item("interval", (posterior.interval.lo, posterior.interval.hi))?;
    // A slope between neighbours of the levels used; levels near their floor are not.
    found.set_item("levels", posterior.slopes.len() + 1)?;
    found.set_item("slopes", posterior.slopes.clone())?;
    found.set_item("left_out", posterior.coarse_left_out)?;
    found.set_item("floor_from", posterior.floor_from)?;
    if let Some(claim) = claim {
        let ruling = posterior.decide(&claim);
        let help = posterior.help(&ruling, further);
        found.set_item("next", help.map(|help| help.text))?;
        found.set_item("decision", ruling.decision.name())?;
        found.set_item("reason", ruling.reason)?;
        found.set_item("probability", ruling.probability)?;
    }
    Ok(found)
}

/// Whether a table that grows level by level may end with this decision, after that of the level before.
#[pyfunction]
pub fn settles(
    levels: usize,
    decision: &str,
    probability: Option<f64>,
    before: Option<&str>,
) -> PyResult<bool> {
    let decision_named = |name: &str| {
        let all = [Decision::Pass, Decision::Fail, Decision::Unresolved];
        let found = all.into_iter().find(|known| known.name() == name);
        found.ok_or_else(|| refused(format!("`{name}` is no decision")))
    };
    let before = before.map(decision_named).transpose()?;
    Ok(judge::fit::settles(levels, decision_named(decision)?, probability, before))
}
