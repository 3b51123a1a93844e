//! Rules on tetrahedra.

use super::rule::{Orbit, Rule, gauss_jacobi};

fn four(weight: f64, a: f64) -> Orbit {
    (weight, vec![1.0 - 3.0 * a, a, a, a])
}

fn six(weight: f64, a: f64) -> Orbit {
    (weight, vec![a, a, 0.5 - a, 0.5 - a])
}

/// Tetrahedron rule of 4 points, exact for degree 2: where quadratic elements have their strains, near the corners.
///
/// Source: P. C. Hammer, A. H. Stroud, Numerical integration over simplexes, Math. Tables Aids Comput. 10 (1956).
pub fn tetrahedron_degree_2() -> Rule {
    // 1 - 3a at its corner is 1/√5 more than a.
    Rule::symmetric(&[four(0.25, 0.25 * (1.0 - 0.2f64.sqrt()))])
}

/// Tetrahedron rule of 14 points, exact for degree 5: the rule of loads given or in strong form.
///
/// Source: the rule of this symmetry with positive weights, N. J. Walkington, Quadrature on simplices of
/// arbitrary dimension (2000).
pub fn tetrahedron_degree_5() -> Rule {
    Rule::symmetric(&[
        four(0.112_687_925_718_015_85, 0.310_885_919_263_300_6),
        four(0.073_493_043_116_361_95, 0.092_735_250_310_891_23),
        six(0.042_546_020_777_081_466, 0.045_503_704_125_649_65),
    ])
}

/// Tetrahedron rule of 24 points, exact for degree 6: the rule of the errors, and of σ in loads.
///
/// Source: P. Keast, Moderate-degree tetrahedral quadrature formulas, Comput. Methods Appl. Mech. Engrg. 55 (1986),
/// rule 7; its digits from the moment equations, solved anew.
pub fn tetrahedron_degree_6() -> Rule {
    let [a, b] = [0.063_661_001_875_017_53, 0.269_672_331_458_315_8];
    Rule::symmetric(&[
        four(0.039_922_750_258_167_49, 0.214_602_871_259_152_03),
        four(0.010_077_211_055_320_643, 0.040_673_958_534_611_35),
        four(0.055_357_181_543_654_72, 0.322_337_890_142_275_5),
        (27.0 / 560.0, vec![b, 1.0 - 2.0 * a - b, a, a]),
    ])
}

/// Tetrahedron rule of `count`³ points, exact for degree 2·count - 1: Gauss points of the cube, of which one face is
/// collapsed to an edge and that to a corner, by Gauss-Jacobi rules that hold the measure.
///
/// Source: A. H. Stroud, Approximate Calculation of Multiple Integrals (1971), conical products.
pub fn tetrahedron_product(count: usize) -> Rule {
    // On (0, 1).
    let gauss = |power| {
        let rule = gauss_jacobi(count, power).into_iter();
        rule.map(|(x, w)| (0.5 * (1.0 + x), 0.5 * w)).collect::<Vec<_>>()
    };
    let [first, second, third] = [2, 1, 0].map(gauss);
    let (mut points, mut weights) = (Vec::new(), Vec::new());
    for &(a, wa) in &first {
        for &(b, wb) in &second {
            for &(c, wc) in &third {
                let (p, q, r) = (a, (1.0 - a) * b, (1.0 - a) * (1.0 - b) * c);
                points.push(vec![1.0 - p - q - r, p, q, r]);
                weights.push(6.0 * wa * wb * wc);
            }
        }
    }
    Rule { points, weights }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// ∫ of x^i y^j z^l over the reference tetrahedron, divided by its volume: 6 i! j! l! / (i+j+l+3)!.
    #[test]
    fn tetrahedron_rules_have_exactly_their_degree() {
        let factorial = |m: i32| (1..=m).map(f64::from).product::<f64>();
        let off = |rule: &Rule, i: i32, j: i32, l: i32| {
            let power = |p: &Vec<f64>| p[1].powi(i) * p[2].powi(j) * p[3].powi(l);
            let sum: f64 = rule.points.iter().zip(&rule.weights).map(|(p, w)| w * power(p)).sum();
            let exact = factorial(i) * factorial(j) * factorial(l) / factorial(i + j + l + 3);
            (sum - 6.0 * exact).abs()
        };
        let rules =
            [(tetrahedron_degree_5(), 5), (tetrahedron_degree_6(), 6), (tetrahedron_product(4), 7)];
        for (rule, degree) in rules {
            for i in 0..=degree {
                for j in 0..=degree - i {
                    // Points and weights have 16 digits; sums have up to 64 terms.
                    let exact = |l: i32| off(&rule, i, j, l) < 4e-15;
                    assert!((0..=degree - i - j).all(exact), "{i} {j}");
                }
            }
            assert!(off(&rule, 0, 0, degree + 1).max(off(&rule, degree + 1, 0, 0)) > 1e-7);
            assert!(rule.weights.iter().all(|weight| *weight > 0.0));
        }
    }
}
