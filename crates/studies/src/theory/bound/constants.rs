//! Every constant of sections 2 to 5 for a contact scene, with how it was obtained.

use serde::Serialize;

use super::ladder::BoundError;
use fem::contact::{Discretization, TraceMass, tangential_trace_constant, trace_constant};
use scene::setup::{
    Constants, Setup, TraceFamily, tangential_trace_family, trace_family, with_trace_constant,
};
use vhi::law::{Potential, TensorField};

/// How a number was obtained.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Provenance {
    /// By an argument on paper.
    Proved,
    /// As a number: of one mesh to rounding, or as the largest of many samples.
    Computed,
    /// As the limit of numbers of several meshes.
    Extrapolated,
    /// By the scene or the law, and checked by samples.
    Declared,
}

impl Provenance {
    /// The word for tables.
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
    pub how: Provenance,
    /// Whether the true constant is certainly on the safe side of it: an upper bound, or for m_A, m0 a
    /// lower one.
    pub safe: bool,
    /// What it is, or the argument.
    pub note: String,
}

/// Trace constants of a scene.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct TraceConstants {
    /// sup ‖v_ν‖²/‖ε(v)‖² with the consistent mass, and with the vertex rule's.
    pub strain: [TraceFamily; 2],
    /// sup ‖v_ν‖²/(𝒜ε(v), ε(v)), the same.
    pub energy: [TraceFamily; 2],
    /// sup ‖v_τ‖²/‖ε(v)‖², the same, where there is friction.
    pub tangential: Option<[TraceFamily; 2]>,
}

/// The meshes on which trace constants are computed.
const LEVELS: [u32; 6] = [8, 16, 32, 64, 128, 256];
/// More cells than this none of them has: the finest of a unit square eightfold.
const MOST_CELLS: f64 = 1_048_576.0;
/// Meshes in space, up to 15,000 unknowns.
const LEVELS_IN_SPACE: [u32; 4] = [2, 4, 8, 16];

impl TraceConstants {
    /// The families of a scene; none without contact sides.
    ///
    /// # Errors
    /// A stiffness matrix that cannot be factorized.
    pub(crate) fn new(setup: &Setup) -> Result<Option<Self>, BoundError> {
        if setup.body.domain.contact.is_empty() {
            return Ok(None);
        }
        let levels = Self::meshes(setup);
        let strain = TensorField::identity();
        let elastic = &setup.model.elasticity;
        // Coarse meshes may not follow the boundaries of regions.
        let follow: Vec<u32> =
            levels.iter().copied().filter(|&n| setup.check_regions(n).is_ok()).collect();
        Ok(Some(Self {
            strain: both_masses(setup, &strain, &levels)?,
            energy: both_masses(setup, elastic, &follow)?,
            tangential: setup
                .model
                .friction
                .as_ref()
                .map(|_| tangential(setup, &levels))
                .transpose()?,
        }))
    }

    /// The meshes of the families, n of each; none without contact sides.
    pub(crate) fn meshes(setup: &Setup) -> Vec<u32> {
        let levels = match (setup.body.domain.contact.is_empty(), setup.scene.dimension) {
            (true, _) => &[],
            (_, 2) => &LEVELS[..],
            _ => &LEVELS_IN_SPACE,
        };
        let whole = levels.iter().copied().filter(|&n| setup.scene.check_cells(n).is_ok());
        // The coarsest is there in any case: whether it fits into memory is another question.
        let fits = |&(i, n): &(usize, u32)| i == 0 || setup.body.domain.cells(n) <= MOST_CELLS;
        whole.enumerate().filter(fits).map(|(_, n)| n).collect()
    }

    /// The limit of a pair of families, and how far they and their own extrapolations lie apart.
    pub(crate) fn limit(pair: &[TraceFamily; 2]) -> (f64, f64) {
        let apart = (pair[0].limit - pair[1].limit).abs();
        let own = pair[0].uncertainty.max(pair[1].uncertainty);
        (pair[0].limit, apart.max(own))
    }
}

fn both_masses(
    setup: &Setup,
    tensor: &TensorField,
    levels: &[u32],
) -> Result<[TraceFamily; 2], BoundError> {
    let family = |mass| trace_family(setup, tensor, mass, levels);
    Ok([family(TraceMass::Consistent)?, family(TraceMass::Lumped)?])
}

fn tangential(setup: &Setup, levels: &[u32]) -> Result<[TraceFamily; 2], BoundError> {
    let family = |mass| tangential_trace_family(setup, mass, levels);
    Ok([family(TraceMass::Consistent)?, family(TraceMass::Lumped)?])
}

/// The constants that judge the discrete problem on the mesh of `space`: c_j² is the largest of the
/// extrapolated limit with its uncertainty and the values of both masses on this mesh.
///
/// # Errors
/// A stiffness matrix that cannot be factorized.
pub(crate) fn on_mesh(
    setup: &Setup,
    traces: Option<&TraceConstants>,
    space: &Discretization,
) -> Result<Constants, BoundError> {
    let Some(traces) = traces else { return Ok(with_trace_constant(setup, 0.0)) };
    let (limit, uncertainty) = TraceConstants::limit(&traces.strain);
    let strain = TensorField::identity();
    let consistent = trace_constant(space, &strain, TraceMass::Consistent)?.value;
    let lumped = trace_constant(space, &strain, TraceMass::Lumped)?.value;
    let above = |(limit, uncertainty): (f64, f64)| {
        limit + if uncertainty.is_nan() { 0.0 } else { uncertainty }
    };
    let own = above((limit, uncertainty)).max(consistent).max(lumped);
    let found = with_trace_constant(setup, own);
    let Some(tangential) = &traces.tangential else { return Ok(found) };
    let consistent = tangential_trace_constant(space, TraceMass::Consistent)?.value;
    let lumped = tangential_trace_constant(space, TraceMass::Lumped)?.value;
    let own = above(TraceConstants::limit(tangential)).max(consistent).max(lumped);
    Ok(found.with_friction(own))
}

/// The table of constants.
pub(crate) fn table(
    setup: &Setup,
    constants: &Constants,
    traces: Option<&TraceConstants>,
) -> Vec<Constant> {
    let proved = |name: &str, value: f64, note: &str| Constant {
        name: name.into(),
        value,
        uncertainty: None,
        how: Provenance::Proved,
        safe: true,
        note: note.into(),
    };
    let sampled = |name: &str, value: f64, note: &str| Constant {
        how: Provenance::Computed,
        safe: false,
        ..proved(name, value, note)
    };
    let c = constants;
    let mut rows = vec![
        proved("m_A", c.m_a, "smallest eigenvalue of the elasticity tensor (of all regions) + mu"),
        proved("L_A", c.l_a, "largest eigenvalue of the elasticity tensor (of all regions) + mu"),
        match c.coulomb {
            None => proved("alpha_phi", c.alpha_phi, "mu: the projection is nonexpansive"),
            Some(_) => Constant {
                how: Provenance::Extrapolated,
                safe: false,
                ..proved(
                    "alpha_phi",
                    c.alpha_phi_as_printed(),
                    "mu + mu_f L_p c_j c_tau, with the largest c_j and c_tau of this table",
                )
            },
        },
        proved("beta_phi", c.beta_phi, "max(mu L_kappa sqrt|Omega|, 1), for |r| + |theta| on Y"),
        proved("c_phi", 0.0, "(4.1): phi is linear in its last argument"),
        proved("sqrt|Omega|", c.root_area, ""),
        sampled("L_kappa", c.lipschitz_kappa, "largest sampled |kappa'| on [0, 100 T]"),
    ];
    rows.extend(law_rows(setup));
    if setup.model.friction.is_some() {
        let note = "steepest descent of the friction bound over the slip";
        rows.push(Constant { how: Provenance::Declared, ..proved("alpha_tau", c.alpha_tau, note) });
    }
    if let Some(own) = &c.coulomb {
        let declared = |row: Constant| Constant { how: Provenance::Declared, ..row };
        rows.push(declared(proved("mu_f", own.coefficient, "S = mu_f p(u_nu)")));
        let note = "steepest rise of p";
        rows.push(declared(proved("L_p", own.rise, note)));
    }
    if let Some(traces) = traces {
        rows.extend(trace_rows(c, traces));
    }
    let monotone = c.alpha_nu == 0.0 && c.alpha_tau == 0.0 && c.coulomb.is_none();
    let how = if monotone { Provenance::Proved } else { Provenance::Extrapolated };
    rows.push(Constant {
        name: "m0".into(),
        value: c.m0,
        uncertainty: None,
        how,
        safe: monotone,
        note: match setup.model.friction {
            None => "m_A - alpha_phi - alpha_j c_j^2 (2.9), with the largest c_j^2 of this table".into(),
            Some(_) if c.coulomb.is_some() => "m_A - mu - A c_j^2 - B c_tau^2 (docs/CONTACT-LAWS.md), with the largest of this table".into(),
            Some(_) => "m_A - alpha_phi - alpha_j c_j^2 - alpha_tau c_tau^2, with the largest of this table".into(),
        },
    });
    let normal_alone = c.alpha_nu > 0.0 && c.alpha_tau == 0.0 && c.coulomb.is_none();
    if let Some(bound) = c.c_j_squared_bound.filter(|_| normal_alone) {
        let value = c.m_elastic - c.alpha_nu * bound;
        rows.push(proved("m0, proved", value, "with the proved bound of c_j^2"));
    }
    let memory = &c.memory;
    rows.extend([
        sampled("|B|", memory.operator, "largest operator norm on S^d over 513 times of [0, T]"),
        sampled("|B|_Q", memory.entries, "the paper's norm: sum of |entries|, over the same times"),
        proved("|B(0)|", memory.at_zero, "operator norm on S^d"),
        proved("lambda_min B(0)", memory.spectrum_at_zero.0, "smallest eigenvalue on S^d"),
        sampled("|R||q|", 1.0 + memory.operator, "Lipschitz constant of S: 1 + |B|"),
        sampled("|R||q|_Q", 1.0 + memory.entries, "the same with the paper's norm"),
    ]);
    rows
}

fn law_rows(setup: &Setup) -> Vec<Constant> {
    let potential = setup.model.boundary.as_ref().map(|boundary| &*boundary.potential);
    let (c0, c1) = potential.map_or((0.0, 0.0), Potential::growth);
    let alpha = potential.map_or(0.0, Potential::alpha);
    // A law with a factor c(x): (2.8b) and (2.8c) hold on all of Γ3 with the largest c.
    let law = setup.body.contact.as_ref().and_then(|contact| contact.law.as_ref());
    let largest = law.and_then(|law| law.scale).map_or(1.0, |scale| scale.largest);
    let [c0, c1, alpha] = [c0, c1, alpha].map(|constant| largest * constant);
    let row = |name: &str, value: f64, note: &str| Constant {
        name: name.into(),
        value,
        uncertainty: None,
        how: Provenance::Declared,
        safe: true,
        note: note.into(),
    };
    vec![
        row("c0", c0, "|dj_nu(r)| <= c0 + c1 |r|; in (2.8b) it counts c0 sqrt|Gamma3|"),
        row("c1", c1, "steepest slope of the law at infinity; the same in (2.8b)"),
        row(
            "alpha_j",
            alpha,
            "steepest descent of the law (2.8c), with the largest factor on Gamma3",
        ),
    ]
}

fn trace_rows(constants: &Constants, traces: &TraceConstants) -> Vec<Constant> {
    let mut rows = Vec::new();
    let names = ["consistent mass", "vertex rule"];
    let tangential = traces.tangential.as_ref().map(|pair| ("c_tau^2", pair));
    let normal = [("c_j^2", &traces.strain), ("energy constant", &traces.energy)];
    for (symbol, pair) in normal.into_iter().chain(tangential) {
        for (family, mass) in pair.iter().zip(names) {
            let note = if mass == names[0] { "not above the limit" } else { "no side is sure" };
            rows.extend(family.values.iter().map(|(n, value)| Constant {
                name: format!("{symbol}, n = {n}, {mass}"),
                value: *value,
                uncertainty: None,
                how: Provenance::Computed,
                safe: false,
                note: note.into(),
            }));
        }
        let (value, uncertainty) = TraceConstants::limit(pair);
        rows.push(Constant {
            name: format!("{symbol}, limit"),
            value,
            uncertainty: Some(uncertainty),
            how: Provenance::Extrapolated,
            safe: false,
            note: match symbol {
                "c_j^2" => "sup |v_nu|^2/|eps(v)|^2".into(),
                "c_tau^2" => "sup |v_tau|^2/|eps(v)|^2: Korn's inequality is in it".into(),
                _ => "sup |v_nu|^2/(A eps(v), eps(v))".into(),
            },
        });
    }
    if let Some(bound) = constants.c_j_squared_bound {
        let proved = |name: &str, value: f64, note: &str| Constant {
            name: name.into(),
            value,
            uncertainty: None,
            how: Provenance::Proved,
            safe: true,
            note: note.into(),
        };
        rows.push(proved("c_j^2, bound", bound, "distance of Gamma3 from the clamped side"));
        let (m, note) = (constants.m_elastic, "bound of c_j^2 over the elastic part of m_A");
        rows.push(proved("energy constant, bound", bound / m, note));
    }
    for (family, mass) in traces.energy.iter().zip(names) {
        if let Some((n, value)) = family.values.last() {
            rows.push(Constant {
                name: format!("alpha_j lost, n = {n}, {mass}"),
                value: 1.0 / value,
                uncertainty: None,
                how: Provenance::Computed,
                safe: false,
                note: "1/energy constant of the mesh".into(),
            });
        }
    }
    let (energy, uncertainty) = TraceConstants::limit(&traces.energy);
    let (strain, _) = TraceConstants::limit(&traces.strain);
    rows.push(Constant {
        name: "alpha_j lost, k -> 0".into(),
        value: 1.0 / energy,
        uncertainty: Some(uncertainty / (energy * energy)),
        how: Provenance::Extrapolated,
        safe: false,
        note: format!(
            "1/energy constant: steeper laws lose uniqueness; (2.9) asks alpha_j < {:.6}",
            constants.m_elastic / strain
        ),
    });
    rows
}
