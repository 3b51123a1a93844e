//! Functions on a cell that are one at a strain point and zero at the others: what strains are between those points.

use nalgebra::DMatrix;

use super::Element;
use super::polynomials::monomials;

/// Strain points of the most that an element may have: those of cubics on tetrahedra.
const MOST_STRAINS: usize = 10;

/// The functions of a cell, one a strain point; of products of two the strain rule has the mean exactly.
#[derive(Debug, Clone)]
pub struct StrainShapes {
    /// p - 1, the degree of the functions.
    degree: usize,
    /// Row p: the factors of the monomials in function p.
    factors: Vec<Vec<f64>>,
}

impl StrainShapes {
    /// Those of an element in dimension d.
    pub fn new(element: Element, dimension: usize) -> Self {
        let (points, degree) = (element.strain_rule(dimension).points, element.degree() - 1);
        let at: Vec<Vec<f64>> = points.iter().map(|b| monomials(degree, b)).collect();
        let places = DMatrix::from_fn(points.len(), at[0].len(), |p, m| at[p][m]);
        let inverse = places.try_inverse().expect("strain points that determine polynomials");
        let factors = (0..points.len()).map(|p| inverse.column(p).iter().copied().collect());
        Self { degree, factors: factors.collect() }
    }

    /// All of them at barycentric coordinates `b`.
    pub fn at(&self, b: &[f64], out: &mut [f64]) {
        if self.degree == 0 {
            out.fill(1.0);
            return;
        }
        let powers;
        let terms = if self.degree == 1 {
            b
        } else {
            powers = monomials(self.degree, b);
            &powers
        };
        for (value, factors) in out.iter_mut().zip(&self.factors) {
            *value = factors.iter().zip(terms).map(|(f, b)| f * b).sum();
        }
    }

    /// The tensor at `b` that has these values at the strain points.
    pub fn tensor<const S: usize>(&self, b: &[f64], values: &[[f64; S]]) -> [f64; S] {
        let (mut shape, mut sum) = ([1.0; MOST_STRAINS], [0.0; S]);
        self.at(b, &mut shape[..values.len()]);
        for (shape, value) in shape.iter().zip(values) {
            (0..S).for_each(|i| sum[i] += shape * value[i]);
        }
        sum
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn linear_tensors_are_known_by_their_values_at_the_strain_points() {
        let linear = |b: &[f64]| [1.0 + 2.0 * b[1] - 3.0 * b[2], b[0]];
        for dimension in [2, 3] {
            let points = Element::P2.strain_rule(dimension).points;
            let values: Vec<[f64; 2]> = points.iter().map(|b| linear(b)).collect();
            let shapes = StrainShapes::new(Element::P2, dimension);
            let b = [0.1, 0.2, 0.3, 0.4];
            let b = if dimension == 2 { vec![0.3, 0.2, 0.5] } else { b.to_vec() };
            let (found, exact) = (shapes.tensor(&b, &values), linear(&b));
            // Rounding of sums of three numbers below four.
            assert!((0..2).all(|i| (found[i] - exact[i]).abs() < 1e-14), "{found:?} {exact:?}");
        }
        let edges = StrainShapes { degree: 2, factors: vec![vec![1.0; 6]] };
        let mut one = [0.0];
        edges.at(&[0.2, 0.3, 0.5], &mut one);
        // Σ_{i ≤ j} b_i b_j = (1 + Σ b_i²)/2.
        assert!((one[0] - 0.69).abs() < 1e-15);
        let constant = StrainShapes::new(Element::P1, 2).tensor(&[0.2, 0.3, 0.5], &[[3.0, 4.0]]);
        assert_eq!(constant, [3.0, 4.0]);
    }
}
