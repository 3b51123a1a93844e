//! Exact fields as sums of products of time and space.

use std::sync::Arc;

use super::exact::{ExactData, MaterialNumbers, RegionNumbers};
use super::shared_program::SharedProgram;
use super::symbolic;
use super::truth::ByTime;
use formula::{Graph, Node, Program};

/// Longer sums are evaluated at each time: a part costs as much as a time.
const MOST_PARTS: usize = 8;

/// The a_m of formulas Σ_m a_m(t) S_m(x).
pub struct TimeFactors {
    pub parts: usize,
    bound: SharedProgram,
    known: ByTime<Vec<f64>>,
}

impl TimeFactors {
    fn new(graph: &Graph, factors: &[Node], horizon: f64) -> Self {
        let bound = Program::compile(graph, factors, horizon).bind(&[[0.0; 3]]);
        Self { parts: factors.len(), bound: bound.into(), known: ByTime::default() }
    }

    /// The a_m(t).
    pub fn at(&self, t: f64) -> Arc<Vec<f64>> {
        self.known.always(t, || self.bound.values_at(t).into_iter().flatten().collect())
    }
}

/// The a_m of formulas, and the S_m of all of them, part by part; None if a formula does not show a short sum.
fn short_sum(graph: &mut Graph, formulas: &[Node]) -> Option<(Vec<Node>, Vec<Vec<Node>>)> {
    let together = graph.separate_together(formulas)?;
    if together.factors.len() > MOST_PARTS {
        return None;
    }
    let zero = graph.constant(0.0);
    let shape = |m: usize, terms: &[(usize, Node)]| {
        terms.iter().find(|(index, _)| *index == m).map_or(zero, |(_, shape)| *shape)
    };
    let of_part = |m: usize| together.shapes.iter().map(|terms| shape(m, terms)).collect();
    let shapes = (0..together.factors.len()).map(of_part).collect();
    Some((together.factors, shapes))
}

/// u and ε as Σ_m a_m(t) S_m(x), and what follows from them.
///
/// The memory acts in time only: H_i = Σ_m (b_i * a_m)(t) ε_m(x) has the shapes of ε. If ℬ_i = β_i 𝒜 in the whole body,
/// then σ = Σ_m s_m(t) 𝒜ε_m with s_m = a_m + Σ_i β_i b_i * a_m, and σ and f0 have separate factors. Otherwise there are
/// parts of the memory alone beside those of u and ε.
pub struct Separation {
    /// The a_m, and b_i * a_m of parts of the memory alone.
    pub factors: TimeFactors,
    /// The s_m, if different.
    of_stress: Option<TimeFactors>,
    /// The S_m of [u, ε, H_1, …], part by part.
    pub interior: Program,
    /// The S_m of f0.
    pub forces: Program,
    /// Parts without u and ε, which occur in the memory alone.
    pub remembered_alone: Vec<bool>,
}

impl Separation {
    /// Separates [u, ε] of data without projection; None if one of them does not show a short sum.
    pub(crate) fn of(data: &ExactData, strain: &[Node]) -> Option<Self> {
        let mut graph = data.graph.clone();
        let d = data.u.len();
        let (mut factors, mut parts) = short_sum(&mut graph, &[&data.u, strain].concat())?;
        let present = parts.len();
        let of_stress = remember(&mut graph, data, &mut factors, &mut parts);
        if parts.len() > MOST_PARTS {
            return None;
        }
        let mut forces = Vec::with_capacity(d * parts.len());
        for part in &parts {
            let (strain, memory) = part[d..].split_at(strain.len());
            let material = (&data.material, &data.regions[..]);
            let stress = symbolic::stress_in_regions(&mut graph, material, None, strain, memory);
            forces.extend(symbolic::body_force(&mut graph, &stress));
        }
        let inside = parts.concat();
        let times = |nodes: &[Node]| TimeFactors::new(&graph, nodes, data.horizon);
        let of_stress = of_stress.map(|factors| times(&factors));
        let factors = times(&factors);
        let remembered_alone = (0..parts.len()).map(|m| m >= present).collect();
        let [interior, forces] =
            [inside, forces].map(|all| Program::compile(&graph, &all, data.horizon));
        Some(Self { factors, of_stress, interior, forces, remembered_alone })
    }

    /// The factors of σ and f0.
    pub(crate) fn of_stress(&self) -> &TimeFactors {
        self.of_stress.as_ref().unwrap_or(&self.factors)
    }
}

/// Extends parts of [u, ε] by [H_1, …]. With multiples of 𝒜 the factors of σ are returned; otherwise parts of the
/// memory alone are added, and b_i * a_m to the factors.
fn remember(
    graph: &mut Graph,
    data: &ExactData,
    factors: &mut Vec<Node>,
    parts: &mut Vec<Vec<Node>>,
) -> Option<Vec<Node>> {
    let (d, present, zero) = (data.u.len(), parts.len(), graph.constant(0.0));
    let numbers = parts.first().map_or(0, |part| part.len() - d);
    parts.iter_mut().for_each(|part| part.resize(d + numbers * (1 + data.kernels.len()), zero));
    let multiples = multiples(data);
    let mut of_stress = factors.clone();
    for m in 0..present {
        for (i, &kernel) in data.kernels.iter().enumerate() {
            let remembered = graph.convolve(kernel, factors[m]);
            if let Some(multiples) = &multiples {
                let beta = graph.constant(multiples[i]);
                let more = graph.mul(beta, remembered);
                of_stress[m] = graph.add(of_stress[m], more);
                continue;
            }
            let mut part = vec![zero; parts[m].len()];
            part[d + numbers * (1 + i)..][..numbers].copy_from_slice(&parts[m][d..d + numbers]);
            factors.push(remembered);
            parts.push(part);
        }
    }
    multiples.filter(|multiples| !multiples.is_empty()).map(|_| of_stress)
}

/// β_i with ℬ_i = β_i 𝒜 in all regions up to rounding, if they exist.
fn multiples(data: &ExactData) -> Option<Vec<f64>> {
    const ROUNDING: f64 = 4.0 * f64::EPSILON;
    let of = |material: &MaterialNumbers| -> Option<Vec<f64>> {
        let beta = |&(lambda, mu): &(f64, f64)| {
            let beta = mu / material.mu_l;
            let off = (lambda - beta * material.lambda).abs();
            (material.full.is_none() && off <= ROUNDING * lambda.abs()).then_some(beta)
        };
        material.memory.iter().map(beta).collect()
    };
    let of_body = of(&data.material)?;
    let same = |region: &RegionNumbers| {
        let close = |(a, b): (&f64, &f64)| (a - b).abs() <= ROUNDING * b.abs();
        of(&region.material).is_some_and(|other| other.iter().zip(&of_body).all(close))
    };
    data.regions.iter().all(same).then_some(of_body)
}
