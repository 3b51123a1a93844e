//! Strains of a function of the element from its nodal values, by slopes along edges: independent of the solver's shape
//! gradients.

use fem::mesh::in_dimension;
use std::sync::Arc;

use super::constitutive::Tensor;
use super::linear::edge_slopes;
use super::shapes::Shapes;
use fem::contact::Discretization;
use fem::space::quadrature::Rule;

/// Data independent of the function.
pub struct NodalStrain {
    space: Arc<Discretization>,
    /// ∇λ of all corners of a cell but its first, cell by cell.
    slopes: Vec<f64>,
    /// At each point of a cell, where they are not zero: node but the first, corner, and the derivative of its shape
    /// function by that coordinate.
    at_points: Vec<Vec<(usize, usize, f64)>>,
}

impl NodalStrain {
    /// For the points of a rule on the cells; the norm takes the strain points of the element.
    pub fn new(space: Arc<Discretization>, rule: &Rule) -> Self {
        let d = space.mesh.dimension;
        let slopes = in_dimension!(d, D => edge_slopes::<D>(&space.mesh));
        let functions = Shapes::of_cell(space.element, d);
        let at_point = |b: &Vec<f64>| {
            let all = functions.slopes(b).into_iter().enumerate().skip(1);
            let each = all.flat_map(|(a, of_a)| {
                of_a.into_iter().enumerate().map(move |(corner, slope)| (a, corner, slope))
            });
            each.filter(|(_, _, slope)| *slope != 0.0).collect()
        };
        let at_points = rule.points.iter().map(at_point).collect();
        Self { slopes, at_points, space }
    }

    pub(super) fn points(&self) -> usize {
        self.at_points.len()
    }

    /// ε of a nodal vector at point p of cell c, as a full tensor.
    pub fn at<const D: usize>(&self, nodal: &[f64], c: usize, p: usize) -> Tensor<D> {
        let nodes = self.space.cell_nodes(c);
        let slopes = &self.slopes.as_chunks::<D>().0[D * c..D * (c + 1)];
        let values = nodal.as_chunks::<D>().0;
        let from = &values[nodes[0] as usize];
        let slope = |corner: usize| -> [f64; D] {
            match corner {
                0 => std::array::from_fn(|j| -slopes.iter().map(|slope| slope[j]).sum::<f64>()),
                _ => slopes[corner - 1],
            }
        };
        let mut gradient = [[0.0; D]; D];
        // Shape functions sum up to one: differences to the first node, which do not cancel.
        for &(a, corner, factor) in &self.at_points[p] {
            let (to, of_corner) = (&values[nodes[a] as usize], slope(corner));
            for i in 0..D {
                for j in 0..D {
                    gradient[i][j] += factor * (to[i] - from[i]) * of_corner[j];
                }
            }
        }
        let mut strain = gradient;
        for i in 0..D {
            for j in i + 1..D {
                strain[i][j] = 0.5 * (gradient[i][j] + gradient[j][i]);
                strain[j][i] = strain[i][j];
            }
        }
        strain
    }

    /// ‖ε‖_ℋ of a nodal vector: the strain points integrate squares exactly.
    pub(super) fn norm<const D: usize>(&self, nodal: &[f64]) -> f64 {
        let mut sum = 0.0;
        for (c, measure) in self.space.geometry.measure.iter().enumerate() {
            for (p, share) in self.space.geometry.shares.iter().enumerate() {
                let mut squares = 0.0;
                let strain: Tensor<D> = self.at(nodal, c, p);
                for i in 0..D {
                    squares += strain[i][i] * strain[i][i];
                    for j in i + 1..D {
                        squares += 2.0 * strain[i][j] * strain[i][j];
                    }
                }
                sum += measure * share * squares;
            }
        }
        sum.sqrt()
    }
}
