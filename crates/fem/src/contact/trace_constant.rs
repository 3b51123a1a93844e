//! The constants of the traces on a mesh: sup ‖v_ν‖²_{L²(Γ3)}/(𝒞ε(v), ε(v)) over V^h, and the same of v_τ.
//!
//! With 𝒞 = I it is c_j² of (2.4); with 𝒞 = 𝒜 it is the energy constant, which with α_ν decides by
//! itself whether the elastic part of a step is monotone.

use super::{ContactTrace, Discretization, StiffnessInverse};
use algebra::linalg::{
    EigenError, Extreme, FactorError, LinearMap, largest_eigenvalue, signed_unit,
};
use vhi::law::TensorField;

/// How ‖v_ν‖² is integrated over Γ3.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TraceMass {
    /// Exactly: the mass matrix of the element on facets.
    Consistent,
    /// By the vertex rule, as the solver integrates the compliance term; never smaller for linear elements and on edges,
    /// where Simpson's rule overestimates squares of quadratics. On triangles the midpoints see nothing of a quadratic that
    /// is zero there.
    Lumped,
}

/// Which trace is squared.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TracePart {
    /// v_ν.
    Normal,
    /// v_τ. Korn's inequality is in its constant, which is much larger than that of v_ν.
    Tangential,
}

/// The largest quotients (lengths, over a stress if 𝒞 is one), each with the field that has it, by one factor of the
/// stiffness matrix of `tensor`.
///
/// # Errors
/// A stiffness matrix that cannot be factorized.
pub fn trace_constants<const K: usize>(
    space: &Discretization,
    tensor: &TensorField,
    squares: [(TracePart, TraceMass); K],
) -> Result<[Extreme; K], EigenError> {
    weighted_trace_constants(space, tensor, squares, &|_| 1.0)
}

/// The same with the square on each side of Γ3 times its `weight`, at least 0.
///
/// # Errors
/// As [`trace_constants`].
pub fn weighted_trace_constants<const K: usize>(
    space: &Discretization,
    tensor: &TensorField,
    squares: [(TracePart, TraceMass); K],
    weight: &(dyn Fn(u32) -> f64 + Sync),
) -> Result<[Extreme; K], EigenError> {
    let mut stiffness = StiffnessInverse::new(space, tensor, false)?;
    let mut found = squares.map(|_| Extreme::default());
    for (found, square) in found.iter_mut().zip(squares) {
        *found = largest_quotient(space, &mut stiffness, square, weight)?;
    }
    Ok(found)
}

impl TracePart {
    /// v_ν, or v_τ along the tangents.
    fn value(self, trace: &ContactTrace, i: usize, v: &[f64]) -> [f64; 2] {
        match self {
            Self::Normal => [trace.normal(i, v), 0.0],
            Self::Tangential => trace.points[i].slip(v),
        }
    }

    fn add(self, trace: &ContactTrace, i: usize, value: [f64; 2], force: &mut [f64]) {
        match self {
            Self::Normal => trace.add_normal(i, value[0], force),
            Self::Tangential => trace.points[i].add_tangential(&value, force),
        }
    }
}

fn largest_quotient(
    space: &Discretization,
    stiffness: &mut StiffnessInverse<'_>,
    (part, mass): (TracePart, TraceMass),
    weight: &(dyn Fn(u32) -> f64 + Sync),
) -> Result<Extreme, EigenError> {
    let nodal = vec![0.0; space.nodes.len()];
    let mut map = Quotient { space, stiffness, part, mass, weight, nodal };
    // A constant pressure and some of everything else: no symmetry of the mesh hides the maximum.
    let (mut seed, mut load) = (1, vec![0.0; space.nodes.len()]);
    for (i, _) in space.trace.points.iter().enumerate().filter(|(_, point)| !point.clamped) {
        // The second number is of a second tangent; the plane has none.
        let value = 1.0 + 0.1 * signed_unit(&mut seed);
        part.add(&space.trace, i, [value, 0.7 * value], &mut load);
    }
    let mut start = vec![0.0; space.dofs()];
    map.apply(&load[..space.dofs()], &mut start)?;
    if start.iter().all(|value| *value == 0.0) {
        return Ok(Extreme { vector: start, ..Extreme::default() });
    }
    largest_eigenvalue(&mut map, &start)
}

/// K⁻¹M in the inner product of K.
struct Quotient<'a, 'b> {
    space: &'a Discretization,
    stiffness: &'a mut StiffnessInverse<'b>,
    part: TracePart,
    mass: TraceMass,
    weight: &'a (dyn Fn(u32) -> f64 + Sync),
    nodal: Vec<f64>,
}

impl LinearMap for Quotient<'_, '_> {
    fn apply(&mut self, x: &[f64], out: &mut [f64]) -> Result<(), FactorError> {
        self.nodal[..x.len()].copy_from_slice(x);
        let mut force = self.trace_mass();
        force.truncate(out.len());
        out.copy_from_slice(&force);
        self.stiffness.solve(out);
        Ok(())
    }

    fn gram(&mut self, x: &[f64], out: &mut [f64]) {
        self.stiffness.multiply(x, out);
    }
}

impl Quotient<'_, '_> {
    /// M v over all nodes: Σ c_i ∫_{Γ_i} v_ν φ_ν, or the same of the tangential part.
    fn trace_mass(&self) -> Vec<f64> {
        let (space, part, v) = (self.space, self.part, &self.nodal);
        let mut out = vec![0.0; v.len()];
        let trace = &space.trace;
        match self.mass {
            TraceMass::Lumped => {
                for (i, point) in trace.points.iter().enumerate() {
                    let weight = (self.weight)(point.side) * point.weight;
                    let value = part.value(trace, i, v).map(|value| weight * value);
                    part.add(trace, i, value, &mut out);
                }
            }
            TraceMass::Consistent => {
                let mean = space.element.mass(space.mesh.dimension);
                for (f, measure) in trace.measure.iter().enumerate() {
                    let (members, measure) =
                        (trace.facet(f), (self.weight)(space.side(f)) * measure);
                    for (&i, row) in members.iter().zip(mean.chunks_exact(members.len())) {
                        let mut value = [0.0; 2];
                        for (&j, mean) in members.iter().zip(row) {
                            let trace_value = part.value(trace, j as usize, v);
                            (0..2).for_each(|k| value[k] += measure * mean * trace_value[k]);
                        }
                        part.add(trace, i as usize, value, &mut out);
                    }
                }
            }
        }
        out
    }
}
