//! The constants of a scene, and what its law declares, (2.8b) and (2.8c), against samples. A sample can refute a constant,
//! not prove it.

use crate::study::Result;
use Obtained::{Computed, Declared, Extrapolated, Proved};
use algebra::linalg::{larger, signed_unit};
use fem::contact::{Discretization, TraceMass, TracePart, weighted_trace_constants};
use files::digits;
use judge::claim::{Claim, Place, Statement};
use scene::setup::{
    AbstractConstants, Constants, Setup, TraceConstant, falling_sides, growth, weight_by_side,
    weighted_trace_constant, with_trace_constants,
};
use scene::{Contact, Side};
use serde::Serialize;
use vhi::finite::FiniteModel;
use vhi::law::{Potential, TensorField};

/// Rounding of a quotient of sums over a small mesh.
const ROUNDING: f64 = 1e-10;
/// Pairs of arguments of a law.
const PAIRS: u32 = 20_000;
/// Relative distance of a close pair: within 2 % of its steepest place a smooth law is as steep to 1e-3.
const CLOSE: f64 = 0.02;
/// Least distance (a length): over less, the rounding of pressures of size 1 counts.
const APART: f64 = 1e-5;

/// The worst need of so many samples is no larger than the declared constant.
pub fn sampled(what: &'static str, declared: f64, needed: f64, samples: u32) -> Claim {
    let statement = Statement { source: what, says: "needed <= declared" };
    let place = Place { at: format!("{samples} samples"), ..Place::default() };
    Claim::at_most(statement, place, [needed, declared], ROUNDING * declared.abs().max(1.0))
}

/// What a scene declares of its law, on samples.
pub fn declared(setup: &Setup, constants: &Constants, space: &Discretization) -> Vec<Claim> {
    let mut rows = Vec::new();
    for (contact, boundary) in setup.body.contact.iter().zip(&setup.model.boundary) {
        let mut of_side = law(&*boundary.potential).to_vec();
        if boundary.scale.is_some() {
            // α_ν of the scene against the descents of the law at the vertices of its sides.
            let vertices = || space.trace.points.iter().filter(|point| boundary.is_on(point.side));
            let needed = vertices().map(|point| {
                let x = space.mesh.point(&[point.vertex], &[1.0]);
                law(&boundary.potential_at(x))[1].left
            });
            let (needed, count) = (needed.fold(0.0, larger), vertices().count() as u32 * PAIRS);
            let of_law = contact.alpha();
            let declared = of_law.min(constants.alpha_nu);
            of_side.push(sampled("(2.8c): alpha_j with the factor", declared, needed, count));
        }
        if setup.model.boundary.len() > 1 {
            let on = on_sides(setup, contact);
            of_side.iter_mut().for_each(|row| row.place.at = format!("{} {on}", row.place.at));
        }
        rows.extend(of_side);
    }
    rows
}

/// The sides of a contact in words.
fn on_sides(setup: &Setup, contact: &Contact) -> String {
    let names: Vec<&str> = contact.sides.iter().map(|&side| setup.body.domain.name(side)).collect();
    format!("on {}", names.join(", "))
}

/// (2.8b) and (2.8c) of a law, pointwise, which gives them on Γ3 by integration. The law is sampled
/// at, between and beyond its points, at all scales; every other pair is close, so that a smooth law shows
/// its slopes.
pub fn law(potential: &dyn Potential) -> [Claim; 2] {
    let mut seed = 41;
    let mut place = || {
        let scale = 10f64.powf(2.0 * signed_unit(&mut seed) - 1.0);
        let offset = potential.jumps().first().copied().unwrap_or(0.0);
        let whole = signed_unit(&mut seed) * scale;
        if whole > 0.5 * scale { offset } else { whole }
    };
    let (c0, c1) = potential.growth();
    let (mut growth, mut descent) = (0f64, 0f64);
    for pair in 0..PAIRS {
        let (r, mut s) = (place(), place());
        let close = r * (1.0 + CLOSE);
        if pair % 2 == 1 && (close - r).abs() > APART {
            s = close;
        }
        let ends = |r: f64| <[f64; 2]>::from(potential.subdifferential(r));
        for xi in ends(r) {
            growth = larger(growth, (xi.abs() - c1 * r.abs()).max(0.0));
            for eta in ends(s) {
                if r != s {
                    descent = larger(descent, -(xi - eta) / (r - s));
                }
            }
        }
    }
    [
        sampled("(2.8b): |dj_nu(r)| - c1 |r| <= c0", c0, growth, PAIRS),
        sampled("(2.8c): alpha_j", potential.alpha(), descent, PAIRS),
    ]
}

// The constants of a scene as a table: name, value, how it was obtained, what it is; and those of one mesh.

/// How a number was obtained.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Obtained {
    /// By an argument on paper.
    Proved,
    /// As a number: of one mesh to rounding, or as the largest of many samples.
    Computed,
    /// As the limit of numbers of several meshes.
    Extrapolated,
    /// By the scene or the law, and checked by samples.
    Declared,
}

/// A constant.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Constant {
    /// Its symbol.
    pub name: String,
    /// Its value.
    pub value: f64,
    /// How far off it may be; none if it is exact to rounding or a bound.
    pub uncertainty: Option<f64>,
    /// How it was obtained.
    pub how: Obtained,
    /// Whether the true constant is certainly on the safe side of it: an upper bound, or for m_A, m0 a
    /// lower one.
    pub safe: bool,
    /// What it is, or the argument.
    pub note: String,
}

impl Obtained {
    /// In a table.
    pub fn words(self) -> &'static str {
        match self {
            Proved => "proved",
            Computed => "computed",
            Extrapolated => "limit of meshes",
            Declared => "declared, checked by samples",
        }
    }
}

/// Constants in the order of a table.
#[derive(Default)]
pub(super) struct Rows(pub Vec<Constant>);

impl Rows {
    /// Adds a constant that is safe where it is proved or declared: what is computed of one mesh or of samples, and limits of
    /// those, may lie on either side.
    fn add(
        &mut self,
        name: impl Into<String>,
        value: f64,
        how: Obtained,
        note: impl Into<String>,
    ) -> &mut Constant {
        let safe = matches!(how, Proved | Declared);
        let (at, name, note) = (self.0.len(), name.into(), note.into());
        self.0.push(Constant { name, value, uncertainty: None, how, safe, note });
        &mut self.0[at]
    }
}

/// A trace constant, and what it is on a mesh.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct OnMesh {
    /// None where it is that of a tensor that varies: meshes for constants do not follow regions.
    pub limit: Option<TraceConstant>,
    /// By the consistent mass, and by the vertex rule.
    pub values: [f64; 2],
}

/// The trace constants of a contact scene.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct TraceConstants {
    /// The mesh.
    pub n: u32,
    /// sup ‖v_ν‖²/‖ε(v)‖².
    pub strain: OnMesh,
    /// sup ‖v_ν‖²/(𝒜ε(v), ε(v)), with the same factors as `falling`.
    energy: OnMesh,
    /// sup Σ (α_i/α_ν) ‖v_ν‖²/‖ε(v)‖² over the contact sides, where their α_i differ.
    pub falling: Option<OnMesh>,
    /// sup ‖v_τ‖²/‖ε(v)‖², where there is friction.
    tangential: Option<OnMesh>,
}

impl TraceConstants {
    /// Those of a scene and a mesh of it; none without contact sides.
    ///
    /// # Errors
    /// A stiffness matrix that cannot be factorized.
    pub(super) fn new(setup: &Setup, space: &Discretization) -> Result<Option<Self>> {
        let domain = &setup.body.domain;
        if domain.contact.is_empty() {
            return Ok(None);
        }
        let weighted = |tensor: &TensorField, part, weights: &[(Side, f64)]| -> Result<OnMesh> {
            let squares = [TraceMass::Consistent, TraceMass::Lumped].map(|mass| (part, mass));
            let weight = weight_by_side(weights);
            let values = match domain.bilateral && part == TracePart::Normal {
                true => [0.0; 2],
                false => weighted_trace_constants(space, tensor, squares, &weight)?
                    .map(|found| found.value),
            };
            let limit = || weighted_trace_constant(domain, tensor, part, weights);
            let limit = tensor.is_uniform().then(limit);
            Ok(OnMesh { limit: limit.transpose()?, values })
        };
        let of = |tensor: &TensorField, part| weighted(tensor, part, &[]);
        let strain = TensorField::identity();
        let tangential = setup.model.friction.as_ref().map(|_| of(&strain, TracePart::Tangential));
        let sides = falling_sides(setup);
        let falling = (!sides.is_empty()).then(|| weighted(&strain, TracePart::Normal, &sides));
        Ok(Some(Self {
            n: space.mesh.n,
            strain: of(&strain, TracePart::Normal)?,
            energy: weighted(&setup.model.elasticity, TracePart::Normal, &sides)?,
            falling: falling.transpose()?,
            tangential: tangential.transpose()?,
        }))
    }

    /// The constants that judge the discrete problem on the mesh: c_j² is the largest of what it may be and the values of
    /// both masses.
    pub(super) fn on_mesh(&self, setup: &Setup) -> Constants {
        let largest = |of: &OnMesh| {
            let most = of.limit.as_ref().map_or(0.0, |limit| limit.range()[1]);
            TraceConstant::exactly(of.values.into_iter().fold(most, f64::max))
        };
        let tangential = self.tangential.as_ref().map_or(TraceConstant::ZERO, largest);
        let normal = largest(&self.strain);
        let falling = self.falling.as_ref().map_or_else(|| normal.clone(), largest);
        with_trace_constants(setup, [&normal, &falling, &tangential])
    }

    fn add_to(&self, rows: &mut Rows, c: &Constants) {
        let korn = "sup |v_tau|^2/|eps(v)|^2: Korn's inequality is in it";
        let tangential = self.tangential.as_ref().map(|of| ("c_tau^2", of, korn));
        let normal = [
            ("c_j^2", &self.strain, "sup |v_nu|^2/|eps(v)|^2"),
            ("energy constant", &self.energy, "sup |v_nu|^2/(A eps(v), eps(v))"),
        ];
        let meaning = "sup sum (alpha_i/alpha_j) |v_nu|^2 over the contact sides / |eps(v)|^2";
        let falling = self.falling.as_ref().map(|of| ("c_nu^2", of, meaning));
        for (symbol, of, meaning) in normal.into_iter().chain(falling).chain(tangential) {
            let [consistent, lumped] = of.values;
            let name = format!("{symbol}, n = {}", self.n);
            rows.add(
                format!("{name}, consistent mass"),
                consistent,
                Computed,
                "not above the limit",
            );
            rows.add(format!("{name}, vertex rule"), lumped, Computed, "no side is sure");
            let Some(limit) = &of.limit else { continue };
            let note = format!("{meaning}, {}", limit.how());
            let row = rows.add(format!("{symbol}, limit"), limit.value, Extrapolated, note);
            row.uncertainty = Some(limit.uncertainty);
        }
        if let Some(bound) = c.c_j_squared_bound {
            rows.add("c_j^2, bound", bound, Proved, "distance of Gamma3 from the clamped side");
        }
        if let (Some(_), Some(bound)) = (&self.falling, c.c_nu_squared_bound) {
            let note = "distance of the side with the falling law from the clamped side";
            rows.add("c_nu^2, bound", bound, Proved, note);
        }
        if let Some(energy) = &self.energy.limit {
            let asked = digits(c.m_elastic / c.c_nu_squared, 7);
            let note = format!(
                "1/energy constant: steeper laws lose uniqueness; (2.9) asks alpha_j < {asked}"
            );
            let row = rows.add("alpha_j lost, k -> 0", 1.0 / energy.value, Extrapolated, note);
            row.uncertainty = Some(energy.uncertainty / (energy.value * energy.value));
        }
    }
}

/// The constants of a scene with how each was obtained, without those of a mesh.
pub fn table_of_body(setup: &Setup, c: &Constants) -> Vec<Constant> {
    table(setup, c, c.m0, None)
}

/// `c` are the constants of the problem, `m0_on_mesh` that of the discrete one.
pub(super) fn table(
    setup: &Setup,
    c: &Constants,
    m0_on_mesh: f64,
    traces: Option<&TraceConstants>,
) -> Vec<Constant> {
    // (2.8b) and (2.8c) hold on all of Γ3 with the largest constants of its laws, a factor c(x) at its largest.
    let [c0, c1] = growth(setup);
    let mut rows = Rows::default();
    let note = "smallest eigenvalue of the elasticity tensor (of all regions) + mu";
    rows.add("m_A", c.m_a, Proved, note);
    let note = "largest eigenvalue of the elasticity tensor (of all regions) + mu";
    rows.add("L_A", c.l_a, Proved, note);
    let limits = "mu + mu_f L_p c_j c_tau, with the limits";
    match c.coulomb {
        None => rows.add("alpha_phi", c.alpha_phi, Proved, "mu: the projection is nonexpansive"),
        Some(_) => rows.add("alpha_phi", c.alpha_phi_as_printed(), Extrapolated, limits),
    };
    let note = "max(mu L_kappa sqrt|Omega|, 1), for |r| + |theta| on Y";
    rows.add("beta_phi", c.beta_phi, Proved, note);
    rows.add("c_phi", 0.0, Proved, "(4.1): phi is linear in its last argument");
    rows.add("sqrt|Omega|", c.root_area, Proved, "");
    rows.add("L_kappa", c.lipschitz_kappa, Proved, setup.kappa.how());
    let note = "|dj_nu(r)| <= c0 + c1 |r|; in (2.8b) it counts c0 sqrt|Gamma3|";
    rows.add("c0", c0, Declared, note);
    let note = "steepest slope of the law at infinity; the same in (2.8b)";
    rows.add("c1", c1, Declared, note);
    let note = "steepest descent of the law (2.8c), with the largest factor on Gamma3";
    rows.add("alpha_j", c.alpha_nu, Declared, note);
    if setup.body.contact.len() > 1 {
        for contact in &setup.body.contact {
            let name = format!("alpha_j {}", on_sides(setup, contact));
            rows.add(name, contact.alpha(), Declared, "steepest descent of the law there");
        }
    }
    if setup.model.friction.is_some() {
        let note = "steepest descent of the friction bound over the slip";
        rows.add("alpha_tau", c.alpha_tau, Declared, note);
    }
    if let Some(friction) = &c.coulomb {
        rows.add("mu_f", friction.coefficient, Declared, "S = mu_f p(u_nu)");
        rows.add("L_p", friction.rise, Declared, "steepest rise of p");
    }
    traces.inspect(|traces| traces.add_to(&mut rows, c));
    // m0 of (2.9).
    let other = c.alpha_tau > 0.0 || c.coulomb.is_some();
    let monotone = c.alpha_nu == 0.0 && !other;
    let several = traces.is_some_and(|traces| traces.falling.is_some());
    let note = match setup.model.friction {
        None if several => "m_A - alpha_phi - alpha_j c_nu^2 (2.9): all contact sides together",
        None => "m_A - alpha_phi - alpha_j c_j^2 (2.9)",
        Some(_) if c.coulomb.is_some() => "m_A - mu - A c_j^2 - B c_tau^2 (docs/CONTACT-LAWS.md)",
        Some(_) => "m_A - alpha_phi - alpha_j c_j^2 - alpha_tau c_tau^2",
    };
    let off = c.m0_range.map(|end| (end - c.m0).abs()).into_iter().reduce(f64::max);
    let m0 = rows.add("m0", c.m0, if monotone { Proved } else { Extrapolated }, note);
    m0.uncertainty = off.filter(|_| !monotone);
    if let Some(bound) = c.c_nu_squared_bound.filter(|_| c.alpha_nu > 0.0 && !other) {
        let value = c.m_elastic - c.alpha_nu * bound;
        let note = match several {
            true => "with the proved bound of c_nu^2",
            false => "with the proved bound of c_j^2",
        };
        rows.add("m0, proved", value, Proved, note);
    }
    if let Some(TraceConstants { n, .. }) = traces {
        let note = "the same with the largest c_j^2 and c_tau^2 of this table, for the bounds on this mesh";
        rows.add(format!("m0, n = {n}"), m0_on_mesh, Extrapolated, note);
    }
    let [operator, entries] = [c.memory.operator, c.memory.entries];
    rows.add("|B|", operator, Proved, "largest operator norm on S^d on [0, T]");
    rows.add("|B|_Q", entries, Proved, "the paper's norm: sum of |entries|");
    rows.add("|B(0)|", c.memory.at_zero, Proved, "operator norm on S^d");
    let least = c.memory.spectrum_at_zero.0;
    rows.add("lambda_min B(0)", least, Proved, "smallest eigenvalue on S^d");
    rows.add("|R||q|", 1.0 + operator, Proved, "Lipschitz constant of S: 1 + |B|");
    rows.add("|R||q|_Q", 1.0 + entries, Proved, "the same with the paper's norm");
    rows.0
}

/// The constants of an abstract problem with how each was obtained.
pub fn table_of_finite(c: &AbstractConstants, model: &FiniteModel) -> Vec<Constant> {
    // Eigenvalues are exact to rounding; norms and slopes are bounds where they hold for all arguments.
    let everywhere = c.slopes_up_to == f64::INFINITY;
    let slopes = match everywhere {
        true => "; slopes for all arguments".into(),
        false => format!("; slopes for |r|, |y| <= {}", c.slopes_up_to),
    };
    let (bent, forced) = (!model.nonlinear.is_empty(), !model.force.is_empty());
    let mut rows = Rows::default();
    for (name, value, by_slopes, note) in [
        ("m_A", c.m_a, bent, "smallest eigenvalue of the symmetric part in X"),
        ("L_A", c.l_a, bent, "norm X -> X*"),
        ("alpha_phi", c.alpha_phi, forced, "slopes of N in u"),
        ("beta_phi", c.beta_phi, forced, "slopes of N in y"),
        ("alpha_j", c.alpha_j, false, "steepest descent of the laws (2.8c)"),
        ("c_j^2", c.c_j_squared, false, "largest eigenvalue of sum w_i a_i a_i^T in X"),
        ("m0", c.m0, bent || forced, "m_A - alpha_phi - alpha_j c_j^2 (2.9)"),
        ("|R|", c.r_norm, false, "norm on X*"),
    ] {
        let (how, by) = if by_slopes { (Proved, &*slopes) } else { (Computed, "") };
        rows.add(name, value, how, format!("{note}{by}")).safe = !by_slopes || everywhere;
    }
    rows.add("|q|", c.plain.all, Proved, "largest norm X -> X* over 0 <= s <= t <= T");
    rows.add("|q(t,t)|", c.plain.now, Proved, "the same over s = t");
    if c.nested.all > 0.0 {
        let note = "max |q| max |r| of histories of histories, X -> X*: S has |R|(|q| + T |q||r|)";
        rows.add("|q||r|", c.nested.all, Proved, note);
        rows.add("|q(t,t) r(t,t)|", c.nested.now, Proved, "beside the last weight w_nn^2");
    }
    rows.0
}
