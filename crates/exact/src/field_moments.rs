//! Moments of exact fields: projections onto the element, and squares of the remainders.

use std::ops::Range;

use pulp::{Simd, WithSimd};

use super::constitutive::mandel;
use super::fields::Fields;
use super::lanes::{Lanes, WIDTH};
use super::onto::{Onto, append};
use super::sampled::Sampled;
use fem::contact::LoadError;
use fem::norms::Moments;
use fem::space::quadrature::Rule;

impl Fields<'_> {
    /// The moments in the cells.
    pub(crate) fn moments<const D: usize, const N: usize>(
        &self,
        points: &Sampled,
    ) -> Result<Moments, LoadError> {
        let (mesh, mut sums) = (&self.space.mesh, Moments::default());
        let tensors = self.exact.strain.len() * self.space.geometry.points();
        sums.strain.at.reserve_exact(tensors);
        sums.stress.at.reserve_exact(tensors);
        sums.displacement.node.reserve_exact(D * self.space.nodes.cells.len());
        let (program, names) = self.inside();
        let (at, onto) = ((self.t, 0.0), &Onto::new(self.space.element, &points.rule));
        points.each_block(mesh, program, at, &names, |cells, values| {
            let (fields, rule, sums) = (self, &points.rule, &mut sums);
            pulp::Arch::new().dispatch(Add::<D, N> { fields, onto, rule, cells, values, sums });
        })?;
        Ok(sums)
    }
}

/// Adds the moments on some cells, on the widest vectors of the processor.
struct Add<'a, const D: usize, const N: usize> {
    fields: &'a Fields<'a>,
    onto: &'a Onto,
    rule: &'a Rule,
    cells: Range<usize>,
    values: &'a [&'a [f64]],
    sums: &'a mut Moments,
}

impl<const D: usize, const N: usize> WithSimd for Add<'_, D, N> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Self { fields, onto, rule, cells, values, sums } = self;
        let (mut at_points, mut at_nodes) = (Vec::new(), Vec::new());
        let (count, points, mut memory) = (cells.len(), rule.weights.len(), Vec::new());
        let (mut strains, mut stresses) = (Vec::with_capacity(points), Vec::with_capacity(points));
        let mut displacements = Vec::with_capacity(points);
        for first in (0..count).step_by(WIDTH) {
            let chunk = first..count.min(first + WIDTH);
            let global = cells.start + chunk.start..cells.start + chunk.end;
            let regions = &fields.regions[global.clone()];
            strains.clear();
            stresses.clear();
            displacements.clear();
            for q in 0..points {
                let field = |k: usize| {
                    Lanes::load(&values[k][count * q + chunk.start..count * q + chunk.end])
                };
                let (strain, sigma) = fields.of_cells::<D>(regions, field, &mut memory);
                strains.push(mandel::<D, N, _>(&strain));
                stresses.push(mandel::<D, N, _>(&sigma));
                let mut displacement = [Lanes::from(0.0); D];
                for i in 0..D {
                    displacement[i] = field(i);
                }
                displacements.push(displacement);
            }
            onto.strains.split(&mut stresses, &mut at_points);
            append(&mut sums.stress.at, chunk.len(), &at_points);
            onto.strains.split(&mut strains, &mut at_points);
            append(&mut sums.strain.at, chunk.len(), &at_points);
            onto.functions.split(&mut displacements, &mut at_nodes);
            append(&mut sums.displacement.node, chunk.len(), &at_nodes);
            let measures = &fields.space.geometry.measure[global];
            add_squares(&strains, &rule.weights, measures, &mut sums.strain.rest);
            add_squares(&stresses, &rule.weights, measures, &mut sums.stress.rest);
            add_squares(&displacements, &rule.weights, measures, &mut sums.displacement.rest);
        }
    }
}

/// Adds Σ_K ∫_K |r|² over cells of the given measures; the remainders have numbers for each of `weights`.
#[inline(always)]
fn add_squares<const N: usize>(
    remainders: &[[Lanes; N]],
    weights: &[f64],
    measures: &[f64],
    rest: &mut f64,
) {
    let mut sum = Lanes::from(0.0);
    for (r, weight) in remainders.iter().zip(weights) {
        let mut square = r[0] * r[0];
        for i in 1..N {
            square = square + r[i] * r[i];
        }
        sum = sum + Lanes::from(*weight) * square;
    }
    measures.iter().zip(sum.0).for_each(|(measure, sum)| *rest += measure * sum);
}
