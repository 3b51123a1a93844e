//! Moments of cells cut by a kink, with a rule on each side of it.
//!
//! Only means and remainders for errors are corrected. Loads keep the rule attributed to the scheme, whose error is
//! measured separately.

use super::constitutive::{Tensor, mandel, stress};
use super::cuts::{Cut, Cuts};
use super::onto::Onto;
use super::parts::Parts;
use fem::norms::Moments;
use fem::space::quadrature::Rule;

/// The fields of one cell at the points of a rule.
struct Fields<const D: usize, const N: usize> {
    strain: Vec<[f64; N]>,
    stress: Vec<[f64; N]>,
    displacement: Vec<[f64; D]>,
}

/// Projections of the fields on one cell onto the element, and the mean squares of the remainders of ε, σ and u.
#[derive(Default)]
struct CellMoments<const D: usize, const N: usize> {
    strain: Vec<[f64; N]>,
    stress: Vec<[f64; N]>,
    displacement: Vec<[f64; D]>,
    rest: [f64; 3],
}

/// Recomputes the moments of cut cells by `rule` on their pieces; returns the previous means of σ. A cell with new
/// non-finite values is left as it is.
pub(super) fn correct<const D: usize>(
    cuts: &Cuts,
    parts: &Parts<'_>,
    rule: &Rule,
    moments: &mut Moments,
) -> Vec<(usize, Vec<f64>)> {
    match D {
        2 => Correction::<D, 3> { parts, rule, moments }.all(cuts),
        _ => Correction::<D, 6> { parts, rule, moments }.all(cuts),
    }
}

/// For tensors of N numbers.
struct Correction<'a, const D: usize, const N: usize> {
    parts: &'a Parts<'a>,
    rule: &'a Rule,
    moments: &'a mut Moments,
}

impl<const D: usize, const N: usize> Correction<'_, D, N> {
    fn all(mut self, cuts: &Cuts) -> Vec<(usize, Vec<f64>)> {
        let whole = self.rule;
        let cut = cuts.rules(&self.parts.space.mesh, whole, self.parts.t);
        let rules =
            cut.iter().flat_map(|Cut { simplex, rule }| [whole, rule].map(|rule| (*simplex, rule)));
        let points = cuts.points(&self.parts.space.mesh, rules);
        let values = self.parts.exact.interior.values(&points, self.parts.t, 0.0);
        let onto = Onto::new(self.parts.space.element, whole);
        let (mut first, mut before) = (0, Vec::new());
        for Cut { simplex, rule } in &cut {
            let [whole, pieces] = [(&onto, whole), (&onto.by(rule), rule)].map(|(onto, rule)| {
                let moments = self.of_cell(*simplex, onto, &rule.weights, &values, first);
                first += rule.weights.len();
                moments
            });
            if whole.rest.iter().chain(&pieces.rest).all(|rest| rest.is_finite()) {
                before.push(self.replace(*simplex, &whole, &pieces));
            }
        }
        before
    }

    /// The moments of cell c by a rule whose values begin at `first`.
    fn of_cell(
        &self,
        c: usize,
        onto: &Onto,
        weights: &[f64],
        values: &[Vec<f64>],
        first: usize,
    ) -> CellMoments<D, N> {
        let exact = self.parts.exact;
        let material = exact.material_in(self.parts.regions[c]);
        let mut fields =
            Fields { strain: Vec::new(), stress: Vec::new(), displacement: Vec::new() };
        let mut memory: Vec<Tensor<D>> = Vec::new();
        for p in first..first + weights.len() {
            let strain = exact.tensors(|k| values[k][p], &mut memory);
            let sigma = stress(material, &strain, &memory, self.parts.kappa);
            fields.strain.push(mandel(&strain));
            fields.stress.push(mandel(&sigma));
            fields.displacement.push(std::array::from_fn(|i| values[i][p]));
        }
        let mut moments = CellMoments::default();
        onto.strains.split(&mut fields.strain, &mut moments.strain);
        onto.strains.split(&mut fields.stress, &mut moments.stress);
        onto.functions.split(&mut fields.displacement, &mut moments.displacement);
        moments.rest = [
            mean_square(&fields.strain, weights),
            mean_square(&fields.stress, weights),
            mean_square(&fields.displacement, weights),
        ];
        moments
    }

    /// Replaces the moments of the whole cell c by those of its pieces; returns the previous σ.
    fn replace(
        &mut self,
        c: usize,
        whole: &CellMoments<D, N>,
        pieces: &CellMoments<D, N>,
    ) -> (usize, Vec<f64>) {
        let measure = self.parts.space.geometry.measure[c];
        let Moments { strain, stress, displacement, .. } = &mut *self.moments;
        let rests = [&mut strain.rest, &mut stress.rest, &mut displacement.rest];
        for (rest, (pieces, whole)) in rests.into_iter().zip(pieces.rest.iter().zip(&whole.rest)) {
            // If all cells are cut, the rest may be rounding of either sign.
            *rest = (*rest + measure * (pieces - whole)).max(0.0);
        }
        let numbers = N * pieces.strain.len();
        let range = numbers * c..numbers * (c + 1);
        let before = stress.at[range.clone()].to_vec();
        strain.at[range.clone()].copy_from_slice(pieces.strain.as_flattened());
        stress.at[range].copy_from_slice(pieces.stress.as_flattened());
        let numbers = D * pieces.displacement.len();
        let target = &mut displacement.node[numbers * c..numbers * (c + 1)];
        target.copy_from_slice(pieces.displacement.as_flattened());
        (c, before)
    }
}

fn mean_square<const N: usize>(values: &[[f64; N]], weights: &[f64]) -> f64 {
    let square = |value: &[f64; N]| value.iter().map(|v| v * v).sum::<f64>();
    values.iter().zip(weights).map(|(value, weight)| weight * square(value)).sum()
}
