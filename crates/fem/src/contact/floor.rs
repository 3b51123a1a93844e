//! The floor of a case: what the unresolved residual of a step and rounding contribute to each error
//! norm. An upper estimate; `sweep check --floors` measures what it stands for.

use super::Discretization;
use super::nodal_norms::{l2_norm, strain_norm, trace_norm};

/// Floors of the error norms.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Floors {
    /// Floor of ‖ε(u - u_h)‖.
    pub v: f64,
    /// Floor of ‖u - u_h‖.
    pub l2: f64,
    /// Floor of ‖σ - σ_h‖.
    pub stress: f64,
    /// Floor of ‖u_ν - u_{h,ν}‖ on Γ3.
    pub trace: f64,
    /// Floor of the pressure on Γ3.
    pub pressure: f64,
}

/// The residual with which a level was accepted, and the tolerance it had to meet (forces).
#[derive(Debug, Clone, Copy)]
pub(super) struct Accepted {
    pub(super) residual: f64,
    pub(super) tolerance: f64,
}

/// One residual is one draw of rounding, and history adds up those of all levels: corrections of
/// single levels, scaled as below, are 0.35 of what `sweep check --floors` measures at worst.
const SAFETY: f64 = 4.0;

impl Accepted {
    /// What the tolerance would have allowed, as a multiple of the residual. A computed residual far
    /// below it is rounding that cancels: the level is known no better than the tolerance says.
    fn scale(self) -> f64 {
        let scale = self.tolerance / self.residual;
        SAFETY * if scale.is_finite() && scale > 1.0 { scale } else { 1.0 }
    }
}

impl Floors {
    /// Floors from the correction `delta` that one more linear solve would make (a nodal vector),
    /// scaled from the residual that was accepted to its tolerance; the solution `u`; the stiffest
    /// modulus `largest`.
    pub(super) fn new(
        space: &Discretization,
        delta: &[f64],
        u: &[f64],
        accepted: Accepted,
        largest: f64,
    ) -> Self {
        let scale = accepted.scale();
        let size = u.iter().fold(0.0f64, |size, value| size.max(value.abs()));
        // Strains are differences of nodal values over the distance of nodes: they round to ε‖u‖/h.
        let rounding =
            f64::EPSILON * size * f64::from(space.mesh.n) * space.element.degree() as f64;
        let v = scale * strain_norm(space, delta) + rounding;
        // Vertices of quadratic elements in space have no weight, and no law: their pressure is that of midpoints.
        let weights = space.trace.points.iter().map(|point| point.weight);
        let lightest = weights.filter(|&weight| weight > 0.0).fold(f64::INFINITY, f64::min);
        Self {
            v,
            l2: scale * l2_norm(space, delta) + f64::EPSILON * size,
            stress: largest * v,
            trace: scale * trace_norm(space, delta) + f64::EPSILON * size,
            pressure: match lightest.is_finite() {
                true => accepted.residual.max(accepted.tolerance) / lightest.sqrt(),
                false => 0.0,
            },
        }
    }
}

impl Floors {
    /// The larger of each; a NaN stays, it says that something could not be measured.
    pub fn max(self, other: Self) -> Self {
        self.with(other, |a, b| if a.is_nan() || a > b { a } else { b })
    }

    /// |a - b| of each.
    pub fn minus(self, other: Self) -> Self {
        self.with(other, |a, b| (a - b).abs())
    }

    /// Each so many times.
    pub fn times(self, factor: f64) -> Self {
        self.with(self, |a, _| factor * a)
    }

    /// a + b of each.
    pub fn plus(self, other: Self) -> Self {
        self.with(other, |a, b| a + b)
    }

    fn with(self, other: Self, f: impl Fn(f64, f64) -> f64) -> Self {
        Self {
            v: f(self.v, other.v),
            l2: f(self.l2, other.l2),
            stress: f(self.stress, other.stress),
            trace: f(self.trace, other.trace),
            pressure: f(self.pressure, other.pressure),
        }
    }
}
