//! `[material.projection]`: the projection on the von Mises convex.

use formula::{EvaluationPoint, Node, Scope, Variable};

use super::diagnostic::SceneError;
use super::heading::Hypothesis;
use super::reading::{Reading, evenly};

/// Even intervals of the range of ζ, and points that crowd towards ζ = 0.
const EVEN_SAMPLES: u32 = 2000;
const CROWDED_SAMPLES: i32 = 48;
/// Sampled range of ζ, in horizons: mean strain norms up to 100.
const LARGEST_MEAN_STRAIN: f64 = 100.0;

/// The stress μ(ε - P_{M(κ(ζ))} ε) of (5.1).
#[derive(Debug, Clone, PartialEq)]
pub struct Projection {
    /// μ ≥ 0.
    pub mu: f64,
    /// κ ≥ 0, a formula in zeta.
    pub kappa: Node,
    /// L_κ: largest sampled |κ'| on [0, 100 T]; infinite only if the scene violates (5.1) on purpose.
    pub lipschitz: f64,
}

impl Projection {
    pub(super) fn validate(reading: &mut Reading, horizon: f64) -> Result<Projection, SceneError> {
        let key = "material.projection.kappa";
        let fault = "is negative: the projection term would not be monotone";
        let hint = "give mu >= 0; remove [material.projection] for mu = 0";
        let fits = |mu: f64| mu >= 0.0 && mu.is_finite();
        let mu = reading.number("material.projection.mu", fits, [fault, hint])?;
        let kappa = reading.formula(key, &Scope::new(&[Variable::Zeta]))?;
        let fits = |kappa: f64| kappa.is_finite() && kappa >= 0.0;
        reading.everywhere((key, kappa), samples(horizon), fits, |at, value| {
            let (zeta, must) = (at.zeta, "a yield bound must be finite and not negative");
            let hint =
                "give a formula with values >= 0 for all zeta >= 0, such as max(0, 0.2 - zeta)";
            (format!("kappa = {value} at zeta = {zeta}: {must}"), hint)
        })?;
        let lipschitz = lipschitz(reading, key, kappa, horizon)?;
        Ok(Projection { mu, kappa, lipschitz })
    }
}

/// L_κ from the exact derivative at the samples.
fn lipschitz(
    reading: &mut Reading,
    key: &str,
    kappa: Node,
    horizon: f64,
) -> Result<f64, SceneError> {
    let slope = reading.formulas.derivative(kappa, Variable::Zeta);
    if !reading.violates.contains(&Hypothesis::LipschitzKappa) {
        reading.everywhere((key, slope), samples(horizon), f64::is_finite, |at, value| {
            let message = format!(
                "kappa is not Lipschitz: its derivative at zeta = {} is {value}, and (5.1) asks for a constant L_kappa",
                at.zeta
            );
            (message, "to run it on purpose, write violates = [\"5.1\"] in [scene]")
        })?;
    }
    let size = |at| {
        let value = reading.formulas.evaluate(slope, &at).abs();
        if value.is_finite() { value } else { f64::INFINITY }
    };
    Ok(samples(horizon).map(size).fold(0.0, f64::max))
}

/// ζ = 0, a geometric sequence towards 0, and even steps up to 100 T.
fn samples(horizon: f64) -> impl Iterator<Item = EvaluationPoint> {
    let largest = LARGEST_MEAN_STRAIN * horizon;
    let crowded = (0..CROWDED_SAMPLES).map(move |i| largest * 0.5_f64.powi(i));
    evenly(0.0, largest, EVEN_SAMPLES)
        .chain(crowded)
        .map(|zeta| EvaluationPoint { zeta, ..EvaluationPoint::default() })
}
