//! The time error in ℝ^m: the linearised scheme of an abstract scene along its exact solution.

use nalgebra::{DMatrix, DVector};

use super::NoConstant;
use super::cells::{Answer, answer};
use super::sums::{Kernel, Pair};
use algebra::linalg::axpy;
use exact::LawNumbers;
use formula::{EvaluationPoint, Graph, Node, Variable};
use scene::setup::AbstractSetup;
use scene::{AbstractKernel, Norm};

/// max_n ‖e_n‖_X on a grid, or of the pressures that come with it, where
///
/// ```text
/// (M + g'(u_n) + N_r + Σ w a aᵀ ∂²j) e_n + N_y R Σ_l Q_l Σ' w_nj q_l(t_n,t_j) e_j = N(S u, u_n) - N(S_n^k u, u_n)
/// ```
///
/// and a_i·e_n = 0 where the constraint or a jump of ∂j_i holds a_i·u; its multiplier is w_i times the error of ξ_i + λ_i,
/// which elsewhere is the slope of the law times a_i·e_n.
///
/// # Errors
/// [`NoConstant::Rule`], [`NoConstant::Singular`].
pub(super) fn largest_error(
    setup: &AbstractSetup,
    norm: Norm,
    times: &[f64],
) -> Result<f64, NoConstant> {
    let problem = Linearised::new(setup)?;
    let m = problem.matrix.nrows();
    // Of earlier levels u and its error, and for nested terms v of the exact u and its error.
    let mut levels: Vec<Pair<Vec<f64>>> = Vec::new();
    let mut nested = vec![Vec::new(); problem.terms.len()];
    let mut largest: f64 = 0.0;
    for &t in times {
        let state = setup.state(t);
        let mut sum = problem.constant.clone();
        let (mut past, mut present) = (DVector::zeros(m), DMatrix::zeros(m, m));
        let mut known = Vec::new();
        for (term, before) in problem.terms.iter().zip(&nested) {
            // v_n of the exact u, its error as far as it is known, and the weight of u_n in it.
            let v = term.inner.as_ref().map(|inner| {
                let ([mut v, of_errors], slot) = inner.sums(times, &levels, m);
                axpy(slot, &state.u, &mut v);
                axpy(1.0, &setup.problem.start, &mut v);
                ([v, of_errors], slot)
            });
            let before = if v.is_some() { before } else { &levels };
            let ([mut discrete, mut of_errors], mut weight) = term.kernel.sums(times, before, m);
            match &v {
                None => axpy(weight, &state.u, &mut discrete),
                Some(([v, errors], slot)) => {
                    axpy(weight, v, &mut discrete);
                    axpy(weight, errors, &mut of_errors);
                    weight *= slot;
                }
            }
            sum += &term.matrix * DVector::from_vec(discrete);
            past += &term.matrix * DVector::from_vec(of_errors);
            present += weight * &term.matrix;
            known.push(v);
        }
        let discrete = &problem.r * sum;
        // N(S u, u) - N(S^k u, u), ∂N/∂y, and the diagonal g' + ∂N/∂r.
        let at = |node: Node, i: usize, y: f64| {
            problem
                .graph
                .evaluate(node, &EvaluationPoint { x: state.u[i], y, ..EvaluationPoint::default() })
        };
        let source = DVector::from_fn(m, |i, _| match problem.force.get(i) {
            Some(nodes) => at(nodes[0], i, state.history[i]) - at(nodes[0], i, discrete[i]),
            None => state.history[i] - discrete[i],
        });
        let by_y = DVector::from_fn(m, |i, _| {
            problem.force.get(i).map_or(1.0, |f| at(f[1], i, discrete[i]))
        });
        let by_r = DVector::from_fn(m, |i, _| {
            let derivative = problem.nonlinear.get(i).map_or(0.0, |&g| at(g, i, 0.0));
            derivative + problem.force.get(i).map_or(0.0, |f| at(f[2], i, discrete[i]))
        });
        let mut tangent = &problem.matrix + DMatrix::from_diagonal(&by_r);
        tangent += DMatrix::from_diagonal(&by_y) * &problem.r * present;
        let right = source - by_y.component_mul(&(&problem.r * past));
        let (error, pressure) =
            problem.solve(tangent, right, &state).ok_or(NoConstant::Singular { t })?;
        largest = largest.max(match norm {
            Norm::PressureL2Max => pressure,
            Norm::DisplacementMax => {
                let ([mut off, of_errors], weight) = problem.one.sums(times, &levels, m);
                axpy(weight, &state.u, &mut off);
                axpy(1.0, &setup.problem.start, &mut off);
                // Both errors are discrete less exact.
                axpy(-1.0, &setup.exact.integral(t), &mut off);
                axpy(1.0, &of_errors, &mut off);
                axpy(weight, error.as_slice(), &mut off);
                problem.norm(&DVector::from_vec(off))
            }
            _ => problem.norm(&error),
        });
        for (nested, v) in nested.iter_mut().zip(known) {
            if let Some(([v, mut of_errors], slot)) = v {
                axpy(slot, error.as_slice(), &mut of_errors);
                nested.push([v, of_errors]);
            }
        }
        levels.push([state.u.clone(), error.as_slice().to_vec()]);
    }
    Ok(largest)
}

/// A term of the history.
struct Term {
    kernel: Kernel,
    /// r of a nested one.
    inner: Option<Kernel>,
    /// Q.
    matrix: DMatrix<f64>,
}

struct Linearised<'a> {
    graph: Graph,
    matrix: DMatrix<f64>,
    product: DMatrix<f64>,
    r: DMatrix<f64>,
    constant: DVector<f64>,
    terms: Vec<Term>,
    /// q = 1.
    one: Kernel,
    /// g_i'.
    nonlinear: Vec<Node>,
    /// N_i, ∂N_i/∂y, ∂N_i/∂r.
    force: Vec<[Node; 3]>,
    laws: Vec<Option<LawNumbers>>,
    setup: &'a AbstractSetup,
}

impl<'a> Linearised<'a> {
    fn new(setup: &'a AbstractSetup) -> Result<Self, NoConstant> {
        let (problem, time) = (&setup.problem, &setup.scene.time);
        let mut graph = setup.scene.formulas.clone();
        let rows = |list: &[Vec<f64>]| DMatrix::from_fn(list.len(), list.len(), |i, j| list[i][j]);
        let kernel = |power, q| Kernel::new(&graph, (time.rule, power), q, time.horizon);
        let term = |written: &AbstractKernel| {
            Ok(Term {
                kernel: kernel(written.power, written.q)?,
                inner: written.inner.map(|r| kernel(0.0, r)).transpose()?,
                matrix: rows(&written.matrix),
            })
        };
        let terms = problem.kernels.iter().map(term).collect::<Result<_, NoConstant>>()?;
        let one = Kernel::one(&mut graph, time.rule, time.horizon)?;
        let mut by = |f: Node, variable| graph.derivative(f, variable);
        let nonlinear = problem.nonlinear.iter().flatten().map(|&g| by(g, Variable::X)).collect();
        let force = problem
            .force
            .iter()
            .flatten()
            .map(|&f| [f, by(f, Variable::Y), by(f, Variable::X)])
            .collect();
        Ok(Self {
            matrix: rows(&problem.matrix),
            product: rows(&problem.inner_product),
            r: rows(&problem.r),
            constant: DVector::from_column_slice(&problem.a_s),
            laws: setup.exact.laws(),
            terms,
            one,
            nonlinear,
            force,
            graph,
            setup,
        })
    }

    fn norm(&self, e: &DVector<f64>) -> f64 {
        (e.dot(&(&self.product * e))).sqrt()
    }

    /// The saddle point problem with the held functionals, and (Σ w_i δp_i²)^½ of the pressures; None if singular.
    fn solve(
        &self,
        mut tangent: DMatrix<f64>,
        right: DVector<f64>,
        state: &exact::FiniteState,
    ) -> Option<(DVector<f64>, f64)> {
        let m = right.len();
        let (mut held, mut sloping) = (Vec::new(), Vec::new());
        for (i, trace) in self.setup.problem.traces.iter().enumerate() {
            let a = DVector::from_column_slice(&trace.functional);
            let (r, xi, lambda) = (state.traces[i], state.selection[i], state.multiplier[i]);
            match answer(self.laws[i].as_ref(), r, xi, lambda) {
                Answer::Slope(slope) => {
                    tangent += (trace.weight * slope) * &a * a.transpose();
                    sloping.push((trace.weight * slope * slope, a));
                }
                Answer::Held => held.push((trace.weight, a)),
            }
        }
        let order = m + held.len();
        let saddle = DMatrix::from_fn(order, order, |i, j| match (i < m, j < m) {
            (true, true) => tangent[(i, j)],
            (true, false) => held[j - m].1[i],
            (false, true) => held[i - m].1[j],
            (false, false) => 0.0,
        });
        let right = DVector::from_fn(order, |i, _| if i < m { right[i] } else { 0.0 });
        let solution = saddle.lu().solve(&right)?;
        let error = solution.rows(0, m).into_owned();
        let of_law = sloping.iter().map(|(weight, a)| weight * a.dot(&error).powi(2));
        let reactions = held.iter().zip(solution.iter().skip(m));
        let of_bounds = reactions.map(|((weight, _), reaction)| reaction * reaction / weight);
        let pressure = of_law.chain(of_bounds).sum::<f64>().sqrt();
        solution.iter().all(|value| value.is_finite()).then_some((error, pressure))
    }
}
