//! Projections of sampled fields onto the element.

use std::sync::Arc;

use nalgebra::DMatrix;

use super::shapes::Shapes;
use fem::space::Element;
use fem::space::quadrature::Rule;

/// Singular values of products of functions, of which those of rules that tell functions apart are far larger, and the
/// others rounding.
const DISTINCT: f64 = 1e-10;

/// L² projections by a rule, onto the strains and onto the functions of an element.
pub(super) struct Onto {
    /// Projections by their values at the strain points.
    pub(super) strains: Projector,
    /// By their values at the nodes.
    pub(super) functions: Projector,
}

impl Onto {
    /// Onto those of cells.
    pub(super) fn new(element: Element, rule: &Rule) -> Self {
        let d = rule.points[0].len() - 1;
        let [strains, functions] = [Shapes::of_strains(element, d), Shapes::of_cell(element, d)]
            .map(|functions| Projector::new(rule, functions));
        Self { strains, functions }
    }

    /// By a rule on the pieces of a cell, see [`Projector::by`].
    pub(super) fn by(&self, rule: &Rule) -> Self {
        Self { strains: self.strains.by(rule), functions: self.functions.by(rule) }
    }
}

/// A projection onto the span of some functions.
pub(super) struct Projector {
    functions: Arc<Shapes>,
    /// Of the matrix of their products, row by row.
    inverse: Arc<[f64]>,
    count: usize,
    weights: Vec<f64>,
    /// The values of all functions, point by point.
    shape: Vec<f64>,
    /// The weights of all points in the coefficients, function by function.
    dual: Vec<f64>,
}

impl Projector {
    pub(super) fn new(rule: &Rule, functions: Shapes) -> Self {
        let shape = values(&functions, rule);
        let (points, count) = (rule.weights.len(), shape.len() / rule.weights.len());
        let product = |i: usize, j: usize| {
            let weighted = shape.chunks(count).zip(&rule.weights);
            weighted.map(|(shape, weight)| weight * shape[i] * shape[j]).sum::<f64>()
        };
        let gram = DMatrix::from_fn(count, count, product);
        // Fewer points than functions: the least of the coefficients with the values there.
        let inverse = match count <= points {
            true => gram.try_inverse().expect("a rule that tells functions apart"),
            false => gram.pseudo_inverse(DISTINCT).expect("a bound that is not negative"),
        };
        Self::of(Arc::new(functions), inverse.as_slice().into(), shape, &rule.weights)
    }

    /// Onto the same functions by another rule, as exact for their products.
    pub(super) fn by(&self, rule: &Rule) -> Self {
        let shape = values(&self.functions, rule);
        Self::of(self.functions.clone(), self.inverse.clone(), shape, &rule.weights)
    }

    fn of(functions: Arc<Shapes>, inverse: Arc<[f64]>, shape: Vec<f64>, weights: &[f64]) -> Self {
        let count = shape.len() / weights.len();
        let mut dual = Vec::with_capacity(shape.len());
        for row in inverse.chunks(count) {
            let sum = |shape: &[f64]| row.iter().zip(shape).map(|(a, b)| a * b).sum::<f64>();
            let points = shape.chunks(count).zip(weights);
            dual.extend(points.map(|(shape, weight)| weight * sum(shape)));
        }
        Self { functions, inverse, count, weights: weights.to_vec(), shape, dual }
    }

    /// Appends the coefficients of fields on some cells to `out`, cell by cell and function by function, and returns
    /// Σ_K ∫_K |r|² of what is left, the cells having these measures. Each field comes with a factor; its value at point
    /// q of cell i of m is at q m + i.
    pub(super) fn split(
        &self,
        fields: &[(&[f64], f64)],
        measures: &[f64],
        out: &mut Vec<f64>,
    ) -> f64 {
        pulp::Arch::new().dispatch(
            #[inline(always)]
            || self.split_on_vectors(fields, measures, out),
        )
    }

    /// Index-free inner loops over cells, which vectorise.
    #[inline(always)]
    fn split_on_vectors(
        &self,
        fields: &[(&[f64], f64)],
        measures: &[f64],
        out: &mut Vec<f64>,
    ) -> f64 {
        let (m, points) = (measures.len(), self.weights.len());
        let mut coefficients = vec![0.0; m * self.count * fields.len()];
        let mut squares = vec![0.0; m * points];
        let (mut coefficient, mut left) = (vec![0.0; m * self.count], vec![0.0; m * points]);
        for (k, (values, factor)) in fields.iter().enumerate() {
            left.iter_mut().zip(*values).for_each(|(left, value)| *left = factor * value);
            coefficient.fill(0.0);
            let rows = coefficient.chunks_exact_mut(m).zip(self.dual.chunks_exact(points));
            for (row, dual) in rows {
                for (values, weight) in left.chunks_exact(m).zip(dual) {
                    row.iter_mut().zip(values).for_each(|(sum, value)| *sum += weight * value);
                }
            }
            for (left, shape) in left.chunks_exact_mut(m).zip(self.shape.chunks_exact(self.count)) {
                for (row, s) in coefficient.chunks_exact(m).zip(shape) {
                    left.iter_mut().zip(row).for_each(|(left, c)| *left -= c * s);
                }
            }
            squares.iter_mut().zip(&left).for_each(|(sum, left)| *sum += left * left);
            for (a, row) in coefficient.chunks_exact(m).enumerate() {
                let of_cells = coefficients[fields.len() * a + k..].iter_mut();
                let stride = fields.len() * self.count;
                of_cells.step_by(stride).zip(row).for_each(|(out, c)| *out = *c);
            }
        }
        out.extend_from_slice(&coefficients);
        let mut sums = vec![0.0; m];
        for (squares, weight) in squares.chunks_exact(m).zip(&self.weights) {
            sums.iter_mut().zip(squares).for_each(|(sum, square)| *sum += weight * square);
        }
        measures.iter().zip(sums).fold(0.0, |rest, (measure, sum)| rest + measure * sum)
    }
}

fn values(functions: &Shapes, rule: &Rule) -> Vec<f64> {
    let mut values = Vec::new();
    rule.points.iter().for_each(|b| functions.append_at(b, &mut values));
    values
}

#[cfg(test)]
mod tests {
    use super::*;
    use fem::space::quadrature::{edge, triangle_degree_6};

    /// Linear fields and quadratic functions have no remainder; a cubic has one.
    #[test]
    fn what_the_element_has_is_given_back() {
        let rule = triangle_degree_6();
        let onto = Onto::new(Element::P2, &rule);
        let linear = |b: &[f64], cell: f64| cell + 2.0 * b[1] - 3.0 * b[2];
        // Two fields on three cells, of which the second is the first, doubled.
        let cells = [1.0, -2.0, 0.5];
        let sampled: Vec<f64> =
            rule.points.iter().flat_map(|b| cells.map(|cell| linear(b, cell))).collect();
        let (mut out, fields) = (Vec::new(), [(&sampled[..], 1.0), (&sampled[..], 2.0)]);
        let rest = onto.strains.split(&fields, &[1.0; 3], &mut out);
        let points = Element::P2.strain_rule(2).points;
        let expected = cells.iter().flat_map(|&cell| {
            points.iter().flat_map(move |b| [1.0, 2.0].map(|factor| factor * linear(b, cell)))
        });
        assert_eq!(out.len(), 3 * 3 * 2);
        assert!(out.iter().zip(expected).all(|(at, e)| (at - e).abs() < 1e-14), "{out:?}");
        assert!(rest < 1e-28);
        let rule = edge(6);
        let onto = Projector::new(&rule, Shapes::of_facet(Element::P2, 2));
        let left = |f: &dyn Fn(f64) -> f64, expected: [f64; 3]| {
            let values: Vec<f64> = rule.points.iter().map(|b| f(b[1])).collect();
            let mut out = Vec::new();
            let rest = onto.split(&[(&values, 1.0)], &[1.0], &mut out);
            let off = out.iter().zip(expected).map(|(at, e)| (at - e).abs()).fold(0.0, f64::max);
            (off, rest)
        };
        let (off, rest) = left(&|x| x * (3.0 - x), [0.0, 2.0, 1.25]);
        assert!(off < 1e-14 && rest < 1e-28);
        // x³ less its best quadratic is the Legendre polynomial over 20, whose square has the mean 1/7.
        let (_, rest) = left(&|x| x.powi(3), [0.05, 0.95, 0.125]);
        assert!((rest - 1.0 / 2800.0).abs() < 1e-15, "{rest}");
    }
}
