//! The floor of a case: what the unresolved residual of a step and rounding contribute to each error
//! norm. An upper estimate; `sweep floors` measures what it stands for.

use super::{Discretization, Model, StepView, linear::strain_norm};
use vhi::law::Projection;

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
/// single levels, scaled as below, are 0.35 of what `sweep floors` measures at worst.
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

/// What a solution of one time level is measured by.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct LevelFields {
    /// u_n as a nodal vector.
    pub u: Vec<f64>,
    /// σ_n at the strain points, the numbers of each one after another (Mandel).
    pub stress: Vec<f64>,
    /// ξ_n + λ_n at the points of the trace.
    pub pressure: Vec<f64>,
}

fn stresses<P: Projection, const S: usize>(
    space: &Discretization,
    model: &Model<P>,
    view: &StepView<'_>,
) -> Vec<f64> {
    space.points().flat_map(|at| view.stress_at::<P, S>(space, model, &at)).collect()
}

impl LevelFields {
    /// The fields that `view` shows.
    pub fn of<P: Projection>(
        space: &Discretization,
        model: &Model<P>,
        view: &StepView<'_>,
    ) -> Self {
        let sum = view.compliance.iter().zip(view.multiplier).map(|(xi, lambda)| xi + lambda);
        Self {
            u: view.u.to_vec(),
            stress: match space.mesh.dimension {
                2 => stresses::<P, 3>(space, model, view),
                _ => stresses::<P, 6>(space, model, view),
            },
            pressure: sum.collect(),
        }
    }

    /// The distance of two solutions of one level in every norm.
    pub fn distance(&self, other: &Self, space: &Discretization) -> Floors {
        let minus =
            |a: &[f64], b: &[f64]| -> Vec<f64> { a.iter().zip(b).map(|(a, b)| a - b).collect() };
        let u = minus(&self.u, &other.u);
        let stress = minus(&self.stress, &other.stress);
        let numbers = stress.len() / space.geometry.points().max(1);
        let points = stress.chunks(numbers.max(1)).zip(space.points());
        let squares = points.map(|(s, at)| at.weight * s.iter().map(|s| s * s).sum::<f64>());
        let pressure = minus(&self.pressure, &other.pressure);
        let points = space.trace.points.iter().zip(&pressure);
        Floors {
            v: strain_norm(space, &u),
            l2: l2_norm(space, &u),
            stress: squares.sum::<f64>().sqrt(),
            trace: trace_norm(space, &u),
            pressure: points.map(|(at, p)| at.weight * p * p).sum::<f64>().sqrt(),
        }
    }
}

/// ‖v‖ of a nodal vector.
fn l2_norm(space: &Discretization, v: &[f64]) -> f64 {
    let d = space.mesh.dimension;
    let square = space.element.mean_square(d + 1);
    let (mut sum, mut own) = (0.0, Vec::new());
    for c in 0..space.mesh.cell_count() {
        for i in 0..d {
            own.clear();
            own.extend(space.cell_nodes(c).iter().map(|node| [v[d * *node as usize + i]]));
            sum += square.over(space.geometry.measure[c], &own);
        }
    }
    sum.sqrt()
}

/// ‖v_ν‖ on Γ3 of a nodal vector, by the lumped rule.
fn trace_norm(space: &Discretization, v: &[f64]) -> f64 {
    let points = space.trace.points.iter().enumerate();
    points.map(|(i, point)| point.weight * space.trace.normal(i, v).powi(2)).sum::<f64>().sqrt()
}

/// ‖ε(v) - ε(w)‖ of two nodal vectors.
pub fn strain_distance(space: &Discretization, v: &[f64], w: &[f64]) -> f64 {
    fn sum<const S: usize>(space: &Discretization, v: &[f64], w: &[f64]) -> f64 {
        let mut sum = 0.0;
        for at in space.points() {
            let (a, b) = (at.strain::<S>(v), at.strain::<S>(w));
            let square: f64 = a.iter().zip(&b).map(|(x, y)| (x - y).powi(2)).sum();
            sum += at.weight * square;
        }
        sum
    }
    let jumps = match space.jumps.is_empty() {
        true => 0.0,
        false => space.jump_square(&v.iter().zip(w).map(|(v, w)| v - w).collect::<Vec<f64>>()),
    };
    match space.mesh.dimension {
        2 => (sum::<3>(space, v, w) + jumps).sqrt(),
        _ => (sum::<6>(space, v, w) + jumps).sqrt(),
    }
}
