//! The time error in ℝ^m: the linearised scheme of an abstract scene along its exact solution.

use nalgebra::{DMatrix, DVector};

use super::NoConstant;
use super::cells::{Answer, answer};
use super::sums::{Kernel, Sums, Weights};
use algebra::linalg::axpy;
use exact::{LawNumbers, sign_changes};
use formula::{EvaluationPoint, Graph, Node, Program, Variable};
use scene::Norm;
use scene::setup::AbstractSetup;

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
    let problem = Linearised::new(setup);
    let m = problem.matrix.nrows();
    let of_one = |kernel: &Kernel| {
        let weights = Weights::of_kernel(setup.scene.time.rule, kernel.power)?;
        Ok(Sums::new(vec![weights], std::slice::from_ref(kernel), times, m))
    };
    let mut sums = problem.kernels.iter().map(of_one).collect::<Result<Vec<_>, _>>()?;
    let inner = problem.inner.iter().map(|inner| inner.as_ref().map(of_one).transpose());
    let mut inner = inner.collect::<Result<Vec<_>, NoConstant>>()?;
    let asked = (norm == Norm::DisplacementMax).then_some(&problem.one);
    let mut displacement = asked.map(of_one).transpose()?;
    let exact = |times: &[f64]| -> Vec<Vec<f64>> {
        let places: Vec<[f64; 3]> = times.iter().map(|&s| [s, 0.0, 0.0]).collect();
        let mut values = vec![Vec::new(); m];
        problem.u.bind(&places).evaluate(0.0, 0.0, &mut values);
        (0..times.len()).map(|k| values.iter().map(|list| list[k]).collect()).collect()
    };
    let mut largest: f64 = 0.0;
    let kinks = problem.kinks(times);
    for &t in times {
        let state = setup.state(t);
        let [mut sum, mut of_exact] = [(); 2].map(|()| problem.constant.clone());
        let (mut past, mut present) = (DVector::zeros(m), DMatrix::zeros(m, m));
        // v_n of the exact u and the error of v_n as far as it is known, and the weight of u_n in it.
        let known = inner.iter().map(|sums| {
            let ([mut v, of_errors], slot) =
                (sums.as_ref()?.before(0), sums.as_ref()?.current_weight(0));
            axpy(slot, &state.u, &mut v);
            axpy(1.0, &setup.problem.start, &mut v);
            Some((v, of_errors, slot))
        });
        let known: Vec<_> = known.collect();
        for (l, (kernel, matrix)) in problem.kernels.iter().zip(&problem.matrices).enumerate() {
            let ([mut discrete, mut of_errors], mut weight) =
                (sums[l].before(0), sums[l].current_weight(0));
            let integral = match (&known[l], &problem.inner[l]) {
                (Some((v, errors, slot)), Some(within)) => {
                    axpy(weight, v, &mut discrete);
                    axpy(weight, errors, &mut of_errors);
                    weight *= slot;
                    let v = |times: &[f64]| {
                        let at = |&s: &f64| within.history(s, &kinks, &setup.problem.start, exact);
                        times.iter().map(at).collect()
                    };
                    kernel.integral(t, &kinks, &discrete, v)
                }
                _ => {
                    axpy(weight, &state.u, &mut discrete);
                    kernel.integral(t, &kinks, &discrete, exact)
                }
            };
            of_exact += matrix * DVector::from_vec(integral);
            sum += matrix * DVector::from_vec(discrete);
            past += matrix * DVector::from_vec(of_errors);
            present += weight * matrix;
        }
        let [history, discrete] = [of_exact, sum].map(|sum| &problem.r * sum);
        let (source, by_y, by_r) = problem.force(&state.u, history.as_slice(), discrete.as_slice());
        let mut tangent = &problem.matrix + DMatrix::from_diagonal(&by_r);
        tangent += DMatrix::from_diagonal(&by_y) * &problem.r * present;
        let right = source - by_y.component_mul(&(&problem.r * past));
        let (error, pressure) =
            problem.solve(tangent, right, &state).ok_or(NoConstant::Singular { t })?;
        largest = largest.max(match norm {
            Norm::PressureL2Max => pressure,
            Norm::DisplacementMax => {
                let [mut sum, mut off] = [(); 2].map(|()| vec![0.0; m]);
                let mut weight = 0.0;
                if let Some(sums) = &displacement {
                    ([sum, off], weight) = (sums.before(0), sums.current_weight(0));
                }
                axpy(weight, &state.u, &mut sum);
                axpy(weight, error.as_slice(), &mut off);
                let integral = problem.one.integral(t, &kinks, &sum, exact);
                // Both errors are discrete less exact.
                axpy(1.0, &sum, &mut off);
                axpy(-1.0, &integral, &mut off);
                problem.norm(&DVector::from_vec(off))
            }
            _ => problem.norm(&error),
        });
        let levels = [state.u.clone(), error.as_slice().to_vec()];
        for (sums, known) in sums.iter_mut().zip(known) {
            sums.advance(match known {
                Some((v, mut errors, slot)) => {
                    axpy(slot, &levels[1], &mut errors);
                    [v, errors]
                }
                None => levels.clone(),
            });
        }
        inner.iter_mut().flatten().for_each(|sums| sums.advance(levels.clone()));
        displacement.iter_mut().for_each(|sums| sums.advance(levels.clone()));
    }
    Ok(largest)
}

struct Linearised<'a> {
    graph: Graph,
    matrix: DMatrix<f64>,
    product: DMatrix<f64>,
    r: DMatrix<f64>,
    constant: DVector<f64>,
    kernels: Vec<Kernel>,
    /// r_l of the nested terms.
    inner: Vec<Option<Kernel>>,
    /// q = 1.
    one: Kernel,
    /// Q_l.
    matrices: Vec<DMatrix<f64>>,
    /// u(x).
    u: Program,
    /// g_i'.
    nonlinear: Vec<Node>,
    /// N_i, ∂N_i/∂y, ∂N_i/∂r.
    force: Vec<[Node; 3]>,
    laws: Vec<Option<LawNumbers>>,
    setup: &'a AbstractSetup,
}

impl<'a> Linearised<'a> {
    fn new(setup: &'a AbstractSetup) -> Self {
        let problem = &setup.problem;
        let mut graph = setup.scene.formulas.clone();
        let rows = |list: &[Vec<f64>]| DMatrix::from_fn(list.len(), list.len(), |i, j| list[i][j]);
        let horizon = setup.scene.time.horizon;
        let kernels = problem.kernels.iter();
        let (kernels, matrices) = kernels
            .map(|written| {
                let kernel = Kernel::new(&mut graph, written.power, written.q, horizon);
                (kernel, rows(&written.matrix))
            })
            .unzip();
        let inner = problem
            .kernels
            .iter()
            .map(|written| written.inner.map(|r| Kernel::new(&mut graph, 0.0, r, horizon)));
        let inner = inner.collect();
        let one = Kernel::one(&mut graph, horizon);
        let s = graph.variable(Variable::X);
        let u = problem.u.iter().map(|&u| graph.substitute(u, Variable::T, s));
        let u: Vec<Node> = u.collect();
        let u = Program::compile(&graph, &u, horizon);
        let mut by = |f: Node, variable| graph.derivative(f, variable);
        let nonlinear = problem.nonlinear.iter().flatten().map(|&g| by(g, Variable::X)).collect();
        let force = problem
            .force
            .iter()
            .flatten()
            .map(|&f| [f, by(f, Variable::Y), by(f, Variable::X)])
            .collect();
        Self {
            matrix: rows(&problem.matrix),
            product: rows(&problem.inner_product),
            r: rows(&problem.r),
            constant: DVector::from_column_slice(&problem.a_s),
            laws: setup.exact.laws(),
            kernels,
            inner,
            one,
            matrices,
            u,
            nonlinear,
            force,
            graph,
            setup,
        }
    }

    fn norm(&self, e: &DVector<f64>) -> f64 {
        (e.dot(&(&self.product * e))).sqrt()
    }

    /// Where a guard of u changes sign between two of these times.
    fn kinks(&self, times: &[f64]) -> Vec<f64> {
        let guards = self.graph.guards(&self.setup.problem.u);
        let values = |times: &[f64]| -> Vec<Vec<f64>> {
            let at = |guard: Node, t: f64| {
                self.graph.evaluate(guard, &EvaluationPoint { t, ..EvaluationPoint::default() })
            };
            guards.iter().map(|&guard| times.iter().map(|&t| at(guard, t)).collect()).collect()
        };
        times.windows(2).flat_map(|ends| sign_changes(ends[0], ends[1], 1, values)).collect()
    }

    /// N(S u, u) - N(S^k u, u), ∂N/∂y, and the diagonal g' + ∂N/∂r.
    fn force(
        &self,
        u: &[f64],
        exact: &[f64],
        discrete: &[f64],
    ) -> (DVector<f64>, DVector<f64>, DVector<f64>) {
        let m = u.len();
        let at = |node: Node, i: usize, y: f64| {
            self.graph.evaluate(node, &EvaluationPoint { x: u[i], y, ..EvaluationPoint::default() })
        };
        let source = DVector::from_fn(m, |i, _| match self.force.get(i) {
            Some(nodes) => at(nodes[0], i, exact[i]) - at(nodes[0], i, discrete[i]),
            None => exact[i] - discrete[i],
        });
        let by_y =
            DVector::from_fn(m, |i, _| self.force.get(i).map_or(1.0, |f| at(f[1], i, discrete[i])));
        let by_r = DVector::from_fn(m, |i, _| {
            let derivative = self.nonlinear.get(i).map_or(0.0, |&g| at(g, i, 0.0));
            derivative + self.force.get(i).map_or(0.0, |f| at(f[2], i, discrete[i]))
        });
        (source, by_y, by_r)
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
