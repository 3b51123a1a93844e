//! The law of a scene for the solver, and its numbers for the manufactured side.

use std::sync::Arc;

use exact::{CurveNumbers, LawNumbers};
use vhi::law::{Curve, Curved, NoPotential, PiecewiseLinear, Potential};

/// The law of a scene, without its factor; its points were validated, so a refusal here cannot happen
/// and would mean no law.
pub(super) fn potential(law: Option<&crate::Law>) -> Arc<dyn Potential> {
    let graph = law.and_then(|law| {
        let points = law.points.iter().map(|&[r, p]| (r, p)).collect();
        let graph = PiecewiseLinear::new(points, law.slope_before, law.slope_after).ok()?;
        Some((graph, law.curve))
    });
    match graph {
        Some((graph, Some(curve))) => Arc::new(Curved::new(graph, solver_curve(curve))),
        Some((graph, None)) => Arc::new(graph),
        None => Arc::new(NoPotential),
    }
}

fn solver_curve(curve: crate::Curve) -> Curve {
    match curve {
        crate::Curve::Rational { stiffness, length } => Curve::Rational { stiffness, length },
        crate::Curve::Exponential { stiffness, length } => Curve::Exponential { stiffness, length },
        crate::Curve::Power { coefficient, exponent, until } => {
            Curve::Power { coefficient, exponent, until }
        }
    }
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
