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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::{Family, lattice};
    use crate::space::Element;
    use crate::space::quadrature::{edge, tetrahedron_degree_5, triangle_degree_4};

    fn totals_and_moments<const D: usize>(size: [f64; D], family: Family, rules: &[Rule; 2]) {
        for element in [Element::P1, Element::P2] {
            let mesh = lattice(size, 4, family);
            let [top, bottom] = ["top", "bottom"].map(|name| mesh.side(name).expect("a side"));
            let space = Discretization::of(element, mesh, &[bottom], &[]);
            let inside = ForceAtPoints::in_cells(&space, &rules[0]);
            let on_top = ForceAtPoints::on_side(&space, &rules[1], top);
            for ((force, points), across) in [(inside, 0.5), (on_top, 1.0)] {
                assert!(D == 3 || force.measures.iter().any(|size| *size != force.measures[0]));
                let values: Vec<f64> = points.iter().map(|[x, ..]| 1.0 + 2.0 * x).collect();
                let mut found = vec![0.0; space.nodes.len()];
                force.add(1, &values, &mut found);
                let (mut total, mut moment) = (0.0, 0.0);
                for (node, &vertex) in found.chunks(D).zip(&space.nodes.vertex) {
                    total += node[1];
                    moment += node[1] * space.mesh.vertex(vertex)[0];
                    assert!(node.iter().enumerate().all(|(i, f)| i == 1 || *f == 0.0));
                }
                // Rounding of a thousand terms below one.
                assert!((total - 2.0 * across).abs() < 1e-13, "{element:?}: {total}");
                assert!((moment - 7.0 / 6.0 * across).abs() < 1e-13, "{element:?}: {moment}");
            }
        }
    }

    /// Σ F_i and Σ F_i x_i are ∫ f and ∫ f x, because 1 and x are in the space: for f = 1 + 2x on 0 < x < 1, 2 and 7/6 times
    /// the extent across; in the plane on cells and facets of different sizes.
    #[test]
    fn totals_and_moments_are_those_of_the_force() {
        let graded = Family::Graded { corner: [0.0, 0.5], exponent: 2.0 };
        totals_and_moments([1.0, 0.5], graded, &[triangle_degree_4(), edge(3)]);
        let perturbed = Family::Perturbed { amplitude: 0.2, seed: 3, axes: [true, false, true] };
        let rules = [tetrahedron_degree_5(), triangle_degree_4()];
        totals_and_moments([1.0, 0.5, 1.0], perturbed, &rules);
    }
}
