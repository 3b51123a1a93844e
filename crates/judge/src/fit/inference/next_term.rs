//! Next terms of an error expansion: families with priors, on a grid of nodes.
//!
//! log e = c + p log h + g(z), z = h / (largest h kept); D is the size of the next term at z = 1, r its power:
//!
//! | family | g | reads |
//! |---|---|---|
//! | bend | log(1 + D z^r) | a further term of the expansion, of either sign |
//! | plateau | −log(1 + D z^r) | coarse meshes that do not resolve the solution yet |
//! | floor | log(1 + D (h/h_fine)^−r), r ≈ p | errors that end in an unstated floor |
//!
//! Nodes of D are so close that their spacing acts as a normal uncertainty, see [`Node::smoothing`].

use std::sync::LazyLock;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Family {
    /// 1 + D z^r as a factor.
    Bend,
    /// 1 + D z^r as a divisor.
    Plateau,
    /// A floor below the finest errors.
    Floor,
}

#[derive(Debug, Clone, Copy)]
pub(super) struct Node {
    pub(super) family: Family,
    pub(super) power: f64,
    /// D at z = 1; for a floor, at the finest h.
    size: f64,
    spacing: f64,
    pub(super) log_prior: f64,
}

/// Powers relative to the first term, with weights; theory gives halves and integers.
const BENDS: [(f64, f64); 6] =
    [(0.25, 0.02), (0.5, 0.14), (1.0, 0.42), (1.5, 0.08), (2.0, 0.22), (3.0, 0.04)];
const PLATEAUS: [(f64, f64); 5] = [(0.5, 0.02), (1.0, 0.02), (1.5, 0.01), (2.0, 0.02), (3.0, 0.01)];
const FLOORS: f64 = 0.03;
const FLOOR_POWERS: [f64; 21] = [
    0.5, 0.75, 1.0, 1.25, 1.5, 1.75, 2.0, 2.25, 2.5, 2.75, 3.0, 3.25, 3.5, 3.75, 4.0, 4.5, 5.0,
    5.5, 6.0, 7.0, 8.0,
];
/// Scale of bends: most are below one fifth at the coarsest level kept.
const BEND_SCALE: f64 = 0.2;
const BEND_RANGE: [f64; 2] = [-0.95, 60.0];
const BEND_NODES: usize = 33;
const PLATEAU_RANGE: [f64; 2] = [0.1, 300.0];
const PLATEAU_NODES: usize = 20;
const PLATEAU_CENTRE: f64 = 1.5;
const PLATEAU_SPREAD: f64 = 1.8;
const FLOOR_RANGE: [f64; 2] = [0.03, 10.0];
const FLOOR_NODES: usize = 9;
/// Standard deviation in spacings: 0.29 for a uniform distribution, and as much again for overlap.
const SMOOTHING: f64 = 0.55;
/// Bound of the term after the next, as a share of the next.
const AFTER: f64 = 0.3;
const AFTER_FLOOR: f64 = 0.1;
/// Standard deviation of p − r for a floor.
const FLATNESS: f64 = 0.15;
/// Prior of the order: mean and standard deviation.
const ORDER: [f64; 2] = [1.5, 2.5];

pub(super) static NODES: LazyLock<Vec<Node>> = LazyLock::new(|| {
    let mut nodes = Vec::new();
    // Uniform in asinh(10 D): fine around zero, wide in the tails.
    let scaled = BEND_RANGE.map(|size| (10.0 * size).asinh());
    let bends = grid(scaled, BEND_NODES, |t| {
        let (size, slope) = (t.sinh() / 10.0, t.cosh() / 10.0);
        (size, slope, slope / (1.0 + (size / BEND_SCALE).powi(2)))
    });
    let plateaus = grid(PLATEAU_RANGE.map(f64::ln), PLATEAU_NODES, |t| {
        let away = (t - PLATEAU_CENTRE.ln()) / PLATEAU_SPREAD;
        (t.exp(), t.exp(), (-0.5 * away * away).exp())
    });
    let floors = grid(FLOOR_RANGE.map(f64::ln), FLOOR_NODES, |t| (t.exp(), t.exp(), 1.0));
    let floor_weight = FLOORS / FLOOR_POWERS.len() as f64;
    let families = [
        (Family::Bend, BENDS.to_vec(), bends),
        (Family::Plateau, PLATEAUS.to_vec(), plateaus),
        (Family::Floor, FLOOR_POWERS.map(|power| (power, floor_weight)).to_vec(), floors),
    ];
    for (family, powers, sizes) in families {
        for (power, weight) in powers {
            let node = |&(size, spacing, share): &(f64, f64, f64)| {
                let log_prior = (weight * share).ln();
                Node { family, power, size, spacing, log_prior }
            };
            nodes.extend(sizes.iter().map(node));
        }
    }
    nodes
});

/// Sizes D with spacing and prior share; `at` gives D, dD/dt and a density at t.
fn grid(
    [first, last]: [f64; 2],
    count: usize,
    at: impl Fn(f64) -> (f64, f64, f64),
) -> Vec<(f64, f64, f64)> {
    let step = (last - first) / (count - 1) as f64;
    let found: Vec<_> = (0..count).map(|i| at(first + step * i as f64)).collect();
    let total: f64 = found.iter().map(|(.., density)| density).sum();
    found.into_iter().map(|(d, slope, density)| (d, step * slope, density / total)).collect()
}

impl Node {
    /// For |D| = 1: the next term and the one after it, at z = h/h_coarsest and y = h/h_fine.
    pub(super) fn powers(&self, z: f64, y: f64) -> [f64; 2] {
        match self.family {
            Family::Floor => [y.powf(-self.power), AFTER_FLOOR * z],
            Family::Bend | Family::Plateau => {
                let term = z.powf(self.power);
                [term, AFTER * term * term]
            }
        }
    }

    /// g, its uncertainty from the node spacing, and the term after the next, from [`Node::powers`].
    pub(super) fn terms(&self, [term, after]: [f64; 2]) -> [f64; 3] {
        let factor = 1.0 + self.size * term;
        let smoothing = SMOOTHING * self.spacing * term / factor;
        match self.family {
            Family::Plateau => [-factor.ln(), smoothing, after * self.size.min(1.0)],
            Family::Bend => [factor.ln(), smoothing, after * self.size.abs().min(1.0)],
            Family::Floor => [factor.ln(), smoothing, after],
        }
    }

    /// Prior mean and standard deviation of the order under this reading.
    pub(super) fn order(&self) -> [f64; 2] {
        match self.family {
            Family::Floor => [self.power, FLATNESS],
            Family::Bend | Family::Plateau => ORDER,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn priors_sum_to_their_weights_and_terms_to_their_definitions() {
        let total = |family| -> f64 {
            let of = NODES.iter().filter(|node| node.family == family);
            of.map(|node| node.log_prior.exp()).sum()
        };
        // 0.02 + 0.14 + 0.42 + 0.08 + 0.22 + 0.04, and 0.02 + 0.02 + 0.01 + 0.02 + 0.01.
        for (family, sum) in [(Family::Bend, 0.92), (Family::Plateau, 0.08), (Family::Floor, 0.03)]
        {
            assert!((total(family) - sum).abs() < 1e-12, "{family:?}");
        }
        for node in NODES.iter() {
            let [g, ..] = node.terms(node.powers(1.0, 4.0));
            let factor = match node.family {
                Family::Floor => 1.0 + node.size * 4f64.powf(-node.power),
                Family::Bend | Family::Plateau => 1.0 + node.size,
            };
            let sign = if node.family == Family::Plateau { -1.0 } else { 1.0 };
            assert!((g - sign * factor.ln()).abs() < 1e-12);
        }
    }

    #[test]
    fn smoothing_is_a_derivative_by_size() {
        for node in NODES.iter().step_by(17) {
            let by = 1e-6 * node.size.abs().max(0.01);
            let at = |size: f64| Node { size, ..*node }.terms(node.powers(0.5, 2.0))[0].abs();
            let [.., smoothing, _] = node.terms(node.powers(0.5, 2.0));
            let change = (at(node.size + by) - at(node.size - by)) / (2.0 * by);
            let expected = (SMOOTHING * node.spacing * change).abs();
            // Central differences: truncation 1e-12 relative, rounding 1e-10.
            assert!((smoothing.abs() - expected).abs() < 1e-5 * expected.max(1e-6));
        }
    }
}
