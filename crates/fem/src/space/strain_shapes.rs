//! Functions on a cell that are one at a strain point and zero at the others: what strains are between those points.

use nalgebra::DMatrix;

use super::Element;

/// The functions of a cell, one a strain point; of products of two the strain rule has the mean exactly.
#[derive(Debug, Clone)]
pub struct StrainShapes {
    /// Row p: the factors of the barycentric coordinates in function p. Empty for the constant.
    factors: Vec<Vec<f64>>,
}

impl StrainShapes {
    /// Those of an element in dimension d.
    pub fn new(element: Element, dimension: usize) -> Self {
        let points = element.strain_rule(dimension).points;
        let factors = match points.len() {
            1 => Vec::new(),
            count => {
                let places = DMatrix::from_fn(count, dimension + 1, |p, a| points[p][a]);
                let inverse = places.try_inverse().expect("strain points that span the cell");
                (0..count).map(|p| inverse.column(p).iter().copied().collect()).collect()
            }
        };
        Self { factors }
    }

    /// All of them at barycentric coordinates `b`.
    pub fn at(&self, b: &[f64], out: &mut [f64]) {
        if self.factors.is_empty() {
            out.fill(1.0);
            return;
        }
        for (value, factors) in out.iter_mut().zip(&self.factors) {
            *value = factors.iter().zip(b).map(|(f, b)| f * b).sum();
        }
    }

    /// The tensor at `b` that has these values at the strain points.
    pub fn tensor<const S: usize>(&self, b: &[f64], values: &[[f64; S]]) -> [f64; S] {
        let (mut shape, mut sum) = ([1.0; 4], [0.0; S]);
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
        let constant = StrainShapes::new(Element::P1, 2).tensor(&[0.2, 0.3, 0.5], &[[3.0, 4.0]]);
        assert_eq!(constant, [3.0, 4.0]);
    }
}
