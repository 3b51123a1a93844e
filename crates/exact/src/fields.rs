//! Exact fields on a mesh at one time: their moments and nodal forces.

use std::ops::Range;

use super::constitutive::off_diagonal;
use super::cuts::{Cut, Cuts};
use super::exact::Exact;
use super::nodal_force::add_means;
use super::onto::{Onto, Projector};
use super::sampled::{Sampled, tensor_names, vector_names};
use super::shapes::Work;
use super::symbolic::components;
use fem::contact::{Discretization, LoadError};
use fem::norms::Moments;
use fem::space::quadrature::Rule;

/// The fields at a time.
pub(super) struct Fields<'a> {
    pub exact: &'a Exact,
    pub space: &'a Discretization,
    pub t: f64,
    pub zeta: f64,
}

/// u, ε or σ with factors, as [`Projector::split`] takes them.
type Field<'a> = Vec<(&'a [f64], f64)>;

/// u, ε and σ among the outputs of [`Exact::fields`], tensors in the notation of moments, see [`off_diagonal`].
fn in_notation_of_moments<'a>(d: usize, values: &[&'a [f64]]) -> [Field<'a>; 3] {
    let (of_pairs, root) = (components(d), std::f64::consts::SQRT_2);
    let diagonal = (0..d).map(|i| ((i, i), 1.0));
    let pairs = diagonal.chain(off_diagonal(d).iter().map(|&pair| (pair, root)));
    let place = |pair| of_pairs.iter().position(|known| *known == pair).expect("a pair i ≤ j");
    let order: Vec<(usize, f64)> = pairs.map(|(pair, factor)| (place(pair), factor)).collect();
    let tensor =
        |first: usize| order.iter().map(|&(k, factor)| (values[first + k], factor)).collect();
    let u = values[..d].iter().map(|values| (*values, 1.0)).collect();
    [u, tensor(d), tensor(d + of_pairs.len())]
}

impl Fields<'_> {
    /// Passes u, ε and σ to `visit`, run by run, see [`Sampled::each_block`].
    pub(super) fn each_block(
        &self,
        points: &Sampled,
        visit: impl FnMut(Range<usize>, &[&[f64]]),
    ) -> Result<(), LoadError> {
        let d = self.exact.dimension();
        let names = [vector_names("u", d), tensor_names("ε", d)].concat();
        let at = (self.t, self.zeta);
        points.each_block(&self.space.mesh, &self.exact.fields, at, &names, visit)
    }

    /// The moments in the cells.
    pub(super) fn moments(&self, points: &Sampled) -> Result<Moments, LoadError> {
        let (d, mut sums) = (self.exact.dimension(), Moments::default());
        let tensors = self.exact.strain.len() * self.space.geometry.points();
        sums.strain.at.reserve_exact(tensors);
        sums.stress.at.reserve_exact(tensors);
        sums.displacement.node.reserve_exact(d * self.space.nodes.cells.len());
        let onto = &Onto::new(self.space.element, &points.rule);
        self.each_block(points, |cells, values| {
            let measures = &self.space.geometry.measure[cells];
            let [u, strain, stress] = in_notation_of_moments(d, values);
            let Moments { strain: of_strain, stress: of_stress, displacement, .. } = &mut sums;
            of_strain.rest += onto.strains.split(&strain, measures, &mut of_strain.at);
            of_stress.rest += onto.strains.split(&stress, measures, &mut of_stress.at);
            displacement.rest += onto.functions.split(&u, measures, &mut displacement.node);
        })?;
        Ok(sums)
    }

    /// Recomputes the moments of cells cut by a kink by the rule of `whole` cells on their pieces. A cell with new
    /// non-finite values is left as it is. Loads keep the rule attributed to the scheme, whose error is measured
    /// separately.
    pub(super) fn correct(&self, cuts: &Cuts, whole: &Rule, moments: &mut Moments) {
        let cut = cuts.rules(&self.space.mesh, whole, self.t);
        let rules =
            cut.iter().flat_map(|Cut { simplex, rule }| [whole, rule].map(|rule| (*simplex, rule)));
        let points = cuts.points(&self.space.mesh, rules);
        let values = self.exact.fields.values(&points, self.t, self.zeta);
        let onto = Onto::new(self.space.element, whole);
        let mut first = 0;
        for Cut { simplex, rule } in &cut {
            let measure = self.space.geometry.measure[*simplex];
            let [before, pieces] = [(&onto, whole), (&onto.by(rule), rule)].map(|(onto, rule)| {
                let range = first..first + rule.weights.len();
                first = range.end;
                let of_cell: Vec<&[f64]> = values.iter().map(|all| &all[range.clone()]).collect();
                let [u, strain, stress] = in_notation_of_moments(self.exact.dimension(), &of_cell);
                let of = |onto: &Projector, field: &Field<'_>| {
                    let mut numbers = Vec::new();
                    (onto.split(field, &[measure], &mut numbers), numbers)
                };
                let strains = &onto.strains;
                [of(strains, &strain), of(strains, &stress), of(&onto.functions, &u)]
            });
            if before.iter().chain(&pieces).all(|(rest, _)| rest.is_finite()) {
                let Moments { strain, stress, displacement, .. } = moments;
                let targets = [
                    (&mut strain.rest, &mut strain.at),
                    (&mut stress.rest, &mut stress.at),
                    (&mut displacement.rest, &mut displacement.node),
                ];
                for ((rest, all), (before, (after, numbers))) in
                    targets.into_iter().zip(before.iter().zip(pieces))
                {
                    // If all cells are cut, the rest may be rounding of either sign.
                    *rest = (*rest + (after - before.0)).max(0.0);
                    all[numbers.len() * simplex..][..numbers.len()].copy_from_slice(&numbers);
                }
            }
        }
    }

    /// ∫ σ:ε(v), over all nodes.
    pub(crate) fn stress_force<const D: usize>(
        &self,
        points: &Sampled,
    ) -> Result<Vec<f64>, LoadError> {
        let (space, onto) = (self.space, &Onto::new(self.space.element, &points.rule));
        let work = Work::new(space.element, D);
        let (mut force, mut means) = (vec![0.0; space.nodes.len()], Vec::new());
        self.each_block(points, |cells, values| {
            means.clear();
            let [.., stress] = in_notation_of_moments(D, values);
            onto.strains.split(&stress, &space.geometry.measure[cells.clone()], &mut means);
            add_means::<D>((space, &work), cells, &means, &mut force);
        })?;
        Ok(force)
    }
}
