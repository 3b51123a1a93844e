//! An abstract problem in ℝ^m as a scene in time: no mesh, u(t) and (S u)(t) known, any kernel q(t, s),
//! uniform, graded and random grids.

use nalgebra::{DMatrix, DVector, SymmetricEigen};

use super::estimate::Terms;
use super::in_time::{
    GivenLoads, GronwallError, InTime, Known, Levels, NO_HISTORY, OWN_WEIGHTS, named, refused,
    smallness,
};
use super::recurrence::{KernelNorms, Weights};
use scene::setup::AbstractSetup;
use vhi::Newton;
use vhi::finite::{FiniteError, FiniteLoad, FiniteModel, march};
use vhi::history::TimeGrid;
use vhi::law::HistoryKernel;

/// Accuracy of the exact side's histories, relative.
const EXACT: f64 = 1e-12;

/// An abstract scene with the square roots of its inner product.
pub(super) struct FiniteInTime<'a> {
    setup: &'a AbstractSetup,
    /// G^{-1/2}: ‖y‖_{X*} = |G^{-1/2} y|.
    inverse_root: DMatrix<f64>,
    /// m0, β_φ and ‖R‖‖q‖; a test may spoil them.
    pub constants: [f64; 3],
    /// ‖q‖, of kernels with (t - s)^{-a} of what stands beside it.
    q_norm: f64,
    weights: Weights,
}

impl<'a> FiniteInTime<'a> {
    /// The scene with its constants.
    ///
    /// # Errors
    /// A rule with weights for each kernel, no history, m0 ≤ 0.
    pub(super) fn new(setup: &'a AbstractSetup) -> Result<Self, GronwallError> {
        let (found, scene) = (&setup.constants, &setup.scene);
        let own = || refused(scene, OWN_WEIGHTS);
        let weights = Weights::of(scene.time.rule, found.power).ok_or_else(own)?;
        smallness(scene, found.m0)?;
        let plain = weights.beside_plain(scene.time.horizon) * found.q_norm;
        let q_norm = plain + found.b_norm;
        let constants = [found.m0, found.beta_phi, found.r_norm * q_norm];
        if constants[2] == 0.0 {
            return Err(refused(scene, NO_HISTORY));
        }
        let gram = SymmetricEigen::new(setup.model.inner_product.clone());
        if gram.eigenvalues.min() <= 0.0 {
            return Err(GronwallError::InnerProduct);
        }
        let scale = DMatrix::from_diagonal(&gram.eigenvalues.map(|value| value.sqrt().recip()));
        let inverse_root = &gram.eigenvectors * scale * gram.eigenvectors.transpose();
        Ok(Self { setup, inverse_root, constants, q_norm, weights })
    }

    /// u_0^k, …, u_N^k of `model`, which a test may have changed, under these loads, and the floor of the run.
    ///
    /// # Errors
    /// The run fails.
    pub(super) fn run(
        &self,
        model: &FiniteModel,
        grid: &TimeGrid,
        loads: &[Vec<f64>],
    ) -> Result<(Levels, f64), GronwallError> {
        let (mut found, mut load) = (Vec::new(), GivenLoads(grid, loads));
        let info = march(model, grid, &mut load, &Newton::default(), &mut |view| {
            found.push(view.u.as_slice().to_vec());
        })
        .map_err(|source| GronwallError::FiniteCase { steps: grid.steps() as u32, source })?;
        Ok((found, info.floor))
    }
}

impl InTime for FiniteInTime<'_> {
    fn constants(&self) -> Vec<(&'static str, f64)> {
        let c = &self.setup.constants;
        let details = [
            ("m_A", c.m_a),
            ("alpha_phi", c.alpha_phi),
            ("alpha_j", c.alpha_j),
            ("c_j_squared", c.c_j_squared),
            ("r_norm", c.r_norm),
            ("q_norm", self.q_norm),
        ];
        named(self.constants, details)
    }

    fn truth(&self) -> String {
        "exact u(t) in R^m".to_string()
    }

    fn grid(&self, steps: u32) -> TimeGrid {
        self.setup.grid(steps)
    }

    fn loads(&self, grid: &TimeGrid) -> Result<Levels, GronwallError> {
        Ok(grid.times().iter().map(|t| self.setup.state(*t).load.clone()).collect())
    }

    fn dual_norms(&self, loads: &[Vec<f64>]) -> Result<Vec<f64>, GronwallError> {
        let norm = |load: &Vec<f64>| (&self.inverse_root * DVector::from_column_slice(load)).norm();
        Ok(loads.iter().map(norm).collect())
    }

    fn solutions(
        &self,
        grid: &TimeGrid,
        loads: &[Vec<f64>],
    ) -> Result<(Levels, f64), GronwallError> {
        self.run(&self.setup.model, grid, loads)
    }

    fn distance(&self, u: &[f64], v: &[f64]) -> f64 {
        let difference = DVector::from_column_slice(u) - DVector::from_column_slice(v);
        self.setup.model.norm(&difference)
    }

    /// κ(n, j) = ‖R Σ_l q_l(t_n, t_j) Q_l‖ from X to X*; by product integration with W^l_nj in place of q_l.
    fn terms(&self, grid: &TimeGrid) -> Terms {
        let ([m0, beta, lipschitz], model) = (self.constants, &self.setup.model);
        // Operators X → X* between orthonormal coordinates.
        let matrices: Vec<DMatrix<f64>> = model
            .kernels
            .iter()
            .map(|term| &self.inverse_root * &model.r * &term.matrix * &self.inverse_root)
            .collect();
        let norm = |matrix: &DMatrix<f64>| matrix.singular_values().max();
        let alone: Vec<f64> = matrices.iter().map(norm).collect();
        let of = |factors: &[f64]| match factors {
            [factor] => factor.abs() * alone[0],
            _ => {
                let each = matrices.iter().zip(factors).map(|(matrix, factor)| *factor * matrix);
                each.reduce(|sum, matrix| sum + matrix).map_or(0.0, |sum| norm(&sum))
            }
        };
        let kernels: Vec<&dyn HistoryKernel> =
            model.kernels.iter().map(|term| &*term.kernel as _).collect();
        let norms = KernelNorms::of(&kernels, of, (self.weights.integrating(), grid), false);
        (m0, beta, self.weights, vec![norms.part(beta, lipschitz, grid)])
    }

    /// g_n = ‖S_n u - S_n^k u‖_{X*}, S_n^k u = R(Σ_l Q_l Σ_j w_nj q_l(t_n, t_j) u_j + a_S).
    fn known(&self, grid: &TimeGrid) -> Result<Known, GronwallError> {
        let (model, rule) = (&self.setup.model, self.weights.rule());
        let states: Vec<_> = grid.times().iter().map(|t| self.setup.state(*t)).collect();
        let column = |values: &[f64]| DVector::from_column_slice(values);
        let u: Vec<DVector<f64>> = states.iter().map(|state| column(&state.u)).collect();
        let defect = |n: usize| {
            let mut sum = model.a_s.clone();
            for term in &model.kernels {
                let weights = rule.kernel_row(&*term.kernel, grid, n);
                let mut integral = DVector::zeros(model.dimension());
                for (u, weight) in u.iter().zip(&weights) {
                    integral.axpy(*weight, u, 1.0);
                }
                sum += &term.matrix * integral;
            }
            (&self.inverse_root * (column(&states[n].history) - &model.r * sum)).norm()
        };
        Ok(Known {
            truncation: [vec![0.0; u.len()], (0..u.len()).map(defect).collect()],
            factors: [0.0, self.constants[1]],
            unknown: EXACT * u.iter().map(|u| model.norm(u)).fold(0.0, f64::max),
            u: states.iter().map(|state| state.u.clone()).collect(),
        })
    }
}

impl FiniteLoad for GivenLoads<'_> {
    fn at(&mut self, t: f64) -> Result<DVector<f64>, FiniteError> {
        let missing = FiniteError::Load { component: 0, value: f64::NAN, t };
        self.load(t).map(DVector::from_column_slice).ok_or(missing)
    }
}
