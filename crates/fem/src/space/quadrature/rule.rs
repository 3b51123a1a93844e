//! A rule, and those on an edge: Gauss-Legendre by Newton's iteration on the Legendre polynomial.

use std::sync::OnceLock;

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
    RULES[count].get_or_init(|| roots_and_weights(count))
}

fn roots_and_weights(count: usize) -> Vec<(f64, f64)> {
    let n = count as f64;
    (0..count)
        .map(|i| {
            let mut x = -(std::f64::consts::PI * (i as f64 + 0.75) / (n + 0.5)).cos();
            let mut slope = 1.0;
            // Newton from Tricomi's estimate doubles its digits: six rounds are more than enough.
            for _ in 0..6 {
                let (mut p, mut before) = (1.0, 0.0);
                for j in 1..=count {
                    let j = j as f64;
                    (p, before) = (((2.0 * j - 1.0) * x * p - (j - 1.0) * before) / j, p);
                }
                slope = n * (x * p - before) / (x * x - 1.0);
                x -= p / slope;
            }
            (x, 2.0 / ((1.0 - x * x) * slope * slope))
        })
        .collect()
}
