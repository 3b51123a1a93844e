//! Moments of exact fields, part by part: what P1 functions can have of them, and the products of what they cannot.

use std::ops::Range;

use pulp::{Simd, WithSimd};

use super::constitutive::mandel;
use super::lanes::{Lanes, WIDTH};
use super::parts::Parts;
use super::reduction::{deviations, remainders};
use super::sampled::Sampled;
use crate::contact::LoadError;
use crate::norms::{CellConstants, Moments, Piecewise};
use crate::space::quadrature::Rule;

impl Parts<'_> {
    /// Moments of u, ε and σ of all parts.
    pub fn moments<const D: usize>(&self, points: &Sampled) -> Result<PartMoments, LoadError> {
        let (space, cells) = (self.space, self.space.mesh.cell_count());
        let lengths = [self.exact.strain.len() * cells, D * (D + 1) * cells];
        let [strain, stress, displacement] = [lengths[0], lengths[0], lengths[1]]
            .map(|numbers| PartFamily::with_room(self.count, numbers));
        let mut sums = PartMoments { strain, stress, displacement, lengths };
        let mut room = Remainders::new(self.count);
        let (program, names) = self.inside();
        let at = (self.t, 0.0);
        points.each_block(&space.mesh, program, at, self.again, &names, |cells, values| {
            pulp::Arch::new().dispatch(Add::<D> {
                parts: self,
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

/// What P1 functions cannot have of ε, σ and u in a few cells, of each part: numbers point by point.
struct Remainders {
    strain: Vec<Vec<Lanes>>,
    stress: Vec<Vec<Lanes>>,
    displacement: Vec<Vec<Lanes>>,
    component: Vec<Lanes>,
}

impl Remainders {
    fn new(parts: usize) -> Self {
        let [strain, stress, displacement] = [(); 3].map(|()| vec![Vec::new(); parts]);
        Self { strain, stress, displacement, component: Vec::new() }
    }
}

/// Adds the moments on some cells, on the widest vectors of the processor.
struct Add<'a, const D: usize> {
    parts: &'a Parts<'a>,
    rule: &'a Rule,
    cells: Range<usize>,
    values: &'a [&'a [f64]],
    sums: &'a mut PartMoments,
    room: &'a mut Remainders,
}

impl<const D: usize> WithSimd for Add<'_, D> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Self { parts, rule, cells, values, sums, room } = self;
        let (count, points, mut memory) = (cells.len(), rule.weights.len(), Vec::new());
        let numbers = parts.exact.strain.len();
        for first in (0..count).step_by(WIDTH) {
            let own = first..count.min(first + WIDTH);
            let global = cells.start + own.start..cells.start + own.end;
            let at = |field: &[f64], q: usize| {
                Lanes::load(&field[count * q + own.start..count * q + own.end])
            };
            for (m, part) in values.chunks(parts.fields()).enumerate() {
                let (strains, stresses) = (&mut room.strain[m], &mut room.stress[m]);
                strains.clear();
                stresses.clear();
                for q in 0..points {
                    let field = |k: usize| at(part[k], q);
                    let regions = &parts.regions[global.clone()];
                    let (strain, sigma) = parts.of_cells::<D>(regions, field, &mut memory);
                    mandel(&strain, strains);
                    mandel(&sigma, stresses);
                }
                let mean = deviations(strains, &rule.weights);
                sums.strain.append(m, own.len(), &mean[..numbers]);
                let mean = deviations(stresses, &rule.weights);
                sums.stress.append(m, own.len(), &mean[..numbers]);

                let displacements = &mut room.displacement[m];
                displacements.resize(D * points, Lanes::from(0.0));
                let mut corners = [Lanes::from(0.0); 12];
                for (i, field) in part[..D].iter().enumerate() {
                    room.component.clear();
                    room.component.extend((0..points).map(|q| at(field, q)));
                    let linear = remainders(&mut room.component, rule);
                    (0..=D).for_each(|a| corners[D * a + i] = linear[a]);
                    (0..points).for_each(|q| displacements[D * q + i] = room.component[q]);
                }
                sums.displacement.append(m, own.len(), &corners[..D * (D + 1)]);
            }
            let measures = &parts.space.geometry.measure[global];
            sums.strain.add_products(&room.strain, &rule.weights, measures);
            sums.stress.add_products(&room.stress, &rule.weights, measures);
            sums.displacement.add_products(&room.displacement, &rule.weights, measures);
        }
    }
}

/// A field of several parts: what P1 functions can have of each, and the products of what they cannot.
#[derive(Debug, Default)]
pub(super) struct PartFamily {
    /// Cell means, or linear projections by their values at the corners; empty where they vanish.
    vectors: Vec<Vec<f64>>,
    /// Σ_K ∫_K r_m·r_l of the remainders, row by row.
    products: Vec<f64>,
}

impl PartFamily {
    fn with_room(parts: usize, numbers: usize) -> Self {
        let vectors = (0..parts).map(|_| Vec::with_capacity(numbers)).collect();
        Self { vectors, products: vec![0.0; parts * parts] }
    }

    /// Appends the numbers of so many cells to the vector of a part, cell by cell.
    #[inline(always)]
    fn append(&mut self, part: usize, cells: usize, numbers: &[Lanes]) {
        let vector = &mut self.vectors[part];
        (0..cells).for_each(|l| vector.extend(numbers.iter().map(|number| number.0[l])));
    }

    /// Adds the products over cells of the given measures; `remainders` hold the numbers point by point, for each of
    /// `weights`.
    #[inline(always)]
    fn add_products(&mut self, remainders: &[Vec<Lanes>], weights: &[f64], measures: &[f64]) {
        let parts = remainders.len();
        for m in 0..parts {
            let numbers = remainders[m].len() / weights.len();
            for l in m..parts {
                let mut sum = Lanes::from(0.0);
                let pairs =
                    remainders[m].chunks_exact(numbers).zip(remainders[l].chunks_exact(numbers));
                for ((a, b), weight) in pairs.zip(weights) {
                    let product = |i: usize| a[i] * b[i];
                    let all = (1..numbers).fold(product(0), |all, i| all + product(i));
                    sum += Lanes::from(*weight) * all;
                }
                let product = &mut self.products[parts * m + l];
                measures.iter().zip(sum.0).for_each(|(measure, sum)| *product += measure * sum);
            }
        }
    }

    /// The field Σ_m a_m S_m; none if it is not finite.
    fn combined(&self, factors: &[f64], length: usize) -> Option<(Vec<f64>, f64)> {
        let parts = factors.len();
        let mut rest = 0.0;
        for m in 0..parts {
            for l in m..parts {
                let twice = if l > m { 2.0 } else { 1.0 };
                rest += twice * factors[m] * factors[l] * self.products[parts * m + l];
            }
        }
        // Parts that cancel leave rounding, of either sign.
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

/// Moments of u, ε and σ in the cells, part by part.
#[derive(Debug, Default)]
pub(super) struct PartMoments {
    strain: PartFamily,
    stress: PartFamily,
    displacement: PartFamily,
    /// Numbers of ε, and of u.
    lengths: [usize; 2],
}

impl PartMoments {
    /// The moments of Σ_m a_m S_m in the cells; none if a number is not finite.
    pub fn at(&self, factors: &[f64]) -> Option<Moments> {
        let [tensors, corners] = self.lengths;
        let constants = |family: &PartFamily| {
            let (mean, rest) = family.combined(factors, tensors)?;
            Some(CellConstants { mean, rest })
        };
        let (strain, stress) = (constants(&self.strain)?, constants(&self.stress)?);
        let (corner, rest) = self.displacement.combined(factors, corners)?;
        let displacement = Piecewise { corner, rest };
        Some(Moments { strain, stress, displacement, ..Moments::default() })
    }

    /// Those of a single part.
    pub fn single(self) -> Moments {
        let [strain, stress, displacement] = [self.strain, self.stress, self.displacement]
            .map(|mut family| (family.vectors.swap_remove(0), family.products[0]));
        let constants = |(mean, rest)| CellConstants { mean, rest };
        let displacement = Piecewise { corner: displacement.0, rest: displacement.1 };
        let (strain, stress) = (constants(strain), constants(stress));
        Moments { strain, stress, displacement, ..Moments::default() }
    }

    /// Forgets vectors of nothing but zeros: the strain of a part that occurs in the memory alone.
    pub fn without_zeros(mut self) -> Self {
        let families = [&mut self.strain, &mut self.stress, &mut self.displacement];
        families.into_iter().for_each(|family| forget_zeros(&mut family.vectors));
        self
    }
}

/// Empties the vectors of zeros.
pub(super) fn forget_zeros(vectors: &mut [Vec<f64>]) {
    for vector in vectors.iter_mut().filter(|vector| vector.iter().all(|value| *value == 0.0)) {
        *vector = Vec::new();
    }
}
