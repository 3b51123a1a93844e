//! `[material.projection]`: the projection on the von Mises convex.

use formula::{Interval, Node, Scope, Variable};

use super::diagnostic::Result;
use super::heading::Hypothesis;
use super::reading::Reading;

/// κ is examined on [0, 100 T]: mean strain norms up to 100.
const LARGEST_MEAN_STRAIN: f64 = 100.0;
/// Jumps are looked for up to this many horizons.
const FARTHEST_JUMP: f64 = 1e6;

/// The stress μ(ε - P_{M(κ(ζ))} ε) of (5.1).
#[derive(Debug, Clone, PartialEq)]
pub struct Projection {
    /// μ ≥ 0.
    pub mu: f64,
    /// κ ≥ 0, a formula in zeta, without jumps unless the scene violates (5.1) on purpose.
    pub kappa: Node,
    /// A proved bound of |κ'| for all ζ ≥ 0; infinite if there is none, or none was found. Then [`crate::setup::YieldSlope`]
    /// has one for the ζ that a run can reach.
    pub lipschitz: f64,
}

impl Projection {
    pub(super) fn validate(reading: &mut Reading, horizon: f64) -> Result<Projection> {
        let key = "material.projection.kappa";
        let fault = "is negative: the projection term would not be monotone";
        let hint = "give mu >= 0; remove [material.projection] for mu = 0";
        let fits = |mu: f64| mu >= 0.0 && mu.is_finite();
        let mu = reading.number("material.projection.mu", fits, [fault, hint])?;
        let kappa = reading.formula(key, &Scope::new(&[Variable::Zeta]))?;
        yield_bound(reading, key, kappa, horizon)?;
        let lipschitz = lipschitz(reading, key, kappa, horizon)?;
        Ok(Projection { mu, kappa, lipschitz })
    }
}

/// κ finite and nonnegative.
fn yield_bound(reading: &Reading, key: &str, kappa: Node, horizon: f64) -> Result<()> {
    let over = Interval::new(0.0, LARGEST_MEAN_STRAIN * horizon);
    let must = "a yield bound must be finite and not negative";
    let hint = "give a formula with values >= 0 for all zeta >= 0, such as max(0, 0.2 - zeta)";
    let negative = reading.formulas.largest_negative(kappa, Variable::Zeta, over);
    let message = format!("kappa = {:.6} at zeta = {}: {must}", -negative.attained, negative.at[0]);
    reading.refuse_if(negative.attained > 0.0, key, message, hint)?;
    let size = reading.formulas.largest_modulus(kappa, Variable::Zeta, over);
    let message = format!("kappa has no finite value near zeta = {}: {must}", size.part[0].low);
    reading.refuse_if(!size.bound.is_finite(), key, message, hint)
}

/// The bound of |κ'| for all ζ ≥ 0; refuses a κ without one on [0, 100 T], or with a jump.
fn lipschitz(reading: &mut Reading, key: &str, kappa: Node, horizon: f64) -> Result<f64> {
    let graph = &mut reading.formulas;
    let slope = graph.derivative(kappa, Variable::Zeta);
    let bound = |high| graph.largest_modulus(slope, Variable::Zeta, Interval::new(0.0, high));
    let everywhere = bound(f64::INFINITY);
    let near = match everywhere.bound.is_finite() {
        true => everywhere,
        false => bound(LARGEST_MEAN_STRAIN * horizon),
    };
    let jumps = Interval::new(0.0, FARTHEST_JUMP * horizon);
    let jump = graph.jump(kappa, Variable::Zeta, jumps);
    let fault = match jump {
        Ok(Some(jump)) => Some(format!(
            "it jumps between {:.6} and {:.6} at zeta = {:.6}",
            jump.values.low, jump.values.high, jump.at.low
        )),
        Err(left) => Some(format!("its branches near zeta = {:.6} cannot be told apart", left.low)),
        Ok(None) if !near.bound.is_finite() => {
            Some(format!("its derivative has no bound near zeta = {:.6}", near.part[0].low))
        }
        Ok(None) => None,
    };
    let Some(fault) = fault else { return Ok(everywhere.bound) };
    let message = format!("kappa is not Lipschitz, and (5.1) asks for a constant L_kappa: {fault}");
    let hint = "to run it on purpose, write violates = [\"5.1\"] in [scene]";
    let refused = !reading.violates.contains(&Hypothesis::LipschitzKappa);
    reading.refuse_if(refused, key, message, hint).map(|()| f64::INFINITY)
}
