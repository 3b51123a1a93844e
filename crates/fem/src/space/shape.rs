//! Geometry of shape functions: cell measures, gradients at the points where strains live, and the strain of a
//! nodal vector there.

use super::Element;
use crate::mesh::Mesh;
use algebra::tensor::{dimension, off_diagonal};

/// Measures of all cells, and shape gradients at their strain points.
#[derive(Debug, Clone)]
pub struct Geometry {
    /// Space dimension d.
    pub dimension: usize,
    /// |K| of each cell.
    pub measure: Vec<f64>,
    /// Shares of the strain points of a cell in its measure.
    pub shares: Vec<f64>,
    /// Gradients of the shape functions of its cell at each point, d numbers each.
    pub gradient: Vec<f64>,
    /// Numbers a point.
    stride: usize,
}

impl Geometry {
    /// Computes measures and gradients of `mesh`. A cell of no or negative area is a broken
    /// invariant of the mesh generators and is reported by its non-positive measure.
    pub(crate) fn new(mesh: &Mesh, element: Element) -> Self {
        let d = mesh.dimension;
        let cells = mesh.cell_count();
        let rule = element.strain_rule(d);
        let stride = d * element.nodes(d + 1).len();
        let mut measure = Vec::with_capacity(cells);
        let mut gradient = Vec::with_capacity(cells * rule.points.len() * stride);
        let mut linear = Vec::with_capacity(d * (d + 1));
        let slopes: Vec<_> = rule.points.iter().map(|b| element.slopes(b)).collect();
        for c in 0..cells {
            let (inward, content) = mesh.inward(c);
            measure.push(content / if d == 2 { 2.0 } else { 6.0 });
            linear.clear();
            linear.extend(inward.iter().flat_map(|normal| &normal[..d]).map(|g| g / content));
            for at_point in &slopes {
                append_gradients(at_point, &linear, &mut gradient);
            }
        }
        Self { dimension: d, measure, shares: rule.weights, gradient, stride }
    }

    /// Strain points in all.
    pub fn points(&self) -> usize {
        self.shares.len() * self.measure.len()
    }

    /// Shape gradients at strain point p, which is cell p where each has one: d numbers for each node of its cell.
    #[inline]
    pub fn gradients(&self, p: usize) -> &[f64] {
        &self.gradient[self.stride * p..self.stride * (p + 1)]
    }
}

/// Appends the gradients of shape functions, d numbers each, from their slopes ∂φ_a/∂b_i and the gradients of b_i.
pub(super) fn append_gradients(slopes: &[Vec<f64>], linear: &[f64], out: &mut Vec<f64>) {
    for of_function in slopes {
        let d = of_function.len() - 1;
        let along =
            |axis| of_function.iter().zip(linear.chunks_exact(d)).map(move |(s, g)| s * g[axis]);
        out.extend((0..d).map(|axis| along(axis).sum::<f64>()));
    }
}

/// ε(v) at a point with shape `gradients` of a cell with these `nodes`, from the nodal vector `v`, in Mandel
/// notation.
#[inline]
pub fn strain_of<const S: usize>(gradients: &[f64], nodes: &[u32], v: &[f64]) -> [f64; S] {
    let (mut strain, half, d) = ([0.0; S], std::f64::consts::FRAC_1_SQRT_2, dimension::<S>());
    for (g, &node) in gradients.chunks_exact(d).zip(nodes) {
        let w = &v[d * node as usize..][..d];
        for i in 0..d {
            strain[i] += g[i] * w[i];
        }
        for (k, &(i, j)) in off_diagonal(d).iter().enumerate() {
            strain[d + k] += half * (g[i] * w[j] + g[j] * w[i]);
        }
    }
    strain
}

/// A point of a cell.
#[derive(Debug, Clone, Copy)]
pub struct StrainPoint<'a> {
    /// Its number among all points.
    pub index: usize,
    /// Its cell.
    pub cell: usize,
    /// Its share of the measure of the cell.
    pub weight: f64,
    /// Shape gradients there, d numbers for each of `nodes`.
    pub gradients: &'a [f64],
    /// The nodes of the cell.
    pub nodes: &'a [u32],
}

impl StrainPoint<'_> {
    /// ε(v) of a nodal vector.
    #[inline]
    pub fn strain<const S: usize>(&self, v: &[f64]) -> [f64; S] {
        strain_of(self.gradients, self.nodes, v)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::{Family, lattice};

    #[test]
    fn strain_of_an_affine_field_is_exact_on_any_mesh() {
        let mesh =
            lattice([1.0, 1.0], 3, Family::Perturbed { amplitude: 0.2, seed: 1, axes: [true; 3] });
        let geometry = Geometry::new(&mesh, Element::P1);
        // v = (2x + 3y, -x + 5y): ε = (2, 5, (3-1)/2).
        let v: Vec<f64> = (0..mesh.vertices() as u32)
            .flat_map(|p| {
                let x = mesh.vertex(p);
                [2.0 * x[0] + 3.0 * x[1], -x[0] + 5.0 * x[1]]
            })
            .collect();
        for c in 0..mesh.cell_count() {
            let strain = strain_of::<3>(geometry.gradients(c), mesh.cell(c), &v);
            let expected = [2.0, 5.0, 2f64.sqrt()];
            // Rounding of coordinates of size 1 divided by h = 1/3: a few units in the last place.
            assert!(strain.iter().zip(expected).all(|(s, e)| (s - e).abs() < 1e-13));
        }
    }

    #[test]
    fn strain_in_space_has_the_mandel_order_yz_xz_xy() {
        let gradients = [-1.0, -1.0, -1.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0];
        // v = (y, 0, 0) on the unit tetrahedron: ε_xy = 1/2.
        let mut v = [0.0; 12];
        v[6] = 1.0;
        let strain = strain_of::<6>(&gradients, &[0, 1, 2, 3], &v);
        assert!((strain[5] - 0.5f64.sqrt()).abs() < 1e-15 && strain[3] == 0.0 && strain[4] == 0.0);
    }
}
