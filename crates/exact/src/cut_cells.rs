//! Moments of cells cut by a kink, with a rule on each side of it.
//!
//! Only means and remainders for errors are corrected. Loads keep the rule attributed to the scheme, whose error is
//! measured separately.

use super::constitutive::{mandel, stress};
use super::cuts::{Cut, Cuts};
use super::fields::Fields;
use super::onto::Onto;
use fem::norms::Moments;
use fem::space::quadrature::Rule;

/// Projections of the fields on one cell onto the element, and the mean squares of the remainders of ε, σ and u.
#[derive(Default)]
struct CellMoments<const D: usize, const N: usize> {
    strain: Vec<[f64; N]>,
    stress: Vec<[f64; N]>,
    displacement: Vec<[f64; D]>,
    rest: [f64; 3],
}

impl Fields<'_> {
    /// Recomputes the moments of cut cells by the rule of `whole` cells on their pieces. A cell with new non-finite
    /// values is left as it is.
    pub(super) fn correct<const D: usize, const N: usize>(
        &self,
        cuts: &Cuts,
        whole: &Rule,
        moments: &mut Moments,
    ) {
        let cut = cuts.rules(&self.space.mesh, whole, self.t);
        let rules =
            cut.iter().flat_map(|Cut { simplex, rule }| [whole, rule].map(|rule| (*simplex, rule)));
        let points = cuts.points(&self.space.mesh, rules);
        let values = self.exact.interior.values(&points, self.t, 0.0);
        let onto = Onto::new(self.space.element, whole);
        let mut first = 0;
        for Cut { simplex, rule } in &cut {
            let [whole, pieces] = [(&onto, whole), (&onto.by(rule), rule)].map(|(onto, rule)| {
                let of_cell = self.of_cell::<D, N>(*simplex, onto, &rule.weights, &values, first);
                first += rule.weights.len();
                of_cell
            });
            if whole.rest.iter().chain(&pieces.rest).all(|rest| rest.is_finite()) {
                let measure = self.space.geometry.measure[*simplex];
                replace(moments, (*simplex, measure), &whole.rest, &pieces);
            }
        }
    }

    /// The moments of cell c by a rule whose values begin at `first`.
    fn of_cell<const D: usize, const N: usize>(
        &self,
        c: usize,
        onto: &Onto,
        weights: &[f64],
        values: &[Vec<f64>],
        first: usize,
    ) -> CellMoments<D, N> {
        let material = self.exact.material_in(self.regions[c]);
        let (mut strains, mut stresses, mut memory) = (Vec::new(), Vec::new(), Vec::new());
        let mut displacements: Vec<[f64; D]> = Vec::new();
        for p in first..first + weights.len() {
            let strain = self.exact.tensors::<D, f64>(|k| values[k][p], &mut memory);
            strains.push(mandel::<D, N, f64>(&strain));
            stresses.push(mandel(&stress(material, &strain, &memory, self.kappa)));
            displacements.push(std::array::from_fn(|i| values[i][p]));
        }
        let mut moments = CellMoments::default();
        onto.strains.split(&mut strains, &mut moments.strain);
        onto.strains.split(&mut stresses, &mut moments.stress);
        onto.functions.split(&mut displacements, &mut moments.displacement);
        moments.rest = [
            mean_square(&strains, weights),
            mean_square(&stresses, weights),
            mean_square(&displacements, weights),
        ];
        moments
    }
}

/// Replaces the moments of the whole cell c, and its mean squares, by those of its pieces.
fn replace<const D: usize, const N: usize>(
    Moments { strain, stress, displacement, .. }: &mut Moments,
    (c, measure): (usize, f64),
    whole: &[f64; 3],
    pieces: &CellMoments<D, N>,
) {
    let rests = [&mut strain.rest, &mut stress.rest, &mut displacement.rest];
    for (rest, (pieces, whole)) in rests.into_iter().zip(pieces.rest.iter().zip(whole)) {
        // If all cells are cut, the rest may be rounding of either sign.
        *rest = (*rest + measure * (pieces - whole)).max(0.0);
    }
    let of_cell = |numbers: &[f64]| numbers.len() * c..numbers.len() * (c + 1);
    for (all, numbers) in [
        (&mut strain.at, pieces.strain.as_flattened()),
        (&mut stress.at, pieces.stress.as_flattened()),
        (&mut displacement.node, pieces.displacement.as_flattened()),
    ] {
        all[of_cell(numbers)].copy_from_slice(numbers);
    }
}

fn mean_square<const N: usize>(values: &[[f64; N]], weights: &[f64]) -> f64 {
    let square = |value: &[f64; N]| value.iter().map(|v| v * v).sum::<f64>();
    values.iter().zip(weights).map(|(value, weight)| weight * square(value)).sum()
}
