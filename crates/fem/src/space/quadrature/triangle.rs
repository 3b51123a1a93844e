//! Rules on triangles.
//!
//! Source: Dunavant, Int. J. Numer. Meth. Eng. 21 (1985).

use super::rule::{Orbit, Rule, gauss_legendre};

fn three(weight: f64, a: f64) -> Orbit {
    (weight, vec![a, a, 1.0 - 2.0 * a])
}

fn six(weight: f64, a: f64, b: f64) -> Orbit {
    (weight, vec![a, b, 1.0 - a - b])
}

/// Triangle rule of 3 points, exact for degree 2: where the strains of quadratic elements live.
pub fn triangle_degree_2() -> Rule {
    let rule = Rule::symmetric(&[three(1.0 / 3.0, 1.0 / 6.0)]);
    // The first point is the one near the first corner.
    let points = [2, 1, 0].map(|a| rule.points[a].clone()).to_vec();
    Rule { points, ..rule }
}

/// Triangle rule of 6 points, exact for degree 4: the rule of loads given or in strong form.
pub fn triangle_degree_4() -> Rule {
    Rule::symmetric(&[
        three(0.223_381_589_678_011_47, 0.445_948_490_915_964_9),
        three(0.109_951_743_655_321_87, 0.091_576_213_509_770_74),
    ])
}

/// Triangle rule of 12 points, exact for degree 6: the rule of the errors, and of σ in loads.
pub fn triangle_degree_6() -> Rule {
    Rule::symmetric(&[
        three(0.116_786_275_726_379_37, 0.249_286_745_170_910_42),
        three(0.050_844_906_370_206_82, 0.063_089_014_491_502_23),
        six(0.082_851_075_618_373_58, 0.053_145_049_844_816_95, 0.310_352_451_033_784_4),
    ])
}

/// Triangle rule of 16 points, exact for degree 8: what the rule of the errors is compared with.
pub fn triangle_degree_8() -> Rule {
    Rule::symmetric(&[
        (0.144_315_607_677_787_17, vec![1.0 / 3.0; 3]),
        three(0.095_091_634_267_284_62, 0.459_292_588_292_723_1),
        three(0.103_217_370_534_718_24, 0.170_569_307_751_760_2),
        three(0.032_458_497_623_198_08, 0.050_547_228_317_030_98),
        six(0.027_230_314_174_434_994, 0.263_112_829_634_638_1, 0.008_394_777_409_957_605),
    ])
}

/// Triangle rule of `count`² points, exact for degree 2·count - 2: Gauss points of the square, of which
/// one edge is collapsed to a corner.
pub fn triangle_product(count: usize) -> Rule {
    let gauss: Vec<(f64, f64)> =
        gauss_legendre(count).iter().map(|(x, w)| (0.5 * (1.0 + x), 0.5 * w)).collect();
    let (mut points, mut weights) = (Vec::new(), Vec::new());
    for &(a, wa) in &gauss {
        for &(b, wb) in &gauss {
            let (p, q) = (a, (1.0 - a) * b);
            points.push(vec![1.0 - p - q, p, q]);
            weights.push(2.0 * wa * wb * (1.0 - a));
        }
    }
    Rule { points, weights }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// ∫ over the reference triangle of x^i y^j, divided by its area: 2 i! j! / (i+j+2)!.
    fn triangle_moment(i: u32, j: u32) -> f64 {
        let factorial = |m: u32| (1..=m).map(f64::from).product::<f64>();
        2.0 * factorial(i) * factorial(j) / factorial(i + j + 2)
    }

    fn integrate(rule: &Rule, i: u32, j: u32) -> f64 {
        rule.points
            .iter()
            .zip(&rule.weights)
            .map(|(p, w)| w * p[1].powi(i as i32) * p[2].powi(j as i32))
            .sum()
    }

    #[test]
    fn triangle_rules_have_exactly_their_degree() {
        let rules = [
            (triangle_degree_2(), 2),
            (triangle_degree_4(), 4),
            (triangle_degree_6(), 6),
            (triangle_degree_8(), 8),
            (triangle_product(4), 6),
        ];
        for (rule, degree) in rules {
            for total in 0..=degree {
                for i in 0..=total {
                    let error = integrate(&rule, i, total - i) - triangle_moment(i, total - i);
                    assert!(error.abs() < 1e-14, "degree {degree}, x^{i}: {error:e}");
                }
            }
            let beyond = integrate(&rule, degree + 1, 0) - triangle_moment(degree + 1, 0);
            assert!(beyond.abs() > 1e-8, "a degree {degree} rule that is exact beyond its degree");
        }
    }
}
