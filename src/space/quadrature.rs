//! Quadrature on simplices in barycentric coordinates; weights sum to one (times the measure).
//!
//! Sources: Dunavant, Int. J. Numer. Meth. Eng. 21 (1985) for the triangle; Gauss-Legendre on the
//! interval by Newton's iteration on the Legendre polynomial.

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

/// A symmetric orbit of triangle points: the centre, (a, a, 1-2a) or (a, b, 1-a-b).
enum Orbit {
    Centre { weight: f64 },
    Three { weight: f64, a: f64 },
    Six { weight: f64, a: f64, b: f64 },
}

/// Triangle rule of 6 points, exact for degree 4: the rule of loads given or in strong form.
pub fn triangle_degree_4() -> Rule {
    triangle(&[
        Orbit::Three { weight: 0.223_381_589_678_011_47, a: 0.445_948_490_915_964_9 },
        Orbit::Three { weight: 0.109_951_743_655_321_87, a: 0.091_576_213_509_770_74 },
    ])
}

/// Triangle rule of 12 points, exact for degree 6: the rule of the errors, and of σ in loads.
pub fn triangle_degree_6() -> Rule {
    triangle(&[
        Orbit::Three { weight: 0.116_786_275_726_379_37, a: 0.249_286_745_170_910_42 },
        Orbit::Three { weight: 0.050_844_906_370_206_82, a: 0.063_089_014_491_502_23 },
        Orbit::Six {
            weight: 0.082_851_075_618_373_58,
            a: 0.053_145_049_844_816_95,
            b: 0.310_352_451_033_784_4,
        },
    ])
}

/// Triangle rule of 16 points, exact for degree 8: what the rule of the errors is compared with.
pub fn triangle_degree_8() -> Rule {
    triangle(&[
        Orbit::Centre { weight: 0.144_315_607_677_787_17 },
        Orbit::Three { weight: 0.095_091_634_267_284_62, a: 0.459_292_588_292_723_1 },
        Orbit::Three { weight: 0.103_217_370_534_718_24, a: 0.170_569_307_751_760_2 },
        Orbit::Three { weight: 0.032_458_497_623_198_08, a: 0.050_547_228_317_030_98 },
        Orbit::Six {
            weight: 0.027_230_314_174_434_994,
            a: 0.263_112_829_634_638_1,
            b: 0.008_394_777_409_957_605,
        },
    ])
}

fn triangle(orbits: &[Orbit]) -> Rule {
    let (mut points, mut weights) = (Vec::new(), Vec::new());
    for orbit in orbits {
        let (weight, images) = match *orbit {
            Orbit::Centre { weight } => (weight, vec![[1.0 / 3.0; 3]]),
            Orbit::Three { weight, a } => {
                let c = 1.0 - 2.0 * a;
                (weight, vec![[a, a, c], [a, c, a], [c, a, a]])
            }
            Orbit::Six { weight, a, b } => {
                let c = 1.0 - a - b;
                let images = vec![[a, b, c], [a, c, b], [b, a, c], [b, c, a], [c, a, b], [c, b, a]];
                (weight, images)
            }
        };
        for image in images {
            points.push(image.to_vec());
            weights.push(weight);
        }
    }
    Rule { points, weights }
}

/// Triangle rule of `count`² points, exact for degree 2·count - 2: Gauss points of the square, of which
/// one edge is collapsed to a corner.
pub fn triangle_product(count: usize) -> Rule {
    let gauss: Vec<(f64, f64)> =
        gauss_legendre(count).into_iter().map(|(x, w)| (0.5 * (1.0 + x), 0.5 * w)).collect();
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

/// A symmetric orbit of tetrahedron points: (a, a, a, 1-3a), (a, a, ½-a, ½-a) or (a, a, b, 1-2a-b).
enum SpatialOrbit {
    Four { weight: f64, a: f64 },
    Six { weight: f64, a: f64 },
    Twelve { weight: f64, a: f64, b: f64 },
}

/// Tetrahedron rule of 14 points, exact for degree 5: the rule of loads given or in strong form.
///
/// Source: the rule of this symmetry with positive weights, N. J. Walkington, Quadrature on simplices of
/// arbitrary dimension (2000).
pub fn tetrahedron_degree_5() -> Rule {
    tetrahedron(&[
        SpatialOrbit::Four { weight: 0.112_687_925_718_015_85, a: 0.310_885_919_263_300_6 },
        SpatialOrbit::Four { weight: 0.073_493_043_116_361_95, a: 0.092_735_250_310_891_23 },
        SpatialOrbit::Six { weight: 0.042_546_020_777_081_466, a: 0.045_503_704_125_649_65 },
    ])
}

/// Tetrahedron rule of 24 points, exact for degree 6: the rule of the errors, and of σ in loads.
///
/// Source: P. Keast, Moderate-degree tetrahedral quadrature formulas, Comput. Methods Appl. Mech. Engrg. 55 (1986),
/// rule 7; its digits from the moment equations, solved anew.
pub fn tetrahedron_degree_6() -> Rule {
    tetrahedron(&[
        SpatialOrbit::Four { weight: 0.039_922_750_258_167_49, a: 0.214_602_871_259_152_03 },
        SpatialOrbit::Four { weight: 0.010_077_211_055_320_643, a: 0.040_673_958_534_611_35 },
        SpatialOrbit::Four { weight: 0.055_357_181_543_654_72, a: 0.322_337_890_142_275_5 },
        SpatialOrbit::Twelve {
            weight: 27.0 / 560.0,
            a: 0.063_661_001_875_017_53,
            b: 0.269_672_331_458_315_8,
        },
    ])
}

fn tetrahedron(orbits: &[SpatialOrbit]) -> Rule {
    let (mut points, mut weights) = (Vec::new(), Vec::new());
    let mut put = |weight: f64, others: f64, own: &[(usize, f64)]| {
        let mut point = vec![others; 4];
        own.iter().for_each(|&(corner, value)| point[corner] = value);
        points.push(point);
        weights.push(weight);
    };
    for orbit in orbits {
        match *orbit {
            SpatialOrbit::Four { weight, a } => {
                (0..4).for_each(|p| put(weight, a, &[(p, 1.0 - 3.0 * a)]));
            }
            SpatialOrbit::Six { weight, a } => {
                for p in 0..4 {
                    (p + 1..4).for_each(|q| put(weight, 0.5 - a, &[(p, a), (q, a)]));
                }
            }
            SpatialOrbit::Twelve { weight, a, b } => {
                for p in 0..4 {
                    for q in (0..4).filter(|&q| q != p) {
                        put(weight, a, &[(p, b), (q, 1.0 - 2.0 * a - b)]);
                    }
                }
            }
        }
    }
    Rule { points, weights }
}

/// Tetrahedron rule of `count`³ points, exact for degree 2·count - 1: Gauss points of the cube, of which one face is
/// collapsed to an edge and that to a corner, by Gauss-Jacobi rules that hold the measure.
///
/// Source: A. H. Stroud, Approximate Calculation of Multiple Integrals (1971), conical products.
pub fn tetrahedron_product(count: usize) -> Rule {
    let [first, second, third] = [2, 1, 0].map(|power| gauss_jacobi(count, power));
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

/// Points and weights of ∫_0^1 (1-x)^p f(x) dx, exact for f of degree 2·count - 1: eigenvalues of the recurrence of the
/// Jacobi polynomials P^(p,0).
///
/// Source: G. H. Golub, J. H. Welsch, Math. Comp. 23 (1969) 221-230.
fn gauss_jacobi(count: usize, power: u32) -> Vec<(f64, f64)> {
    let p = f64::from(power);
    let recurrence = nalgebra::DMatrix::from_fn(count, count, |i, j| {
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
    let first = |i: usize| eigen.eigenvectors[(0, i)];
    (0..count).map(|i| (0.5 * (1.0 + eigen.eigenvalues[i]), first(i).powi(2) / (p + 1.0))).collect()
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

    #[test]
    fn triangle_rules_have_exactly_their_degree() {
        let rules = [
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
