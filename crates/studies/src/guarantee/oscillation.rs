//! Constants of a triangle T with which loads orthogonal to linear functions act on strains, proved and explicit.
//!
//! Let v be a displacement less the rigid motion with its mean and its mean rotation ω. In the plane
//! ∂_x ω = ∂_x ε_xy - ∂_y ε_xx and ∂_y ω = ∂_x ε_yy - ∂_y ε_xy, so the Babuška–Aziz constant β of T bounds
//! ‖ω‖ ≤ ‖ε(v)‖/β, and ‖∇v‖² = ‖ε(v)‖² + 2‖ω‖² ≤ (1 + 2/β²) ‖ε(v)‖². On a domain in a disc of radius R that is
//! star-shaped with respect to the concentric disc of radius ρ, β ≥ ρ/(2R) (M. Costabel, M. Dauge, Arch. Ration.
//! Mech. Anal. 217 (2015)); here the discs are about the incentre. The inequality of Payne and Weinberger,
//! ‖v‖ ≤ (h/π) ‖∇v‖ on convex domains, gives ‖v‖_T; with x - p, p the corner opposite to an edge E at the height H, the
//! divergence theorem gives H ‖v‖²_E ≤ 2‖v‖² + 2h ‖v‖ ‖∇v‖.

use std::f64::consts::PI;

/// Constants C with ‖v‖ ≤ C ‖ε(v)‖_T for some rigid motion taken off.
pub(super) struct Constants {
    /// Of ‖v‖_T.
    pub inside: f64,
    /// Of ‖v‖_E for the edges opposite to each corner.
    pub on_edge: [f64; 3],
}

impl Constants {
    /// The constants of the triangle with these corners.
    pub(super) fn of(corners: &[[f64; 2]; 3]) -> Self {
        let distance = |a: [f64; 2], b: [f64; 2]| (a[0] - b[0]).hypot(a[1] - b[1]);
        let sides: [f64; 3] =
            std::array::from_fn(|s| distance(corners[(s + 1) % 3], corners[(s + 2) % 3]));
        let [a, b, c] = *corners;
        let twice = ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])).abs();
        let around: f64 = sides.iter().sum();
        let incentre: [f64; 2] =
            std::array::from_fn(|i| (0..3).map(|s| sides[s] * corners[s][i]).sum::<f64>() / around);
        let inner = twice / around;
        let outer = corners.iter().map(|&corner| distance(corner, incentre)).fold(0.0, f64::max);
        let beta = inner / (2.0 * outer);
        let korn = (1.0 + 2.0 / (beta * beta)).sqrt();
        let longest = sides.iter().copied().fold(0.0, f64::max);
        let inside = longest / PI * korn;
        let on_edge = sides.map(|side| {
            let height = twice / side;
            ((2.0 * inside * inside + 2.0 * longest * inside * korn) / height).sqrt()
        });
        Self { inside, on_edge }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Against quotients of polynomial displacements with their rigid motion taken off: none may exceed the constants,
    /// and those are no more than fifty times too large.
    #[test]
    fn no_displacement_exceeds_the_constants() {
        use fem::space::quadrature::{edge, triangle_product};
        let corners = [[0.1, 0.0], [0.6, 0.1], [0.2, 0.4]];
        let constants = Constants::of(&corners);
        let at = |b: &[f64]| -> [f64; 2] {
            std::array::from_fn(|i| (0..3).map(|a| b[a] * corners[a][i]).sum())
        };
        let (inside, along) = (triangle_product(6), edge(6));
        let mut most = 0.0f64;
        for (powers, component) in
            (0..=3).flat_map(|i| (0..=3 - i).map(move |j| (i, j))).flat_map(|p| [(p, 0), (p, 1)])
        {
            let v = |x: [f64; 2]| x[0].powi(powers.0) * x[1].powi(powers.1);
            let gradient = |x: [f64; 2]| {
                let (i, j) = powers;
                let dx = if i == 0 { 0.0 } else { f64::from(i) * x[0].powi(i - 1) * x[1].powi(j) };
                let dy = if j == 0 { 0.0 } else { f64::from(j) * x[0].powi(i) * x[1].powi(j - 1) };
                [dx, dy]
            };
            let mean = |f: &dyn Fn([f64; 2]) -> f64| -> f64 {
                inside.weights.iter().zip(&inside.points).map(|(w, b)| w * f(at(b))).sum()
            };
            let strain = mean(&|x| {
                let [dx, dy] = gradient(x);
                let (along, across) = if component == 0 { (dx, dy) } else { (dy, dx) };
                along * along + 0.5 * across * across
            });
            if strain < 1e-12 {
                continue;
            }
            // Taken off: the mean, and the rotation ω(-(y - ȳ), x - x̄) with the mean ω.
            let sign = if component == 0 { -0.5 } else { 0.5 };
            let omega = sign * mean(&|x| gradient(x)[1 - component]);
            let middle = [mean(&|x| x[0]), mean(&|x| x[1])];
            let average = mean(&v);
            let rest = |x: [f64; 2]| {
                let mut rest = [omega * (x[1] - middle[1]), -omega * (x[0] - middle[0])];
                rest[component] += v(x) - average;
                rest
            };
            let square = |x: [f64; 2]| {
                let [p, q] = rest(x);
                p * p + q * q
            };
            most = most.max((mean(&square) / strain).sqrt() / constants.inside);
            for s in 0..3 {
                let [from, to] = [corners[(s + 1) % 3], corners[(s + 2) % 3]];
                let length = (from[0] - to[0]).hypot(from[1] - to[1]);
                let on: f64 = along
                    .weights
                    .iter()
                    .zip(&along.points)
                    .map(|(w, b)| {
                        w * length * square(std::array::from_fn(|i| b[0] * from[i] + b[1] * to[i]))
                    })
                    .sum();
                let area = 0.5 * ((0.5 * 0.4) - (0.1 * 0.1));
                most = most.max((on / (strain * area)).sqrt() / constants.on_edge[s]);
            }
        }
        assert!((0.02..=1.0).contains(&most), "{most}");
    }
}
