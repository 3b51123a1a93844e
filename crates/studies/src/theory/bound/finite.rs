//! The step-size study of an abstract scene: constants, samples, factors in ℝ^m.

use nalgebra::DVector;

use super::BoundStudy;
use super::constant_table::{Constant, Obtained};
use super::ladder::BoundError;
use super::run::{self, ContractionStudy};
use super::sampled::Sampled;
use algebra::linalg::{larger, signed_unit};
use scene::setup::{AbstractConstants, AbstractLoad, AbstractSetup, Smallness};
use vhi::finite::{FiniteEvolution, FiniteModel};

/// Pairs of random states.
const SAMPLES: u32 = 2000;
/// Their components are at most this large, as in the samples of slopes.
const REACH: f64 = 10.0;

impl BoundStudy {
    /// Studies an abstract scene along a run with `steps` steps.
    ///
    /// # Errors
    /// [`BoundError`].
    pub fn of_abstract(setup: &AbstractSetup, steps: u32) -> Result<Self, BoundError> {
        if setup.model.time_rule.last_share() == 0.0 {
            return Err(BoundError::NoLastSlot);
        }
        let limits = setup.constants.step_bounds(setup.model.time_rule.as_ref());
        let grid = setup.grid(steps);
        let mut load = AbstractLoad(setup);
        let levels = {
            let mut level = FiniteEvolution::new(&setup.model, &grid, &mut load)?;
            run::all_levels(&mut level, &limits, None)?
        };
        let mut study = ContractionStudy::of_levels(levels, steps)?;
        let mut level = FiniteEvolution::new(&setup.model, &grid, &mut load)?;
        let state = run::run_to(&mut level, study.worst.level)?;
        study.climb(&mut level, state, &limits)?;
        let samples = samples(&setup.model, &setup.constants);
        let constants = table(&setup.constants, &setup.model);
        let m0 = setup.constants.m0;
        let known = if m0 > 0.0 { Smallness::Holds } else { Smallness::Fails };
        let found = super::smallness_violation(known, m0).into_iter().collect();
        Ok(Self::of(&setup.scene, (None, steps), constants, samples, limits, study, found))
    }
}

/// The constants of an abstract problem with how each was obtained.
fn table(c: &AbstractConstants, model: &FiniteModel) -> Vec<Constant> {
    // Eigenvalues are exact to rounding.
    let row = |name: &str, value: f64, by_slopes: bool, note: &str| {
        let (how, by) = match (by_slopes, c.slopes_up_to) {
            (false, _) => (Obtained::Computed, String::new()),
            (true, f64::INFINITY) => (Obtained::Proved, "; slopes for all arguments".into()),
            (true, reach) => (Obtained::Proved, format!("; slopes for |r|, |y| <= {reach}")),
        };
        let safe = !by_slopes || c.slopes_up_to == f64::INFINITY;
        Constant { safe, ..Constant::new(name, value, how, format!("{note}{by}")) }
    };
    let (bent, forced) = (!model.nonlinear.is_empty(), !model.force.is_empty());
    let mut rows = vec![
        row("m_A", c.m_a, bent, "smallest eigenvalue of the symmetric part in X"),
        row("L_A", c.l_a, bent, "norm X -> X*"),
        row("alpha_phi", c.alpha_phi, forced, "slopes of N in u"),
        row("beta_phi", c.beta_phi, forced, "slopes of N in y"),
        row("alpha_j", c.alpha_j, false, "steepest descent of the laws (2.8c)"),
        row("c_j^2", c.c_j_squared, false, "largest eigenvalue of sum w_i a_i a_i^T in X"),
        row("m0", c.m0, bent || forced, "m_A - alpha_phi - alpha_j c_j^2 (2.9)"),
        row("|R|", c.r_norm, false, "norm on X*"),
    ];
    let note = "largest norm X -> X* over 0 <= s <= t <= T";
    rows.push(Constant::new("|q|", c.q_norm, Obtained::Proved, note));
    rows.push(Constant::new("|q(t,t)|", c.q_norm_now, Obtained::Proved, "the same over s = t"));
    rows
}

/// Constants against random pairs of states.
fn samples(model: &FiniteModel, c: &AbstractConstants) -> Vec<Sampled> {
    let m = model.dimension();
    let mut seed = 7;
    let mut draw = || DVector::from_fn(m, |_, _| REACH * signed_unit(&mut seed));
    let gram = model.inner_product.clone().cholesky();
    let dual = |f: &DVector<f64>| {
        gram.as_ref().map_or(f64::NAN, |gram| f.dot(&gram.solve(f)).max(0.0).sqrt())
    };
    let (mut monotone, mut lipschitz, mut by_state, mut by_history) = (f64::MIN, 0f64, 0f64, 0f64);
    // A NaN must not vanish in a maximum.
    for _ in 0..SAMPLES {
        let (u, v, y, z) = (draw(), draw(), draw(), draw());
        let (off, force) = (&u - &v, model.operator(&u) - model.operator(&v));
        let size = model.norm(&off);
        monotone = larger(monotone, -force.dot(&off) / (size * size));
        lipschitz = larger(lipschitz, dual(&force) / size);
        let moved = model.force_of(&y, &u) - model.force_of(&y, &v);
        by_state = larger(by_state, dual(&moved) / size);
        let moved = model.force_of(&y, &u) - model.force_of(&z, &u);
        by_history = larger(by_history, dual(&moved) / dual(&(&y - &z)));
    }
    vec![
        Sampled::new("(2.5b): -m_A", -c.m_a, monotone, SAMPLES),
        Sampled::new("L_A", c.l_a, lipschitz, SAMPLES),
        Sampled::new("(2.7b): alpha_phi, same y", c.alpha_phi, by_state, SAMPLES),
        Sampled::new("(2.7b): beta_phi, same u", c.beta_phi, by_history, SAMPLES),
    ]
}
