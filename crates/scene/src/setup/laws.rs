//! The law of a scene for the solver, and its numbers for the manufactured side.

use std::sync::Arc;

use super::formulas::on_contact_in_time;
use exact::{CurveNumbers, LawNumbers};
use fem::contact::{Friction, OnContactInTime};
use formula::Graph;
use vhi::law::{Curved, NoPotential, PiecewiseLinear, Potential};

/// The law of a scene, without its factor. Its points were validated, so the fallback to no law does not occur.
pub(super) fn potential(law: Option<&crate::Law>) -> Arc<dyn Potential> {
    let graph = law.and_then(|law| {
        let points = law.points.iter().map(|&[r, p]| (r, p)).collect();
        let graph = PiecewiseLinear::new(points, law.slope_before, law.slope_after).ok()?;
        Some((graph, law.curve))
    });
    match graph {
        Some((graph, Some(curve))) => Arc::new(Curved::new(graph, curve)),
        Some((graph, None)) => Arc::new(graph),
        None => Arc::new(NoPotential),
    }
}

/// Friction for the solver: S = c(x, t) S_0(|u_τ|) with S_0 = 1 for a given bound, c = 1 for one that depends on the
/// slip; S = c p(u_ν) if it follows the normal law.
pub(super) fn friction(written: &crate::Friction, graph: &Arc<Graph>) -> Friction {
    let unit = vec![[0.0, 1.0]];
    let (factor, points) = match &written.bound {
        crate::FrictionBound::Given(bound) => (on_contact_in_time(graph, Some(*bound)), &unit),
        crate::FrictionBound::Slip(points) => (on_contact_in_time(graph, None), points),
        crate::FrictionBound::Coulomb(coefficient) => {
            let coefficient = *coefficient;
            (Box::new(move |_: [f64; 3], _: f64| coefficient) as OnContactInTime, &unit)
        }
    };
    let backward = points.iter().rev().map(|&[r, s]| (-r, -s));
    let both = backward.chain(points.iter().map(|&[r, s]| (r, s))).collect();
    // Sorted, and upward at 0: the points were validated.
    let potential: Arc<dyn Potential> = match PiecewiseLinear::new(both, 0.0, 0.0) {
        Ok(graph) => Arc::new(graph),
        Err(_) => Arc::new(NoPotential),
    };
    let follows_pressure = matches!(written.bound, crate::FrictionBound::Coulomb(_));
    Friction { factor, graph: potential, follows_pressure }
}

/// The numbers of a scene's law, without its factor.
pub fn law_numbers(law: &crate::Law) -> LawNumbers {
    let curve = law.curve.map(|curve| match curve {
        crate::Curve::Rational { stiffness: c, length } => CurveNumbers::Rational { c, r0: length },
        crate::Curve::Exponential { stiffness: c, length } => {
            CurveNumbers::Exponential { c, r0: length }
        }
        crate::Curve::Power { coefficient: c, exponent: m, until } => {
            CurveNumbers::Power { c, m, r1: until }
        }
    });
    LawNumbers {
        points: law.points.clone(),
        slope_before: law.slope_before,
        slope_after: law.slope_after,
        curve,
    }
}
