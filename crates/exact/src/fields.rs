//! Exact fields on a mesh at one time, and their nodal forces.

use std::ops::Range;

use pulp::{Simd, WithSimd};

use super::constitutive::{Tensor, mandel, stress};
use super::exact::Exact;
use super::lanes::{Lanes, WIDTH};
use super::nodal_force::add_means;
use super::onto::{Onto, append};
use super::sampled::{Sampled, tensor_names, vector_names};
use super::shapes::Work;
use fem::contact::{Discretization, LoadError};
use fem::space::quadrature::Rule;
use formula::Program;

/// The fields at a time.
pub(super) struct Fields<'a> {
    pub exact: &'a Exact,
    pub space: &'a Discretization,
    /// Of each cell.
    pub regions: &'a [usize],
    pub t: f64,
    pub zeta: f64,
    pub kappa: f64,
}

impl Fields<'_> {
    /// [u, ε, H_1, …], and the names of those that must be finite.
    pub(super) fn inside(&self) -> (&Program, Vec<String>) {
        let d = self.exact.dimension();
        (&self.exact.interior, [vector_names("u", d), tensor_names("ε", d)].concat())
    }

    /// ε and σ in some cells of the given regions; `field` gives its values by number.
    #[inline(always)]
    pub(super) fn of_cells<const D: usize>(
        &self,
        regions: &[usize],
        field: impl Fn(usize) -> Lanes,
        memory: &mut Vec<Tensor<D, Lanes>>,
    ) -> (Tensor<D, Lanes>, Tensor<D, Lanes>) {
        let strain = self.exact.tensors(field, memory);
        let law = |region| stress(self.exact.material_in(region), &strain, memory, self.kappa);
        (strain, by_region(regions, law))
    }

    /// ∫ σ:ε(v), over all nodes.
    pub(crate) fn stress_force<const D: usize, const N: usize>(
        &self,
        points: &Sampled,
    ) -> Result<Vec<f64>, LoadError> {
        let (space, onto) = (self.space, &Onto::new(self.space.element, &points.rule));
        let work = Work::new(space.element, D);
        let (mut force, mut means) = (vec![0.0; space.nodes.len()], Vec::new());
        let rule = &points.rule;
        let (program, names) = self.inside();
        let at = (self.t, 0.0);
        points.each_block(&space.mesh, program, at, &names, |cells, values| {
            let (fields, cells, room) = (self, &cells, &mut means);
            let means_of_cells = Means::<D, N> { fields, rule, onto, cells, values, means: room };
            pulp::Arch::new().dispatch(means_of_cells);
            add_means::<D>((space, &work), cells.clone(), &means, &mut force);
        })?;
        Ok(force)
    }
}

/// The tensor of `law` for each cell by its region.
#[inline(always)]
fn by_region<const D: usize>(
    regions: &[usize],
    law: impl Fn(usize) -> Tensor<D, Lanes>,
) -> Tensor<D, Lanes> {
    let mut all = [[Lanes::from(0.0); D]; D];
    // Called from one place only, so that it is inlined.
    for (l, &region) in regions.iter().enumerate() {
        if l > 0 && region == regions[0] {
            continue;
        }
        let tensor = law(region);
        if l == 0 {
            all = tensor;
            continue;
        }
        let pairs = all.as_flattened_mut().iter_mut().zip(tensor.as_flattened());
        pairs.for_each(|(all, tensor)| all.0[l] = tensor.0[l]);
    }
    all
}

/// Projections of σ onto the strains of some cells (means for linear elements), on the widest vectors of the processor.
struct Means<'a, const D: usize, const N: usize> {
    fields: &'a Fields<'a>,
    rule: &'a Rule,
    onto: &'a Onto,
    cells: &'a Range<usize>,
    values: &'a [&'a [f64]],
    /// Cell by cell, in the notation of moments.
    means: &'a mut Vec<f64>,
}

impl<const D: usize, const N: usize> WithSimd for Means<'_, D, N> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Self { fields, rule, onto, cells, values, means } = self;
        let (count, mut memory, mut sigmas) = (cells.len(), Vec::new(), Vec::new());
        let mut projected: Vec<[Lanes; N]> = Vec::new();
        means.clear();
        for first in (0..count).step_by(WIDTH) {
            let end = count.min(first + WIDTH);
            let regions = &fields.regions[cells.start + first..cells.start + end];
            sigmas.clear();
            for q in 0..rule.weights.len() {
                let field = |k: usize| Lanes::load(&values[k][count * q + first..count * q + end]);
                let (_, sigma) = fields.of_cells::<D>(regions, field, &mut memory);
                sigmas.push(mandel(&sigma));
            }
            onto.strains.project(&sigmas, &mut projected);
            append(means, end - first, &projected);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_cell_has_the_law_of_its_own_region() {
        // In lane l of region r: 10 r + l.
        let law = |region: usize| {
            let lanes = Lanes(std::array::from_fn(|l| (10 * region + l) as f64));
            [[lanes; 2]; 2]
        };
        let lanes = |regions: &[usize]| by_region(regions, law)[0][1].0;
        assert_eq!(lanes(&[2, 2, 2, 2]), [20.0, 21.0, 22.0, 23.0]);
        assert_eq!(lanes(&[0, 3, 0, 1]), [0.0, 31.0, 2.0, 13.0]);
        // Of the last cells of a run only some lanes count.
        assert_eq!(lanes(&[1, 0])[..2], [10.0, 1.0]);
    }
}
