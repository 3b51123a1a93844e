//! Wrong measures in the norms beside V_max.

use fem::contact::StepView;

use super::Defect;
use super::Term::Measurement;

/// Errors in one norm times a factor that may depend on n.
fn scaled(name: &'static str, norm: &'static str, factor: fn(f64) -> f64) -> Defect {
    Measurement.each(name, move |record| {
        let by = record.n.map_or(1.0, |n| factor(f64::from(n)));
        for entry in record.errors.iter_mut().filter(|entry| entry.norm == norm) {
            entry.error = entry.error.map(|error| error * by);
        }
    })
}

/// The share of a norm on n facets of one length that is left without one of them, its error that of the mean.
fn without_a_facet(n: f64) -> f64 {
    (1.0 - 1.0 / n).sqrt()
}

pub fn defects() -> Vec<Defect> {
    vec![
        Measurement.moments("stress norm without its remainder", |_, _, moments| {
            moments.stress.rest = 0.0;
        }),
        Measurement.moments("L² norm without its remainder", |_, _, moments| {
            moments.displacement.rest = 0.0;
        }),
        Measurement.moments("norms on Γ3 without their remainders", |_, _, moments| {
            (moments.normal.rest, moments.pressure.rest) = (0.0, 0.0);
        }),
        Measurement.moments("exact contact set on half of the facets", |_, _, moments| {
            let half = moments.locked.len() / 2;
            moments.locked[half..].fill(false);
        }),
        Measurement.seen("stress without the memory", |_, view, observe| {
            let history: Vec<Vec<f64>> = view.history.iter().map(|h| vec![0.0; h.len()]).collect();
            observe(&StepView { history: &history, ..*view })
        }),
        Measurement.seen("pressure without its multiplier", |_, view, observe| {
            observe(&StepView { multiplier: &vec![0.0; view.multiplier.len()], ..*view })
        }),
        // |T|/6 in place of |T|/12.
        scaled("L² norm with the mass of an edge", "L2_max", |_| 2f64.sqrt()),
        scaled("trace norm without one facet", "trace_L2_max", without_a_facet),
        scaled("pressure norm without one facet", "pressure_L2_max", without_a_facet),
    ]
}
