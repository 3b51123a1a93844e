//! A rule, and those on an edge by the rules of Gauss and Jacobi.

use std::sync::OnceLock;

use nalgebra::DMatrix;

/// Points (barycentric) and weights.
#[derive(Debug, Clone, PartialEq)]
pub struct Rule {
    /// Barycentric coordinates of each point.
    pub points: Vec<Vec<f64>>,
    /// Weights, summing to one.
    pub weights: Vec<f64>,
}

impl Rule {
    /// The barycentre of a simplex: degree 1.
    pub fn barycentre(dimension: usize) -> Self {
        let share = 1.0 / (dimension + 1) as f64;
        Self { points: vec![vec![share; dimension + 1]], weights: vec![1.0] }
    }

    /// The rule with all images of some points, by the symmetries of the simplex.
    pub(super) fn symmetric(orbits: &[Orbit]) -> Self {
        let (mut points, mut weights) = (Vec::new(), Vec::new());
        for (weight, first) in orbits {
            for image in orders(first) {
                // Where coordinates are the same, so are images.
                if !points.contains(&image) {
                    points.push(image);
                    weights.push(*weight);
                }
            }
        }
        Self { points, weights }
    }

    /// The largest distance from the mean of a product of `degree` barycentric coordinates: zero if the rule is exact for
    /// all polynomials of this degree.
    #[cfg(test)]
    pub(crate) fn missed(&self, degree: usize) -> f64 {
        use crate::space::polynomials::{means, monomials};
        let corners = self.points.first().map_or(1, Vec::len);
        let mut off: Vec<f64> = means(degree, corners);
        for (b, weight) in self.points.iter().zip(&self.weights) {
            off.iter_mut().zip(monomials(degree, b)).for_each(|(off, term)| *off -= weight * term);
        }
        algebra::linalg::largest(&off)
    }
}

/// The weight of each image of a point of a simplex, and the barycentric coordinates of one.
pub(super) type Orbit = (f64, Vec<f64>);

/// Some numbers in all orders.
fn orders(numbers: &[f64]) -> Vec<Vec<f64>> {
    let with_first = |first: usize| {
        let mut others = numbers.to_vec();
        let first = others.remove(first);
        orders(&others).into_iter().map(move |others| [vec![first], others].concat())
    };
    match numbers {
        [] => vec![Vec::new()],
        _ => (0..numbers.len()).flat_map(with_first).collect(),
    }
}

/// Gauss-Legendre rule with `count` points on an edge, exact for degree 2·count - 1.
pub fn edge(count: usize) -> Rule {
    let (mut points, mut weights) = (Vec::new(), Vec::new());
    for &(x, w) in gauss_legendre(count) {
        points.push(vec![0.5 * (1.0 - x), 0.5 * (1.0 + x)]);
        weights.push(0.5 * w);
    }
    Rule { points, weights }
}

/// Nodes and weights of the Gauss-Legendre rule on [-1, 1] with `count` < 128 points, made once: many ask for it on
/// every piece.
pub fn gauss_legendre(count: usize) -> &'static [(f64, f64)] {
    static RULES: [OnceLock<Vec<(f64, f64)>>; 128] = [const { OnceLock::new() }; 128];
    RULES[count].get_or_init(|| gauss_jacobi(count, 0))
}

/// Nodes x and weights of ∫_{-1}^1 ((1-x)/2)^p f(x) dx in increasing order, exact for f of degree 2·count - 1: eigenvalues
/// of the recurrence of the Jacobi polynomials P^(p,0), and first components of their vectors.
///
/// Source: G. H. Golub, J. H. Welsch, Math. Comp. 23 (1969) 221-230.
pub(super) fn gauss_jacobi(count: usize, power: u32) -> Vec<(f64, f64)> {
    let p = f64::from(power);
    let recurrence = DMatrix::from_fn(count, count, |i, j| {
        let n = i.max(j) as f64;
        let s = 2.0 * n + p;
        match i.abs_diff(j) {
            0 if i == 0 => -p / (p + 2.0),
            0 => -p * p / (s * (s + 2.0)),
            1 => 2.0 * n * (n + p) / (s * ((s + 1.0) * (s - 1.0)).sqrt()),
            _ => 0.0,
        }
    });
    let eigen = recurrence.symmetric_eigen();
    let weight = |i: usize| 2.0 / (p + 1.0) * eigen.eigenvectors[(0, i)].powi(2);
    let mut rule: Vec<_> = (0..count).map(|i| (eigen.eigenvalues[i], weight(i))).collect();
    rule.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
    rule
}
