//! Constants of an abstract problem (docs/THEORY.md, section 1), with respect to ‖·‖_X and its dual norm. Forces and
//! values of S are measured in X*: ‖y‖² = y·G⁻¹y.

use nalgebra::{DMatrix, DVector, SymmetricEigen};

use super::SetupError;
use crate::singular::in_the_largest;
use crate::{AbstractScene, Law, Scene};
use vhi::finite::{ComponentLaw, FiniteModel};
use vhi::history::TimeRule;
use vhi::{SingularSlot, StepBounds, monotonicity};

/// Constants of (2.5)-(2.11).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AbstractConstants {
    /// m_A, of strong monotonicity.
    pub m_a: f64,
    /// Lipschitz constant of A.
    pub l_a: f64,
    /// α_φ of (2.7b).
    pub alpha_phi: f64,
    /// β_φ of (2.7b).
    pub beta_phi: f64,
    /// α_j of (2.8c).
    pub alpha_j: f64,
    /// c_j², the largest eigenvalue of Σ w_i a_i a_iᵀ in X.
    pub c_j_squared: f64,
    /// m0 = m_A - α_φ - α_j c_j².
    pub m0: f64,
    /// ‖R‖ on X*.
    pub r_norm: f64,
    /// ‖q‖ = max over 0 ≤ s ≤ t ≤ T of the norm of q(t, s): X → X*, sampled; without the terms that are infinite at s =
    /// t.
    pub q_norm: f64,
    /// max ‖q(t, t)‖ over t, sampled.
    pub q_norm_now: f64,
    /// a of the terms (t - s)^{-a} b(t, s); 0 without one.
    pub power: f64,
    /// ‖b‖ and ‖b(t, t)‖ likewise.
    pub b_norm: f64,
    pub b_norm_now: f64,
}

impl AbstractConstants {
    /// The bounds on the step size. The last slot may act in any direction, so all of it counts against the
    /// monotonicity of a step.
    pub fn step_bounds(&self, rule: &dyn TimeRule) -> StepBounds {
        let (lipschitz, now) = (self.r_norm * self.q_norm, self.r_norm * self.q_norm_now);
        StepBounds {
            m0: self.m0,
            beta_phi: self.beta_phi,
            lipschitz,
            paper_lipschitz: lipschitz,
            last_slot: self.beta_phi * now,
            destabilizing: self.beta_phi * now,
            last_share: rule.last_share(),
            singular: SingularSlot {
                power: self.power,
                share: rule.last_weight(self.power, 1.0),
                lipschitz: self.r_norm * self.b_norm,
                paper_lipschitz: self.r_norm * self.b_norm,
                last_slot: self.beta_phi * self.r_norm * self.b_norm_now,
                destabilizing: self.beta_phi * self.r_norm * self.b_norm_now,
            },
        }
    }
}

/// Samples of component laws, and of kernels in t and s.
const SAMPLES: u32 = 400;
const TIMES: u32 = 64;
/// Components and histories are sampled on [-REACH, REACH].
const REACH: f64 = 10.0;

/// The constants of an abstract problem.
///
/// # Errors
/// An inner product that is not positive definite.
pub(crate) fn abstract_constants(
    scene: &Scene,
    problem: &AbstractScene,
    model: &FiniteModel,
) -> Result<AbstractConstants, SetupError> {
    let gram = SymmetricEigen::new(model.inner_product.clone());
    let least = gram.eigenvalues.min();
    let message = format!("the inner product has the eigenvalue {least:.3e}: not positive");
    let hint = "an inner product is positive definite";
    let odd = least.is_nan() || least <= 0.0;
    scene.refuse_if(odd, "space.inner_product", message, hint)?;
    let root = |power: f64| -> DMatrix<f64> {
        let scaled = DMatrix::from_diagonal(&gram.eigenvalues.map(|value| value.powf(power)));
        &gram.eigenvectors * scaled * gram.eigenvectors.transpose()
    };
    let (half, inverse_half) = (root(0.5), root(-0.5));
    // Operators X → X* and X* → X* as matrices in orthonormal coordinates.
    let to_dual = |a: &DMatrix<f64>| &inverse_half * a * &inverse_half;
    let m = model.dimension();
    let diagonal = |slopes: &[[f64; 2]], of: fn(&[f64; 2]) -> f64| {
        DMatrix::from_diagonal(&DVector::from_fn(m, |i, _| slopes.get(i).map_or(0.0, of)))
    };
    let size = |[low, high]: &[f64; 2]| low.abs().max(high.abs());
    let nonlinear = slopes(&model.nonlinear, |law, y, r| law.by_r(y, r));
    let shifted = &model.matrix + diagonal(&nonlinear, |[low, _]| *low);
    let symmetric = to_dual(&(0.5 * (&shifted + shifted.transpose())));
    let bends = to_dual(&diagonal(&nonlinear, size));
    let by_r = slopes(&model.force, |law, y, r| law.by_r(y, r));
    let by_y = slopes(&model.force, |law, y, r| law.by_y(y, r));
    let beta_phi = match model.force.is_empty() {
        true => 1.0,
        false => norm(&inverse_half) * diagonal(&by_y, size).max() * norm(&half),
    };
    let mut trace = DMatrix::zeros(m, m);
    for functional in &model.functionals {
        trace += functional.weight * &functional.a * functional.a.transpose();
    }
    let alpha_phi = norm(&to_dual(&diagonal(&by_r, size)));
    let alpha_j = problem.traces.iter().filter_map(|t| t.law.as_ref()).map(Law::alpha);
    let alpha_j = alpha_j.fold(0.0, f64::max);
    let c_j_squared = norm(&to_dual(&trace));
    let m_a = SymmetricEigen::new(symmetric).eigenvalues.min();
    let m0 = monotonicity(m_a, alpha_phi + alpha_j * c_j_squared);
    let r_norm = norm(&(&inverse_half * &model.r * &half));
    let horizon = scene.time.horizon;
    let (q_norm, q_norm_now) = kernel_norms(horizon, model, 0.0, to_dual);
    let (power, b_norm, b_norm_now) = singular_norms(horizon, model, to_dual);
    Ok(AbstractConstants {
        m_a,
        l_a: norm(&to_dual(&model.matrix)) + norm(&bends),
        alpha_phi,
        beta_phi,
        alpha_j,
        c_j_squared,
        m0,
        r_norm,
        q_norm,
        q_norm_now,
        power,
        b_norm,
        b_norm_now,
    })
}

/// The largest norms of Σ_l b_l(t, s) Q_l: X → X* over s ≤ t and over s = t, for the terms with (t - s)^{-power} b_l.
fn kernel_norms(
    horizon: f64,
    model: &FiniteModel,
    power: f64,
    to_dual: impl Fn(&DMatrix<f64>) -> DMatrix<f64>,
) -> (f64, f64) {
    let m = model.dimension();
    let terms: Vec<_> = model.kernels.iter().filter(|term| term.kernel.power() == power).collect();
    let at = |t: f64, s: f64| {
        let mut sum = DMatrix::zeros(m, m);
        for term in &terms {
            sum += term.kernel.factor(t, s) * &term.matrix;
        }
        norm(&to_dual(&sum))
    };
    if terms.is_empty() {
        return (0.0, 0.0);
    }
    let time = |i: u32| horizon * f64::from(i) / f64::from(TIMES);
    let pairs = (0..=TIMES).flat_map(|i| (0..=i).map(move |j| (time(i), time(j))));
    let all = pairs.map(|(t, s)| at(t, s)).fold(0.0, f64::max);
    let now = (0..=TIMES).map(|i| at(time(i), time(i))).fold(0.0, f64::max);
    (all, now)
}

/// The largest power a, and the norms of all terms that are infinite at s = t as terms (t - s)^{-a} b.
fn singular_norms(
    horizon: f64,
    model: &FiniteModel,
    to_dual: impl Fn(&DMatrix<f64>) -> DMatrix<f64>,
) -> (f64, f64, f64) {
    let all = model.kernels.iter().map(|term| term.kernel.power());
    let sum = |(_, all, now): (f64, f64, f64), (power, scale): (f64, f64)| {
        let of_power = kernel_norms(horizon, model, power, &to_dual);
        (power, all + scale * of_power.0, now + scale * of_power.1)
    };
    in_the_largest(all, horizon).into_iter().fold((0.0, 0.0, 0.0), sum)
}

/// Smallest and largest slope of each component law over the samples.
fn slopes(
    laws: &[Box<dyn ComponentLaw>],
    slope: fn(&dyn ComponentLaw, f64, f64) -> f64,
) -> Vec<[f64; 2]> {
    let place = |i: u32| REACH * (2.0 * f64::from(i) / f64::from(SAMPLES) - 1.0);
    let of_law = |law: &dyn ComponentLaw| {
        let points = (0..=SAMPLES)
            .flat_map(|i| (0..=SAMPLES).step_by(20).map(move |j| (place(j), place(i))));
        let values = points.map(|(y, r)| slope(law, y, r));
        values.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], value| {
            [low.min(value), high.max(value)]
        })
    };
    laws.iter().map(|law| of_law(&**law)).collect()
}

fn norm(a: &DMatrix<f64>) -> f64 {
    a.singular_values().max()
}
