//! Problem 9 in ℝ^m as a [`HistoryInequality`].
//!
//! The unknowns are w with u = C w, in which the functionals a_i are coordinates: K is a box and every graph acts on
//! one unknown; forces are Cᵀ F.

use nalgebra::{DMatrix, DVector, Dyn, LU};

use super::{FiniteError, FiniteLoad, FiniteModel};
use crate::history::TimeGrid;
use crate::law::HistoryKernel;
use crate::{
    BoundaryGraph, Coordinate, HistoryInequality, OpenInequality, StepInequality, StepState,
};
use algebra::linalg::FactorError;

/// v_0, …, v_{n-1} of a term, and v_n = `known` + `slot` u_n of the open level.
struct Inner {
    past: Vec<DVector<f64>>,
    known: DVector<f64>,
    slot: f64,
}

/// The problem with its committed history.
pub struct FiniteEvolution<'a> {
    model: &'a FiniteModel,
    grid: &'a TimeGrid,
    source: &'a mut dyn FiniteLoad,
    /// C.
    coordinates: DMatrix<f64>,
    /// Cᵀ G C, the inner product in w.
    pub(super) inner_product: DMatrix<f64>,
    graph: BoundaryGraph,
    /// u_0, …, u_{n-1}.
    past: Vec<DVector<f64>>,
    /// The inner history of each nested term, in order.
    inner: Vec<Inner>,
    /// f_n.
    load: DVector<f64>,
    /// R(Σ_{j<n} … + a_S), including the last slot while it is frozen.
    y_past: DVector<f64>,
    /// R Σ_l W^l_nn Q_l.
    pub(super) last_slot: DMatrix<f64>,
    implicit: bool,
    y_before: DVector<f64>,
    u: DVector<f64>,
    /// Jacobian without the graphs, then with them, and its factor.
    jacobian: DMatrix<f64>,
    factor: Option<LU<f64, Dyn, Dyn>>,
    prescribed: Vec<Option<f64>>,
    /// DΛ and its adjoint in X, in the coordinates w.
    pub(super) frozen: Option<[DMatrix<f64>; 2]>,
}

impl<'a> FiniteEvolution<'a> {
    /// The problem before the first level.
    ///
    /// # Errors
    /// [`FiniteError::Dependent`] if the functionals are linearly dependent.
    pub fn new(
        model: &'a FiniteModel,
        grid: &'a TimeGrid,
        source: &'a mut dyn FiniteLoad,
    ) -> Result<Self, FiniteError> {
        let m = model.dimension();
        let nested = model.kernels.iter().filter(|term| term.inner.is_some());
        let nested =
            nested.map(|_| Inner { past: Vec::new(), known: model.start.clone(), slot: 0.0 });
        let coordinates = model.coordinates().ok_or(FiniteError::Dependent)?;
        let stiffness = coordinates.transpose() * &model.matrix * &coordinates;
        let positions = model.functionals.iter().enumerate().map(|(i, functional)| Coordinate {
            dof: i as u32,
            sign: 1.0,
            weight: functional.weight,
            gap: functional.upper,
            floor: functional.lower,
            law: i as u32,
            shift: 0.0,
            // γ α_i < 1 makes z one to one along the graph; here half of what (2.9) allows.
            gamma: 0.5 * functional.weight / stiffness[(i, i)].abs().max(f64::MIN_POSITIVE),
            span: 1,
        });
        let graph = BoundaryGraph {
            coordinates: positions.collect(),
            potentials: model.functionals.iter().map(|f| f.potential.clone()).collect(),
        };
        Ok(Self {
            inner_product: coordinates.transpose() * &model.inner_product * &coordinates,
            coordinates,
            graph,
            past: Vec::new(),
            inner: nested.collect(),
            load: DVector::zeros(m),
            y_past: DVector::zeros(m),
            y_before: DVector::zeros(m),
            last_slot: DMatrix::zeros(m, m),
            frozen: None,
            implicit: true,
            u: DVector::zeros(m),
            jacobian: DMatrix::zeros(m, m),
            factor: None,
            prescribed: Vec::new(),
            model,
            grid,
            source,
        })
    }

    /// Sets the weight w of the last slot for a step k: R Σ_l w q_l(t_n, t_n) Q_l.
    pub(super) fn set_last_slot(&mut self, k: f64) {
        let (model, t) = (self.model, self.grid.time(self.past.len()));
        self.last_slot.fill(0.0);
        for term in &model.kernels {
            let slot = |kernel: &dyn HistoryKernel| {
                model.time_rule.last_weight(kernel.power(), k) * kernel.factor(t, t)
            };
            let inner = term.inner.as_ref().map_or(1.0, |inner| slot(&**inner));
            self.last_slot += slot(&*term.kernel) * inner * &model.r * &term.matrix;
        }
    }

    pub(crate) fn displacement(&self, w: &[f64]) -> DVector<f64> {
        &self.coordinates * DVector::from_column_slice(w)
    }

    /// J⁻¹ rhs with the last factor, in w; None before the first factor.
    pub(crate) fn correction(&self, rhs: &[f64]) -> Option<DVector<f64>> {
        self.factor.as_ref()?.solve(&DVector::from_column_slice(rhs))
    }

    /// Cᵀ ∂N/∂y (last slot) C at the last evaluated u: the dependence of F on the last slot.
    pub(super) fn force_by_history(&self) -> DMatrix<f64> {
        self.coordinates.tr_mul(&self.by_history(&self.history())) * &self.coordinates
    }

    /// ∂N/∂y (last slot) at y and the last evaluated u.
    fn by_history(&self, y: &DVector<f64>) -> DMatrix<f64> {
        let mut slope = self.last_slot.clone();
        for (i, law) in self.model.force.iter().enumerate() {
            let scale = law.by_y(y[i], self.u[i]);
            slope.row_mut(i).iter_mut().for_each(|value| *value *= scale);
        }
        slope
    }

    /// S_n u at the last evaluated u.
    pub(crate) fn history(&self) -> DVector<f64> {
        self.history_of(&self.u)
    }

    fn history_of(&self, u: &DVector<f64>) -> DVector<f64> {
        let mut y = self.y_past.clone();
        if self.implicit {
            y += &self.last_slot * u;
        }
        y
    }
}

impl HistoryInequality for FiniteEvolution<'_> {
    type Error = FiniteError;

    fn grid(&self) -> &TimeGrid {
        self.grid
    }

    fn open(&mut self) -> Result<(), FiniteError> {
        let (model, n) = (self.model, self.past.len());
        self.load = self.source.at(self.grid.time(n))?;
        let mut sum = model.a_s.clone();
        self.last_slot.fill(0.0);
        let mut nested = self.inner.iter_mut();
        let weighed = |list: &[DVector<f64>], weights: &[f64]| {
            let mut sum = DVector::zeros(model.dimension());
            list.iter().zip(weights).for_each(|(v, weight)| sum.axpy(*weight, v, 1.0));
            sum
        };
        for term in &model.kernels {
            let row = |kernel| model.time_rule.kernel_row(kernel, self.grid, n);
            let weights = row(&*term.kernel);
            let (past, slot) = match &term.inner {
                None => (weighed(&self.past, &weights), weights[n]),
                Some(kernel) => {
                    let own = row(&**kernel);
                    let inner = nested.next().expect("an inner history for each nested term");
                    inner.slot = own[n];
                    inner.known = &model.start + weighed(&self.past, &own);
                    let past = weighed(&inner.past, &weights) + weights[n] * &inner.known;
                    (past, weights[n] * own[n])
                }
            };
            sum += &term.matrix * past;
            self.last_slot += &model.r * &term.matrix * slot;
        }
        self.y_before = &model.r * sum;
        self.freeze(None);
        Ok(())
    }

    fn commit(&mut self, solution: &StepState) {
        let u = self.displacement(&solution.u);
        for inner in &mut self.inner {
            inner.past.push(&inner.known + inner.slot * &u);
        }
        self.past.push(u);
    }
}

impl OpenInequality for FiniteEvolution<'_> {
    fn freeze(&mut self, eta: Option<&[f64]>) {
        self.y_past = self.y_before.clone();
        self.implicit = eta.is_none();
        if let Some(eta) = eta {
            self.y_past += &self.last_slot * self.displacement(eta);
        }
    }

    fn norm(&self, v: &[f64]) -> f64 {
        let v = DVector::from_column_slice(v);
        v.dot(&(&self.inner_product * &v)).max(0.0).sqrt()
    }
}

impl StepInequality for FiniteEvolution<'_> {
    fn dofs(&self) -> usize {
        self.model.dimension()
    }

    fn graph(&self) -> &BoundaryGraph {
        &self.graph
    }

    fn residual(&mut self, w: &[f64], out: &mut [f64]) {
        self.u = self.displacement(w);
        let y = self.history();
        let force = self.model.operator(&self.u) + self.model.force_of(&y, &self.u) - &self.load;
        out.copy_from_slice(self.coordinates.tr_mul(&force).as_slice());
    }

    fn linearize(&mut self, slopes: &[f64], prescribed: &[Option<f64>]) -> Result<(), FactorError> {
        let (model, y) = (self.model, self.history());
        let mut tangent = model.matrix.clone();
        for (i, g) in model.nonlinear.iter().enumerate() {
            tangent[(i, i)] += g.by_r(0.0, self.u[i]);
        }
        for (i, law) in model.force.iter().enumerate() {
            tangent[(i, i)] += law.by_r(y[i], self.u[i]);
        }
        if self.implicit {
            tangent += self.by_history(&y);
        }
        self.jacobian = self.coordinates.tr_mul(&tangent) * &self.coordinates;
        for (i, slope) in slopes.iter().enumerate() {
            self.jacobian[(i, i)] += slope;
        }
        self.prescribed = prescribed.to_vec();
        for (i, increment) in prescribed.iter().enumerate() {
            if increment.is_some() {
                self.jacobian.row_mut(i).fill(0.0);
                self.jacobian[(i, i)] = 1.0;
            }
        }
        let factor = self.jacobian.clone().lu();
        if !factor.is_invertible() {
            let diagonal = factor.u().diagonal();
            let dof = (0..diagonal.len()).find(|&i| diagonal[i] == 0.0).unwrap_or(0);
            return Err(FactorError::NotPositiveDefinite { dof });
        }
        self.factor = Some(factor);
        Ok(())
    }

    fn solve(&mut self, rhs: &mut [f64], _forcing: f64) -> Result<(), FactorError> {
        for (i, increment) in self.prescribed.iter().enumerate() {
            if let Some(increment) = increment {
                rhs[i] = *increment;
            }
        }
        let solution = self.correction(rhs).ok_or(FactorError::NotPositiveDefinite { dof: 0 })?;
        rhs.copy_from_slice(solution.as_slice());
        Ok(())
    }

    fn force_scale(&self, w: &[f64]) -> f64 {
        let (model, u) = (self.model, self.displacement(w));
        let y = self.history_of(&u);
        let force = model.matrix.abs() * u.abs()
            + (model.operator(&u) - &model.matrix * &u).abs()
            + model.force_of(&y, &u).abs()
            + y.abs()
            + self.load.abs();
        (self.coordinates.abs().tr_mul(&force)).norm()
    }
}
