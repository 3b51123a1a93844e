//! Quadrature on simplices in barycentric coordinates; weights sum to one (times the measure).
//!
//! Rules on triangles: D. A. Dunavant, Int. J. Numer. Meth. Eng. 21 (1985).

use std::sync::OnceLock;

use nalgebra::DMatrix;

use super::Element;

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
    fn symmetric(orbits: &[Orbit]) -> Self {
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
type Orbit = (f64, Vec<f64>);

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
fn gauss_jacobi(count: usize, power: u32) -> Vec<(f64, f64)> {
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

fn three_images(weight: f64, a: f64) -> Orbit {
    (weight, vec![a, a, 1.0 - 2.0 * a])
}

fn six_images(weight: f64, a: f64, b: f64) -> Orbit {
    (weight, vec![a, b, 1.0 - a - b])
}

/// Triangle rule of 3 points, exact for degree 2: where the strains of quadratic elements live.
pub fn triangle_degree_2() -> Rule {
    let rule = Rule::symmetric(&[three_images(1.0 / 3.0, 1.0 / 6.0)]);
    // The first point is the one near the first corner.
    let points = [2, 1, 0].map(|a| rule.points[a].clone()).to_vec();
    Rule { points, ..rule }
}

/// Triangle rule of 6 points, exact for degree 4: the rule of loads given or in strong form.
pub fn triangle_degree_4() -> Rule {
    Rule::symmetric(&[
        three_images(0.223_381_589_678_011_47, 0.445_948_490_915_964_9),
        three_images(0.109_951_743_655_321_87, 0.091_576_213_509_770_74),
    ])
}

/// Triangle rule of 12 points, exact for degree 6: the rule of the errors, and of σ in loads.
pub fn triangle_degree_6() -> Rule {
    Rule::symmetric(&[
        three_images(0.116_786_275_726_379_37, 0.249_286_745_170_910_42),
        three_images(0.050_844_906_370_206_82, 0.063_089_014_491_502_23),
        six_images(0.082_851_075_618_373_58, 0.053_145_049_844_816_95, 0.310_352_451_033_784_4),
    ])
}

/// Triangle rule of 16 points, exact for degree 8: what the rule of the errors is compared with.
pub fn triangle_degree_8() -> Rule {
    Rule::symmetric(&[
        (0.144_315_607_677_787_17, vec![1.0 / 3.0; 3]),
        three_images(0.095_091_634_267_284_62, 0.459_292_588_292_723_1),
        three_images(0.103_217_370_534_718_24, 0.170_569_307_751_760_2),
        three_images(0.032_458_497_623_198_08, 0.050_547_228_317_030_98),
        six_images(0.027_230_314_174_434_994, 0.263_112_829_634_638_1, 0.008_394_777_409_957_605),
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

fn four_images(weight: f64, a: f64) -> Orbit {
    (weight, vec![1.0 - 3.0 * a, a, a, a])
}

fn six_of_edges(weight: f64, a: f64) -> Orbit {
    (weight, vec![a, a, 0.5 - a, 0.5 - a])
}

/// Tetrahedron rule of 4 points, exact for degree 2: where quadratic elements have their strains, near the corners.
///
/// Source: P. C. Hammer, A. H. Stroud, Numerical integration over simplexes, Math. Tables Aids Comput. 10 (1956).
pub fn tetrahedron_degree_2() -> Rule {
    // 1 - 3a at its corner is 1/√5 more than a.
    Rule::symmetric(&[four_images(0.25, 0.25 * (1.0 - 0.2f64.sqrt()))])
}

/// Tetrahedron rule of 14 points, exact for degree 5: the rule of loads given or in strong form.
///
/// Source: the rule of this symmetry with positive weights, N. J. Walkington, Quadrature on simplices of
/// arbitrary dimension (2000).
pub fn tetrahedron_degree_5() -> Rule {
    Rule::symmetric(&[
        four_images(0.112_687_925_718_015_85, 0.310_885_919_263_300_6),
        four_images(0.073_493_043_116_361_95, 0.092_735_250_310_891_23),
        six_of_edges(0.042_546_020_777_081_466, 0.045_503_704_125_649_65),
    ])
}

/// Tetrahedron rule of 24 points, exact for degree 6: the rule of the errors, and of σ in loads.
///
/// Source: P. Keast, Moderate-degree tetrahedral quadrature formulas, Comput. Methods Appl. Mech. Engrg. 55 (1986),
/// rule 7; its digits from the moment equations, solved anew.
pub fn tetrahedron_degree_6() -> Rule {
    let [a, b] = [0.063_661_001_875_017_53, 0.269_672_331_458_315_8];
    Rule::symmetric(&[
        four_images(0.039_922_750_258_167_49, 0.214_602_871_259_152_03),
        four_images(0.010_077_211_055_320_643, 0.040_673_958_534_611_35),
        four_images(0.055_357_181_543_654_72, 0.322_337_890_142_275_5),
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
    /// The rules for linear elements in dimension 2 or 3: degrees 4 and 6 in the cells of the plane, 5 and 6 in space; in the
    /// plane 6 Gauss points on the sides, degree 11, beyond the 3 of the compliance rule, and 4 for tractions.
    pub fn of(dimension: usize) -> Self {
        Self::by(1, dimension, 0)
    }

    /// The rules for an element: for quadratic ones two degrees more in the cells, in space on the sides as well, and as many
    /// points as keep what a kink leaves out far below the smaller error; of higher degree p for polynomials of degree
    /// 2p + 4 and more.
    pub fn for_element(element: Element, dimension: usize) -> Self {
        Self::by(element.degree(), dimension, 0)
    }

    /// The next rule of each of [`Self::for_element`]: what the usual one leaves out shows in the difference.
    pub fn stronger_for(element: Element, dimension: usize) -> Self {
        Self::by(element.degree(), dimension, 1)
    }

    /// The usual rules for elements of degree p, or with `next` = 1 the next ones.
    fn by(p: usize, dimension: usize, next: usize) -> Self {
        let triangle = |degree: usize| match degree {
            4 => triangle_degree_4(),
            6 => triangle_degree_6(),
            _ => triangle_degree_8(),
        };
        let more = 2 * next;
        let (load, error) = match (dimension, p) {
            (2, ..=1) => (triangle(4 + more), triangle(6 + more)),
            (2, 2) => (triangle(6 + more), triangle_product(5 + more)),
            (2, _) => (triangle_product(p + 3 + more), triangle_product(p + 4 + more)),
            (_, ..=1) if next == 0 => (tetrahedron_degree_5(), tetrahedron_degree_6()),
            (_, ..=1) => (tetrahedron_degree_6(), tetrahedron_product(4)),
            _ => (tetrahedron_product(p + 2 + next), tetrahedron_product(p + 3 + next)),
        };
        let side = match (dimension, p) {
            (2, _) => edge(6 + more),
            (_, ..=1) => triangle(6 + more),
            (_, 2) if next == 0 => triangle(8),
            _ => triangle_product(p + 3 + next),
        };
        let traction = if dimension == 2 { edge(4 + more) } else { side.clone() };
        Self { load, stress: error.clone(), error, side, traction }
    }
}

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
