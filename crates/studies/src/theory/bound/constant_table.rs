//! The constants as a table: name, value, how it was obtained, what it is.

use serde::Serialize;

use super::constants::TraceConstants;
use Obtained::{Computed, Declared, Extrapolated, Proved};
use files::digits;
use scene::setup::{Constants, MemoryNorms, Setup};
use vhi::law::Potential;

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

impl Obtained {
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Proved => "proved",
            Self::Computed => "computed",
            Self::Extrapolated => "extrapolated",
            Self::Declared => "declared",
        }
    }
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

impl Constant {
    /// A constant that is safe where it is proved or declared: what is computed of one mesh or of samples, and limits of
    /// those, may lie on either side.
    pub(super) fn new(
        name: impl Into<String>,
        value: f64,
        how: Obtained,
        note: impl Into<String>,
    ) -> Self {
        let safe = matches!(how, Obtained::Proved | Obtained::Declared);
        Self { name: name.into(), value, uncertainty: None, how, safe, note: note.into() }
    }
}

/// `constants` are those of the problem, `m0_on_mesh` that of the discrete one.
pub(crate) fn table(
    setup: &Setup,
    constants: &Constants,
    m0_on_mesh: f64,
    traces: Option<&TraceConstants>,
) -> Vec<Constant> {
    let mut rows = operator_rows(setup, constants);
    rows.extend(law_rows(setup));
    rows.extend(friction_rows(setup, constants));
    rows.extend(traces.map(|traces| trace_rows(constants, traces)).unwrap_or_default());
    rows.extend(smallness_rows(setup, constants));
    if let Some(TraceConstants { n, .. }) = traces {
        let note = "the same with the largest c_j^2 and c_tau^2 of this table, for the bounds on this mesh";
        rows.push(Constant::new(format!("m0, n = {n}"), m0_on_mesh, Extrapolated, note));
    }
    rows.extend(memory_rows(&constants.memory));
    rows
}

/// A and φ.
fn operator_rows(setup: &Setup, c: &Constants) -> Vec<Constant> {
    let row = |name, value, note: &str| Constant::new(name, value, Proved, note);
    let alpha_phi = match c.coulomb {
        None => row("alpha_phi", c.alpha_phi, "mu: the projection is nonexpansive"),
        Some(_) => {
            let note = "mu + mu_f L_p c_j c_tau, with the limits";
            Constant::new("alpha_phi", c.alpha_phi_as_printed(), Extrapolated, note)
        }
    };
    vec![
        row("m_A", c.m_a, "smallest eigenvalue of the elasticity tensor (of all regions) + mu"),
        row("L_A", c.l_a, "largest eigenvalue of the elasticity tensor (of all regions) + mu"),
        alpha_phi,
        row("beta_phi", c.beta_phi, "max(mu L_kappa sqrt|Omega|, 1), for |r| + |theta| on Y"),
        row("c_phi", 0.0, "(4.1): phi is linear in its last argument"),
        row("sqrt|Omega|", c.root_area, ""),
        row("L_kappa", c.lipschitz_kappa, &setup.kappa.how()),
    ]
}

fn friction_rows(setup: &Setup, c: &Constants) -> Vec<Constant> {
    let row = |name, value, note: &str| Constant::new(name, value, Declared, note);
    let mut rows = Vec::new();
    if setup.model.friction.is_some() {
        let note = "steepest descent of the friction bound over the slip";
        rows.push(row("alpha_tau", c.alpha_tau, note));
    }
    if let Some(friction) = &c.coulomb {
        rows.push(row("mu_f", friction.coefficient, "S = mu_f p(u_nu)"));
        rows.push(row("L_p", friction.rise, "steepest rise of p"));
    }
    rows
}

/// m0 of (2.9).
fn smallness_rows(setup: &Setup, c: &Constants) -> Vec<Constant> {
    let monotone = c.alpha_nu == 0.0 && c.alpha_tau == 0.0 && c.coulomb.is_none();
    let how = if monotone { Proved } else { Extrapolated };
    let note = match setup.model.friction {
        None => "m_A - alpha_phi - alpha_j c_j^2 (2.9)",
        Some(_) if c.coulomb.is_some() => "m_A - mu - A c_j^2 - B c_tau^2 (docs/CONTACT-LAWS.md)",
        Some(_) => "m_A - alpha_phi - alpha_j c_j^2 - alpha_tau c_tau^2",
    };
    let uncertainty = c.m0_range.map(|end| (end - c.m0).abs()).into_iter().reduce(f64::max);
    let uncertainty = uncertainty.filter(|_| !monotone);
    let mut rows = vec![Constant { uncertainty, ..Constant::new("m0", c.m0, how, note) }];
    let normal_alone = c.alpha_nu > 0.0 && c.alpha_tau == 0.0 && c.coulomb.is_none();
    if let Some(bound) = c.c_j_squared_bound.filter(|_| normal_alone) {
        let value = c.m_elastic - c.alpha_nu * bound;
        rows.push(Constant::new("m0, proved", value, Proved, "with the proved bound of c_j^2"));
    }
    rows
}

fn memory_rows(memory: &MemoryNorms) -> Vec<Constant> {
    let [operator, entries] = [memory.operator, memory.entries];
    [
        ("|B|", operator, Proved, "largest operator norm on S^d on [0, T]"),
        ("|B|_Q", entries, Proved, "the paper's norm: sum of |entries|"),
        ("|B(0)|", memory.at_zero, Proved, "operator norm on S^d"),
        ("lambda_min B(0)", memory.spectrum_at_zero.0, Proved, "smallest eigenvalue on S^d"),
        ("|R||q|", 1.0 + operator, Proved, "Lipschitz constant of S: 1 + |B|"),
        ("|R||q|_Q", 1.0 + entries, Proved, "the same with the paper's norm"),
    ]
    .map(|(name, value, how, note)| Constant::new(name, value, how, note))
    .into()
}

fn law_rows(setup: &Setup) -> Vec<Constant> {
    let potential = setup.model.boundary.as_ref().map(|boundary| &*boundary.potential);
    let (c0, c1) = potential.map_or((0.0, 0.0), Potential::growth);
    let alpha = potential.map_or(0.0, Potential::alpha);
    // A law with a factor c(x): (2.8b) and (2.8c) hold on all of Γ3 with the largest c.
    let law = setup.body.contact.as_ref().and_then(|contact| contact.law.as_ref());
    let largest = law.and_then(|law| law.scale).map_or(1.0, |scale| scale.largest);
    [
        ("c0", c0, "|dj_nu(r)| <= c0 + c1 |r|; in (2.8b) it counts c0 sqrt|Gamma3|"),
        ("c1", c1, "steepest slope of the law at infinity; the same in (2.8b)"),
        ("alpha_j", alpha, "steepest descent of the law (2.8c), with the largest factor on Gamma3"),
    ]
    .map(|(name, value, note)| Constant::new(name, largest * value, Declared, note))
    .into()
}

/// The quadratures of Γ3 that trace constants are computed with.
const MASSES: [&str; 2] = ["consistent mass", "vertex rule"];

fn trace_rows(constants: &Constants, traces: &TraceConstants) -> Vec<Constant> {
    let mut rows = Vec::new();
    let korn = "sup |v_tau|^2/|eps(v)|^2: Korn's inequality is in it";
    let tangential = traces.tangential.as_ref().map(|of| ("c_tau^2", of, korn));
    let normal = [
        ("c_j^2", &traces.strain, "sup |v_nu|^2/|eps(v)|^2"),
        ("energy constant", &traces.energy, "sup |v_nu|^2/(A eps(v), eps(v))"),
    ];
    for (symbol, of, meaning) in normal.into_iter().chain(tangential) {
        for (value, mass) in of.values.into_iter().zip(MASSES) {
            let note = if mass == MASSES[0] { "not above the limit" } else { "no side is sure" };
            let name = format!("{symbol}, n = {}, {mass}", traces.n);
            rows.push(Constant::new(name, value, Computed, note));
        }
        rows.extend(of.limit.as_ref().map(|limit| {
            let note = format!("{meaning}, {}", limit.how());
            let row = Constant::new(format!("{symbol}, limit"), limit.value, Extrapolated, note);
            Constant { uncertainty: Some(limit.uncertainty), ..row }
        }));
    }
    if let Some(bound) = constants.c_j_squared_bound {
        let note = "distance of Gamma3 from the clamped side";
        rows.push(Constant::new("c_j^2, bound", bound, Proved, note));
        let (m, note) = (constants.m_elastic, "bound of c_j^2 over the elastic part of m_A");
        rows.push(Constant::new("energy constant, bound", bound / m, Proved, note));
    }
    rows.extend(lost_rows(constants, traces));
    rows
}

/// The α_j beyond which uniqueness is lost: 1/energy constant.
fn lost_rows(constants: &Constants, traces: &TraceConstants) -> Vec<Constant> {
    let of_mesh = traces.energy.values.into_iter().zip(MASSES).map(|(value, mass)| {
        let name = format!("alpha_j lost, n = {}, {mass}", traces.n);
        Constant::new(name, 1.0 / value, Computed, "1/energy constant of the mesh")
    });
    let limit = traces.energy.limit.as_ref().map(|energy| {
        let note = format!(
            "1/energy constant: steeper laws lose uniqueness; (2.9) asks alpha_j < {}",
            digits(constants.m_elastic / constants.c_j_squared, 7)
        );
        let limit = Constant::new("alpha_j lost, k -> 0", 1.0 / energy.value, Extrapolated, note);
        let uncertainty = Some(energy.uncertainty / (energy.value * energy.value));
        Constant { uncertainty, ..limit }
    });
    of_mesh.chain(limit).collect()
}
