//! What multiplies the leading term: families with priors, on a grid of nodes.
//!
//! log e = c + p log h + g(z), z = h / (largest h kept); D is the size of the next term at z = 1, r its power:
//!
//! | family | g | reads |
//! |---|---|---|
//! | bend | log abs(1 + D z^r) | a further term of the expansion, none, or one that outweighs the first on coarse meshes |
//! | plateau | −log(1 + D z^r) | coarse meshes that do not resolve the solution yet |
//! | floor | log(1 + D (h/h_a)^−p) | errors that end in an unstated floor, of the first term's size near the step h_a |
//! | scattered | the same | a floor that is another one at every level, as a tolerance of a solver leaves it |
//! | slow | log(1 + D (h/h_fine)^r), D > 1 | a slower power that is still small |
//! | reference | log(1 − D (h/h_fine)^−p), or the same of squares | errors against a finer run |
//!
//! Nodes of D and r are so close that their spacing acts as a normal uncertainty, see [`Node::terms`]. Where g depends on p, it
//! is linear in p about r.

use std::sync::LazyLock;

use super::evidence::NUISANCES;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Family {
    /// 1 + D z^r as a factor.
    Bend,
    /// 1 + D z^r as a divisor.
    Plateau,
    /// A constant that is added.
    Floor,
    /// A constant that scatters from level to level.
    Scattered,
    /// The error of a reference that is subtracted.
    Reference,
    /// The same of squares: where errors are orthogonal.
    ReferenceSquares,
    /// A bend stated at the finest step, where it outweighs the first term: a slower power is about to take over.
    Slow,
}

impl Family {
    /// r stands for the order itself: D is stated at a fine step, and the further levels must show it.
    pub(super) fn at_the_fine_end(self) -> bool {
        !matches!(self, Self::Bend | Self::Plateau | Self::Slow)
    }

    pub(super) fn is_reference(self) -> bool {
        matches!(self, Self::Reference | Self::ReferenceSquares)
    }
}

#[derive(Debug, Clone, Copy)]
pub(super) struct Node {
    pub(super) family: Family,
    pub(super) power: f64,
    /// Standard deviation of the power within the list.
    power_spread: f64,
    /// D at z = 1.
    pub(super) size: f64,
    spacing: f64,
    pub(super) log_prior: f64,
    /// D stands at an end of its list beyond which it may go on.
    pub(super) last: bool,
}

/// Powers relative to the first term, with weights and half their spacing; theory gives halves and integers, corners any.
const BENDS: [(f64, f64, f64); 9] = [
    (0.25, 0.02, 0.06),
    (0.5, 0.13, 0.1),
    (0.75, 0.04, 0.1),
    (1.0, 0.36, 0.1),
    (1.25, 0.03, 0.1),
    (1.5, 0.07, 0.1),
    (2.0, 0.20, 0.2),
    (2.5, 0.03, 0.2),
    (3.0, 0.04, 0.4),
];
const PLATEAUS: [(f64, f64, f64); 5] =
    [(0.5, 0.02, 0.1), (1.0, 0.02, 0.2), (1.5, 0.01, 0.2), (2.0, 0.02, 0.2), (3.0, 0.01, 0.4)];
/// Prior of no next term.
const STRAIGHT: f64 = 0.25;
/// Above this noise a straight line is so many times likelier, and a slow term so many times less.
const FINE_NOISE: f64 = 0.02;
const STRAIGHT_IN_NOISE: f64 = 12.0;
const SLOW_NOISE: f64 = 0.002;
const SLOW_IN_NOISE: f64 = 0.1;
/// Where levels are enough to see it, a next term that changes the sign is so many times likelier than the tail of the prior.
const CROSSING: f64 = 3.0;
/// Powers by which a slower term may lag.
const SLOW: [(f64, f64, f64); 2] = [(0.5, 0.03, 0.1), (1.0, 0.03, 0.2)];
const SLOW_RANGE: [f64; 2] = [2.0, 100.0];
const SLOW_NODES: usize = 10;
const FLOORS: f64 = 0.03;
const SCATTERED: f64 = 0.03;
const REFERENCES: f64 = 0.02;
const ORDERS: [f64; 23] = [
    0.5, 0.75, 1.0, 1.25, 1.5, 1.75, 2.0, 2.25, 2.5, 2.75, 3.0, 3.25, 3.5, 3.75, 4.0, 4.5, 5.0,
    5.5, 6.0, 7.0, 8.0, 10.0, 12.0,
];
/// Scale of bends: most are below one fifth at the coarsest level kept.
const BEND_SCALE: f64 = 0.2;
const BEND_RANGE: [f64; 2] = [-60.0, 1e4];
const BEND_NODES: usize = 64;
const PLATEAU_RANGE: [f64; 2] = [0.1, 300.0];
const PLATEAU_NODES: usize = 20;
const PLATEAU_CENTRE: f64 = 1.5;
const PLATEAU_SPREAD: f64 = 1.8;
const FLOOR_RANGE: [f64; 2] = [0.03, 10.0];
const FLOOR_NODES: usize = 9;
/// Stated at every level but the coarsest in turn: what lies between two is within this range.
const SCATTERED_RANGE: [f64; 2] = [0.1, 10.0];
const SCATTERED_NODES: usize = 5;
/// A reference at the finest step itself has D = 1, at half of it 2^-p.
const REFERENCE_RANGE: [f64; 2] = [0.02, 0.9];
const REFERENCE_ORDERS: usize = 15;
const REFERENCE_NODES: usize = 7;
/// Standard deviation in spacings: 0.29 for a uniform distribution, and as much again for overlap.
const SMOOTHING: f64 = 0.55;
/// Half the square of half a spacing of log D, for floors and references.
const SECOND_ORDER: f64 = 0.03;
/// Bound of the term after the next, as a share of the next.
const AFTER: f64 = 0.3;
const AFTER_FLOOR: f64 = 0.1;
/// Standard deviation of p − r for a floor.
const FLATNESS: f64 = 0.15;
/// Prior of the order: mean and standard deviation.
const ORDER: [f64; 2] = [1.5, 2.5];
/// The factor is no smaller: a zero of it never falls on a level.
const LEAST_FACTOR: f64 = 1e-3;

static NODES: LazyLock<Vec<Node>> = LazyLock::new(|| {
    let straight = Node {
        family: Family::Bend,
        power: 1.0,
        power_spread: 0.0,
        size: 0.0,
        spacing: 0.0,
        log_prior: STRAIGHT.ln(),
        last: false,
    };
    let mut nodes = vec![straight];
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
    let scattered =
        grid(SCATTERED_RANGE.map(f64::ln), SCATTERED_NODES, |t| (t.exp(), t.exp(), 1.0));
    let references =
        grid(REFERENCE_RANGE.map(f64::ln), REFERENCE_NODES, |t| (t.exp(), t.exp(), 1.0));
    let slow = grid(SLOW_RANGE.map(f64::ln), SLOW_NODES, |t| (t.exp(), t.exp(), 1.0));
    // An order has the prior that it has without a floor.
    let orders = |orders: &[f64], weight: f64| -> Vec<(f64, f64, f64)> {
        let share = |at: usize| {
            let away = (orders[at] - ORDER[0]) / ORDER[1];
            let [before, after] = [at.saturating_sub(1), (at + 1).min(orders.len() - 1)];
            (orders[after] - orders[before]) * (-0.5 * away * away).exp()
        };
        let total: f64 = (0..orders.len()).map(share).sum();
        let of = |at: usize| (orders[at], weight * share(at) / total, 0.0);
        (0..orders.len()).map(of).collect()
    };
    // Of a higher order the reference is below a hundredth of the finest error.
    let references_of = orders(&ORDERS[..REFERENCE_ORDERS], REFERENCES);
    let families = [
        (Family::Bend, BENDS.to_vec(), bends),
        (Family::Plateau, PLATEAUS.to_vec(), plateaus),
        (Family::Floor, orders(&ORDERS, FLOORS), floors),
        (Family::Scattered, orders(&ORDERS, SCATTERED), scattered),
        (Family::Slow, SLOW.to_vec(), slow),
        (Family::Reference, references_of.clone(), references.clone()),
        (Family::ReferenceSquares, references_of, references),
    ];
    for (family, powers, sizes) in families {
        for (power, weight, power_spread) in powers {
            let node = |(at, &(size, spacing, share)): (usize, &(f64, f64, f64))| {
                let last = match family {
                    Family::Bend => at == 0 || at + 1 == sizes.len(),
                    Family::Plateau => at + 1 == sizes.len(),
                    _ => false,
                };
                let log_prior = (weight * share).ln();
                Node { family, power, power_spread, size, spacing, log_prior, last }
            };
            nodes.extend(sizes.iter().enumerate().map(node));
        }
    }
    nodes
});

/// Nodes of one family and one power, D rising.
pub(super) fn runs() -> impl Iterator<Item = &'static [Node]> {
    NODES.chunk_by(|a, b| (a.family, a.power, a.straight()) == (b.family, b.power, b.straight()))
}

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

/// g at one level, its derivative by p, and the columns of unknown size.
pub(super) struct Terms {
    pub(super) g: f64,
    pub(super) by_order: f64,
    pub(super) nuisances: [f64; NUISANCES],
}

impl Node {
    /// For |D| = 1: the next term, the one after it, and the logarithm that multiplies a change of r, at z = h/h_coarsest and
    /// y = h over the step at which a floor is stated.
    pub(super) fn powers(&self, z: f64, y: f64) -> [f64; 3] {
        match self.family {
            Family::Floor | Family::Scattered | Family::Reference => {
                [y.powf(-self.power), AFTER_FLOOR * z, -y.ln()]
            }
            Family::ReferenceSquares => [y.powf(-2.0 * self.power), AFTER_FLOOR * z, -2.0 * y.ln()],
            Family::Slow => [y.powf(self.power), AFTER_FLOOR * z, y.ln()],
            Family::Bend | Family::Plateau => {
                let term = z.powf(self.power);
                [term, AFTER * term * term, z.ln()]
            }
        }
    }

    /// From [`Node::powers`]: g with its derivatives by D and r times their spreads in the lists, and the term after the next.
    pub(super) fn terms(&self, [term, after, log]: [f64; 3]) -> Terms {
        // g = m log |1 + D t|: its derivative by D is m t / (1 + D t), that by r is D log z times it.
        let (multiple, size) = match self.family {
            Family::Bend | Family::Slow | Family::Floor | Family::Scattered => (1.0, self.size),
            Family::Plateau => (-1.0, self.size),
            Family::Reference => (1.0, -self.size),
            Family::ReferenceSquares => (0.5, -self.size * self.size),
        };
        let factor = 1.0 + size * term;
        let factor = if factor.abs() < LEAST_FACTOR { LEAST_FACTOR } else { factor };
        let by_size = multiple * term / factor;
        let by_power = by_size * size * log;
        let spacing = match self.family {
            Family::ReferenceSquares => 2.0 * self.size * self.spacing,
            _ => self.spacing,
        };
        let (by_order, after, third) = if self.family.at_the_fine_end() {
            // What is left of second order in log D.
            let share = size * term / factor;
            (by_power, after, SECOND_ORDER * multiple * share * (1.0 - share))
        } else {
            (0.0, after * self.size.abs().min(1.0), self.power_spread * by_power)
        };
        Terms {
            g: multiple * factor.abs().ln(),
            by_order,
            nuisances: [SMOOTHING * spacing * by_size, after, third],
        }
    }

    /// Of a floor its share of the error, from its power.
    pub(super) fn share(&self, power: f64) -> f64 {
        self.size * power / (1.0 + self.size * power)
    }

    /// What this node adds to the slope of the first two levels, which are so far apart in log h.
    pub(super) fn first_slope(&self, terms: &[[f64; 3]], apart: f64) -> f64 {
        let [first, second] = [0, 1].map(|at| self.terms(terms[at]).g);
        (first - second) / apart
    }

    /// There is no next term.
    pub(super) fn straight(&self) -> bool {
        self.family == Family::Bend && self.size == 0.0
    }

    /// Its prior beside a noise that nobody told: where the noise is large, a next term is rarely needed, and a slow one is not seen.
    /// Of four and more levels.
    pub(super) fn log_prior_at(&self, noise: f64) -> f64 {
        self.log_prior
            + match self.family {
                Family::Slow if noise > SLOW_NOISE => SLOW_IN_NOISE.ln(),
                Family::Bend if self.size < -1.0 => CROSSING.ln(),
                _ if self.straight() && noise > FINE_NOISE => STRAIGHT_IN_NOISE.ln(),
                _ => 0.0,
            }
    }

    /// The next term changes its sign among the levels kept, or outweighs the first on all of them.
    pub(super) fn far(&self) -> bool {
        self.family == Family::Bend && !(-1.0..=60.0).contains(&self.size)
    }

    /// Prior mean and standard deviation of the order under this reading.
    pub(super) fn order(&self) -> [f64; 2] {
        if self.family.at_the_fine_end() { [self.power, FLATNESS] } else { ORDER }
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
        // The weights of the lists above, added by hand; a bend may be none.
        let sums = [
            (Family::Bend, 0.92 + 0.25),
            (Family::Plateau, 0.08),
            (Family::Slow, 0.06),
            (Family::Floor, 0.03),
            (Family::Scattered, 0.03),
            (Family::Reference, 0.02),
            (Family::ReferenceSquares, 0.02),
        ];
        for (family, sum) in sums {
            assert!((total(family) - sum).abs() < 1e-12, "{family:?}");
        }
        for node in NODES.iter() {
            let y = 4f64.powf(-node.power);
            let expected = match node.family {
                Family::Bend => (1.0 + node.size).abs().ln(),
                Family::Slow => (1.0 + node.size / y).ln(),
                Family::Plateau => -(1.0 + node.size).ln(),
                Family::Floor | Family::Scattered => (1.0 + node.size * y).ln(),
                Family::Reference => (1.0 - node.size * y).ln(),
                Family::ReferenceSquares => 0.5 * (1.0 - (node.size * y).powi(2)).ln(),
            };
            assert!((node.terms(node.powers(1.0, 4.0)).g - expected).abs() < 1e-12);
        }
    }

    #[test]
    fn columns_are_derivatives() {
        for node in NODES.iter().step_by(17) {
            let at = |node: Node| node.terms(node.powers(0.5, 2.0));
            let by = 1e-6 * node.size.abs().max(0.01);
            let change = (at(Node { size: node.size + by, ..*node }).g
                - at(Node { size: node.size - by, ..*node }).g)
                / (2.0 * by);
            let found = at(*node);
            let [smoothing, _, of_power] = found.nuisances;
            let expected = SMOOTHING * node.spacing * change;
            // Central differences: truncation 1e-12 relative, rounding 1e-10. The sign of a column is free.
            let near = |a: f64, b: f64| (a - b).abs() < 1e-5 * b.abs().max(1e-4);
            assert!(near(smoothing.abs(), expected.abs()), "{node:?}: {smoothing} {expected}");
            let by = 1e-6;
            let change = (at(Node { power: node.power + by, ..*node }).g
                - at(Node { power: node.power - by, ..*node }).g)
                / (2.0 * by);
            let found = if node.family.at_the_fine_end() { found.by_order } else { of_power };
            let spread = if node.family.at_the_fine_end() { 1.0 } else { node.power_spread };
            assert!(near(found, spread * change), "{node:?}: {found} {change}");
        }
    }
}
