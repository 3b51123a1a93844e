//! An abstract scene made computable: model, exact solution, and checks before a solve.

use super::kernel_bounds::{KernelBounds, KernelNorms, NESTED, norm};
use super::regularity::abstract_claims;
use super::{Result, potential};
use crate::memory::in_the_largest;
use crate::reading::evenly;
use crate::{AbstractScene, Body, Hypothesis, Law, Norm, Scene};
use algebra::linalg::larger;
use exact::{ByTime, FiniteData, FiniteExact, FiniteState, FiniteTrace};
use files::digits;
use formula::{Effort, EvaluationPoint, Graph, Interval, Node, Place, Program, Variable, largest};
use nalgebra::{DMatrix, DVector, SymmetricEigen};
use std::sync::Arc;
use std::time::Instant;
use vhi::finite::{
    ComponentLaw, FiniteError, FiniteInfo, FiniteKernel, FiniteLoad, FiniteModel, FiniteView,
    Functional, march,
};
use vhi::history::{TimeGrid, TimeRule};
use vhi::law::HistoryKernel;
use vhi::{SingularSlot, StepBounds, StepSolver, monotonicity};

/// An abstract scene with its model and exact solution.
pub struct AbstractSetup {
    pub scene: Scene,
    pub problem: AbstractScene,
    pub model: FiniteModel,
    pub exact: FiniteExact,
    pub constants: AbstractConstants,
    /// States at times already asked for: grids share their common times.
    states: ByTime<FiniteState>,
}

impl AbstractSetup {
    /// Builds model and exact solution, and checks the contact state and (2.9).
    ///
    /// # Errors
    /// The first violated condition, at its key in the scene.
    pub fn new(scene: Scene) -> Result<Self> {
        let Body::Abstract(problem) = scene.body.clone() else {
            let message = "a body in contact is no abstract problem";
            let hint = "this command needs a scene with kind = \"abstract\"";
            return Err(scene.error("scene.kind", message, hint).into());
        };
        scene.check_sweep()?;
        let model = model(&scene, &problem);
        // First: a kernel without a bound has no integrals either.
        let constants = abstract_constants(&scene, &problem, &model)?;
        let exact = exact(&scene, &problem).map_err(|error| {
            let hint = "write u and q by functions that vary on the scale of the horizon";
            scene.error("exact.u", error.to_string(), hint)
        })?;
        let setup =
            Self { scene, problem: *problem, model, exact, constants, states: ByTime::default() };
        setup.admissible()?;
        Ok(setup)
    }

    /// The grid with the given number of steps.
    pub fn grid(&self, steps: u32) -> TimeGrid {
        self.scene.time.grid(steps).unwrap_or_else(|error| panic!("{error}"))
    }

    /// The exact state at time t; computed once.
    pub fn state(&self, t: f64) -> Arc<FiniteState> {
        self.states.always(t, || self.exact.at(t))
    }

    /// Solves the scene with `steps` steps and measures it against the exact solution.
    pub fn run(&self, steps: u32, solver: &dyn StepSolver) -> Result<AbstractRun, FiniteError> {
        self.run_under(&mut AbstractLoad(self), steps, solver)
    }

    /// The same under another load.
    pub fn run_under(
        &self,
        load: &mut dyn FiniteLoad,
        steps: u32,
        solver: &dyn StepSolver,
    ) -> Result<AbstractRun, FiniteError> {
        let mut run = AbstractRun::default();
        let (grid, mut levels) = (self.grid(steps), Vec::new());
        let wanted = self.scene.predicts.iter().any(|p| p.norm == Norm::DisplacementMax);
        let mut observe = |view: &FiniteView<'_>| {
            let begin = Instant::now();
            let exact = self.state(view.t);
            run.seconds_truth += begin.elapsed().as_secs_f64();
            let u = DVector::from_column_slice(&exact.u);
            run.error = larger(run.error, self.model.norm(&(u - view.u)));
            if wanted {
                levels.push(view.u.clone());
                let mut off = &self.model.start - DVector::from_vec(self.exact.integral(view.t));
                for (j, u) in levels.iter().enumerate() {
                    off.axpy(self.model.time_rule.weight(&grid, view.n, j), u, 1.0);
                }
                run.displacement_error = larger(run.displacement_error, self.model.norm(&off));
            }
            let pressures = exact.selection.iter().zip(&exact.multiplier).zip(view.pressure);
            let squares = pressures
                .zip(&self.problem.traces)
                .map(|(((xi, lambda), found), trace)| trace.weight * (xi + lambda - found).powi(2));
            run.pressure_error = larger(run.pressure_error, squares.sum::<f64>().sqrt());
            run.u = view.u.as_slice().to_vec();
            run.history = view.history.as_slice().to_vec();
            run.pressure = view.pressure.to_vec();
        };
        let info = march(&self.model, &grid, load, solver, &mut observe)?;
        Ok(AbstractRun { info, ..run })
    }

    /// l ≤ a·u ≤ g, λ on the bound only and of its sign, ξ ∈ ∂j(a·u); m0 > 0.
    fn admissible(&self) -> Result<()> {
        let c = &self.constants;
        let message = format!(
            "the smallness condition (2.9) fails: m0 = m_A - alpha_phi - alpha_j c_j^2 = {} - {} - {} * {} = {}",
            digits(c.m_a, 5),
            digits(c.alpha_phi, 5),
            digits(c.alpha_j, 5),
            digits(c.c_j_squared, 5),
            digits(c.m0, 5)
        );
        let hint = "enlarge the matrix of the operator; or say violates = [\"2.9\"] in [scene] to run it all the same";
        let fails = c.m0 <= 0.0 && !self.scene.violates.contains(&Hypothesis::Smallness);
        self.scene.refuse_if(fails, "operator.matrix", message, hint)?;
        let times = evenly(0.0, self.scene.time.horizon, TIMES);
        // Scale of rounding: the largest a_i·u and ξ_i at any time.
        let mut sizes = vec![[0.0f64; 2]; self.problem.traces.len()];
        for t in times.clone() {
            let state = self.state(t);
            let traces = state.traces.iter().zip(&state.selection);
            for (size, (r, xi)) in sizes.iter_mut().zip(traces) {
                *size = [size[0].max(r.abs()), size[1].max(xi.abs())];
            }
        }
        for t in times {
            self.contact_state(t, &sizes)?;
        }
        abstract_claims(self)
    }

    fn contact_state(&self, t: f64, sizes: &[[f64; 2]]) -> Result<()> {
        let state = self.state(t);
        if let Some(value) = state.load.iter().find(|value| !value.is_finite()) {
            let message =
                format!("the load of the exact solution is {value} at t = {}", digits(t, 5));
            let hint = "u, its history and the operator must be finite on [0, T]";
            return Err(self.scene.error("exact.u", message, hint).into());
        }
        for (i, trace) in self.problem.traces.iter().enumerate() {
            let (r, xi, lambda) = (state.traces[i], state.selection[i], state.multiplier[i]);
            let slack = ROUNDING * sizes[i][0];
            let (at, time) = (digits(r, 7), digits(t, 5));
            let (lower, upper) = (trace.lower, trace.upper);
            let message = format_args!("a_{i}·u = {at} leaves [{lower}, {upper}], t = {time}");
            let outside = r > upper + slack || r < lower - slack;
            let hint = "keep u in K, or widen the bounds";
            self.scene.refuse_if(outside, "exact.u", message, hint)?;
            let (above, below) = (r >= upper - slack, r <= lower + slack);
            let odd = (lambda > 0.0 && !above) || (lambda < 0.0 && !below) || lambda.is_nan();
            let message =
                format_args!("the multiplier is {lambda:.3e} where a_{i}·u = {at}, t = {time}");
            let hint = "λ > 0 on the upper bound, λ < 0 on the lower one, 0 between";
            self.scene.refuse_if(odd, &format!("exact.multiplier.{i}"), message, hint)?;
            let (lo, hi) = self.model.functionals[i].potential.subdifferential(r);
            let slack = ROUNDING * lo.abs().max(hi.abs()).max(sizes[i][1]);
            let within = xi >= lo - slack && xi <= hi + slack;
            let [inside, low, high] = [xi, lo, hi].map(|value| digits(value, 7));
            let message =
                format_args!("xi = {inside} is not in [{low}, {high}] = ∂j({at}), t = {time}");
            let hint = "state exact.selection within the interval of the law";
            self.scene.refuse_if(!within, &format!("exact.selection.{i}"), message, hint)?;
        }
        Ok(())
    }
}

/// Times at which the exact state is checked.
const TIMES: u32 = 64;
/// Rounding of formulas, relative to the numbers compared.
const ROUNDING: f64 = 1e-9;

/// The result of a run of an abstract scene.
#[derive(Debug, Clone, Default)]
pub struct AbstractRun {
    pub info: FiniteInfo,
    /// max_n ‖u(t_n) - u_n^k‖_X.
    pub error: f64,
    /// max_n (Σ w_i (p_i(t_n) - p_i,n^k)²)^½ of the pressures p = ξ + λ.
    pub pressure_error: f64,
    /// max_n ‖U(t_n) - U_n‖_X, U = start + ∫ u and by the scene's rule; 0 unless a prediction asks for it.
    pub displacement_error: f64,
    /// u_N.
    pub u: Vec<f64>,
    /// S_N^k u.
    pub history: Vec<f64>,
    /// ξ_i + λ_i at t_N per functional.
    pub pressure: Vec<f64>,
    /// Seconds spent on exact states.
    pub seconds_truth: f64,
}

/// f(t) of the exact solution.
pub struct AbstractLoad<'a>(pub &'a AbstractSetup);

impl FiniteLoad for AbstractLoad<'_> {
    fn at(&mut self, t: f64) -> Result<DVector<f64>, FiniteError> {
        let state = self.0.state(t);
        match state.load.iter().position(|value| !value.is_finite()) {
            Some(component) => {
                Err(FiniteError::Load { component, value: state.load[component], t })
            }
            None => Ok(DVector::from_column_slice(&state.load)),
        }
    }
}

/// A law of a component, its derivatives by y and by r.
struct FormulaComponent {
    graph: Arc<Graph>,
    nodes: [Node; 3],
}

impl FormulaComponent {
    fn evaluate(&self, which: usize, y: f64, r: f64) -> f64 {
        let at = EvaluationPoint { x: r, y, ..EvaluationPoint::default() };
        self.graph.evaluate(self.nodes[which], &at)
    }
}

impl ComponentLaw for FormulaComponent {
    fn value(&self, y: f64, r: f64) -> f64 {
        self.evaluate(0, y, r)
    }

    fn by_y(&self, y: f64, r: f64) -> f64 {
        self.evaluate(1, y, r)
    }

    fn by_r(&self, y: f64, r: f64) -> f64 {
        self.evaluate(2, y, r)
    }
}

/// (t - s)^{-a} times a formula in t and s.
struct FormulaKernel {
    graph: Arc<Graph>,
    node: Node,
    program: Program,
    power: f64,
}

impl HistoryKernel for FormulaKernel {
    fn at(&self, t: f64, s: f64) -> f64 {
        let factor = self.factor(t, s);
        if self.power == 0.0 { factor } else { factor * (t - s).powf(-self.power) }
    }

    fn row(&self, t: f64, s: &[f64]) -> Vec<f64> {
        let points: Vec<[f64; 3]> = s.iter().map(|&s| [s, 0.0, 0.0]).collect();
        let mut values = vec![Vec::new()];
        self.program.bind(&points).evaluate(t, 0.0, &mut values);
        let mut row = values.swap_remove(0);
        if self.power != 0.0 {
            row.iter_mut().zip(s).for_each(|(value, s)| *value *= (t - s).powf(-self.power));
        }
        row
    }

    fn power(&self) -> f64 {
        self.power
    }

    fn factor(&self, t: f64, s: f64) -> f64 {
        self.graph.evaluate(self.node, &EvaluationPoint { x: s, t, ..EvaluationPoint::default() })
    }
}

pub(super) fn dense(rows: &[Vec<f64>]) -> DMatrix<f64> {
    DMatrix::from_fn(rows.len(), rows.len(), |i, j| rows[i][j])
}

fn model(scene: &Scene, problem: &AbstractScene) -> FiniteModel {
    let mut graph = scene.formulas.clone();
    let mut derivatives = |nodes: &Option<Vec<Node>>| -> Vec<[Node; 3]> {
        let list = nodes.iter().flatten();
        list.map(|&f| [f, graph.derivative(f, Variable::Y), graph.derivative(f, Variable::X)])
            .collect()
    };
    let (nonlinear, force) = (derivatives(&problem.nonlinear), derivatives(&problem.force));
    let graph = Arc::new(graph);
    let kernel = |node: Node, power: f64| -> Box<dyn HistoryKernel + Send + Sync> {
        let program = Program::compile(&graph, &[node], scene.time.horizon);
        Box::new(FormulaKernel { graph: graph.clone(), node, program, power })
    };
    let component = |nodes: [Node; 3]| -> Box<dyn ComponentLaw> {
        Box::new(FormulaComponent { graph: graph.clone(), nodes })
    };
    FiniteModel {
        inner_product: dense(&problem.inner_product),
        matrix: dense(&problem.matrix),
        nonlinear: nonlinear.into_iter().map(component).collect(),
        kernels: problem
            .kernels
            .iter()
            .map(|written| FiniteKernel {
                kernel: kernel(written.q, written.power),
                inner: written.inner.map(|r| kernel(r, 0.0)),
                matrix: dense(&written.matrix),
            })
            .collect(),
        r: dense(&problem.r),
        a_s: DVector::from_column_slice(&problem.a_s),
        start: DVector::from_column_slice(&problem.start),
        force: force.into_iter().map(component).collect(),
        functionals: problem
            .traces
            .iter()
            .map(|trace| Functional {
                a: DVector::from_column_slice(&trace.functional),
                weight: trace.weight,
                potential: potential(trace.law.as_ref()),
                upper: trace.upper,
                lower: trace.lower,
            })
            .collect(),
        time_rule: scene.time.rule.weights(),
    }
}

fn exact(scene: &Scene, problem: &AbstractScene) -> Result<FiniteExact, exact::Unresolved> {
    let one = |list: &Option<Vec<Node>>, i: usize| list.as_ref().map(|list| list[i]);
    FiniteExact::new(FiniteData {
        graph: scene.formulas.clone(),
        matrix: problem.matrix.clone(),
        nonlinear: problem.nonlinear.clone().unwrap_or_default(),
        kernels: problem.kernels.clone(),
        r: problem.r.clone(),
        a_s: problem.a_s.clone(),
        start: problem.start.clone(),
        force: problem.force.clone().unwrap_or_default(),
        traces: problem
            .traces
            .iter()
            .enumerate()
            .map(|(i, trace)| FiniteTrace {
                functional: trace.functional.clone(),
                weight: trace.weight,
                law: trace.law.as_ref().map(crate::Law::numbers),
                multiplier: one(&problem.multiplier, i),
                selection: one(&problem.selection, i),
            })
            .collect(),
        u: problem.u.clone(),
        horizon: scene.time.horizon,
    })
}

// Constants of an abstract problem (docs/THEORY.md, section 1), with respect to ‖·‖_X and its dual norm. Forces and
// values of S are measured in X*: ‖y‖² = y·G⁻¹y.

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
    /// Of q(t, s), without the terms that are infinite at s = t and those with an inner kernel: what R q(t, t) can take from
    /// the monotonicity of a step of weight 1 is β_φ‖R‖ max ‖q(t, t)‖, if N is not linear in y.
    pub plain: KernelNorms,
    /// Of the terms with an inner kernel, for ‖r‖ q(t, s) and q(t, t) r(t, t) in place of q.
    pub nested: KernelNorms,
    /// a of the terms (t - s)^{-a} b(t, s), 0 without one, and of b.
    pub power: f64,
    pub singular: KernelNorms,
    /// The slopes of g and N are bounded for |r|, |y| up to this.
    pub slopes_up_to: f64,
}

impl AbstractConstants {
    /// The bounds on the step size.
    pub fn step_bounds(&self, rule: &dyn TimeRule) -> StepBounds {
        let lipschitz = self.r_norm * self.plain.all;
        // A nested term has the last weight w_nn².
        let (power, share, norms) = match self.nested.all > 0.0 {
            true => (NESTED, rule.last_share().powi(2), self.nested),
            false => (self.power, rule.last_weight(self.power, 1.0), self.singular),
        };
        let last_slot = |norms: KernelNorms| self.beta_phi * self.r_norm * norms.now;
        StepBounds {
            m0: self.m0,
            beta_phi: self.beta_phi,
            lipschitz,
            paper_lipschitz: lipschitz,
            last_slot: last_slot(self.plain),
            destabilizing: self.plain.destabilizing,
            last_share: rule.last_share(),
            singular: SingularSlot {
                power,
                share,
                lipschitz: self.r_norm * norms.all,
                paper_lipschitz: self.r_norm * norms.all,
                last_slot: last_slot(norms),
                destabilizing: norms.destabilizing,
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
    if let Some((l, key, t)) = kernels.unbounded() {
        let of = if key == "q" {
            "q(t, s) has no bound near t"
        } else {
            "r(s, tau) has no bound near s"
        };
        let message = format!("{of} = {t:.6}");
        let hint = "a kernel must be continuous for 0 <= s <= t <= T; exp(s - t) is an example";
        return Err(scene.error(&format!("history.kernels.{l}.{key}"), message, hint).into());
    }
    let with_phi = |norms: KernelNorms| match linear {
        true => norms,
        false => KernelNorms { destabilizing: beta_phi * r_norm * norms.now, ..norms },
    };
    let (plain, nested) = (with_phi(kernels.norms(0.0)), with_phi(kernels.norms(NESTED)));
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
        plain,
        nested,
        power,
        singular,
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
