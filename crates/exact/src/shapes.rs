//! Shape functions of an element on a simplex and the work of σ on them, independent of the solver's: from the places of
//! the nodes alone, as the polynomials that are one at a node and zero at the others.

use nalgebra::DMatrix;

use super::constitutive::Tensor;
use fem::space::Element;

/// Nodes of a cell of the most that an element may have: those of cubics on tetrahedra; likewise strain points.
pub(super) const MOST_NODES: usize = 20;
pub(super) const MOST_STRAINS: usize = 10;

/// The polynomials of degree p on a simplex that are one at a point and zero at others, Σ_α c_α b^α with |α| = p: products
/// of p barycentric coordinates span all of degree p, since Σ b_i = 1.
pub struct Shapes {
    powers: Vec<Vec<i32>>,
    /// Row a: c_α of function a.
    coefficients: Vec<Vec<f64>>,
}

impl Shapes {
    /// The shape functions of a cell.
    pub fn of_cell(element: Element, dimension: usize) -> Self {
        Self::through(&element.nodes(dimension + 1), element.degree())
    }

    /// Those of a facet.
    pub fn of_facet(element: Element, dimension: usize) -> Self {
        Self::through(&element.nodes(dimension), element.degree())
    }

    /// Of strains, at the strain points of a cell.
    pub(super) fn of_strains(element: Element, dimension: usize) -> Self {
        Self::through(&element.strain_rule(dimension).points, element.degree() - 1)
    }

    fn through(points: &[Vec<f64>], degree: usize) -> Self {
        let powers = powers(points[0].len(), degree as i32);
        let at = |p: usize, m: usize| product(&points[p], &powers[m]);
        let values = DMatrix::from_fn(points.len(), powers.len(), at);
        let inverse = values.try_inverse().expect("nodes that determine a polynomial");
        let row = |a| inverse.column(a).iter().copied().collect();
        Self { coefficients: (0..points.len()).map(row).collect(), powers }
    }

    /// Values at barycentric coordinates.
    pub fn at(&self, b: &[f64]) -> Vec<f64> {
        let mut values = Vec::with_capacity(self.coefficients.len());
        self.append_at(b, &mut values);
        values
    }

    pub(super) fn append_at(&self, b: &[f64], values: &mut Vec<f64>) {
        let mut terms = [0.0; MOST_NODES];
        terms.iter_mut().zip(&self.powers).for_each(|(term, powers)| *term = product(b, powers));
        let value = |row: &Vec<f64>| row.iter().zip(&terms).map(|(c, term)| c * term).sum::<f64>();
        values.extend(self.coefficients.iter().map(value));
    }

    /// ∂/∂b_i of each function, as if the coordinates were independent: ∇φ = Σ (∂φ/∂b_i) ∇b_i.
    pub fn slopes(&self, b: &[f64]) -> Vec<Vec<f64>> {
        let along = |i: usize, row: &Vec<f64>| -> f64 {
            let terms = self.derivatives(i, row);
            terms.map(|(c, powers)| c * product(b, &powers)).sum()
        };
        let of = |row| (0..b.len()).map(|i| along(i, row)).collect();
        self.coefficients.iter().map(of).collect()
    }

    fn derivatives<'a>(
        &'a self,
        i: usize,
        row: &'a [f64],
    ) -> impl Iterator<Item = (f64, Vec<i32>)> + use<'a> {
        let terms = row.iter().zip(&self.powers).filter(move |(_, powers)| powers[i] > 0);
        terms.map(move |(c, powers)| {
            let mut lower = powers.clone();
            lower[i] -= 1;
            (c * f64::from(powers[i]), lower)
        })
    }

    /// Means over the simplex.
    pub(super) fn means(&self) -> Vec<f64> {
        // Of quadratics some are zero, up to rounding of sums of six numbers.
        const NOTHING: f64 = 1e-14;
        let sum = |row: &Vec<f64>| -> f64 {
            row.iter().zip(&self.powers).map(|(c, powers)| c * mean(powers)).sum()
        };
        let snapped = |mean: f64| if mean.abs() < NOTHING { 0.0 } else { mean };
        self.coefficients.iter().map(|row| snapped(sum(row))).collect()
    }
}

/// All lists of `count` powers with this sum.
fn powers(count: usize, sum: i32) -> Vec<Vec<i32>> {
    if count == 1 {
        return vec![vec![sum]];
    }
    let with = |first: i32| {
        powers(count - 1, sum - first).into_iter().map(move |rest| [vec![first], rest].concat())
    };
    (0..=sum).rev().flat_map(with).collect()
}

fn product(b: &[f64], powers: &[i32]) -> f64 {
    b.iter().zip(powers).flat_map(|(b, &power)| (0..power).map(move |_| b)).product()
}

/// The mean of Π b_i^α_i over a simplex of dimension d: d! Π α_i!/(d + Σ α_i)!.
fn mean(powers: &[i32]) -> f64 {
    let factorial = |m: i32| (1..=m).map(f64::from).product::<f64>();
    let d = powers.len() as i32 - 1;
    let above: f64 = powers.iter().map(|&power| factorial(power)).product();
    factorial(d) * above / factorial(d + powers.iter().sum::<i32>())
}

/// ∫ σ·∇φ_a over a cell from the values of σ at its strain points: Σ σ(x_p) ∫ ψ_p (∂φ_a/∂b_i) ∇b_i with ψ_p of
/// [`Shapes::of_strains`].
pub(super) struct Work {
    points: usize,
    /// Node a, strain point p, corner i, and the mean of ψ_p ∂φ_a/∂b_i, where that is not zero.
    factors: Vec<(usize, usize, usize, f64)>,
}

impl Work {
    pub(super) fn new(element: Element, dimension: usize) -> Self {
        let strains = Shapes::of_strains(element, dimension);
        let functions = Shapes::of_cell(element, dimension);
        let (points, mut factors) = (strains.coefficients.len(), Vec::new());
        for (a, function) in functions.coefficients.iter().enumerate() {
            for (p, strain) in strains.coefficients.iter().enumerate() {
                for i in 0..=dimension {
                    let of_slope = |(slope, lower): (f64, Vec<i32>)| -> f64 {
                        let pairs = strain.iter().zip(&strains.powers);
                        let both = |powers: &Vec<i32>| -> Vec<i32> {
                            powers.iter().zip(&lower).map(|(a, b)| a + b).collect()
                        };
                        pairs.map(|(c, powers)| c * slope * mean(&both(powers))).sum()
                    };
                    let factor: f64 = functions.derivatives(i, function).map(of_slope).sum();
                    if factor != 0.0 {
                        factors.push((a, p, i, factor));
                    }
                }
            }
        }
        Self { points, factors }
    }

    /// Strain points a cell.
    pub(super) fn points(&self) -> usize {
        self.points
    }

    /// Visits nodes with what they add: `stress` are the values at the strain points, `inward` is ∫ ∇b_i of the corners.
    #[inline]
    pub(super) fn each<const D: usize>(
        &self,
        stress: &[Tensor<D>],
        inward: &[[f64; D]],
        mut visit: impl FnMut(usize, [f64; D]),
    ) {
        let mut along = [[[0.0; D]; 4]; MOST_STRAINS];
        for (along, tensor) in along.iter_mut().zip(stress) {
            for (along, normal) in along.iter_mut().zip(inward) {
                *along = tensor.map(|row| row.iter().zip(normal).map(|(s, n)| s * n).sum());
            }
        }
        for &(a, p, i, factor) in &self.factors {
            visit(a, along[p][i].map(|work| factor * work));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use fem::space::quadrature::{edge, triangle_degree_4};

    #[test]
    fn means_are_those_of_a_rule() {
        for element in Element::ALL {
            for (d, rule) in [(2, edge(4)), (3, triangle_degree_4())] {
                let functions = Shapes::of_facet(element, d);
                for (a, found) in functions.means().into_iter().enumerate() {
                    let values = rule.points.iter().zip(&rule.weights);
                    let mean: f64 = values.map(|(b, w)| w * functions.at(b)[a]).sum();
                    assert!((mean - found).abs() < 1e-15, "{element:?} {d} {a}");
                }
            }
        }
    }

    /// The functions of the solver, written another way, in its order.
    #[test]
    fn functions_are_those_of_the_solver() {
        for b in [vec![0.2, 0.5, 0.3], vec![0.1, 0.2, 0.3, 0.4]] {
            for element in Element::ALL {
                let functions = Shapes::of_cell(element, b.len() - 1);
                let pairs = functions.at(&b).into_iter().zip(element.values(&b));
                pairs.for_each(|(a, b)| assert!((a - b).abs() < 1e-15, "{element:?}: {a} {b}"));
            }
        }
    }

    /// Differences along an edge of the simplex, on which Σ b_i stays one.
    #[test]
    fn slopes_are_differences() {
        let (b, step) = ([0.1, 0.2, 0.3, 0.4], 1e-5);
        for element in Element::ALL {
            let functions = Shapes::of_cell(element, 3);
            let moved = |sign: f64| functions.at(&[0.1 - sign * step, 0.2, 0.3, 0.4 + sign * step]);
            let differences = moved(1.0).into_iter().zip(moved(-1.0));
            for (slopes, (ahead, behind)) in functions.slopes(&b).iter().zip(differences) {
                // Quadratic: central differences are exact but for rounding, 1e-16/1e-5.
                assert!(((ahead - behind) / (2.0 * step) - slopes[3] + slopes[0]).abs() < 1e-10);
            }
        }
    }

    /// Of σ = (1, x; x, y) on the unit triangle and v = (x², xy): σ:∇v = 2x + x (y + 0) + y x, of mean 2/3 + 1/6.
    #[test]
    fn work_on_quadratics_is_exact_for_linear_stresses() {
        let place = |b: &[f64]| [b[1], b[2]];
        let stress: Vec<Tensor<2>> = Element::P2
            .strain_rule(2)
            .points
            .iter()
            .map(|b| {
                let [x, y] = place(b);
                [[1.0, x], [x, y]]
            })
            .collect();
        let inward = [[-0.5, -0.5], [0.5, 0.0], [0.0, 0.5]];
        let nodes = Element::P2.nodes(3);
        let mut sum = 0.0;
        Work::new(Element::P2, 2).each(&stress, &inward, |a, force: [f64; 2]| {
            let [x, y] = place(&nodes[a]);
            sum += force[0] * x * x + force[1] * x * y;
        });
        assert!((sum - 0.5 * (2.0 / 3.0 + 1.0 / 6.0)).abs() < 1e-15, "{sum}");
    }
}
