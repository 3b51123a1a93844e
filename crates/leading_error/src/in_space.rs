//! The time error on V^h: the linearised scheme of a contact scene along the nodal interpolant of its exact solution.

use super::NoConstant;
use super::cells::{
    Answer, Mandel, add_force, add_stiffness, inner, product, strains, stress_along, stress_of,
};
use super::interpolation::InterpolationError;
use super::sums::{Kernel, Pair};
use algebra::linalg::{Front, axpy, dot, larger};
use exact::{ComplianceRule, Exact, InterpolatedOnMesh, Sliding};
use fem::contact::Discretization;
use fem::space::StrainPoint;
use formula::{EvaluationPoint, Node, Variable};
use nalgebra::{DMatrix, DVector};
use scene::{Norm, RelaxationTerm, TimeRule};
use std::sync::Arc;

pub(super) struct InSpace<const S: usize> {
    pub(super) exact: Arc<Exact>,
    pub(super) space: Arc<Discretization>,
    truth: InterpolatedOnMesh,
    /// κ'(ζ).
    slope: Option<Node>,
    graph: formula::Graph,
    regions: Vec<usize>,
    kernels: Vec<Kernel>,
    /// The kernel of ζ.
    one: Kernel,
}

/// I_h u with its exact histories at one time.
pub(super) struct State<const S: usize> {
    u: Vec<f64>,
    strain: Vec<Mandel<S>>,
    /// ‖ε‖_ℋ.
    norm: f64,
    /// Of each term of the memory.
    memory: Vec<Remembered<S>>,
    zeta: f64,
    /// ζ of the discrete history, with the weight of the level itself and its error.
    accumulated: f64,
    weight: f64,
    zeta_error: f64,
    /// [u_ν, ξ + λ, g, ξ, λ] at the points of the trace.
    pub(super) contact: Vec<[f64; 5]>,
    /// Friction at these points, if any.
    pub(super) friction: Option<Vec<Sliding>>,
}

/// One term of the memory at one time.
struct Remembered<const S: usize> {
    /// ε(∫ b_i(t-s) u ds).
    exact: Vec<Mandel<S>>,
    /// Its sum over all levels.
    discrete: Vec<Mandel<S>>,
    /// The sum over the errors of earlier levels.
    error: Vec<Mandel<S>>,
    /// The weight of the level itself.
    weight: f64,
}

/// Linearised response of the stress at a point.
struct Response<const S: usize> {
    /// In the strain of the level, including its share of the memory.
    tangent: [Mandel<S>; S],
    /// Minus the contribution of the past.
    source: Mandel<S>,
    /// In ζ.
    by_zeta: Mandel<S>,
}

impl<const S: usize> InSpace<S> {
    /// Binds the exact solution to the mesh of `space`.
    ///
    /// # Errors
    /// [`NoConstant::Rule`].
    pub(super) fn new(
        exact: Arc<Exact>,
        space: Arc<Discretization>,
        rule: TimeRule,
        memory: &[RelaxationTerm],
    ) -> Result<Self, NoConstant> {
        // The rule affects loads only, which are not used here.
        let truth = InterpolatedOnMesh::new(exact.clone(), space.clone(), ComplianceRule::Vertex);
        let mut graph = exact.data.graph.clone();
        let slope = exact
            .data
            .kappa
            .filter(|&kappa| graph.depends_on(kappa, Variable::Zeta))
            .map(|kappa| graph.derivative(kappa, Variable::Zeta));
        let regions = exact.cell_regions(&space.mesh);
        let horizon = exact.data.horizon;
        let kernel = |term: &RelaxationTerm| {
            let (power, factor) =
                term.singular.map_or((0.0, term.kernel), |parts| (parts.power, parts.factor));
            Kernel::of_lag(&mut graph, (rule, power), factor, horizon)
        };
        let kernels = memory.iter().map(kernel).collect::<Result<_, _>>()?;
        let one = Kernel::one(&mut graph, rule, horizon)?;
        Ok(Self { exact, space, truth, slope, graph, regions, kernels, one })
    }

    /// Number of steps beyond which the sums cost too much.
    pub(super) fn most_steps(&self) -> u32 {
        (MOST_PRODUCTS / self.space.nodes.len() as f64).sqrt() as u32
    }

    /// Whether u(t) ∈ V^h up to rounding, at arbitrary times.
    pub(super) fn holds_the_solution(&self, horizon: f64) -> Result<bool, NoConstant> {
        let mut interpolation = InterpolationError::new(&self.exact, &self.space, false);
        for share in [0.37, 0.83, 1.0] {
            let t = share * horizon;
            let strain: Vec<Mandel<S>> = strains(&self.space, &self.truth.displacements(t)?.0);
            let size = inner(&self.space, &strain, &strain).sqrt();
            let error = interpolation.at(t)?;
            if error.is_nan() || error > VANISHING * size {
                return Ok(false);
            }
        }
        Ok(true)
    }

    /// The largest errors on a grid, max_n ‖ε(e_n)‖ and those of the other norms.
    pub(super) fn largest_errors(&self, times: &[f64]) -> Result<Largest, NoConstant> {
        // Of earlier levels u and e, and ‖ε‖ and (ε, ε(e))/‖ε‖, the error of the integrand of ζ.
        let mut levels: Vec<Pair<Vec<f64>>> = Vec::new();
        let mut sizes: Vec<Pair<Vec<f64>>> = Vec::new();
        let mut largest = Largest::default();
        for (n, &t) in times.iter().enumerate() {
            let state = self.state(times, [&levels, &sizes])?;
            let (mut error, mut of_norm) = (vec![0.0; self.space.nodes.len()], 0.0);
            if n > 0 {
                let level = self.level(t, &state)?;
                let norm = inner(&self.space, &level.strain, &level.strain).sqrt();
                let along = inner(&self.space, &state.strain, &level.strain) / state.norm;
                // If ε vanishes, the norm of the discrete strain is that of the error.
                of_norm = if state.norm > VANISHING * norm { along } else { norm };
                if norm.is_nan() {
                    return Err(NoConstant::Singular { t });
                }
                largest.raise(&self.space, &level);
                error = level.error;
            }
            sizes.push([vec![state.norm], vec![of_norm]]);
            levels.push([state.u, error]);
        }
        Ok(largest)
    }

    fn at_zeta(&self, node: Option<Node>, zeta: f64, absent: f64) -> f64 {
        let at = EvaluationPoint { zeta, ..EvaluationPoint::default() };
        node.map_or(absent, |node| self.graph.evaluate(node, &at))
    }

    /// The state at the level after those that are given.
    fn state(
        &self,
        times: &[f64],
        [levels, sizes]: [&[Pair<Vec<f64>>]; 2],
    ) -> Result<State<S>, NoConstant> {
        let t = times[levels.len()];
        let (u, histories) = self.truth.displacements(t)?;
        let strain: Vec<Mandel<S>> = strains(&self.space, &u);
        let remembered = |(kernel, exact): (&Kernel, Vec<f64>)| {
            let ([mut discrete, error], weight) = kernel.sums(times, levels, u.len());
            axpy(weight, &u, &mut discrete);
            let [exact, discrete, error] =
                [exact, discrete, error].map(|nodal| strains(&self.space, &nodal));
            Remembered { exact, discrete, error, weight }
        };
        let memory = self.kernels.iter().zip(histories).map(remembered).collect();
        let norm = inner(&self.space, &strain, &strain).sqrt();
        let zeta = if self.slope.is_some() { self.truth.zeta(t)? } else { 0.0 };
        let (contact, friction) = (self.truth.contact_state(t), self.truth.friction_state(t));
        let ([before, zeta_error], weight) = self.one.sums(times, sizes, 1);
        let (accumulated, zeta_error) = (before[0] + weight * norm, zeta_error[0]);
        Ok(State {
            u,
            strain,
            norm,
            memory,
            zeta,
            accumulated,
            weight,
            zeta_error,
            contact,
            friction,
        })
    }

    /// e_n from the linearised step
    ///
    /// ```text
    /// (D ε(e), ε(v)) + ∫ ∂²j e_ν v_ν + (r, ε(v)) w (ε_n, ε(e))/‖ε_n‖ = -(ρ + past, ε(v)),   r = ∂σ/∂κ κ'
    /// ```
    ///
    /// with ρ the stress of the discrete history less that of the exact one.
    fn level(&self, t: f64, state: &State<S>) -> Result<Level<S>, NoConstant> {
        let space = &self.space;
        let kappa = |zeta: f64| self.at_zeta(self.exact.data.kappa, zeta, f64::INFINITY);
        let kappa = [state.zeta, state.accumulated].map(kappa);
        let slope = self.at_zeta(self.slope, state.accumulated, 0.0);
        let mut values = vec![0.0; space.pattern.entries()];
        let mut right = vec![0.0; space.nodes.len()];
        let (mut column, mut row) = (right.clone(), right.clone());
        let mut responses = Vec::with_capacity(state.strain.len());
        for at in space.points() {
            let strain = &state.strain[at.index];
            let response = self.response(&at, state, kappa, slope);
            let by_zeta = response.by_zeta;
            add_force(&at, &response.source, &mut right);
            add_stiffness(space, &at, &response.tangent, &mut values);
            responses.push(response);
            if self.slope.is_some() && state.norm > 0.0 {
                add_force(&at, &by_zeta, &mut column);
                add_force(&at, &strain.map(|e| state.weight * e / state.norm), &mut row);
            }
        }
        let answers = self.answers(state);
        self.add_contact(&answers, &mut values);
        self.add_friction(state, &mut values);
        let mut terms = self.following(&answers, state);
        if self.slope.is_some() {
            terms.push(RankOne { column, row });
        }
        let error = solve(space, t, &values, right, &terms)?;
        let strain: Vec<Mandel<S>> = strains(space, &error);
        // The level's contribution to the change of ζ.
        let share = match self.slope.is_some() && state.norm > 0.0 {
            true => state.weight * inner(space, &state.strain, &strain) / state.norm,
            false => 0.0,
        };
        // The leading part of σ^k - σ.
        let stress = |(response, strain): (&Response<S>, &Mandel<S>)| -> Mandel<S> {
            let of = |i: usize| product(&response.tangent[i], strain) + share * response.by_zeta[i];
            std::array::from_fn(|i| of(i) - response.source[i])
        };
        let stress: Vec<Mandel<S>> = responses.iter().zip(&strain).map(stress).collect();
        // The pressures that balance it at the vertices of Γ3: p_i = -(σ, ε(φ_i ν_i))/w_i.
        let mut force = vec![0.0; space.nodes.len()];
        for (at, tensor) in space.points().zip(&stress) {
            add_force(&at, tensor, &mut force);
        }
        let balance = |i: usize| -normal(space, i, &force) / space.trace.points[i].weight;
        let pressure = answers.iter().enumerate().map(|(i, answer)| match answer {
            None => 0.0,
            Some(Answer::Slope(slope)) => slope * normal(space, i, &error),
            Some(Answer::Held) => balance(i),
        });
        let mut pressure: Vec<f64> = pressure.collect();
        space.trace.extend(&mut pressure);
        Ok(Level { error, strain, stress, pressure })
    }

    /// Response of the stress at a point, with κ at the exact ζ and at that of the scheme, and κ' there.
    fn response(
        &self,
        at: &StrainPoint<'_>,
        state: &State<S>,
        [exact_kappa, scheme_kappa]: [f64; 2],
        slope: f64,
    ) -> Response<S> {
        let strain = &state.strain[at.index];
        let material = self.exact.material_in(self.regions[at.cell]);
        let (exact, discrete): (Vec<Mandel<S>>, Vec<Mandel<S>>) =
            state.memory.iter().map(|term| (term.exact[at.index], term.discrete[at.index])).unzip();
        let before = stress_of(material, strain, &exact, exact_kappa);
        let after = stress_of(material, strain, &discrete, scheme_kappa);
        let along = |by_strain, by_memory: &dyn Fn(&Remembered<S>) -> Mandel<S>, by_kappa| {
            let pair = |term: &Remembered<S>| [term.discrete[at.index], by_memory(term)];
            let memory = state.memory.iter().map(pair);
            stress_along(material, [*strain, by_strain], memory, [scheme_kappa, by_kappa])
        };
        let zero = [0.0; S];
        // Symmetric: the columns are the rows.
        let tangent = std::array::from_fn(|i| {
            let unit: Mandel<S> = std::array::from_fn(|j| f64::from(u8::from(i == j)));
            along(unit, &|term| unit.map(|e| term.weight * e), 0.0)
        });
        let by_zeta = if slope == 0.0 { zero } else { along(zero, &|_| zero, slope) };
        let past = along(zero, &|term| term.error[at.index], slope * state.zeta_error);
        let source = std::array::from_fn(|i| before[i] - after[i] - past[i]);
        Response { tangent, source, by_zeta }
    }
}

/// Limit of multiplications in the sums over the past of one grid: some seconds.
const MOST_PRODUCTS: f64 = 1e10;
/// Smaller shares are zero up to rounding.
const VANISHING: f64 = 1e-9;

// Linearised steps with a sparse symmetric matrix plus a few terms a bᵀ: one for ζ, one per slipping vertex for
// friction whose bound follows the normal law.

/// a bᵀ, both over all nodes.
pub(super) struct RankOne {
    pub column: Vec<f64>,
    pub row: Vec<f64>,
}

/// Smaller pivots are zero up to rounding.
const SINGULAR: f64 = 1e-9;

/// (K + Σ a_i b_iᵀ)⁻¹ `right`, over all nodes, by the Sherman–Morrison–Woodbury formula; `values` are K's.
///
/// # Errors
/// [`NoConstant::Singular`]; a K that cannot be factorized.
fn solve(
    space: &Discretization,
    t: f64,
    values: &[f64],
    mut right: Vec<f64>,
    terms: &[RankOne],
) -> Result<Vec<f64>, NoConstant> {
    let dofs = space.dofs();
    let analysis = space.analysis()?;
    let (mut factor, mut workspace) = (analysis.factor(), analysis.workspace());
    analysis.factorize(&space.pattern, values, &mut factor, &mut workspace)?;
    let mut front = Front::default();
    let mut solved = |side: &[f64]| {
        let mut x = side[..dofs].to_vec();
        analysis.solve(&factor, &mut x, &mut front);
        x
    };
    let mut error = solved(&right);
    // nalgebra does not solve systems without rows.
    if !terms.is_empty() {
        let answers: Vec<Vec<f64>> = terms.iter().map(|term| solved(&term.column)).collect();
        let along = |i: usize, vector: &[f64]| dot(&terms[i].row[..dofs], vector);
        let capacitance = DMatrix::from_fn(terms.len(), terms.len(), |i, j| {
            f64::from(u8::from(i == j)) + along(i, &answers[j])
        });
        let factors = capacitance.lu();
        let pivots = factors.u().diagonal();
        if pivots.iter().any(|pivot| pivot.is_nan() || pivot.abs() <= SINGULAR) {
            return Err(NoConstant::Singular { t });
        }
        let rows = DVector::from_fn(terms.len(), |i, _| along(i, &error));
        let shares = factors.solve(&rows).ok_or(NoConstant::Singular { t })?;
        for (share, answer) in shares.iter().zip(&answers) {
            axpy(-share, answer, &mut error);
        }
    }
    right.fill(0.0);
    right[..dofs].copy_from_slice(&error);
    Ok(right)
}

// Norms of the leading error in time: of functions of the element, and of tensors at its strain points.

pub(super) struct Level<const S: usize> {
    /// e as a nodal vector.
    pub(super) error: Vec<f64>,
    /// ε(e) at the strain points.
    pub(super) strain: Vec<Mandel<S>>,
    /// The leading part of σ^k - σ there.
    pub(super) stress: Vec<Mandel<S>>,
    /// (ξ + λ)^k - (ξ + λ) at the points of the trace.
    pub(super) pressure: Vec<f64>,
}

/// The norms with a leading error in time.
const NORMS: [Norm; 5] =
    [Norm::VMax, Norm::L2Max, Norm::StressL2Max, Norm::TraceL2Max, Norm::PressureL2Max];

/// The largest errors in these norms.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Largest([f64; 5]);

impl Largest {
    /// Includes a level; NaN is kept.
    pub(super) fn raise<const S: usize>(&mut self, space: &Discretization, level: &Level<S>) {
        let of_cells = |field: &[Mandel<S>]| inner(space, field, field).sqrt();
        let d = space.mesh.dimension;
        let squares = space.element.mean_square(d + 1);
        let at = |&node: &u32| -> [f64; 3] {
            std::array::from_fn(|i| if i < d { level.error[d * node as usize + i] } else { 0.0 })
        };
        let cell = |(c, &measure): (usize, &f64)| {
            squares.over(measure, &space.cell_nodes(c).iter().map(at).collect::<Vec<_>>())
        };
        let in_the_body: f64 = space.geometry.measure.iter().enumerate().map(cell).sum();
        let trace: Vec<f64> =
            (0..space.trace.points.len()).map(|i| normal(space, i, &level.error)).collect();
        let values = [
            of_cells(&level.strain),
            in_the_body.sqrt(),
            of_cells(&level.stress),
            on_the_contact_side(space, &trace),
            on_the_contact_side(space, &level.pressure),
        ];
        self.0.iter_mut().zip(values).for_each(|(known, value)| *known = larger(*known, value));
    }

    /// None for norms without a leading error in time.
    pub(super) fn of(&self, norm: Norm) -> Option<f64> {
        let norm = if norm == Norm::VTimeMax { Norm::VMax } else { norm };
        NORMS.iter().position(|known| *known == norm).map(|at| self.0[at])
    }
}

/// v·ν at a point of the trace, by the components of its node.
pub(super) fn normal(space: &Discretization, i: usize, nodal: &[f64]) -> f64 {
    let (point, d) = (&space.trace.points[i], space.mesh.dimension);
    (0..d).map(|j| point.normal[j] * nodal[d * point.node as usize + j]).sum()
}

/// ‖f‖ in L²(Γ3) of values at the points of the trace.
fn on_the_contact_side(space: &Discretization, values: &[f64]) -> f64 {
    let squares = space.element.mean_square(space.mesh.dimension);
    let at = |&i: &u32| [values[i as usize]];
    let facet = |(f, &measure): (usize, &f64)| {
        squares.over(measure, &space.trace.facet(f).iter().map(at).collect::<Vec<_>>())
    };
    space.trace.measure.iter().enumerate().map(facet).sum::<f64>().sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use fem::mesh::{Family, lattice};

    /// A NaN in one norm must not affect the others.
    #[test]
    fn no_number_stays_in_its_norm() {
        let mesh = lattice([1.0, 1.0], 1, Family::Structured);
        let space = Discretization::new(mesh, &[3], &[2]);
        let (nodes, cells) = (space.nodes.len(), space.mesh.cell_count());
        let level = |pressure: f64| Level::<3> {
            error: vec![1.0; nodes],
            strain: vec![[1.0; 3]; cells],
            stress: vec![[2.0; 3]; cells],
            pressure: vec![pressure; space.trace.points.len()],
        };
        let mut largest = Largest::default();
        for pressure in [1.0, f64::NAN, 2.0] {
            largest.raise(&space, &level(pressure));
        }
        assert!(largest.of(Norm::PressureL2Max).is_some_and(f64::is_nan));
        assert!(largest.of(Norm::TraceL2Max).is_some_and(f64::is_finite));
        // √3 on the unit square.
        let v = largest.of(Norm::VMax).expect("a norm");
        assert!((v - 3f64.sqrt()).abs() < 1e-15, "{v}");
    }
}
