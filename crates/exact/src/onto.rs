//! Projections of sampled fields onto the element. Index loops, since the inlined calls then vectorise.

use std::sync::Arc;

use nalgebra::DMatrix;

use super::lanes::{Lanes, Number};
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
    /// The values of all functions, point by point.
    shape: Vec<f64>,
    /// The weights of all points in the coefficients, function by function.
    dual: Vec<f64>,
    points: usize,
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
        Self { functions, inverse, count, shape, dual, points: weights.len() }
    }

    /// The coefficients of sampled values.
    #[inline(always)]
    pub(super) fn project<T: Number, const N: usize>(
        &self,
        values: &[[T; N]],
        out: &mut Vec<[T; N]>,
    ) {
        out.clear();
        for dual in self.dual.chunks_exact(self.points) {
            let mut sum = [T::from(0.0); N];
            for (value, weight) in values.iter().zip(dual) {
                let weight = T::from(*weight);
                for i in 0..N {
                    sum[i] = sum[i] + weight * value[i];
                }
            }
            out.push(sum);
        }
    }

    /// Replaces values point by point by their remainders; `out` are the coefficients.
    #[inline(always)]
    pub(super) fn split<T: Number, const N: usize>(
        &self,
        values: &mut [[T; N]],
        out: &mut Vec<[T; N]>,
    ) {
        self.project(values, out);
        for (value, shape) in values.iter_mut().zip(self.shape.chunks_exact(self.count)) {
            for (coefficient, s) in out.iter().zip(shape) {
                let s = T::from(*s);
                for i in 0..N {
                    value[i] = value[i] - coefficient[i] * s;
                }
            }
        }
    }
}

fn values(functions: &Shapes, rule: &Rule) -> Vec<f64> {
    let mut values = Vec::new();
    rule.points.iter().for_each(|b| functions.append_at(b, &mut values));
    values
}

/// Appends the numbers of the first cells, cell by cell, and within a cell place by place.
#[inline(always)]
pub(super) fn append<const N: usize>(all: &mut Vec<f64>, cells: usize, places: &[[Lanes; N]]) {
    for l in 0..cells {
        for numbers in places {
            let mut of_cell = [0.0; N];
            for i in 0..N {
                of_cell[i] = numbers[i].0[l];
            }
            all.extend_from_slice(&of_cell);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use fem::space::quadrature::{edge, triangle_degree_6};

    /// Linear tensors and quadratic vectors have no remainder; a cubic has one.
    #[test]
    fn what_the_element_has_is_given_back() {
        let rule = triangle_degree_6();
        let onto = Onto::new(Element::P2, &rule);
        let linear = |b: &[f64]| [1.0 + 2.0 * b[1] - 3.0 * b[2]];
        let mut values: Vec<[f64; 1]> = rule.points.iter().map(|b| linear(b)).collect();
        let mut out = Vec::new();
        onto.strains.split(&mut values, &mut out);
        let points = Element::P2.strain_rule(2).points;
        assert!(points.iter().zip(&out).all(|(b, at)| (at[0] - linear(b)[0]).abs() < 1e-14));
        assert!(values.iter().all(|[left]| left.abs() < 1e-14));
        let rule = edge(6);
        let onto = Projector::new(&rule, Shapes::of_facet(Element::P2, 2));
        let left = |f: &dyn Fn(f64) -> f64, expected: [f64; 3]| {
            let mut values: Vec<[f64; 1]> = rule.points.iter().map(|b| [f(b[1])]).collect();
            let mut out = Vec::new();
            onto.split(&mut values, &mut out);
            let off = out.iter().zip(expected).map(|(at, e)| (at[0] - e).abs()).fold(0.0, f64::max);
            let weights = values.iter().zip(&rule.weights);
            (off, weights.map(|([left], w)| w * left * left).sum::<f64>())
        };
        let (off, rest) = left(&|x| x * (3.0 - x), [0.0, 2.0, 1.25]);
        assert!(off < 1e-14 && rest < 1e-28);
        // x³ less its best quadratic is the Legendre polynomial over 20, whose square has the mean 1/7.
        let (_, rest) = left(&|x| x.powi(3), [0.05, 0.95, 0.125]);
        assert!((rest - 1.0 / 2800.0).abs() < 1e-15, "{rest}");
    }
}
