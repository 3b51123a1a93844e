//! Loads as functions at the points of their rules, and the load vector that they give.

use fem::contact::Discretization;
use fem::space::quadrature::Rule;

use super::nodal_force::facet_measure;
use super::shapes::Shapes;

/// f0 and the tractions at the points of two rules, on all cells and boundary facets of a mesh.
#[derive(Debug, Clone, PartialEq)]
pub struct Densities {
    /// Of the cells, of the facets.
    pub rules: [Rule; 2],
    /// Cell by cell, in it point by point, in it component by component.
    pub body: Vec<f64>,
    /// Likewise by the facets of the boundary: f2 on Γ2, h3 on Γ3, zero on Γ1.
    pub traction: Vec<f64>,
}

/// The components of a vector field, each at all points, as one list: point by point, in it component by component.
pub fn point_by_point(components: &[Vec<f64>]) -> Vec<f64> {
    let points = 0..components.first().map_or(0, Vec::len);
    points.flat_map(|p| components.iter().map(move |values| values[p])).collect()
}

impl Densities {
    /// ∫ f0·v + ∫ f2·v over the unknowns. With `flat` shape functions stand at their values in the barycentre: each cell and
    /// facet then gives all its nodes the same share, as lumping does.
    pub fn assembled(&self, space: &Discretization, flat: bool) -> Vec<f64> {
        let (mesh, d) = (&space.mesh, space.mesh.dimension);
        let mut force = vec![0.0; space.nodes.len()];
        let shapes = |functions: Shapes, rule: &Rule| -> Vec<Vec<f64>> {
            let corners = rule.points[0].len();
            let middle = vec![1.0 / corners as f64; corners];
            rule.points.iter().map(|b| functions.at(if flat { &middle } else { b })).collect()
        };
        let mut add =
            |values: &[f64], rule: &Rule, measure: f64, shapes: &[Vec<f64>], nodes: &[u32]| {
                for ((value, weight), shape) in values.chunks(d).zip(&rule.weights).zip(shapes) {
                    let weight = measure * weight;
                    for (&node, shape) in nodes.iter().zip(shape) {
                        let force = force[d * node as usize..][..d].iter_mut();
                        force.zip(value).for_each(|(force, f)| *force += weight * shape * f);
                    }
                }
            };
        let [in_cell, on_facet] = &self.rules;
        let of_cell = shapes(Shapes::of_cell(space.element, d), in_cell);
        for (c, values) in self.body.chunks(d * in_cell.weights.len()).enumerate() {
            add(values, in_cell, space.geometry.measure[c], &of_cell, space.cell_nodes(c));
        }
        let of_facet = shapes(Shapes::of_facet(space.element, d), on_facet);
        for (f, values) in self.traction.chunks(d * on_facet.weights.len()).enumerate() {
            let vertices = space.nodes.on_facet(f).iter();
            let nodes: Vec<u32> = vertices.map(|&v| space.nodes.of_vertex[v as usize]).collect();
            add(values, on_facet, facet_measure(mesh, f), &of_facet, &nodes);
        }
        force.truncate(space.dofs());
        force
    }
}
