//! Shape functions of the elements on a simplex and the work of σ on them, independent of the solver's.

use super::constitutive::Tensor;
use fem::space::Element;

pub(super) const MOST_NODES: usize = 10;

/// End points of the midpoint nodes of a tetrahedron, in the order of its nodes; those of its first edge and facet come
/// first.
const BETWEEN: [[usize; 2]; 6] = [[0, 1], [1, 2], [2, 0], [0, 3], [1, 3], [2, 3]];

/// Ends of the edges with midpoint nodes of a simplex with so many corners.
pub(super) fn between(corners: usize) -> &'static [[usize; 2]] {
    &BETWEEN[..corners * (corners - 1) / 2]
}

/// Shape functions of a cell at barycentric coordinates: at corners, then at midpoints, or at barycentres of facets.
pub fn shapes(element: Element, b: &[f64]) -> Vec<f64> {
    match element {
        Element::P1 => b.to_vec(),
        Element::P2 => {
            // A quadratic is linear through the corners plus a bubble 4 b_i b_j per edge, which lifts the midpoint;
            // half of each bubble is subtracted at both ends.
            let mut all = b.to_vec();
            for &[i, j] in between(b.len()) {
                let bubble = 4.0 * b[i] * b[j];
                all[i] -= 0.5 * bubble;
                all[j] -= 0.5 * bubble;
                all.push(bubble);
            }
            all
        }
        // Linear, one on its facet and zero at the barycentres of the others: 1 - d at the corner opposite to it.
        Element::CR => {
            let d = b.len() - 1;
            (0..=d).map(|facet| 1.0 - d as f64 * b[opposite(facet, d)]).collect()
        }
    }
}

/// Those of a facet. Functions of Crouzeix and Raviart count by their means there.
pub fn facet_shapes(element: Element, b: &[f64]) -> Vec<f64> {
    match element {
        Element::P1 | Element::P2 => shapes(element, b),
        Element::CR => vec![1.0],
    }
}

/// The corner opposite to a facet of a cell: facets begin with corner 0, 1, … and go on in cyclic order.
fn opposite(facet: usize, d: usize) -> usize {
    if facet == 0 { d } else { facet - 1 }
}

/// Means of the shape functions over a facet in dimension d, as numerators per node and a common denominator.
pub(super) fn facet_means(element: Element, d: usize) -> (Vec<f64>, f64) {
    match element {
        Element::P1 => (vec![1.0; d], d as f64),
        // Of a linear function 1/d; of a bubble 2/3 on an edge and 1/3 on a triangle, half of which each end loses.
        Element::P2 if d == 2 => (vec![1.0, 1.0, 4.0], 6.0),
        Element::P2 => (vec![0.0, 0.0, 0.0, 1.0, 1.0, 1.0], 3.0),
        Element::CR => (vec![1.0], 1.0),
    }
}

/// Barycentric coordinates of the strain points of a cell: its centre for linear elements; for quadratic ones a point
/// near each corner, with all other coordinates equal.
pub(super) fn strain_places(element: Element, d: usize) -> Vec<Vec<f64>> {
    match element {
        Element::P1 | Element::CR => vec![vec![1.0 / (d + 1) as f64; d + 1]],
        Element::P2 => {
            let root = ((d + 2) as f64).sqrt();
            let (far, near) = (1.0 / ((d + 2) as f64 + root), 1.0 / root);
            let place = |corner: usize| {
                (0..=d).map(|b| if b == corner { far + near } else { far }).collect()
            };
            (0..=d).map(place).collect()
        }
    }
}

/// ∫ σ·∇φ_a of all nodes of a cell: `stress` is the projection of σ at its strain points, and `inward` is ∫ ∇λ_b of its
/// corners.
pub(super) fn work<const D: usize>(
    element: Element,
    stress: &[Tensor<D>],
    inward: &[[f64; D]],
    mut visit: impl FnMut(usize, [f64; D]),
) {
    let times = |tensor: &Tensor<D>, b: usize| -> [f64; D] {
        std::array::from_fn(|i| tensor[i].iter().zip(&inward[b]).map(|(s, n)| s * n).sum())
    };
    match element {
        Element::P1 => (0..inward.len()).for_each(|a| visit(a, times(&stress[0], a))),
        Element::CR => (0..=D).for_each(|facet| {
            visit(facet, times(&stress[0], opposite(facet, D)).map(|w| -(D as f64) * w));
        }),
        Element::P2 => {
            // Means of σ λ_b, from values at D + 1 points of equal weight: λ_b is 1/(D + 2 + √(D + 2)), plus 1/√(D + 2)
            // at the point of corner b. On triangles that is 1/6 and 2/3.
            let root = ((D + 2) as f64).sqrt();
            let moment = |b: usize| -> Tensor<D> {
                let of = |i: usize, j: usize| {
                    let all: f64 = stress.iter().map(|s| s[i][j]).sum();
                    (all / ((D + 2) as f64 + root) + stress[b][i][j] / root) / (D + 1) as f64
                };
                std::array::from_fn(|i| std::array::from_fn(|j| of(i, j)))
            };
            let moments: Vec<Tensor<D>> = (0..inward.len()).map(moment).collect();
            // ∇φ_a = ∇λ_a - 2 Σ_b ∇(λ_a λ_b), ∇φ_ab = 4 ∇(λ_a λ_b), and Σ λ_b is one.
            for a in 0..inward.len() {
                let mut at_corner = [0.0; D];
                for (b, moment) in moments.iter().enumerate() {
                    let factor = if b == a { 3.0 } else { -1.0 };
                    at_corner
                        .iter_mut()
                        .zip(times(moment, a))
                        .for_each(|(at_corner, w)| *at_corner += factor * w);
                }
                visit(a, at_corner);
            }
            for (edge, &[a, b]) in between(inward.len()).iter().enumerate() {
                let (p, q) = (times(&moments[a], b), times(&moments[b], a));
                visit(inward.len() + edge, std::array::from_fn(|i| 4.0 * (p[i] + q[i])));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use fem::space::quadrature::{edge, triangle_degree_4};

    #[test]
    fn means_and_places_are_those_of_a_rule() {
        for element in Element::ALL {
            for (d, rule) in [(2, edge(4)), (3, triangle_degree_4())] {
                let (parts, sum) = facet_means(element, d);
                for (a, part) in parts.iter().enumerate() {
                    let values = rule.points.iter().zip(&rule.weights);
                    let mean: f64 = values.map(|(b, w)| w * facet_shapes(element, b)[a]).sum();
                    assert!((mean - part / sum).abs() < 1e-15, "{element:?} {d} {a}");
                }
                let places = strain_places(element, d);
                let known = element.strain_rule(d).points;
                assert_eq!(places.len(), known.len());
                let pairs = places.iter().flatten().zip(known.iter().flatten());
                pairs.for_each(|(a, b)| assert!((a - b).abs() < 1e-15, "{places:?}"));
            }
        }
    }

    /// The functions of the solver, written another way, in its order.
    #[test]
    fn functions_are_those_of_the_solver() {
        for b in [vec![0.2, 0.5, 0.3], vec![0.1, 0.2, 0.3, 0.4]] {
            for element in Element::ALL {
                let pairs = shapes(element, &b).into_iter().zip(element.values(&b));
                pairs.for_each(|(a, b)| assert!((a - b).abs() < 1e-15, "{element:?}: {a} {b}"));
            }
        }
    }

    /// Of σ = (1, x; x, y) on the unit triangle and v = (x², xy): σ:∇v = 2x + x (y + 0) + y x, of mean 2/3 + 1/6.
    #[test]
    fn work_on_quadratics_is_exact_for_linear_stresses() {
        let place = |b: [f64; 3]| [b[1], b[2]];
        let near =
            [0, 1, 2].map(|c| std::array::from_fn(|a| if a == c { 2.0 / 3.0 } else { 1.0 / 6.0 }));
        let stress = near.map(|b| {
            let [x, y] = place(b);
            [[1.0, x], [x, y]]
        });
        let inward = [[-0.5, -0.5], [0.5, 0.0], [0.0, 0.5]];
        let nodes = [
            [1.0, 0.0, 0.0],
            [0.0, 1.0, 0.0],
            [0.0, 0.0, 1.0],
            [0.5, 0.5, 0.0],
            [0.0, 0.5, 0.5],
            [0.5, 0.0, 0.5],
        ];
        let mut sum = 0.0;
        work(Element::P2, &stress, &inward, |a, force: [f64; 2]| {
            let [x, y] = place(nodes[a]);
            sum += force[0] * x * x + force[1] * x * y;
        });
        assert!((sum - 0.5 * (2.0 / 3.0 + 1.0 / 6.0)).abs() < 1e-15, "{sum}");
        for (a, b) in nodes.iter().enumerate() {
            let at = shapes(Element::P2, b);
            assert!(at.iter().enumerate().all(|(i, s)| *s == f64::from(u8::from(i == a))));
        }
    }
}
