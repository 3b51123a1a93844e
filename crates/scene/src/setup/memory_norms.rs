//! Proved norms of the relaxation tensor ℬ(t) = Σ b_i(t) ℬ_i over [0, T], region by region.

use super::Setup;
use crate::RelaxationTerm;
use crate::singular::in_the_largest;
use formula::{EvaluationPoint, Graph, Interval, Node, Place, Variable};

/// Norms of the relaxation tensor.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct MemoryNorms {
    /// max over [0, T] of the operator norm of ℬ(t) on S^d: proved, and attained but for a relative 1e-7.
    pub operator: f64,
    /// max over [0, T] of the sum of the moduli of all entries, the paper's norm of Q_∞, likewise.
    pub entries: f64,
    /// Operator norm of ℬ(0).
    pub at_zero: f64,
    /// Smallest and largest eigenvalue of ℬ(0) on S^d.
    pub spectrum_at_zero: (f64, f64),
}

impl MemoryNorms {
    /// The larger of each, for two regions.
    fn or(self, other: Self) -> Self {
        let ((a, b), (c, d)) = (self.spectrum_at_zero, other.spectrum_at_zero);
        Self {
            operator: self.operator.max(other.operator),
            entries: self.entries.max(other.entries),
            at_zero: self.at_zero.max(other.at_zero),
            spectrum_at_zero: (a.min(c), b.max(d)),
        }
    }

    /// The largest of all regions.
    pub(super) fn of_all(regions: &[Self]) -> Self {
        regions.iter().copied().reduce(Self::or).unwrap_or_default()
    }
}

/// The eigenvalues of ℬ(t) on one region as formulas in t: ℬ is isotropic. The terms t^{-a} C(t) without the power.
struct OfRegion {
    /// On deviators and spheres.
    eigenvalues: [Node; 2],
    /// Σ |ℬ_ijkl|.
    entries: Node,
}

/// The terms with one power, by region, in a graph of their own.
pub(super) struct Memory {
    graph: Graph,
    regions: Vec<OfRegion>,
    pub power: f64,
}

impl Memory {
    /// The terms of ℬ with t^{-power} in their kernels, without it.
    pub(super) fn of_power(setup: &Setup, power: f64) -> Self {
        let mut graph = setup.scene.formulas.clone();
        let material = &setup.body.material;
        let factor = |memory: &RelaxationTerm| match memory.singular {
            None => (power == 0.0).then_some(memory.kernel),
            Some(singular) => (power == singular.power).then_some(singular.factor),
        };
        let of_region = |region: usize| {
            let lame = |memory: &RelaxationTerm| match region {
                0 => [memory.lambda, memory.mu],
                named => memory.regions[named - 1],
            };
            let terms = material.memory.iter();
            terms.filter_map(|memory| Some((factor(memory)?, lame(memory)))).collect::<Vec<_>>()
        };
        let regions = (0..=material.regions.len())
            .map(|region| OfRegion::new(&mut graph, &of_region(region), setup.scene.dimension))
            .collect();
        Self { graph, regions, power }
    }

    /// One with each power, plain kernels first.
    pub(super) fn every(setup: &Setup) -> Vec<Self> {
        let singular = setup.body.material.memory.iter().filter_map(|term| term.singular);
        let powers = in_the_largest(singular.map(|singular| singular.power), 1.0);
        let powers = [0.0].into_iter().chain(powers.into_iter().map(|(power, _)| power));
        powers.map(|power| Self::of_power(setup, power)).collect()
    }

    /// The norms on each region, the rest of the body first.
    fn norms(&self, horizon: f64) -> Vec<MemoryNorms> {
        let over = Interval::new(0.0, horizon);
        let bound = |node: Node| self.graph.largest_modulus(node, Variable::T, over).bound;
        let of_region = |region: &OfRegion| {
            let [a, b] = region
                .eigenvalues
                .map(|node| self.graph.evaluate(node, &EvaluationPoint::default()));
            MemoryNorms {
                operator: region.eigenvalues.map(bound).into_iter().fold(0.0, f64::max),
                entries: bound(region.entries),
                at_zero: a.abs().max(b.abs()),
                spectrum_at_zero: (a.min(b), a.max(b)),
            }
        };
        self.regions.iter().map(of_region).collect()
    }

    /// A bound of the operator norm on all regions for t in an interval.
    pub(super) fn within(&self, over: Interval) -> f64 {
        let place = Place::origin().with(Variable::T, over);
        let nodes = self.regions.iter().flat_map(|region| region.eigenvalues);
        nodes.map(|node| self.graph.enclosing(node).over(&place).range.size()).fold(0.0, f64::max)
    }
}

impl OfRegion {
    fn new(graph: &mut Graph, terms: &[(Node, [f64; 2])], dimension: usize) -> Self {
        let d = dimension as f64;
        let mut sum = |weight: &dyn Fn([f64; 2]) -> f64| {
            let zero = graph.constant(0.0);
            terms.iter().fold(zero, |sum, &(kernel, lame)| {
                let weight = graph.constant(weight(lame));
                let term = graph.mul(weight, kernel);
                graph.add(sum, term)
            })
        };
        let deviator = sum(&|[_, mu]| 2.0 * mu);
        let sphere = sum(&|[lambda, mu]| 2.0 * mu + d * lambda);
        let (lambda, normal) = (sum(&|[lambda, _]| lambda), sum(&|[lambda, mu]| lambda + 2.0 * mu));
        // As Σ |λ δ_ij δ_kl + μ(δ_ik δ_jl + δ_il δ_jk)|.
        let mut entries = graph.constant(0.0);
        for (factor, node) in [(d, normal), (d * (d - 1.0), lambda), (d * (d - 1.0), deviator)] {
            let (factor, size) =
                (graph.constant(factor), graph.apply(formula::Function::Abs, node));
            let part = graph.mul(factor, size);
            entries = graph.add(entries, part);
        }
        Self { eigenvalues: [deviator, sphere], entries }
    }
}

/// The norms of ℬ without its terms that are infinite at t = 0, on each region.
pub(super) fn plain_norms(setup: &Setup) -> Vec<MemoryNorms> {
    Memory::of_power(setup, 0.0).norms(setup.scene.time.horizon)
}

/// The largest power a, and the norms of all terms that are infinite at t = 0 as terms t^{-a} C(t), on each region.
pub(super) fn singular_norms(setup: &Setup) -> (f64, Vec<MemoryNorms>) {
    let terms = setup.body.material.memory.iter().filter_map(|term| term.singular);
    let horizon = setup.scene.time.horizon;
    let powers = in_the_largest(terms.map(|singular| singular.power), horizon);
    let none = vec![MemoryNorms::default(); setup.body.material.regions.len() + 1];
    powers.into_iter().fold((0.0, none), |(_, mut sums), (power, scale)| {
        for (sum, norms) in sums.iter_mut().zip(Memory::of_power(setup, power).norms(horizon)) {
            sum.operator += scale * norms.operator;
            sum.entries += scale * norms.entries;
            sum.at_zero += scale * norms.at_zero;
            sum.spectrum_at_zero.0 += scale * norms.spectrum_at_zero.0.min(0.0);
            sum.spectrum_at_zero.1 += scale * norms.spectrum_at_zero.1.max(0.0);
        }
        (power, sums)
    })
}
