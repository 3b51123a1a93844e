//! Quadrature on simplices in barycentric coordinates; weights sum to one (times the measure).
//!
//! Gauss-Legendre on the interval is by Newton's iteration on the Legendre polynomial.

mod tetrahedron;
mod triangle;

use super::Element;

pub use tetrahedron::{
    tetrahedron_degree_2, tetrahedron_degree_5, tetrahedron_degree_6, tetrahedron_product,
};
pub use triangle::{
    triangle_degree_2, triangle_degree_4, triangle_degree_6, triangle_degree_8, triangle_product,
};

/// Points (barycentric) and weights.
#[derive(Debug, Clone, PartialEq)]
pub struct Rule {
    /// Barycentric coordinates of each point.
    pub points: Vec<Vec<f64>>,
    /// Weights, summing to one.
    pub weights: Vec<f64>,
}

/// The rules by which loads and moments of a truth are integrated.
#[derive(Debug, Clone)]
pub struct TruthRules {
    /// Loads in the cells, but for σ of an exact solution.
    pub load: Rule,
    /// σ of an exact solution in loads of the weak form: the rule of the moments, which have the means of σ.
    pub stress: Rule,
    /// Moments of the exact fields in the cells.
    pub error: Rule,
    /// Loads and moments of an exact solution on the sides.
    pub side: Rule,
    /// Tractions given as formulas.
    pub traction: Rule,
}

impl TruthRules {
    /// The rules in dimension 2 or 3: degrees 4 and 6 in the cells of the plane, 5 and 6 in space; in the plane 6 Gauss
    /// points on the sides, degree 11, beyond the 3 of the compliance rule, and 4 for tractions.
    pub fn of(dimension: usize) -> Self {
        let (load, error, side, traction) = match dimension {
            2 => (triangle_degree_4(), triangle_degree_6(), edge(6), edge(4)),
            _ => {
                let side = triangle_degree_6();
                (tetrahedron_degree_5(), tetrahedron_degree_6(), side.clone(), side)
            }
        };
        Self { load, stress: error.clone(), error, side, traction }
    }

    /// The rules for an element: for quadratic ones two degrees more in the cells, in space on the sides as well, and as many
    /// points as keep what a kink leaves out far below the smaller error.
    pub fn for_element(element: Element, dimension: usize) -> Self {
        let linear = Self::of(dimension);
        match element {
            Element::P1 | Element::CR => linear,
            Element::P2 if dimension == 2 => {
                linear.with_cells(triangle_degree_6(), triangle_product(5))
            }
            Element::P2 => linear
                .with_cells(tetrahedron_product(4), tetrahedron_product(5))
                .with_sides(triangle_degree_8()),
        }
    }

    /// The next rule of each of [`Self::for_element`].
    pub fn stronger_for(element: Element, dimension: usize) -> Self {
        let linear = Self::stronger(dimension);
        match element {
            Element::P1 | Element::CR => linear,
            Element::P2 if dimension == 2 => {
                linear.with_cells(triangle_degree_8(), triangle_product(7))
            }
            Element::P2 => linear
                .with_cells(tetrahedron_product(5), tetrahedron_product(6))
                .with_sides(triangle_product(6)),
        }
    }

    fn with_cells(self, load: Rule, error: Rule) -> Self {
        Self { load, stress: error.clone(), error, ..self }
    }

    fn with_sides(self, side: Rule) -> Self {
        Self { side: side.clone(), traction: side, ..self }
    }

    /// The next rule of each: what the usual one leaves out shows in the difference.
    pub fn stronger(dimension: usize) -> Self {
        let (load, error, side, traction) = match dimension {
            2 => (triangle_degree_6(), triangle_degree_8(), edge(8), edge(6)),
            _ => {
                let side = triangle_degree_8();
                (tetrahedron_degree_6(), tetrahedron_product(4), side.clone(), side)
            }
        };
        Self { load, stress: error.clone(), error, side, traction }
    }
}

/// Gauss-Legendre rule with `count` points on an edge, exact for degree 2·count - 1.
pub fn edge(count: usize) -> Rule {
    let (mut points, mut weights) = (Vec::new(), Vec::new());
    for (x, w) in gauss_legendre(count) {
        points.push(vec![0.5 * (1.0 - x), 0.5 * (1.0 + x)]);
        weights.push(0.5 * w);
    }
    Rule { points, weights }
}

/// Nodes and weights of the Gauss-Legendre rule on [-1, 1].
pub fn gauss_legendre(count: usize) -> Vec<(f64, f64)> {
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

#[cfg(test)]
mod tests {
    use super::*;

    impl Rule {
        /// The degree up to which all polynomials have their mean: of the powers b_1^i b_2^j … of degree i + j + … it is
        /// d! i! j! … / (d + i + j + …)!.
        fn degree(&self) -> usize {
            // A rule misses the next degree by 1e-8 and more; sums of a hundred terms below one are good to 1e-14.
            const MISSED: f64 = 1e-11;
            const MOST: usize = 64;
            let dimension = self.points.first().map_or(0, |point| point.len() - 1);
            let is_exact = |degree: &usize| {
                powers(dimension, *degree).iter().all(|powers| {
                    let term = |(point, weight): (&Vec<f64>, &f64)| {
                        let factors = point[1..].iter().zip(powers).map(|(b, p)| b.powi(*p as i32));
                        weight * factors.product::<f64>()
                    };
                    let mean: f64 = self.points.iter().zip(&self.weights).map(term).sum();
                    (mean - mean_of_powers(powers)).abs() <= MISSED
                })
            };
            (0..MOST).take_while(is_exact).last().unwrap_or(0)
        }
    }

    /// All lists of `count` powers whose sum is `degree`.
    fn powers(count: usize, degree: usize) -> Vec<Vec<usize>> {
        match count {
            0 => Vec::new(),
            1 => vec![vec![degree]],
            _ => (0..=degree)
                .flat_map(|first| {
                    let rest = powers(count - 1, degree - first);
                    rest.into_iter().map(move |rest| [vec![first], rest].concat())
                })
                .collect(),
        }
    }

    /// The mean of a product of powers of barycentric coordinates, all but one, over the simplex.
    fn mean_of_powers(powers: &[usize]) -> f64 {
        let factorial = |m: usize| (1..=m).map(|i| i as f64).product::<f64>();
        let (d, degree) = (powers.len(), powers.iter().sum::<usize>());
        powers.iter().map(|p| factorial(*p)).product::<f64>() * factorial(d) / factorial(d + degree)
    }

    #[test]
    fn degrees_are_found() {
        let rules = [
            (triangle_degree_4(), 4),
            (triangle_degree_6(), 6),
            (triangle_degree_8(), 8),
            (triangle_product(3), 4),
            (tetrahedron_degree_2(), 2),
            (tetrahedron_degree_5(), 5),
            (tetrahedron_degree_6(), 6),
            (tetrahedron_product(4), 7),
            (edge(5), 9),
        ];
        for (mut rule, degree) in rules {
            assert_eq!(rule.degree(), degree);
            rule.weights[0] += 1e-9;
            assert_eq!(rule.degree(), 0, "weights that do not sum to one");
        }
    }

    #[test]
    fn edge_rules_have_degree_twice_count_minus_one() {
        for count in 1..=16usize {
            let rule = edge(count);
            for degree in 0..2 * count {
                let sum: f64 = rule
                    .points
                    .iter()
                    .zip(&rule.weights)
                    .map(|(p, w)| w * p[1].powi(degree as i32))
                    .sum();
                assert!((sum - 1.0 / (degree + 1) as f64).abs() < 1e-14, "{count} {degree}");
            }
        }
    }
}
