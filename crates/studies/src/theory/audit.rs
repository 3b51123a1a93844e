//! Inequalities of the proofs of Theorems 10 and 11 at every t_n of real runs, on the numbers of the solver and of the
//! truth: u^{kh}, its history and pressures and the forces that they leave; ε(u), σ, ξ + λ and F of the exact side.
//!
//! v^h is the nodal interpolant of u. ε(u) and σ enter by their L² projections onto the strains of V^h, which test functions
//! see: what they leave out adds as much to the left of (4.9) as to its right, and no more to the left of (4.7), (4.14) and
//! (4.17) than to the right. What the scheme's rule on Γ3 and its load add to (4.9) is a term of its own there, E_q.

use std::sync::Arc;

use super::norms::remembered;
use crate::study::{Asked, Result, StudyError};
use algebra::tensor::{Symmetric, contract};
use exact::{Exact, ExactOnMesh, InterpolatedOnMesh, LoadForm, Truth};
use fem::contact::{
    BoundaryRule, CaseError, Discretization, Histories, LoadError, StepView, out_of_balance,
    strain_norm,
};
use fem::norms::{Moments, state_rule, step_errors, strain_error};
use fem::space::Element;
use fem::space::quadrature::TruthRules;
use formula::{BoundProgram, Program};
use judge::claim::{Claim, Place, Standing, Statement};
use rayon::prelude::*;
use report::{Chapter, Findings, digits};
use run::sweep::{Runs, admit_constants, run_cost};
use scene::setup::{MeshData, Setup, SetupError, constants, growth};
use scene::{Extension, Scene, SceneError, TimeRule};
use serde::Serialize;
use serde_json::json;
use vhi::history::TimeGrid;
use vhi::law::{Potential, Projection};
use vhi::monotonicity;

/// Largest n taken from a scene's list.
const FINEST: u32 = 64;

/// `sweep audit`.
///
/// # Errors
/// [`StudyError`].
pub fn of_scene(scene: Scene, asked: &Asked) -> Result<Findings> {
    admit_constants(&scene, true, &asked.limit)?;
    let setup = Setup::new(scene)?;
    let (ns, steps) = asked.grid(&setup.scene, FINEST)?;
    // `jobs` of a mesh at a time.
    let grid = ns.iter().flat_map(|&n| steps.iter().map(move |&steps| (n, steps))).collect();
    let others = steps.len().min(asked.jobs).saturating_sub(1) as f64;
    // The scene's own, and that of the memory alone.
    let truths = if setup.model.memory.is_empty() { 1.0 } else { 2.0 };
    let beside = |space: &Discretization, steps: u32| {
        // The others march as well, with fewer steps or as many; beside each stands what the rule remembers of u and u^{kh}, and
        // once what the truths keep: points, and moments of all levels.
        let run = run_cost(&setup, space, steps);
        let strains = 3.0 * space.geometry.points() as f64;
        let moments = 2.0 * strains + 2.0 * space.nodes.cells.len() as f64;
        others * run.march_bytes
            + (1.0 + others) * (1.0 + strains / space.dofs() as f64) * run.history_bytes
            + truths * (run.load_bytes + 8.0 * moments * (f64::from(steps) + 1.0))
    };
    Runs { setup: &setup, grid, beside: Box::new(beside) }.admit(&asked.limit)?;
    audit(&setup, &ns, &steps)
}

// The constants that the bounds take, with whether each is a proved upper bound.

/// Constants of the proofs of Theorems 10 and 11 for one scene.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct AuditConstants {
    /// m_A of (4.7) (a stress).
    #[serde(rename = "m_A")]
    pub m_a: f64,
    /// L_A of (4.17).
    #[serde(rename = "L_A")]
    pub l_a: f64,
    /// α_φ and β_φ of (4.14).
    pub alpha_phi: f64,
    /// β_φ.
    pub beta_phi: f64,
    /// α_j of (4.16) (a stiffness).
    pub alpha_j: f64,
    /// c_j², bounding ‖v_ν‖² by c_j²‖v‖_V² (a length).
    pub c_j_squared: f64,
    /// c_ν² of (2.9) with laws of several sides, c_j² where there is one (a length).
    pub c_nu_squared: f64,
    /// Whether c_j² is a proved bound.
    pub c_j_source: &'static str,
    /// c0 of (4.16): c̄0 √|Γ3|.
    pub c0: f64,
    /// c1 of (4.16).
    pub c1: f64,
    /// ‖R‖‖q‖ of (4.20) as the Lipschitz constant of S: 1 for ζ (where it matters) plus ‖ℬ‖.
    pub history: f64,
}

impl AuditConstants {
    /// The constants of a scene.
    ///
    /// # Errors
    /// As [`constants`].
    pub fn new(setup: &Setup) -> Result<Self, SetupError> {
        let known = constants(setup)?;
        let ([c0, c1], domain) = (growth(setup), &setup.body.domain);
        let faces = domain.contact.iter().flat_map(|side| domain.faces(*side));
        let length: f64 = faces.map(|face| face.measure()).sum();
        Ok(Self {
            m_a: known.m_a,
            l_a: known.l_a,
            alpha_phi: known.alpha_phi,
            beta_phi: known.beta_phi,
            alpha_j: known.alpha_nu,
            c_j_squared: known.c_j_squared_bound.unwrap_or(known.c_j_squared),
            c_nu_squared: known.c_nu_squared_bound.unwrap_or(known.c_nu_squared),
            c_j_source: match known.c_j_squared_bound {
                Some(_) => "proved upper bound",
                None => "extrapolated from meshes, no upper bound",
            },
            c0: c0 * length.sqrt(),
            c1,
            history: 1.0 + known.memory.operator,
        })
    }

    /// m0 of (2.9).
    pub fn m0(&self) -> f64 {
        monotonicity(self.m_a, self.alpha_phi + self.alpha_j * self.c_nu_squared)
    }
}

// The inequalities at one level, both sides as numbers.

/// Rounding of a sum, relative to the sum of its absolute terms: up to 10⁶ terms round to 1e-13 of it
/// at worst, and the solver's residual, 16 units of rounding of its forces, is of that size too.
const ROUNDING: f64 = 1e-12;
/// Where v^h - u is rounding itself (u affine in space), its powers are rounding of ‖σ‖‖ε‖: the residual with which a level
/// is accepted, 3.6e-15 of its forces, and some ten times that in strains of meshes of 8 cells a side.
const NATURAL: f64 = 4e-14;

/// In the order of their numbers.
const STATEMENTS: [Statement; 9] = [
    Statement { source: "(2.9)", says: "|u_nu - u_h,nu|^2 <= c_j^2 e^2" },
    Statement { source: "(4.7)", says: "m_A e^2 <= <Au - Au_h, u - u_h>" },
    Statement {
        source: "(4.9)",
        says: "<Au - Au_h, u - u_h> <= E_phi1 + E_phi2 + E_j + E_A + E_n + E_q",
    },
    Statement { source: "(4.14)", says: "E_phi1 <= alpha_phi e^2 + beta_phi Y e" },
    Statement {
        source: "(4.16)",
        says: "E_j <= (2 c0 + c1 |u_nu| + c1 |u_h,nu|) delta + alpha_j |u_nu - u_h,nu|^2",
    },
    Statement { source: "(4.17)", says: "E_A <= L_A e d" },
    Statement { source: "(4.19)", says: "Y <= g_n + |R||q| k sum_j e_j" },
    Statement {
        source: "(4.20)",
        says: "e <= C (d + sqrt(delta) + sqrt(|E_n| + |E_q|)) + C (g_n + |R||q| k sum_j e_j), constants written out",
    },
    Statement { source: "(5.23)", says: "|E_n| <= (|xi + lambda| + c0 + c1 |u_nu|) delta" },
];

/// Sees the levels of a run.
pub struct Auditor<'a> {
    setup: &'a Setup,
    data: &'a MeshData,
    constants: &'a AuditConstants,
    grid: TimeGrid,
    exact: Arc<Exact>,
    /// u at the nodes.
    nodal: BoundProgram,
    /// Where the truth is that interpolant: its own ζ and nodal pressures.
    interpolated: Option<InterpolatedOnMesh>,
    /// The truth of a body that only remembers: its σ is θ. None without memory.
    remembering: Option<Arc<dyn Truth>>,
    /// Of u, by its strains; of u^{kh}, by its nodal values.
    past: [Histories<'a>; 2],
    /// Σ_{j ≤ n} ‖u_j - u_j^{kh}‖_V.
    errors: f64,
    /// With what a unit of the floor in V may add to each.
    claims: Vec<(Claim, f64)>,
}

/// Integrals over Ω at one level, in the notation of section 4 of the paper.
#[derive(Default)]
struct Volume {
    /// ‖u - u^{kh}‖_V² and ‖u - v^h‖_V² of the projected strains.
    e: f64,
    d: f64,
    /// ⟨Au - Au^{kh}, u - u^{kh}⟩.
    monotone: f64,
    phi1: f64,
    phi2: f64,
    operator: f64,
    /// (σ^{kh} - σ, ε(v^h - u^{kh})).
    tested: f64,
    /// Parts of ‖S_n u - S_n^{kh} u^{kh}‖_Y² and ‖S_n u - S_n^k u‖_Y² that the memory has.
    history: f64,
    truncation: f64,
    /// ‖σ‖².
    stress: f64,
}

/// Integrals over Γ3 at one level.
#[derive(Default)]
struct OnContact {
    /// ‖u_ν - v^h_ν‖² and ‖u_ν - u^{kh}_ν‖².
    delta: f64,
    trace: f64,
    /// ‖u_ν - s‖² and ‖u^{kh}_ν - s‖².
    arguments: [f64; 2],
    /// ‖ξ + λ‖².
    pressure: f64,
    /// E_j of (4.12) and the form of E_n of (4.5) on Γ3: since λ(u_ν - g) = 0, ∫ j_ν⁰(u_ν; v^h_ν - u_ν) - (ξ + λ)(v^h_ν - u_ν).
    e_j: f64,
    e_n: f64,
    /// ∫ j_ν⁰(u^{kh}_ν; v^h_ν - u^{kh}_ν) - (ξ + λ)(v^h_ν - u^{kh}_ν).
    at_h: f64,
    /// ∫ λ(u^{kh}_ν - g)₊ of elements that pass the gap between nodes: a part of E_q.
    outside: f64,
}

impl<'a> Auditor<'a> {
    /// An auditor of a run of `setup` on the mesh of `data`, n cells per unit length, with the given number of steps.
    ///
    /// # Errors
    /// The scene has no exact solution.
    pub fn new(
        setup: &'a Setup,
        data: &'a MeshData,
        steps: u32,
        constants: &'a AuditConstants,
    ) -> Result<Self, SceneError> {
        let message = "the scene has no exact solution, and every line of the proof needs u";
        let missing = || setup.scene.error("exact", message, "choose a scene with [exact]");
        let exact = setup.exact.clone().ok_or_else(missing)?;
        let (space, rule, grid) = (&data.space, setup.compliance_rule(), setup.grid(steps));
        let in_space = setup.body.data.is_interpolated();
        let remembering = (!setup.model.memory.is_empty()).then(|| {
            let mut data = exact.data.clone();
            data.kappa = None;
            let regions = data.regions.iter_mut().map(|region| &mut region.material);
            for material in std::iter::once(&mut data.material).chain(regions) {
                (material.lambda, material.mu_l) = (0.0, 0.0);
                (material.full, material.projection) = (None, None);
            }
            let exact = Arc::new(Exact::new(data));
            let truth: Arc<dyn Truth> = if in_space {
                Arc::new(InterpolatedOnMesh::new(exact, space.clone(), rule))
            } else {
                let rules = TruthRules::for_element(space.element, space.mesh.dimension);
                Arc::new(ExactOnMesh::new(exact, space.clone(), LoadForm::Weak, &[], &rules))
            };
            truth
        });
        let nodes: Vec<[f64; 3]> =
            space.nodes.vertex.iter().map(|&v| space.mesh.point(&[v], &[1.0])).collect();
        let past = [3 * space.geometry.points(), space.nodes.len()].map(|length| {
            Histories::new(&setup.model.memory, &*setup.model.time_rule, &grid, length)
        });
        Ok(Self {
            nodal: Program::compile(&exact.data.graph, &exact.data.u, exact.data.horizon)
                .bind(&nodes),
            interpolated: in_space
                .then(|| InterpolatedOnMesh::new(exact.clone(), space.clone(), rule)),
            errors: 0.0,
            claims: Vec::new(),
            setup,
            data,
            constants,
            grid,
            exact,
            remembering,
            past,
        })
    }

    /// Computes the sides at the level that `view` shows; levels come in order.
    ///
    /// # Errors
    /// The truth's.
    pub fn observe(&mut self, view: &StepView<'_>) -> Result<(), LoadError> {
        let (space, model, c, t) = (&*self.data.space, &self.setup.model, self.constants, view.t);
        let (truth, load) = (self.data.truth.moments(t)?, self.data.truth.load(t)?);
        let mut v = vec![0.0; space.nodes.len()];
        for (i, values) in self.nodal.values_at(t, 0.0).iter().enumerate() {
            v.iter_mut().skip(i).step_by(2).zip(values).for_each(|(v, value)| *v = *value);
        }
        v[space.dofs()..].fill(0.0);
        let size = strain_error(space, &vec![0.0; v.len()], &truth);
        let [of_u, of_u_h] = &mut self.past;
        let at = (&self.grid, view.n);
        let (by_rule, zeta_by_rule) = of_u.level(at, &truth.strain.at, size);
        let (history, zeta_h) = of_u_h.level(at, view.u, strain_norm(space, view.u));
        let limit = model.projection.limit();
        let kappa = limit.map_or(f64::INFINITY, |limit| limit.value(zeta_h));
        let shown = StepView { history: &history, zeta: zeta_h, kappa, ..*view };
        // ζ counts where κ follows it.
        let zeta = match (&self.interpolated, limit.and(self.exact.data.kappa)) {
            (_, None) => None,
            (Some(truth), _) => Some(truth.zeta(t)?),
            (None, _) => Some(self.exact.zeta.at(t)).filter(|zeta| !zeta.is_nan()),
        };
        let theta = self.remembering.as_ref().map(|truth| truth.moments(t)).transpose()?;
        let volume = self.volume(&shown, &v, &truth, theta.as_deref(), &by_rule);
        let [history, truncation] = [(volume.history, zeta_h), (volume.truncation, zeta_by_rule)]
            .map(|(square, of_rule)| {
                square.sqrt() + zeta.map_or(0.0, |zeta| (zeta - of_rule).abs())
            });
        let contact = self.on_contact(&shown, &v)?;
        let of_scheme = self.balance(&shown, &v, &load) - volume.tested - contact.at_h;
        let e_q = of_scheme + contact.outside;
        let errors = step_errors(space, model, &shown, &truth);
        self.errors += errors.v;
        let (e, d) = (errors.v, (volume.d + truth.strain.rest).sqrt());
        let (e_h, d_h, delta) = (volume.e.sqrt(), volume.d.sqrt(), contact.delta.sqrt());
        let terms = [volume.phi1, volume.phi2, contact.e_j, volume.operator, contact.e_n, e_q];
        let [u, u_h] = contact.arguments.map(f64::sqrt);
        let growth = 2.0 * c.c0 + c.c1 * (u + u_h);
        let pressures = contact.pressure.sqrt() + c.c0 + c.c1 * u;
        let remembered = truncation + c.history * self.grid.largest_step() * self.errors;
        let bound = c.bound([d, delta], growth, remembered, contact.e_n.abs() + e_q.abs());
        // The terms of nearly incompressible stresses are larger than their sum.
        let stress = volume.stress.sqrt().max(c.l_a * size);
        let square = c.c_j_squared * size.powi(2);
        let energy = stress * size;
        // Left, right, what their terms have in all beside them, and the size of what rounds in them.
        let sides = [
            [errors.trace.powi(2), c.c_j_squared * e * e, 0.0, square],
            [c.m_a * volume.e, volume.monotone, 0.0, energy],
            [
                volume.monotone,
                terms.iter().sum(),
                terms.iter().map(|term| term.abs()).sum::<f64>() + stress * (e_h + d_h),
                energy,
            ],
            [volume.phi1, (c.alpha_phi * e + c.beta_phi * history) * e_h, stress * e_h, energy],
            [contact.e_j, growth * delta + c.alpha_j * contact.trace, 0.0, energy],
            [volume.operator, c.l_a * e_h * d_h, 0.0, energy],
            [history, remembered, 0.0, c.history * size * t],
            [e, bound, 0.0, size],
            [contact.e_n.abs(), pressures * delta, 0.0, energy],
        ];
        let (n, steps) = (Some(space.mesh.n), Some(self.grid.steps() as u32));
        for (statement, [left, right, others, natural]) in STATEMENTS.into_iter().zip(sides) {
            let place = Place { n, steps, level: Some(view.n), at: String::new() };
            let sum = left.abs() + others + if right.is_finite() { right.abs() } else { 0.0 };
            let accuracy = ROUNDING * sum + NATURAL * natural;
            let claim = Claim::at_most(statement, place, [left, right], accuracy);
            self.claims.push((claim, if size > 0.0 { natural / size } else { 0.0 }));
        }
        Ok(())
    }

    /// The claims at all levels seen; `floor` is that of the run in V, by which u^{kh} may be off.
    pub fn claims(self, floor: f64) -> Vec<Claim> {
        let within = |(claim, natural): (Claim, f64)| {
            let accuracy = claim.accuracy + natural * floor;
            Claim { accuracy, ..claim }
        };
        self.claims.into_iter().map(within).collect()
    }

    /// `theta` has θ as its σ, `by_rule` what the rule remembers of ε(u).
    fn volume(
        &self,
        shown: &StepView<'_>,
        v: &[f64],
        truth: &Moments,
        theta: Option<&Moments>,
        by_rule: &[Vec<f64>],
    ) -> Volume {
        let (space, model) = (&*self.data.space, &self.setup.model);
        let (mu, terms) = (self.setup.projection_mu(), &model.memory[..]);
        let mut sums = Volume::default();
        for at in space.points() {
            let elastic = model.elasticity.on(space.region(at.cell));
            let here = |field: &'_ [f64]| -> [f64; 3] { field.as_chunks::<3>().0[at.index] };
            let (strain, stress) = (here(&truth.strain.at), here(&truth.stress.at));
            let (strain_h, strain_v) = (at.strain::<3>(shown.u), at.strain::<3>(v));
            let stress_h = shown.stress_of(space, model, &at, &strain_h);
            let (to_h, to_v) = (minus(&strain_h, &strain), minus(&strain_v, &strain));
            let moved = elastic.apply(&to_h);
            let moved: [f64; 3] = std::array::from_fn(|i| moved[i] + mu * to_h[i]);
            // σ = Aε + ψ.
            let apart = minus(&stress, &stress_h);
            let psi: [f64; 3] = std::array::from_fn(|i| apart[i] + moved[i]);
            let off = |strain: &dyn Fn(usize) -> Symmetric<3>| {
                theta.map_or(0.0, |theta| {
                    let by = remembered(space, terms, &at, strain);
                    let off = minus(&here(&theta.stress.at), &by);
                    contract(&off, &off)
                })
            };
            sums.e += at.weight * contract(&to_h, &to_h);
            sums.d += at.weight * contract(&to_v, &to_v);
            sums.monotone += at.weight * contract(&moved, &to_h);
            sums.phi1 += at.weight * contract(&psi, &to_h);
            sums.phi2 -= at.weight * contract(&psi, &to_v);
            sums.operator += at.weight * contract(&moved, &to_v);
            sums.tested -= at.weight * contract(&apart, &minus(&strain_v, &strain_h));
            sums.history += at.weight * off(&|i| at.strain(&shown.history[i]));
            sums.truncation += at.weight * off(&|i| here(&by_rule[i]));
            sums.stress += at.weight * contract(&stress, &stress);
        }
        sums
    }

    /// At the points of the truth, or, where it is an interpolant, at the nodes, at which its pressures are.
    fn on_contact(&self, shown: &StepView<'_>, v: &[f64]) -> Result<OnContact, LoadError> {
        let (space, model) = (&*self.data.space, &self.setup.model);
        let (mesh, trace, t) = (&space.mesh, &space.trace, shown.t);
        let mut sums = OnContact::default();
        let mut add = |weight: f64, side: u32, x: [f64; 3], [u, u_h, v, pressure]: [f64; 4]| {
            let Some(boundary) = model.boundary_on(side) else { return };
            let (potential, s) = (boundary.potential_at(x), (boundary.shift)(x));
            let j = |at: f64, w: f64| directional(&potential, at, s, w);
            sums.delta += weight * (u - v).powi(2);
            sums.trace += weight * (u - u_h).powi(2);
            sums.arguments[0] += weight * (u - s).powi(2);
            sums.arguments[1] += weight * (u_h - s).powi(2);
            sums.pressure += weight * pressure.powi(2);
            sums.e_j += weight * (j(u, u_h - u) + j(u_h, v - u_h) - j(u, v - u));
            sums.e_n += weight * (j(u, v - u) - pressure * (v - u));
            sums.at_h += weight * (j(u_h, v - u_h) - pressure * (v - u_h));
            if space.element != Element::P1 {
                sums.outside += weight * (pressure * (u_h - u) - j(u, u_h - u)).max(0.0);
            }
        };
        if model.boundary.is_empty() {
            return Ok(sums);
        }
        if let Some(truth) = &self.interpolated {
            for (i, (point, pressure)) in trace.points.iter().zip(truth.pressures(t)).enumerate() {
                let [u, u_h] = [v, shown.u].map(|nodal| trace.normal(i, nodal));
                let x = mesh.point(&[point.vertex], &[1.0]);
                add(point.weight, point.side, x, [u, u_h, u, pressure]);
            }
            return Ok(sums);
        }
        let Some(exact) = self.data.truth.contact_samples(t)? else { return Ok(sums) };
        let rule = state_rule();
        let shapes = rule.points.iter().map(|b| space.element.values(b));
        let shapes: Vec<Vec<f64>> = shapes.collect();
        for (f, measure) in trace.measure.iter().enumerate() {
            let corners = mesh.facet(trace.mesh_facet[f] as usize);
            for (q, (b, shape)) in rule.points.iter().zip(&shapes).enumerate() {
                let value = |nodal: &[f64]| -> f64 {
                    let members = trace.facet(f).iter().zip(shape);
                    members.map(|(&i, shape)| shape * trace.normal(i as usize, nodal)).sum()
                };
                let at = f * shapes.len() + q;
                let values = [exact.normal[at], value(shown.u), value(v), exact.pressure[at]];
                add(measure * rule.weights[q], space.side(f), mesh.point(corners, b), values);
            }
        }
        Ok(sums)
    }

    /// (σ^{kh}, ε(w)) + j⁰(u^{kh}; w) - F(w) for w = v^h - u^{kh}, by stresses, rule and load of the scheme: (4.3) says that it
    /// is not negative.
    fn balance(&self, shown: &StepView<'_>, v: &[f64], load: &[f64]) -> f64 {
        let (space, model) = (&*self.data.space, &self.setup.model);
        let (mut compliance, free) = (shown.compliance.to_vec(), vec![0.0; shown.multiplier.len()]);
        for (i, point) in space.trace.points.iter().enumerate() {
            let boundary = model.boundary_on(point.side);
            let Some(boundary) = boundary.filter(|b| b.rule == BoundaryRule::Vertex) else {
                continue;
            };
            let x = space.mesh.point(&[point.vertex], &[1.0]);
            let [u_h, v] = [shown.u, v].map(|nodal| space.trace.normal(i, nodal));
            let (s, sign) = ((boundary.shift)(x), if v < u_h { -1.0 } else { 1.0 });
            compliance[i] = sign * directional(&boundary.potential_at(x), u_h, s, sign);
        }
        let view = StepView { compliance: &compliance, multiplier: &free, ..*shown };
        let balance = out_of_balance(space, model, &view, load);
        balance.iter().zip(v.iter().zip(shown.u)).map(|(b, (v, u_h))| b * (v - u_h)).sum()
    }
}

impl AuditConstants {
    /// (4.18) solved for e = ‖u - u^{kh}‖: m0 e² ≤ b e + c gives e ≤ b/m0 + √(c/m0), where
    /// b = β_φ Y + (α_φ + L_A) d and c = β_φ Y d + C_j δ + |E_n|, and √(β_φ Y d/m0) ≤ (β_φ Y/m0 + d)/2.
    /// Infinite where m0 ≤ 0: then the proof says nothing.
    fn bound(&self, [d, delta]: [f64; 2], growth: f64, history: f64, residual: f64) -> f64 {
        let m0 = self.m0();
        if m0 <= 0.0 {
            return f64::INFINITY;
        }
        let space = ((self.alpha_phi + self.l_a) / m0 + 0.5) * d;
        let traces = (growth * delta / m0).sqrt();
        space + traces + (residual / m0).sqrt() + 1.5 * self.beta_phi * history / m0
    }
}

/// j_ν⁰(u - s; w), the larger of ξ w: at a jump to rounding of u and s any of its values.
fn directional(potential: &dyn Potential, u: f64, s: f64, w: f64) -> f64 {
    let (r, by) = (u - s, ROUNDING * (u.abs() + s.abs()));
    let ((low, _), (_, high)) =
        (potential.subdifferential(r - by), potential.subdifferential(r + by));
    let here = potential.subdifferential(r);
    [low, high, here.0, here.1].into_iter().fold(f64::NEG_INFINITY, |most, xi| most.max(xi * w))
}

fn minus(a: &Symmetric<3>, b: &Symmetric<3>) -> Symmetric<3> {
    std::array::from_fn(|i| a[i] - b[i])
}

// A scene audited: for each inequality and run the level where it comes nearest to failing.

/// The inequalities of a run of `setup` by its scheme, each at its worst level.
///
/// # Errors
/// [`StudyError`].
pub fn audit_case(
    setup: &Setup,
    data: &MeshData,
    steps: u32,
    constants: &AuditConstants,
) -> Result<Vec<Claim>> {
    let mut auditor = Auditor::new(setup, data, steps, constants)?;
    let n = data.space.mesh.n;
    let run = setup
        .scheme
        .march(setup, data, steps, &mut |view| auditor.observe(view).map_err(CaseError::from));
    let info = run.map_err(|source| StudyError::at(format!("n = {n}, N = {steps}"), source))?;
    let claims = auditor.claims(info.floors.v);
    Ok(Claim::worst(&claims).into_iter().map(|(worst, _)| worst.clone()).collect())
}

/// Audits the runs of `setup` on the meshes `ns` with the numbers of steps `steps`, by the boundary rule of the model.
///
/// # Errors
/// [`StudyError`]: no exact solution, a run without result.
pub fn audit(setup: &Setup, ns: &[u32], steps: &[u32]) -> Result<Findings> {
    // What the inequalities leave out of account.
    let scene = &setup.scene;
    let others = [
        (Extension::Friction, "its lines are those of the normal law alone"),
        (Extension::SingularKernel, "its sums are those of kernels with a value at s = t"),
    ];
    for (extension, why) in others {
        scene.without(&[extension], "sweep audit", why)?;
    }
    let message =
        "`sweep audit` knows the sums of the trapezoidal rule alone, which is that of the theorems";
    let other = scene.time.rule != TimeRule::Trapezoid;
    scene.refuse_if(other, "time.rule", message, "remove `rule`")?;
    audit_under(setup, &AuditConstants::new(setup)?, ns, steps)
}

/// [`audit`] under these constants.
///
/// # Errors
/// As [`audit`].
pub fn audit_under(
    setup: &Setup,
    constants: &AuditConstants,
    ns: &[u32],
    steps: &[u32],
) -> Result<Findings> {
    let message = "the integrals of the audit over Γ3 are those of edges";
    let in_space = setup.scene.dimension != 2;
    setup.scene.refuse_if(in_space, "scene.dimension", message, "choose a plane scene")?;
    let mut claims = Vec::new();
    for &n in ns {
        let data = MeshData::new(setup, n, None)?;
        let run = |&steps: &u32| audit_case(setup, &data, steps, constants);
        let cases = steps.par_iter().map(run).collect::<Result<Vec<_>>>()?;
        claims.extend(cases.into_iter().flatten());
    }
    let m0 = constants.m0();
    if m0 <= 0.0 {
        let undefined = |claim: &&mut Claim| claim.standing() == Standing::Unresolved;
        for claim in claims.iter_mut().filter(undefined) {
            claim.note = format!("m0 = {} is not positive, (2.9) is violated", digits(m0, 5));
        }
    }
    let unconstrained = !setup.body.has_gap();
    let theorem = if unconstrained { "Theorems 10 and 11 (K = X)" } else { "Theorem 10" };
    // The rule's word in scene files.
    let rule = format!("{:?}", setup.rule()).to_lowercase();
    let scene = &setup.scene;
    let title = (Chapter::Audit, format!("Checklist: {}", scene.name));
    let mut findings = Findings::new(title, Some([&scene.name, &scene.source.hash]), claims);
    findings.document.words(format!("{theorem}; boundary rule {rule}."));
    let mut constants = json!(constants);
    constants["m0"] = m0.into();
    let named = constants.as_object().into_iter().flatten();
    let rows = named.map(|(name, value)| json!({ "name": name, "value": value })).collect();
    findings.document.rows("Constants of the bounds.", &rows, "constant = name; >value = value 7");
    findings.numbers(json!({ "theorem": theorem, "rule": rule, "constants": constants }));
    Ok(findings)
}
