//! ∫_{Γ3} ∂j_ν(u_ν) v_ν at Gauss points of the facets.

use std::sync::Arc;

use super::{Boundary, Discretization};
use crate::law::Potential;
use crate::linalg::BlockPattern;
use crate::space::quadrature::{Rule, edge, triangle_degree_4};

/// A quadrature point on Γ3.
struct GaussPoint {
    facet: usize,
    /// Values of the shape functions of the facet.
    shape: Vec<f64>,
    weight: f64,
    shift: f64,
}

/// The compliance term by Gauss quadrature (3 points an edge: exact where ∂j_ν(u_ν) v_ν is a
/// polynomial of degree 5).
pub struct GaussCompliance {
    potential: Arc<dyn Potential>,
    points: Vec<GaussPoint>,
    /// (component, sign, is an unknown) of the trace points of each facet.
    facets: Vec<Vec<(usize, f64, bool)>>,
}

impl GaussCompliance {
    /// The rule on all facets of Γ3.
    pub fn new(space: &Discretization, boundary: &Boundary) -> Self {
        let rule = facet_rule(space.mesh.dimension);
        let (mut points, mut facets) = (Vec::new(), Vec::new());
        for facet in 0..space.trace.measure.len() {
            let members = space.trace.facet(facet);
            let vertices: Vec<u32> =
                members.iter().map(|&i| space.trace.points[i as usize].vertex).collect();
            for (shape, weight) in rule.points.iter().zip(&rule.weights) {
                points.push(GaussPoint {
                    facet,
                    shape: shape.clone(),
                    weight: weight * space.trace.measure[facet],
                    shift: (boundary.shift)(space.mesh.point(&vertices, shape)),
                });
            }
            let member = |&i: &u32| {
                let point = space.trace.points[i as usize];
                (point.component as usize, point.sign, !point.clamped)
            };
            facets.push(members.iter().map(member).collect());
        }
        Self { potential: boundary.potential.clone(), points, facets }
    }

    fn at(&self, point: &GaussPoint, nodal: &[f64]) -> (f64, f64) {
        let members = &self.facets[point.facet];
        let normal: f64 = members
            .iter()
            .zip(&point.shape)
            .map(|((component, sign, _), shape)| shape * sign * nodal[*component])
            .sum();
        self.potential.value_and_slope(normal - point.shift)
    }

    /// Adds the force of the compliance term at the nodal vector `nodal`.
    pub fn add_force(&self, nodal: &[f64], out: &mut [f64]) {
        for point in &self.points {
            let pressure = self.at(point, nodal).0;
            for ((component, sign, unknown), shape) in
                self.facets[point.facet].iter().zip(&point.shape)
            {
                if *unknown {
                    out[*component] += point.weight * pressure * sign * shape;
                }
            }
        }
    }

    /// Adds its derivative to lower-triangle `values`.
    pub fn add_tangent(&self, nodal: &[f64], pattern: &BlockPattern, values: &mut [f64]) {
        for point in &self.points {
            let slope = self.at(point, nodal).1;
            let members = &self.facets[point.facet];
            for (a, &(i, sign_i, unknown_i)) in members.iter().enumerate() {
                for (b, &(j, sign_j, unknown_j)) in members.iter().enumerate().take(a + 1) {
                    if !(unknown_i && unknown_j) {
                        continue;
                    }
                    if let Some(position) = pattern.position(i, j) {
                        values[position] += point.weight
                            * slope
                            * (sign_i * point.shape[a])
                            * (sign_j * point.shape[b]);
                    }
                }
            }
        }
    }
}

/// Gauss rule of the facets of a d-dimensional mesh.
pub fn facet_rule(dimension: usize) -> Rule {
    if dimension == 2 { edge(3) } else { triangle_degree_4() }
}
