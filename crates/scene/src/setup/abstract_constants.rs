//! Constants of an abstract problem (docs/THEORY.md, section 1), with respect to ‖·‖_X and its dual norm. Forces and
//! values of S are measured in X*: ‖y‖² = y·G⁻¹y.

use nalgebra::{DMatrix, DVector, SymmetricEigen};

use super::Result;
use super::kernel_bounds::{KernelBounds, KernelNorms};
use crate::singular::in_the_largest;
use crate::{AbstractScene, Law, Scene};
use formula::{Effort, Interval, Node, Place, Variable, largest};
use vhi::finite::FiniteModel;
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
    /// ‖q‖ = max over 0 ≤ s ≤ t ≤ T of the norm of q(t, s): X → X*, proved; without the terms that are infinite at s =
    /// t.
    pub q_norm: f64,
    /// max ‖q(t, t)‖ over t, proved.
    pub q_norm_now: f64,
    /// What R q(t, t) can take from the monotonicity of a step of weight 1: max over t of -λ_min of the symmetric part of
    /// N' R q(t, t), if N is linear in y, else β_φ‖R‖ max ‖q(t, t)‖.
    pub destabilizing: f64,
    /// a of the terms (t - s)^{-a} b(t, s); 0 without one.
    pub power: f64,
    /// ‖b‖, ‖b(t, t)‖ and what b can take, likewise.
    pub b_norm: f64,
    pub b_norm_now: f64,
    pub b_destabilizing: f64,
    /// The slopes of g and N are bounded for |r|, |y| up to this.
    pub slopes_up_to: f64,
}

impl AbstractConstants {
    /// The bounds on the step size.
    pub fn step_bounds(&self, rule: &dyn TimeRule) -> StepBounds {
        let (lipschitz, now) = (self.r_norm * self.q_norm, self.r_norm * self.q_norm_now);
        StepBounds {
            m0: self.m0,
            beta_phi: self.beta_phi,
            lipschitz,
            paper_lipschitz: lipschitz,
            last_slot: self.beta_phi * now,
            destabilizing: self.destabilizing,
            last_share: rule.last_share(),
            singular: SingularSlot {
                power: self.power,
                share: rule.last_weight(self.power, 1.0),
                lipschitz: self.r_norm * self.b_norm,
                paper_lipschitz: self.r_norm * self.b_norm,
                last_slot: self.beta_phi * self.r_norm * self.b_norm_now,
                destabilizing: self.b_destabilizing,
            },
        }
    }
}

/// Slopes without a bound for all arguments are bounded for |r|, |y| up to this.
const REACH: f64 = 10.0;

/// The constants of an abstract problem.
///
/// # Errors
/// An inner product that is not positive definite; a kernel or a slope without a bound.
pub(crate) fn abstract_constants(
    scene: &Scene,
    problem: &AbstractScene,
    model: &FiniteModel,
) -> Result<AbstractConstants> {
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
    let mut slopes_up_to = f64::INFINITY;
    let mut slopes = |key: &str, nodes: &Option<Vec<Node>>, by| {
        let nodes = nodes.iter().flatten().enumerate();
        let each = nodes.map(|(i, &node)| {
            let (slopes, reach) = slope_range(scene, node, by);
            slopes_up_to = reach.min(slopes_up_to);
            let message = format!("the slope has no bound for arguments up to {REACH}");
            let hint = "a component of the operator or of phi must be Lipschitz";
            let known = slopes.is_finite();
            scene.refuse_if(!known, &format!("{key}.{i}"), message, hint)?;
            Ok([slopes.low, slopes.high])
        });
        each.collect::<Result<Vec<[f64; 2]>>>()
    };
    let nonlinear = slopes("operator.nonlinear", &problem.nonlinear, Variable::X)?;
    let by_r = slopes("phi.force", &problem.force, Variable::X)?;
    let by_y = slopes("phi.force", &problem.force, Variable::Y)?;
    let shifted = &model.matrix + diagonal(&nonlinear, |[low, _]| *low);
    let symmetric = to_dual(&(0.5 * (&shifted + shifted.transpose())));
    let bends = to_dual(&diagonal(&nonlinear, size));
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
    // N' if it is a matrix: the identity for N = y.
    let linear = by_y.iter().all(|[low, high]| low == high);
    let by_y = match model.force.is_empty() {
        true => DMatrix::identity(m, m),
        false => diagonal(&by_y, |[low, _]| *low),
    };
    let kernels = KernelBounds::new(&scene.formulas, problem, horizon, |l| {
        let matrix = &model.kernels[l].matrix;
        let last = to_dual(&(&by_y * &model.r * matrix));
        [to_dual(matrix), 0.5 * (&last + last.transpose())]
    });
    if let Some((l, t)) = kernels.unbounded() {
        let message = format!("q(t, s) has no bound near t = {t:.6}");
        let hint = "a kernel must be continuous for 0 <= s <= t <= T; exp(s - t) is an example";
        return Err(scene.error(&format!("history.kernels.{l}.q"), message, hint).into());
    }
    let with_phi = |norms: KernelNorms| match linear {
        true => norms,
        false => KernelNorms { destabilizing: beta_phi * r_norm * norms.now, ..norms },
    };
    let plain = with_phi(kernels.norms(0.0));
    let powers = in_the_largest(problem.kernels.iter().map(|kernel| kernel.power), horizon);
    let (power, singular) =
        powers.into_iter().fold((0.0, KernelNorms::default()), |(_, sum), (power, scale)| {
            let norms = with_phi(kernels.norms(power));
            let sum = KernelNorms {
                all: sum.all + scale * norms.all,
                now: sum.now + scale * norms.now,
                destabilizing: sum.destabilizing + scale * norms.destabilizing,
            };
            (power, sum)
        });
    Ok(AbstractConstants {
        m_a,
        l_a: norm(&to_dual(&model.matrix)) + norm(&bends),
        alpha_phi,
        beta_phi,
        alpha_j,
        c_j_squared,
        m0,
        r_norm,
        q_norm: plain.all,
        q_norm_now: plain.now,
        destabilizing: plain.destabilizing,
        power,
        b_norm: singular.all,
        b_norm_now: singular.now,
        b_destabilizing: singular.destabilizing,
        slopes_up_to,
    })
}

/// A proved range of the slope of a component law, for all arguments or else for those up to [`REACH`], and which.
fn slope_range(scene: &Scene, law: Node, by: Variable) -> (Interval, f64) {
    let mut graph = scene.formulas.clone();
    let slope = graph.derivative(law, by);
    let range = |over: Interval| {
        let mut slope = graph.enclosing(slope);
        let mut end = |sign: f64| {
            let found = largest([over, over], Effort::FORMULA, |&[y, r]| {
                let place = Place::origin().with(Variable::Y, y).with(Variable::X, r);
                let found = slope.over(&place);
                let all = found.undefined;
                if all { Interval::ALL } else { found.range * Interval::point(sign) }
            });
            sign * found.bound
        };
        let (low, high) = (end(-1.0), end(1.0));
        Interval::new(low, high)
    };
    let everywhere = range(Interval::ALL);
    match everywhere.is_finite() {
        true => (everywhere, f64::INFINITY),
        false => (range(Interval::new(-REACH, REACH)), REACH),
    }
}

pub(super) fn norm(a: &DMatrix<f64>) -> f64 {
    a.singular_values().max()
}
