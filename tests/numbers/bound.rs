//! Source: Theorem 6, (3.4) and (3.15), with the factors of docs/THEORY.md, section 4.
//! Goal: the factor of Λ is what linear algebra says where that is known (B(0) a multiple of 𝒜, or ±I), it obeys
//!   measured ≤ sharpened ≤ (3.15) elsewhere, the iteration obeys the factor, and a wrong constant or derivative is caught.
//! Mesh: the unit square, 8 × 8 squares, clamped top, contact bottom; 4 × 4 for dense comparisons.
//! Data: linear-punch (ℬ(0) = -𝒜/4: factor k/8), memory-minus-identity and -plus-identity (λ = μ_L = 1: factor k/4), punch.

use crate::shipped::{at_level, edited, on_mesh, setup, setup_of, text};
use crate::wrong::as_level;
use algebra::linalg::{FactorError, dot, signed_unit};
use fem::contact::{CaseError, TraceMass, TracePart, trace_constants};
use judge::claim::{Claim, Standing};
use nalgebra::DMatrix;
use scene::setup::{MeshData, Setup, constants, step_bounds};
use studies::study::StudyError;
use studies::theory::bound::{
    BoundStudy, ContractionStudy, Crossing, StepLadder, StepRung, Thresholds, claims, contraction,
    finite_factor, study,
};
use vhi::history::TimeGrid;
use vhi::law::TensorField;
use vhi::{
    FrozenDerivative, HistoryInequality, Newton, OpenInequality, Scratch, StepBounds, StepError,
    StepInequality, StepState,
};

const N: u32 = 8;

fn failing(claims: &[Claim]) -> Vec<&Claim> {
    claims.iter().filter(|claim| claim.standing() != Standing::Passes).collect()
}

fn studied(setup: &Setup, steps: u32) -> (StepBounds, ContractionStudy) {
    let bounds = step_bounds(setup).unwrap_or_else(|error| panic!("{error}"));
    let found = study(setup, &bounds, N, steps).unwrap_or_else(|error| panic!("{error}"));
    (bounds, found)
}

fn bracket(crossing: Option<Crossing>) -> Crossing {
    let bracket = crossing.expect("a crossing");
    assert!(bracket[0] > 0.0 && bracket[1].is_finite(), "{bracket:?}");
    bracket
}

/// The factor is `slope`·k, and reaches one where it should.
fn is_linear_in_k(found: &ContractionStudy, slope: f64) {
    for rung in &found.rungs {
        // Eigenvalues settle to 1e-13, the radius of a map that is not known to be normal to 1e-9.
        assert!((rung.norm - slope * rung.k).abs() < 1e-10 * rung.k, "{rung:?}");
        assert!((rung.radius - slope * rung.k).abs() < 1e-7 * rung.k, "{rung:?}");
    }
    for crossing in [found.thresholds.norm, found.thresholds.radius] {
        let [low, high] = bracket(crossing);
        // Where the tangent becomes singular there, the solution is followed to 1e-6 of it.
        assert!((low * slope - 1.0).abs() < 2e-6 && (high * slope - 1.0).abs() < 2e-6);
    }
}

/// 𝒜 + (k/2)ℬ(0) is singular at this k: within 2e-6 of it Newton's method reaches its tolerance no more.
fn loses_its_solution(found: &ContractionStudy, k: f64) {
    let [low, high] = found.thresholds.loss.as_ref().expect("a loss").bracket;
    assert!(low < high && high - low <= 2e-7 * k, "{low} {high}");
    assert!((low / k - 1.0).abs() < 2e-6 && (high / k - 1.0).abs() < 2e-6, "{low} {high}");
}

/// ℬ(0) = -I, 𝒜 = 2I on deviators: DΛ = (k/2)/2 on strains without trace, which P1 has; attained.
#[test]
fn minus_identity_attains_the_sharpened_bound() {
    let (bounds, found) = studied(&setup("memory-minus-identity"), 4);
    is_linear_in_k(&found, 0.25);
    assert_eq!((bounds.sharpened_limit(), bounds.solvable_limit()), (4.0, 4.0));
    loses_its_solution(&found, 4.0);
    assert!(Claim::all_hold(&claims(&bounds, &found.rungs, &found.thresholds)));
}

/// ℬ(0) = +I: the same factor, yet every step has its solution and Newton's method finds it.
#[test]
fn plus_identity_is_solvable_where_lambda_is_not() {
    let (bounds, found) = studied(&setup("memory-plus-identity"), 4);
    is_linear_in_k(&found, 0.25);
    assert!(found.thresholds.loss.is_none() && bounds.solvable_limit() == f64::INFINITY);
    let beyond: Vec<&StepRung> = found.rungs.iter().filter(|rung| rung.k > 4.05).collect();
    assert!(beyond.len() >= 3);
    for rung in beyond {
        assert!(rung.newton.is_ok(), "{rung:?}");
        let Err(StepError::NotContracting { .. }) = rung.fixed_point else { panic!("{rung:?}") };
    }
}

/// ℬ(0) = -𝒜/4: DΛ = (k/8) times the identity, half of the sharpened bound, which takes the largest eigenvalue
/// of ℬ(0), 1, over the smallest of 𝒜, 2, though they belong to different tensors.
#[test]
fn linear_punch_has_half_of_the_sharpened_factor() {
    let (bounds, found) = studied(&setup("linear-punch"), 8);
    is_linear_in_k(&found, 0.125);
    assert_eq!([bounds.paper_limit(), bounds.limit(), bounds.sharpened_limit()], [0.5, 1.0, 4.0]);
    // Beyond it a linear step has a solution again, with a tangent that is not positive definite: that is no step of a run.
    loses_its_solution(&found, 8.0);
    assert!(found.rungs.iter().any(|rung| rung.k > 15.0 && rung.at_solution));
}

/// All terms at once: the order of things. J = J_0 (I - DΛ): the solution ends where DΛ has the eigenvalue one, which is
/// where Λ stops contracting, because ℬ(0) < 0 makes the largest eigenvalue positive.
#[test]
fn punch_keeps_the_order_of_things() {
    let setup = setup("punch");
    let bound = BoundStudy::new(&setup, N, 8).unwrap_or_else(|error| panic!("{error}"));
    assert!(bound.holds(), "{:?}", failing(&bound.claims));
    assert!(bound.study.starts.same >= 20);
    assert_eq!(bound.study.starts.distinct, 0);
    let loss = bound.study.thresholds.loss.as_ref().expect("an end");
    let [low, high] = loss.bracket;
    assert!(low > bound.limits.solvable_limit() && high - low < 1e-6 * high, "{loss:?}");
    assert!(bound.study.thresholds.radius.expect("a threshold")[0] <= high);
    // (3.4) is a sufficient condition; how far from necessary is the use of this command.
    assert!(bound.ratio().expect("a threshold") > 10.0);
}

/// The open last level of punch with step size k, where contact, yield and ζ are active.
fn with_punch<T>(k: f64, see: impl FnOnce(&mut dyn Probe, StepState) -> T) -> T {
    let setup = setup("punch");
    let data = on_mesh(&setup, N);
    at_level(&setup, &data, 8, 8, |level, mut state| {
        level.set_step(k);
        level.freeze(None);
        Newton::default()
            .solve(level, &mut state, &mut Scratch::default())
            .unwrap_or_else(|error| panic!("{error}"));
        let pinned = state.pressure.iter().filter(|p| **p > 0.5).count();
        assert!(pinned > 0, "no vertex is locked: {:?}", state.pressure);
        Ok(see(level, state))
    })
    .unwrap_or_else(|error| panic!("{error}"))
}

/// What the tests ask of a level.
trait Probe {
    fn adjointness(&mut self, eta: &StepState) -> f64;
    fn derivative_error(&mut self, eta: &StepState) -> f64;
    fn iteration(&mut self, start: &StepState) -> (Vec<f64>, f64, f64);
}

impl<L: FrozenDerivative> Probe for L {
    /// |(DΛx, y) - (x, DΛ*y)| relative to ‖x‖‖y‖.
    fn adjointness(&mut self, eta: &StepState) -> f64 {
        self.differentiate(&eta.u, eta).expect("a tangent");
        let (mut seed, length) = (5, eta.u.len());
        let mut random = || (0..length).map(|_| signed_unit(&mut seed)).collect::<Vec<f64>>();
        let (x, y) = (random(), random());
        let (mut dx, mut dy, mut image) = (vec![0.0; length], vec![0.0; length], vec![0.0; length]);
        self.derivative(&x, &mut dx).expect("a solve");
        self.adjoint(&y, &mut dy).expect("a solve");
        self.gram(&y, &mut image);
        let left = dot(&dx, &image);
        self.gram(&x, &mut image);
        let right = dot(&dy, &image);
        (left - right).abs() / (self.norm(&x) * self.norm(&y))
    }

    fn derivative_error(&mut self, eta: &StepState) -> f64 {
        let found = contraction(self, &eta.u, eta).expect("a factor");
        let finite = finite_factor(self, &eta.u, eta, &found.direction).expect("a solve");
        (finite / found.norm - 1.0).abs()
    }

    /// Ratios of successive errors of the iteration from a start moved in the worst direction, ‖DΛ‖ and radius.
    fn iteration(&mut self, solution: &StepState) -> (Vec<f64>, f64, f64) {
        let found = contraction(self, &solution.u, solution).expect("a factor");
        let size = 1e-3 * self.norm(&solution.u);
        let moved = solution.u.iter().zip(&found.direction);
        let mut eta: Vec<f64> = moved.map(|(u, d)| u + size * d).collect();
        let mut errors = Vec::new();
        for _ in 0..12 {
            self.freeze(Some(&eta));
            let mut state = solution.clone();
            Newton::default().solve(self, &mut state, &mut Scratch::default()).expect("a solve");
            eta.clone_from(&state.u);
            let off: Vec<f64> = eta.iter().zip(&solution.u).map(|(a, b)| a - b).collect();
            errors.push(self.norm(&off));
        }
        (errors.windows(2).map(|pair| pair[1] / pair[0]).collect(), found.norm, found.radius)
    }
}

#[test]
fn the_adjoint_is_the_adjoint() {
    // Rounding of four solves with condition 1e2.
    let off = with_punch(2.0, |level, state| level.adjointness(&state));
    assert!(off < 1e-12, "{off:e}");
}

#[test]
fn the_derivative_agrees_with_differences_where_everything_acts() {
    // Differences of 1e-6 lose six of sixteen digits, times the condition.
    let off = with_punch(2.0, |level, state| level.derivative_error(&state));
    assert!(off < 1e-5, "{off:e}");
}

/// The error of the iteration shrinks by the measured factor where its worst direction is excited: by ‖DΛ‖ at most,
/// and by the spectral radius, 0.5 % below it here, in the long run. Contact and yield do not change within 1e-3.
#[test]
fn the_iteration_obeys_the_factor() {
    let (ratios, norm, radius) = with_punch(4.0, |level, state| level.iteration(&state));
    assert!(radius > 0.3 && radius <= norm && norm < 0.8, "{radius} {norm}");
    for ratio in &ratios {
        assert!(
            *ratio < 1.005 * norm && (ratio / radius - 1.0).abs() < 0.02,
            "{ratios:?} {radius}"
        );
    }
}

/// The largest quotient of a trace mass, by its matrix on an edge of length 1, and the energy of a tensor: as a dense problem.
pub fn dense<const K: usize>(
    space: &fem::contact::Discretization,
    tensor: &TensorField,
    mass: [[f64; K]; K],
) -> f64 {
    let order = space.dofs();
    let values = space.stiffness(tensor);
    let (mut column, mut stiffness) = (vec![0.0; order], DMatrix::zeros(order, order));
    for j in 0..order {
        let unit: Vec<f64> = (0..order).map(|i| f64::from(u8::from(i == j))).collect();
        space.pattern.multiply(&values, &unit, &mut column);
        stiffness.set_column(j, &nalgebra::DVector::from_column_slice(&column));
    }
    let mut matrix = DMatrix::zeros(order, order);
    for (f, length) in space.trace.measure.iter().enumerate() {
        for (&i, row) in space.trace.facet(f).iter().zip(mass) {
            for (&j, value) in space.trace.facet(f).iter().zip(row) {
                let at = [i, j].map(|i| space.trace.points[i as usize].unknown as usize);
                matrix[(at[0], at[1])] += length * value;
            }
        }
    }
    let lower = stiffness.cholesky().expect("positive definite").l();
    let left = lower.solve_lower_triangular(&matrix).expect("a solve");
    let both = lower.solve_lower_triangular(&left.transpose()).expect("a solve");
    both.symmetric_eigen().eigenvalues.max()
}

fn normal_constant(
    space: &fem::contact::Discretization,
    tensor: &TensorField,
    mass: TraceMass,
) -> f64 {
    let [found] = trace_constants(space, tensor, [(TracePart::Normal, mass)]).expect("a constant");
    found.value
}

/// Together with the tangential ones by one factor, each is what it is alone.
#[test]
fn trace_constants_agree_with_a_dense_eigenproblem() {
    let setup = setup("punch");
    let space = setup.space(4).expect("a mesh");
    for tensor in [TensorField::identity(), setup.model.elasticity.clone()] {
        // ∫ of products of linear functions, or a half at either end.
        let exact = [[1.0 / 3.0, 1.0 / 6.0], [1.0 / 6.0, 1.0 / 3.0]];
        let lumped = [[0.5, 0.0], [0.0, 0.5]];
        for (mass, on_edge) in [(TraceMass::Consistent, exact), (TraceMass::Lumped, lumped)] {
            let found = normal_constant(&space, &tensor, mass);
            let exact = dense(&space, &tensor, on_edge);
            assert!((found / exact - 1.0).abs() < 1e-12, "{found} {exact}");
            let squares = [(TracePart::Tangential, mass), (TracePart::Normal, mass)];
            let [tangential, normal] = trace_constants(&space, &tensor, squares).expect("two");
            assert!(normal.value == found && tangential.value > 1.5 * found, "{tangential:?}");
        }
    }
}

/// On the unit square v = (0, 1 - y) has ‖v_ν‖ = ‖ε(v)‖ = 1: the proved bound c_j² ≤ H is attained on every mesh,
/// by either mass; the energy constant lies between 1/(2 μ_L + λ), of the same field, and c_j²/m_𝒜.
#[test]
fn c_j_is_its_proved_bound() {
    let setup = setup("punch");
    let strain = TensorField::identity();
    for n in [3, 8, 16] {
        let space = setup.space(n).expect("a mesh");
        for mass in [TraceMass::Consistent, TraceMass::Lumped] {
            let value = normal_constant(&space, &strain, mass);
            assert!((value - 1.0).abs() < 1e-11, "n = {n}: {value}");
            let energy = normal_constant(&space, &setup.model.elasticity, mass);
            assert!(energy > 1.0 / 3.0 && energy < 0.5, "n = {n}: {energy}");
        }
    }
    let found = constants(&setup).expect("constants");
    assert_eq!(found.c_j_squared_bound, Some(1.0));
}

/// Uniqueness ends at α_ν = 1/energy constant of the vertex rule: there, and only there, the elastic tangent with a
/// falling law on all of Γ3 stops being positive definite.
#[test]
fn a_falling_law_loses_uniqueness_at_the_energy_constant() {
    let space = setup("punch").space(N).expect("a mesh");
    let elastic = setup("punch").model.elasticity;
    let energy = normal_constant(&space, &elastic, TraceMass::Lumped);
    let definite = |share: f64| {
        let alpha = share / energy;
        let law = format!("law = {{ kind = \"linear\", stiffness = -{alpha} }}");
        let scene = edited(&text("linear-punch"), "[contact]\n", &format!("[contact]\n{law}\n"));
        // (2.9) asks α_ν c_j² < m_𝒜 = 2, and 1/energy = 2.7: it is not necessary.
        let scene = edited(&scene, "judge = false\n", "judge = false\nviolates = [\"2.9\"]\n");
        let scene = edited(&scene, "horizon = 1.0", "horizon = 1e-9");
        let setup = setup_of(scene);
        let data = on_mesh(&setup, N);
        match crate::shipped::run(&setup, &setup.model, &data, 1, |_| ()) {
            Ok(_) => true,
            Err(CaseError::Step(step)) => {
                let StepError::Factor { source: FactorError::NotPositiveDefinite { .. }, .. } =
                    step.source
                else {
                    panic!("{step}")
                };
                false
            }
            Err(other) => panic!("{other}"),
        }
    };
    assert!(definite(0.999) && !definite(1.001));
}

/// A level with one part wrong, at the seam between Λ and the study.
struct Wrong<'a, L> {
    sound: &'a mut L,
    derivative: f64,
    step: f64,
}

impl<L: FrozenDerivative> FrozenDerivative for Wrong<'_, L> {
    fn set_step(&mut self, k: f64) {
        self.sound.set_step(self.step * k);
    }
    fn differentiate(&mut self, eta: &[f64], state: &StepState) -> Result<(), FactorError> {
        self.sound.differentiate(eta, state)
    }
    fn derivative(&mut self, x: &[f64], out: &mut [f64]) -> Result<(), FactorError> {
        self.sound.derivative(x, out)?;
        out.iter_mut().for_each(|value| *value *= self.derivative);
        Ok(())
    }
    fn adjoint(&mut self, x: &[f64], out: &mut [f64]) -> Result<(), FactorError> {
        self.sound.adjoint(x, out)?;
        out.iter_mut().for_each(|value| *value *= self.derivative);
        Ok(())
    }
    fn gram(&mut self, x: &[f64], out: &mut [f64]) {
        self.sound.gram(x, out);
    }
}

impl<L: FrozenDerivative> HistoryInequality for Wrong<'_, L> {
    type Error = L::Error;
    fn grid(&self) -> &TimeGrid {
        self.sound.grid()
    }
    fn open(&mut self) -> Result<(), L::Error> {
        self.sound.open()
    }
    fn commit(&mut self, solution: &StepState) {
        self.sound.commit(solution);
    }
}

impl<L: FrozenDerivative> OpenInequality for Wrong<'_, L> {
    fn freeze(&mut self, eta: Option<&[f64]>) {
        self.sound.freeze(eta);
    }

    fn norm(&self, v: &[f64]) -> f64 {
        self.sound.norm(v)
    }
}

impl<L: FrozenDerivative> StepInequality for Wrong<'_, L> {
    as_level!(sound: dofs graph residual linearize solve force_scale);
}

/// What the gate says of memory-minus-identity at k = ½ with bounds and level made wrong.
fn gated(
    bounds: impl Fn(StepBounds) -> StepBounds,
    derivative: f64,
    step: f64,
) -> Vec<&'static str> {
    let setup = setup("memory-minus-identity");
    let data: MeshData = on_mesh(&setup, 4);
    let bounds = bounds(step_bounds(&setup).expect("constants"));
    let rung = at_level(&setup, &data, 4, 2, |level, state| {
        let mut wrong = Wrong { sound: level, derivative, step };
        StepLadder::new(&mut wrong, bounds, state).rung(0.5)
    });
    let rung = rung.unwrap_or_else(|error: StudyError| panic!("{error}"));
    let found = claims(&bounds, &[rung], &Thresholds::default());
    let found = failing(&found);
    assert!(found.iter().all(|claim| ["", "k = 0.5"].contains(&&*claim.place.at)));
    found.into_iter().map(|claim| claim.statement.says).collect()
}

#[test]
fn a_wrong_constant_or_derivative_fails_the_gate() {
    assert_eq!(gated(|b| b, 1.0, 1.0), Vec::<&str>::new());
    let norm = "|DLambda| <= sharpened factor";
    // m0 too large, ‖ℬ(0)‖ too small, the weight of the last slot k instead of k/2.
    assert!(gated(|b| StepBounds { m0: 1.01 * b.m0, ..b }, 1.0, 1.0).contains(&norm));
    assert!(gated(|b| StepBounds { last_slot: 0.9, ..b }, 1.0, 1.0).contains(&norm));
    assert!(gated(|b| b, 1.0, 2.0).contains(&norm));
    // A derivative that is too small passes that bound, and is caught by the finite perturbation.
    let off = "|finite - derivative| <= 2 % of it";
    assert_eq!(gated(|b| b, 0.9, 1.0), [off]);
    // ‖R‖‖q‖ too small.
    let theorem = "sharpened factor <= (3.15)";
    assert!(gated(|b| StepBounds { lipschitz: 0.4, ..b }, 1.0, 1.0).contains(&theorem));
}

/// A derivative that is no number ends in an error, not in a factor.
#[test]
fn a_factor_that_is_not_a_number_is_an_error() {
    let setup = setup("memory-minus-identity");
    let data = on_mesh(&setup, 4);
    let outcome = at_level(&setup, &data, 4, 2, |level, state| {
        let eta = state.u.clone();
        let mut wrong = Wrong { sound: level, derivative: f64::NAN, step: 1.0 };
        Ok(contraction(&mut wrong, &eta, &state).is_err())
    });
    assert!(outcome.unwrap_or_else(|error| panic!("{error}")));
}

#[test]
fn thresholds_out_of_order_fail_the_gate() {
    let bounds = step_bounds(&setup("memory-minus-identity")).expect("constants");
    let at = |k: f64| Some([k, k]);
    let said = |norm: f64, radius: f64| {
        let thresholds = Thresholds { norm: at(norm), radius: at(radius), loss: None };
        failing(&claims(&bounds, &[], &thresholds)).len()
    };
    assert_eq!(said(4.0, 4.0), 0);
    assert_eq!((said(3.9, 4.0), said(4.5, 4.2), said(f64::NAN, 5.0)), (1, 1, 2));
    let wrong = StepBounds { destabilizing: 2.0, ..bounds };
    assert_eq!(failing(&claims(&wrong, &[], &Thresholds::default())).len(), 1);
}
