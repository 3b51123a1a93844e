//! Projections of sampled fields onto the element. Index loops, since the inlined calls then vectorise.

use nalgebra::DMatrix;

use super::lanes::{Lanes, Number};
use super::reduction::{deviations, mean, remainders};
use super::shapes::Shapes;
use fem::space::Element;
use fem::space::quadrature::Rule;

/// L² projections by a rule, onto the strains and onto the functions of an element.
pub(super) struct Onto<'a> {
    rule: &'a Rule,
    /// None for linear elements, which have shortcuts.
    others: Option<[Projector; 2]>,
}

impl<'a> Onto<'a> {
    /// Onto those of cells.
    pub(super) fn new(element: Element, rule: &'a Rule) -> Self {
        let d = rule.points[0].len() - 1;
        Self::functions_of(element, rule, || {
            [Shapes::of_strains(element, d), Shapes::of_cell(element, d)]
        })
    }

    /// Onto the functions on facets; there are no strains.
    pub(super) fn facets(element: Element, rule: &'a Rule) -> Self {
        let d = rule.points[0].len();
        Self::functions_of(element, rule, || [(); 2].map(|()| Shapes::of_facet(element, d)))
    }

    fn functions_of(element: Element, rule: &'a Rule, functions: impl Fn() -> [Shapes; 2]) -> Self {
        let projectors = || functions().map(|functions| Projector::new(rule, &functions));
        Self { rule, others: (element != Element::P1).then(projectors) }
    }

    /// Replaces tensors point by point by their remainders; `out` are the projections, at the strain points.
    #[inline(always)]
    pub(super) fn strains<T: Number, const N: usize>(
        &self,
        values: &mut [[T; N]],
        out: &mut Vec<[T; N]>,
    ) {
        out.clear();
        match &self.others {
            None => out.push(deviations(values, &self.rule.weights)),
            Some([strains, _]) => {
                strains.values(values, out);
                strains.subtract(out, values);
            }
        }
    }

    /// The projections onto strains only.
    #[inline(always)]
    pub(super) fn of_strains<T: Number, const N: usize>(
        &self,
        values: &[[T; N]],
        out: &mut Vec<[T; N]>,
    ) {
        out.clear();
        match &self.others {
            None => out.push(mean(values, &self.rule.weights)),
            Some([strains, _]) => strains.values(values, out),
        }
    }

    /// Replaces vectors point by point by their remainders; `out` are the projections, at the nodes.
    #[inline(always)]
    pub(super) fn functions<T: Number, const N: usize, const C: usize>(
        &self,
        values: &mut [[T; N]],
        out: &mut Vec<[T; N]>,
    ) {
        out.clear();
        let Some([_, functions]) = &self.others else {
            let corners: [[T; C]; N] = remainders(values, self.rule);
            for a in 0..C {
                let mut corner_value = [T::from(0.0); N];
                for i in 0..N {
                    corner_value[i] = corners[i][a];
                }
                out.push(corner_value);
            }
            return;
        };
        functions.values(values, out);
        functions.subtract(out, values);
    }
}

/// A projection onto the span of some functions.
struct Projector {
    /// For each point the values of all functions.
    shape: Vec<Vec<f64>>,
    /// For each function the weights of the points in its coefficient.
    dual: Vec<Vec<f64>>,
}

impl Projector {
    fn new(rule: &Rule, functions: &Shapes) -> Self {
        let shape: Vec<Vec<f64>> = rule.points.iter().map(|b| functions.at(b)).collect();
        let (points, count) = (shape.len(), shape[0].len());
        let product = |i: usize, j: usize| {
            (0..points).map(|q| rule.weights[q] * shape[q][i] * shape[q][j]).sum::<f64>()
        };
        let gram = DMatrix::from_fn(count, count, product);
        let inverse = gram.try_inverse().expect("a rule that tells functions apart");
        let dual = |i: usize, q: usize| {
            rule.weights[q] * (0..count).map(|j| inverse[(i, j)] * shape[q][j]).sum::<f64>()
        };
        let dual = (0..count).map(|i| (0..points).map(|q| dual(i, q)).collect()).collect();
        Self { shape, dual }
    }

    #[inline(always)]
    fn values<T: Number, const N: usize>(&self, values: &[[T; N]], out: &mut Vec<[T; N]>) {
        for dual in &self.dual {
            out.push(mean(values, dual));
        }
    }

    #[inline(always)]
    fn subtract<T: Number, const N: usize>(&self, coefficients: &[[T; N]], values: &mut [[T; N]]) {
        for (value, shape) in values.iter_mut().zip(&self.shape) {
            for (coefficient, s) in coefficients.iter().zip(shape) {
                let s = T::from(*s);
                for i in 0..N {
                    value[i] -= coefficient[i] * s;
                }
            }
        }
    }
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
        onto.strains(&mut values, &mut out);
        let points = Element::P2.strain_rule(2).points;
        assert!(points.iter().zip(&out).all(|(b, at)| (at[0] - linear(b)[0]).abs() < 1e-14));
        assert!(values.iter().all(|[left]| left.abs() < 1e-14));
        let rule = edge(6);
        let onto = Onto::facets(Element::P2, &rule);
        let left = |f: &dyn Fn(f64) -> f64, expected: [f64; 3]| {
            let mut values: Vec<[f64; 1]> = rule.points.iter().map(|b| [f(b[1])]).collect();
            let mut out = Vec::new();
            onto.functions::<f64, 1, 2>(&mut values, &mut out);
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
