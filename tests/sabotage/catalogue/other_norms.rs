//! Wrong measures in the norms beside V_max.

use std::sync::Arc;

use fem::contact::{CaseError, CaseInfo, LoadError, Observer, StepView};
use fem::norms::Moments;
use judge::record::CaseRecord;
use scene::setup::{MeshData, Scheme, Setup};

use super::{Defect, MomentSeed, Site, Term};

/// The levels of a scheme with a part of each left out.
struct Without {
    sound: Arc<dyn Scheme>,
    history: bool,
    multiplier: bool,
}

impl Scheme for Without {
    fn march(
        &self,
        setup: &Setup,
        data: &MeshData,
        steps: u32,
        observe: &mut Observer<'_>,
    ) -> Result<CaseInfo, CaseError> {
        self.sound.march(setup, data, steps, &mut |view| {
            let history: Vec<Vec<f64>> =
                view.history.iter().map(|term| vec![0.0; term.len()]).collect();
            let multiplier = vec![0.0; view.multiplier.len()];
            let mut seen = StepView { ..*view };
            if self.history {
                seen.history = &history;
            }
            if self.multiplier {
                seen.multiplier = &multiplier;
            }
            observe(&seen)
        })
    }
}

fn without(mut setup: Setup, history: bool, multiplier: bool) -> Setup {
    setup.scheme = Arc::new(Without { sound: setup.scheme, history, multiplier });
    setup
}

fn changed(
    site: &Site<'_>,
    t: f64,
    change: impl FnOnce(&mut Moments),
) -> Result<Moments, LoadError> {
    let mut moments = (*site.sound.moments(t)?).clone();
    change(&mut moments);
    Ok(moments)
}

fn stress_without_rest(site: &Site<'_>, t: f64) -> Result<Moments, LoadError> {
    changed(site, t, |moments| moments.stress.rest = 0.0)
}

fn displacement_without_rest(site: &Site<'_>, t: f64) -> Result<Moments, LoadError> {
    changed(site, t, |moments| moments.displacement.rest = 0.0)
}

fn boundary_without_rest(site: &Site<'_>, t: f64) -> Result<Moments, LoadError> {
    changed(site, t, |moments| (moments.normal.rest, moments.pressure.rest) = (0.0, 0.0))
}

/// The exact locked set on the first half of the facets alone.
fn half_a_set(site: &Site<'_>, t: f64) -> Result<Moments, LoadError> {
    changed(site, t, |moments| {
        let half = moments.locked.len() / 2;
        moments.locked[half..].fill(false);
    })
}

/// Errors in one norm times a factor that may depend on n.
fn scaled(mut records: Vec<CaseRecord>, norm: &str, factor: fn(f64) -> f64) -> Vec<CaseRecord> {
    for record in &mut records {
        let by = record.n.map_or(1.0, |n| factor(f64::from(n)));
        for entry in record.errors.iter_mut().filter(|entry| entry.norm == norm) {
            entry.error = entry.error.map(|error| error * by);
        }
    }
    records
}

/// The share of a norm on n facets of one length that is left without one of them, its error that of the mean.
fn without_a_facet(n: f64) -> f64 {
    (1.0 - 1.0 / n).sqrt()
}

pub fn defects() -> Vec<Defect> {
    let none = |name| Defect::none(Term::Measurement, name);
    let sees = |name, measured: fn(Setup) -> Setup| Defect { measured, ..none(name) };
    let measures = |name, moments: MomentSeed| Defect { moments: Some(moments), ..none(name) };
    let writes =
        |name, records: fn(Vec<CaseRecord>) -> Vec<CaseRecord>| Defect { records, ..none(name) };
    vec![
        measures("stress norm without its remainder", stress_without_rest),
        measures("L² norm without its remainder", displacement_without_rest),
        measures("norms on Γ3 without their remainders", boundary_without_rest),
        measures("exact contact set on half of the facets", half_a_set),
        sees("stress without the memory", |setup| without(setup, true, false)),
        sees("pressure without its multiplier", |setup| without(setup, false, true)),
        writes("L² norm with the mass of an edge", |records| {
            // |T|/6 in place of |T|/12.
            scaled(records, "L2_max", |_| 2f64.sqrt())
        }),
        writes("trace norm without one facet", |records| {
            scaled(records, "trace_L2_max", without_a_facet)
        }),
        writes("pressure norm without one facet", |records| {
            scaled(records, "pressure_L2_max", without_a_facet)
        }),
    ]
}
