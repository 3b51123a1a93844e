//! Strains of a function of the element from its nodal values, by slopes along edges: independent of the solver's shape
//! gradients.

use std::sync::Arc;

use super::constitutive::Tensor;
use super::linear::edge_slopes;
use super::shapes::{between, strain_places};
use fem::contact::Discretization;

/// Data independent of the function.
pub(super) struct NodalStrain {
    space: Arc<Discretization>,
    /// ∇λ of all corners of a cell but its first, cell by cell.
    slopes: Vec<f64>,
    /// Barycentric coordinates of the strain points of a cell.
    places: Vec<Vec<f64>>,
}

impl NodalStrain {
    pub(super) fn new(space: Arc<Discretization>) -> Self {
        let d = space.mesh.dimension;
        let slopes = match d {
            2 => edge_slopes::<2>(&space.mesh),
            _ => edge_slopes::<3>(&space.mesh),
        };
        Self { slopes, places: strain_places(space.element, d), space }
    }

    pub(super) fn points(&self) -> usize {
        self.places.len()
    }

    /// ε of a nodal vector at strain point p of cell c, as a full tensor.
    pub(super) fn at<const D: usize>(&self, nodal: &[f64], c: usize, p: usize) -> Tensor<D> {
        let nodes = self.space.cell_nodes(c);
        let slopes = &self.slopes.as_chunks::<D>().0[D * c..D * (c + 1)];
        let values = nodal.as_chunks::<D>().0;
        let from = &values[nodes[0] as usize];
        let mut gradient = [[0.0; D]; D];
        for (slope, &node) in slopes.iter().zip(&nodes[1..]) {
            let to = &values[node as usize];
            for i in 0..D {
                for j in 0..D {
                    gradient[i][j] += (to[i] - from[i]) * slope[j];
                }
            }
        }
        // The deviation of midpoints from linear: 4 λ_a λ_b of each edge.
        let slope = |corner: usize| -> [f64; D] {
            match corner {
                0 => std::array::from_fn(|j| -slopes.iter().map(|slope| slope[j]).sum::<f64>()),
                _ => slopes[corner - 1],
            }
        };
        let place = &self.places[p];
        for (&node, &[a, b]) in nodes[D + 1..].iter().zip(between(D + 1)) {
            let [middle, first, second] =
                [node, nodes[a], nodes[b]].map(|node| &values[node as usize]);
            let (of_a, of_b) = (slope(a), slope(b));
            for i in 0..D {
                let lift = 4.0 * (middle[i] - 0.5 * (first[i] + second[i]));
                for j in 0..D {
                    gradient[i][j] += lift * (place[a] * of_b[j] + place[b] * of_a[j]);
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
            let mut squares = 0.0;
            for p in 0..self.points() {
                let strain: Tensor<D> = self.at(nodal, c, p);
                for i in 0..D {
                    squares += strain[i][i] * strain[i][i];
                    for j in i + 1..D {
                        squares += 2.0 * strain[i][j] * strain[i][j];
                    }
                }
            }
            sum += measure * squares / self.points() as f64;
        }
        sum.sqrt()
    }
}
