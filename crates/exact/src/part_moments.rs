//! Moments of exact fields, part by part: projections onto the element, and products of the remainders.

use std::ops::Range;

use pulp::{Simd, WithSimd};

use super::constitutive::mandel;
use super::lanes::{Lanes, WIDTH};
use super::onto::{Onto, append};
use super::parts::Parts;
use super::sampled::Sampled;
use fem::contact::LoadError;
use fem::norms::{AtPoints, Moments, Piecewise};
use fem::space::quadrature::Rule;

impl Parts<'_> {
    pub(crate) fn moments<const D: usize, const N: usize>(
        &self,
        points: &Sampled,
    ) -> Result<PartMoments, LoadError> {
        let nodes = D * self.space.nodes.cells.len();
        let lengths = [self.exact.strain.len() * self.space.geometry.points(), nodes];
        let [strain, stress, displacement] = [lengths[0], lengths[0], lengths[1]]
            .map(|numbers| PartFamily::with_room(self.count, numbers));
        let mut sums = PartMoments { strain, stress, displacement, lengths };
        let (mesh, mut room) = (&self.space.mesh, Remainders::<D, N>::new(self.count));
        let (program, names) = self.inside();
        let (at, onto) = ((self.t, 0.0), &Onto::new(self.space.element, &points.rule));
        points.each_block(mesh, program, at, self.again, &names, |cells, values| {
            pulp::Arch::new().dispatch(Add::<D, N> {
                parts: self,
                onto,
                rule: &points.rule,
                cells,
                values,
                sums: &mut sums,
                room: &mut room,
            });
        })?;
        Ok(sums)
    }
}

/// Remainders of ε, σ and u in a few cells, for each part: numbers point by point.
struct Remainders<const D: usize, const N: usize> {
    strain: Vec<Vec<[Lanes; N]>>,
    stress: Vec<Vec<[Lanes; N]>>,
    displacement: Vec<Vec<[Lanes; D]>>,
}

impl<const D: usize, const N: usize> Remainders<D, N> {
    fn new(parts: usize) -> Self {
        let [strain, stress] = [(); 2].map(|()| vec![Vec::new(); parts]);
        Self { strain, stress, displacement: vec![Vec::new(); parts] }
    }
}

/// Adds the moments on some cells, on the widest vectors of the processor.
struct Add<'a, const D: usize, const N: usize> {
    parts: &'a Parts<'a>,
    onto: &'a Onto,
    rule: &'a Rule,
    cells: Range<usize>,
    values: &'a [&'a [f64]],
    sums: &'a mut PartMoments,
    room: &'a mut Remainders<D, N>,
}

impl<const D: usize, const N: usize> WithSimd for Add<'_, D, N> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Self { parts, onto, rule, cells, values, sums, room } = self;
        let (mut at_points, mut at_nodes) = (Vec::new(), Vec::new());
        let (count, points, mut memory) = (cells.len(), rule.weights.len(), Vec::new());
        for first in (0..count).step_by(WIDTH) {
            let chunk = first..count.min(first + WIDTH);
            let global = cells.start + chunk.start..cells.start + chunk.end;
            let at = |field: &[f64], q: usize| {
                Lanes::load(&field[count * q + chunk.start..count * q + chunk.end])
            };
            for (m, part) in values.chunks(parts.fields()).enumerate() {
                let (strains, stresses) = (&mut room.strain[m], &mut room.stress[m]);
                strains.clear();
                stresses.clear();
                for q in 0..points {
                    let field = |k: usize| at(part[k], q);
                    let regions = &parts.regions[global.clone()];
                    let (strain, sigma) = parts.of_cells::<D>(regions, field, &mut memory);
                    strains.push(mandel(&strain));
                    stresses.push(mandel(&sigma));
                }
                onto.strains.split(stresses, &mut at_points);
                append(&mut sums.stress.vectors[m], chunk.len(), &at_points);
                if !parts.is_present(m) {
                    // Empty, like any vector that vanishes.
                    strains.clear();
                    continue;
                }
                onto.strains.split(strains, &mut at_points);
                append(&mut sums.strain.vectors[m], chunk.len(), &at_points);
                let displacements = &mut room.displacement[m];
                displacements.clear();
                for q in 0..points {
                    let mut displacement = [Lanes::from(0.0); D];
                    for i in 0..D {
                        displacement[i] = at(part[i], q);
                    }
                    displacements.push(displacement);
                }
                onto.functions.split(displacements, &mut at_nodes);
                append(&mut sums.displacement.vectors[m], chunk.len(), &at_nodes);
            }
            let measures = &parts.space.geometry.measure[global];
            sums.strain.add_products(&room.strain, &rule.weights, measures);
            sums.stress.add_products(&room.stress, &rule.weights, measures);
            sums.displacement.add_products(&room.displacement, &rule.weights, measures);
        }
    }
}

/// A field of several parts: the projection of each, and the products of the remainders.
#[derive(Debug, Default)]
pub(super) struct PartFamily {
    /// Projections by their values at strain points, or at nodes; empty where they vanish.
    pub(super) vectors: Vec<Vec<f64>>,
    /// Σ_K ∫_K r_m·r_l of the remainders, row by row.
    pub(super) products: Vec<f64>,
}

impl PartFamily {
    fn with_room(parts: usize, numbers: usize) -> Self {
        let vectors = (0..parts).map(|_| Vec::with_capacity(numbers)).collect();
        Self { vectors, products: vec![0.0; parts * parts] }
    }

    /// Adds the products over cells of the given measures; `remainders` hold numbers for each of `weights`.
    #[inline(always)]
    fn add_products<const N: usize>(
        &mut self,
        remainders: &[Vec<[Lanes; N]>],
        weights: &[f64],
        measures: &[f64],
    ) {
        let parts = remainders.len();
        for m in 0..parts {
            for l in m..parts {
                let mut sum = Lanes::from(0.0);
                for ((a, b), weight) in remainders[m].iter().zip(&remainders[l]).zip(weights) {
                    let mut product = a[0] * b[0];
                    for i in 1..N {
                        product = product + a[i] * b[i];
                    }
                    sum = sum + Lanes::from(*weight) * product;
                }
                let product = &mut self.products[parts * m + l];
                measures.iter().zip(sum.0).for_each(|(measure, sum)| *product += measure * sum);
            }
        }
    }

    /// The field Σ_m a_m S_m; None if it is not finite.
    fn combined(&self, factors: &[f64], length: usize) -> Option<(Vec<f64>, f64)> {
        let parts = factors.len();
        let mut rest = 0.0;
        for m in 0..parts {
            for l in m..parts {
                let twice = if l > m { 2.0 } else { 1.0 };
                rest += twice * factors[m] * factors[l] * self.products[parts * m + l];
            }
        }
        // Parts that cancel leave rounding of either sign.
        let rest = if rest < 0.0 { 0.0 } else { rest };
        let vector = combined(&self.vectors, factors, length);
        (rest.is_finite() && vector.iter().all(|value| value.is_finite())).then_some((vector, rest))
    }
}

/// Σ_m a_m v_m, of vectors that are empty where they vanish.
pub(super) fn combined(vectors: &[Vec<f64>], factors: &[f64], length: usize) -> Vec<f64> {
    let mut sum = vec![0.0; length];
    for (vector, factor) in vectors.iter().zip(factors) {
        sum.iter_mut().zip(vector).for_each(|(sum, value)| *sum += factor * value);
    }
    sum
}

#[derive(Debug, Default)]
pub(super) struct PartMoments {
    pub(super) strain: PartFamily,
    pub(super) stress: PartFamily,
    pub(super) displacement: PartFamily,
    /// Numbers of ε, and of u.
    pub(super) lengths: [usize; 2],
}

impl PartMoments {
    /// The moments of Σ_m a_m S_m in the cells, σ with factors `of_stress`; None if a number is not finite.
    pub(crate) fn at(&self, factors: &[f64], of_stress: &[f64]) -> Option<Moments> {
        let [tensors, nodes] = self.lengths;
        let constants = |family: &PartFamily, factors: &[f64]| {
            let (at, rest) = family.combined(factors, tensors)?;
            Some(AtPoints { at, rest })
        };
        let strain = constants(&self.strain, factors)?;
        let stress = constants(&self.stress, of_stress)?;
        let (node, rest) = self.displacement.combined(factors, nodes)?;
        let displacement = Piecewise { node, rest };
        Some(Moments { strain, stress, displacement, ..Moments::default() })
    }

    /// The means of σ of each part, in order of the cells.
    pub(crate) fn stress_means(&self) -> &[Vec<f64>] {
        &self.stress.vectors
    }

    pub(crate) fn single(self) -> Moments {
        let [strain, stress, displacement] = [self.strain, self.stress, self.displacement]
            .map(|mut family| (family.vectors.swap_remove(0), family.products[0]));
        let constants = |(at, rest)| AtPoints { at, rest };
        let displacement = Piecewise { node: displacement.0, rest: displacement.1 };
        let (strain, stress) = (constants(strain), constants(stress));
        Moments { strain, stress, displacement, ..Moments::default() }
    }

    /// Drops zero vectors: the strain of a part that occurs only in the memory.
    pub(crate) fn without_zeros(mut self) -> Self {
        let families = [&mut self.strain, &mut self.stress, &mut self.displacement];
        families.into_iter().for_each(|family| forget_zeros(&mut family.vectors));
        self
    }
}

pub(super) fn forget_zeros(vectors: &mut [Vec<f64>]) {
    for vector in vectors.iter_mut().filter(|vector| vector.iter().all(|value| *value == 0.0)) {
        *vector = Vec::new();
    }
}
