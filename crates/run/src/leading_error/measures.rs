//! Norms of the leading error in time: of functions of the element, and of tensors at its strain points.

use super::cells::{Mandel, add_force, inner};
use algebra::linalg::larger;
use exact::constitutive::Tensor;
use fem::contact::Discretization;
use fem::space::Simplex;
use scene::Norm;

pub(super) struct Level<const S: usize> {
    /// e as a nodal vector.
    pub(super) error: Vec<f64>,
    /// ε(e) at the strain points.
    pub(super) strain: Vec<Mandel<S>>,
    /// The leading part of σ^k - σ there.
    pub(super) stress: Vec<Mandel<S>>,
    /// (ξ + λ)^k - (ξ + λ) at the points of the trace.
    pub(super) pressure: Vec<f64>,
}

#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Largest {
    v: f64,
    l2: f64,
    stress: f64,
    trace: f64,
    pressure: f64,
}

impl Largest {
    /// Includes a level; NaN is kept.
    pub(super) fn raise<const S: usize>(&mut self, space: &Discretization, level: &Level<S>) {
        let of_cells = |field: &[Mandel<S>]| inner(space, field, field).sqrt();
        let trace: Vec<f64> =
            (0..space.trace.points.len()).map(|i| normal(space, i, &level.error)).collect();
        for (known, value) in [
            (&mut self.v, of_cells(&level.strain)),
            (&mut self.l2, in_the_body(space, &level.error)),
            (&mut self.stress, of_cells(&level.stress)),
            (&mut self.trace, on_the_contact_side(space, &trace)),
            (&mut self.pressure, on_the_contact_side(space, &level.pressure)),
        ] {
            *known = larger(*known, value);
        }
    }

    /// None for norms without a leading error in time.
    pub(super) fn of(&self, norm: Norm) -> Option<f64> {
        match norm {
            Norm::VMax | Norm::VTimeMax => Some(self.v),
            Norm::L2Max => Some(self.l2),
            Norm::StressL2Max => Some(self.stress),
            Norm::TraceL2Max => Some(self.trace),
            Norm::PressureL2Max => Some(self.pressure),
            _ => None,
        }
    }
}

/// The pressures that balance a stress at the vertices of Γ3: p_i = -(σ, ε(φ_i ν_i))/w_i.
pub(super) fn balancing<const S: usize>(space: &Discretization, stress: &[Mandel<S>]) -> Vec<f64> {
    let mut force = vec![0.0; space.nodes.len()];
    for (at, tensor) in space.points().zip(stress) {
        add_force(&at, tensor, &mut force);
    }
    let points = space.trace.points.iter().enumerate();
    points.map(|(i, point)| -normal(space, i, &force) / point.weight).collect()
}

/// v·ν at a point of the trace, by the components of its node.
pub(super) fn normal(space: &Discretization, i: usize, nodal: &[f64]) -> f64 {
    let (point, d) = (&space.trace.points[i], space.mesh.dimension);
    (0..d).map(|j| point.normal[j] * nodal[d * point.node as usize + j]).sum()
}

fn in_the_body(space: &Discretization, nodal: &[f64]) -> f64 {
    let d = space.mesh.dimension;
    let squares = space.element.mean_square(Simplex::cell(d));
    let at = |&node: &u32| -> [f64; 3] {
        std::array::from_fn(|i| if i < d { nodal[d * node as usize + i] } else { 0.0 })
    };
    let cell = |(c, &measure): (usize, &f64)| {
        squares.over(measure, &space.cell_nodes(c).iter().map(at).collect::<Vec<_>>())
    };
    space.geometry.measure.iter().enumerate().map(cell).sum::<f64>().sqrt()
}

/// ‖f‖ in L²(Γ3) of values at the points of the trace.
fn on_the_contact_side(space: &Discretization, values: &[f64]) -> f64 {
    let squares = space.element.mean_square(Simplex::facet(space.mesh.dimension));
    let at = |&i: &u32| [values[i as usize]];
    let facet = |(f, &measure): (usize, &f64)| {
        squares.over(measure, &space.trace.facet(f).iter().map(at).collect::<Vec<_>>())
    };
    space.trace.measure.iter().enumerate().map(facet).sum::<f64>().sqrt()
}

/// |σ - τ|².
pub(super) fn square_apart<const D: usize>(a: &Tensor<D>, b: &Tensor<D>) -> f64 {
    a.as_flattened().iter().zip(b.as_flattened()).map(|(a, b)| (a - b).powi(2)).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use fem::mesh::{Family, lattice};

    /// A NaN in one norm must not affect the others.
    #[test]
    fn no_number_stays_in_its_norm() {
        let mesh = lattice([1.0, 1.0], 1, Family::Structured);
        let space = Discretization::new(mesh, &[3], &[2]);
        let (nodes, cells) = (space.nodes.len(), space.mesh.cell_count());
        let level = |pressure: f64| Level::<3> {
            error: vec![1.0; nodes],
            strain: vec![[1.0; 3]; cells],
            stress: vec![[2.0; 3]; cells],
            pressure: vec![pressure; space.trace.points.len()],
        };
        let mut largest = Largest::default();
        for pressure in [1.0, f64::NAN, 2.0] {
            largest.raise(&space, &level(pressure));
        }
        assert!(largest.of(Norm::PressureL2Max).is_some_and(f64::is_nan));
        assert!(largest.of(Norm::TraceL2Max).is_some_and(f64::is_finite));
        // √3 on the unit square.
        let v = largest.of(Norm::VMax).expect("a norm");
        assert!((v - 3f64.sqrt()).abs() < 1e-15, "{v}");
    }
}
