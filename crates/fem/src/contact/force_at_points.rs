//! Forces that are known at the points of a rule, as load vectors.

use super::{Discretization, facet_measure};
use crate::space::quadrature::Rule;
use algebra::linalg::dot;

/// ∫ f·v over simplices of a mesh, of a force f that is known at the points of a rule.
pub struct ForceAtPoints {
    dimension: usize,
    /// Of each shape function its values at the points of the rule, times their weights.
    shapes: Vec<Vec<f64>>,
    /// Of each simplex in turn.
    measures: Vec<f64>,
    nodes: Vec<u32>,
}

impl ForceAtPoints {
    /// Over all cells; the points come cell by cell.
    pub fn in_cells(space: &Discretization, rule: &Rule) -> (Self, Vec<[f64; 3]>) {
        let cells = space.mesh.cells();
        let nodes = (0..cells.len()).flat_map(|c| space.cell_nodes(c).to_vec()).collect();
        Self::new(space, rule, (&cells, space.geometry.measure.clone(), nodes))
    }

    /// Over the facets on a side; the points come facet by facet, in mesh order.
    pub fn on_side(space: &Discretization, rule: &Rule, side: u32) -> (Self, Vec<[f64; 3]>) {
        let (mesh, sides) = (&space.mesh, [side]);
        let facets: Vec<usize> = mesh.facets_on(&sides).collect();
        let corners: Vec<&[u32]> = facets.iter().map(|&f| mesh.facet(f)).collect();
        let measures = facets.iter().map(|&f| facet_measure(mesh, f)).collect();
        let vertices = facets.iter().flat_map(|&f| space.nodes.on_facet(f));
        let nodes = vertices.map(|&v| space.nodes.of_vertex[v as usize]).collect();
        Self::new(space, rule, (&corners, measures, nodes))
    }

    fn new(
        space: &Discretization,
        rule: &Rule,
        (simplices, measures, nodes): (&[&[u32]], Vec<f64>, Vec<u32>),
    ) -> (Self, Vec<[f64; 3]>) {
        let values: Vec<_> = rule.points.iter().map(|b| space.element.values(b)).collect();
        let of_points =
            |a: usize| values.iter().zip(&rule.weights).map(|(v, w)| w * v[a]).collect();
        let shapes = (0..values[0].len()).map(of_points).collect();
        let dimension = space.mesh.dimension;
        let points = space.mesh.points_of(simplices, &rule.points);
        (Self { dimension, shapes, measures, nodes }, points)
    }

    /// Adds the integral of a component, given by its values at the points, to a nodal vector.
    pub fn add(&self, component: usize, values: &[f64], force: &mut [f64]) {
        let nodes = self.nodes.chunks_exact(self.shapes.len());
        let of_simplices = nodes.zip(values.chunks_exact(self.shapes[0].len()));
        for (measure, (nodes, values)) in self.measures.iter().zip(of_simplices) {
            for (shape, &node) in self.shapes.iter().zip(nodes) {
                force[self.dimension * node as usize + component] += measure * dot(shape, values);
            }
        }
    }
}
