//! Quadrature on simplices in barycentric coordinates; weights sum to one (times the measure).

mod rule;
mod tetrahedron;
mod triangle;
mod truth;

pub use rule::{Rule, edge, gauss_legendre};
pub use tetrahedron::{
    tetrahedron_degree_2, tetrahedron_degree_5, tetrahedron_degree_6, tetrahedron_product,
};
pub use triangle::{
    triangle_degree_2, triangle_degree_4, triangle_degree_6, triangle_degree_8, triangle_product,
};
pub use truth::TruthRules;

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
