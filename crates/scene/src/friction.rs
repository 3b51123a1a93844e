//! `[contact.friction]`: -σ_τ ∈ S ∂|u_τ| on Γ3, with a bound S that is given as S(x, t), depends on the slip, or
//! follows the normal law.

use exact::FrictionBound;
use fem::contact::BoundaryRule as ContactQuadrature;
use fem::mesh::Face;
use formula::{EvaluationPoint, Node};

use super::domain::{Domain, SAME_NORMAL, place};
use super::gap::{TIMES, on_contact};
use super::law::Law;
use super::reading::{Reading, join};
use super::source::Result;
use super::time::Time;

/// Kinds of a bound with their keys.
const BOUNDS: [(&str, &str); 2] = [("slip", "points"), ("coulomb", "coefficient")];

/// Friction on Γ3.
#[derive(Debug, Clone, PartialEq)]
pub struct Friction {
    pub bound: FrictionBound,
}

impl Friction {
    pub(super) fn validate(
        reading: &mut Reading,
        key: &str,
        domain: &Domain,
        time: &Time,
        normal: (Option<&Law>, ContactQuadrature),
    ) -> Result<Self> {
        one_tangent_a_vertex(reading, key, domain)?;
        let key = &join(key, "bound");
        let bound = match reading.has_parts(key) {
            false => {
                let scope = reading.space_and_time(domain.dimension());
                let node = reading.formula(key, &scope)?;
                let fits = |bound: f64| bound.is_finite() && bound >= 0.0;
                let hint = "the bound of the friction stress must be finite and not negative on every contact side and on [0, T]";
                on_contact(reading, (key, node), domain, (time.horizon, TIMES), fits, hint)?;
                FrictionBound::Given(node)
            }
            true => match reading.kind(key, &BOUNDS)? {
                "coulomb" => FrictionBound::Coulomb(coulomb(reading, key, normal)?),
                _ => {
                    let key = &join(key, "points");
                    let points = reading.points(key)?;
                    for (index, &[r, bound]) in points.iter().enumerate() {
                        let here = format!("{key}.{index}");
                        let message =
                            format!("the bound is {bound} at r = {r}: it must not be negative");
                        reading.refuse_if(bound < 0.0, &here, message, "give S >= 0")?;
                        let fits = match index.checked_sub(1) {
                            None => r == 0.0,
                            Some(before) => r > points[before][0],
                        };
                        let message =
                            format!("the slip {r}: points start at r = 0, and r increases");
                        let hint = "a jump of S would violate relaxed monotonicity (2.8c) on one side of r = 0: replace it by a steep slope";
                        reading.refuse_if(!fits, &here, message, hint)?;
                    }
                    FrictionBound::Slip(points)
                }
            },
        };
        Ok(Self { bound })
    }

    /// α_τ ≥ 0 (a stiffness), the steepest descent of S: r ↦ S(|r|) sign r satisfies (2.8c) with it, since its jump at
    /// 0 goes up.
    pub fn alpha(&self) -> f64 {
        self.graph_and_factor().0.alpha()
    }

    /// For the solver: r ↦ S_0(|r|) sign r as a law, S_0 = 1 where the bound does not depend on the slip, and the formula of
    /// c(x, t) where S = c S_0.
    pub(crate) fn graph_and_factor(&self) -> (Law, Option<Node>) {
        let (points, factor): (&[[f64; 2]], _) = match &self.bound {
            FrictionBound::Given(bound) => (&[[0.0, 1.0]], Some(*bound)),
            FrictionBound::Slip(points) => (points, None),
            FrictionBound::Coulomb(_) => (&[[0.0, 1.0]], None),
        };
        let backward = points.iter().rev().map(|&[r, s]| [-r, -s]);
        (Law::graph(backward.chain(points.iter().copied()).collect(), 0.0, 0.0), factor)
    }
}

/// μ_f > 0, with a single-valued, nonnegative law of bounded rise, at the vertices.
fn coulomb(
    reading: &mut Reading,
    bound: &str,
    (law, quadrature): (Option<&Law>, ContactQuadrature),
) -> Result<f64> {
    let key = &join(bound, "coefficient");
    let scope = reading.scope(&[]);
    let node = reading.formula(key, &scope)?;
    let coefficient = reading.formulas.evaluate(node, &EvaluationPoint::default());
    let message = format!("`coefficient` = {coefficient} is not positive and finite");
    let fits = coefficient > 0.0 && coefficient.is_finite();
    reading.refuse_if(!fits, key, message, "give a number above 0")?;
    let key = &join(bound, "kind");
    let Some(law) = law else {
        let hint = "add law = { kind = \"linear\", stiffness = 2.0 } or another law to [contact], or give the bound";
        return Err(reading.error(key, "the bound mu p(u_nu) without a normal law p", hint));
    };
    let negative = law.points.iter().any(|point| point[1] < 0.0);
    let refused = [
        (
            law.is_set_valued(),
            "the bound mu p(u_nu) and a law p with a jump: p is no number there",
            "replace the jump of the normal law by a steep slope",
        ),
        (
            law.curve.is_some(),
            "the bound mu p(u_nu) and a curved law p: (2.9) takes its steepest rise from lines",
            "take a law by lines: kind = \"linear\" or \"piecewise-linear\"",
        ),
        (
            negative || law.slope_before > 0.0 || law.slope_after < 0.0,
            "the bound mu p(u_nu) is negative for some u_nu",
            "let every point have p >= 0, with slope_before <= 0 and slope_after >= 0",
        ),
        (
            quadrature != ContactQuadrature::Vertex,
            "the bound mu p(u_nu) takes p from the vertices",
            "use quadrature = \"vertex\"",
        ),
    ];
    refused
        .iter()
        .try_for_each(|&(fault, what, hint)| reading.refuse_if(fault, key, what, hint))?;
    Ok(coefficient)
}

/// u_τ takes the unknowns left by u_ν: a vertex between two contact sides has too few, unless it is clamped. In space
/// such sides meet along an edge.
fn one_tangent_a_vertex(reading: &Reading, key: &str, domain: &Domain) -> Result<()> {
    let of = |sides: &[super::Side]| -> Vec<Face> {
        sides.iter().flat_map(|side| domain.faces(*side)).collect()
    };
    let d = domain.dimension();
    let [contact, clamped, symmetry] =
        [&domain.contact, &domain.clamped, &domain.symmetry].map(|sides| of(sides));
    for (i, face) in contact.iter().enumerate() {
        for p in face.corners() {
            let bends = |other: &Face| {
                let (a, b) = (face.normal, other.normal);
                let turn = [(0, 1), (1, 2), (2, 0)].map(|(i, j)| a[i] * b[j] - a[j] * b[i]);
                turn.iter().any(|component| component.abs() > SAME_NORMAL) && other.has_corner(p)
            };
            let held = || d == 2 && clamped.iter().any(|other| other.has_corner(p));
            let leans = |plane: &Face| {
                let along: f64 = (0..3).map(|k| plane.normal[k] * face.normal[k]).sum();
                along.abs() > SAME_NORMAL && plane.has_corner(p)
            };
            let at = || place(&p.into(), d);
            let (message, hint) = if symmetry.iter().any(leans) {
                (
                    format!(
                        "a contact side with friction and a plane of symmetry meet at {} at another angle than a right one: u_tau has no unknown of its own there",
                        at()
                    ),
                    "turn the plane of symmetry, put another side between them, or remove [contact.friction]",
                )
            } else if contact[..i].iter().any(bends) && !held() {
                (
                    format!(
                        "two contact sides with friction meet at {}: both displacements of that vertex carry a normal condition",
                        at()
                    ),
                    "put a traction or clamped side between contact sides, or remove [contact.friction]",
                )
            } else {
                continue;
            };
            return Err(reading.key_error(key, message, hint));
        }
    }
    Ok(())
}
