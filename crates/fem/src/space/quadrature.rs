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
        /// The degree up to which all polynomials have their mean.
        fn degree(&self) -> usize {
            // A rule misses the next degree by 1e-8 and more; sums of a hundred terms below one are good to 1e-14.
            const MISSED: f64 = 1e-11;
            const MOST: usize = 64;
            (0..MOST).take_while(|&degree| self.missed(degree) <= MISSED).last().unwrap_or(0)
        }
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
