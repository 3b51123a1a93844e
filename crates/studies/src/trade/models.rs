//! What the runs with one element say: the error and the cost as functions of h and k.

use super::measure::Bench;
use super::{Composition, CostModel, CostSample, ErrorModel, Trial, Variant};
use judge::fit::{Point, Sample};
use serde::{Serialize, Serializer};

/// Models of error and cost.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct Models {
    /// The error, or why it was not fitted.
    #[serde(rename = "error_model", serialize_with = "or_reason")]
    pub error: Result<ErrorModel, String>,
    /// The cost, likewise.
    #[serde(rename = "cost_model", serialize_with = "or_reason")]
    pub cost: Result<CostModel, String>,
    /// The cost as a sum of parts, for predictions.
    pub composition: Option<Composition>,
}

impl Models {
    /// Fits the rows of a variant on the meshes `n`, whose runs are in `bench`.
    pub(super) fn fit(
        bench: &Bench,
        variant: &Variant,
        trials: &[Trial],
        [n, steps]: [&[u32]; 2],
    ) -> Self {
        let setup = &variant.setup;
        let on_mesh = setup.body.data.is_interpolated();
        let rows = || trials.iter().filter(|trial| trial.knob == variant.knob);
        let done = || rows().filter_map(|trial| Some((trial, trial.done()?)));
        let points: Vec<Point> = done()
            .map(|(t, run)| Point { h: t.h, k: t.k, error: run.error, floor: run.floor })
            .collect();
        let differences = differences(bench, variant, n, steps);
        let samples: Vec<CostSample> =
            done().map(|(t, run)| CostSample { h: t.h, k: t.k, seconds: run.seconds }).collect();
        let cost = CostModel::fit(&samples).map_err(|error| error.to_string());
        let composition = cost.as_ref().ok().and_then(|_| {
            Composition::fit(&samples, setup.scene.dimension, setup.scene.time.horizon)
        });
        Self { error: ErrorModel::fit(&points, &differences, on_mesh), cost, composition }
    }

    /// Both models, where both were fitted.
    pub(super) fn both(&self) -> Option<(&ErrorModel, &CostModel)> {
        self.error.as_ref().ok().zip(self.cost.as_ref().ok())
    }

    /// Predicted seconds at (h, k): by the parts where they are known.
    pub(super) fn seconds(&self, cost: &CostModel, h: f64, k: f64) -> f64 {
        self.composition.as_ref().map_or_else(|| cost.seconds(h, k), |sum| sum.seconds(h, k))
    }
}

/// A model, or `{"reason": …}`.
fn or_reason<T: Serialize, S: Serializer>(
    found: &Result<T, String>,
    serializer: S,
) -> Result<S::Ok, S::Error> {
    match found {
        Ok(model) => model.serialize(serializer),
        Err(reason) => serializer.collect_map([("reason", reason)]),
    }
}

/// C k^q without space error on the finest mesh, from runs with k and k/r: ‖u_k - u_{k/r}‖ = C k^q (1 - r^-q). The
/// factor is that of the order which the differences themselves show.
fn differences(bench: &Bench, variant: &Variant, n: &[u32], steps: &[u32]) -> Vec<Sample> {
    let Some(&n) = n.last() else { return Vec::new() };
    let ratio = |pair: &[u32]| pair[1].is_multiple_of(pair[0]).then(|| pair[1] / pair[0]);
    let Some(r) = steps.windows(2).next().and_then(ratio) else { return Vec::new() };
    let pairs = steps.windows(2).take_while(|pair| ratio(pair) == Some(r));
    let apart: Vec<Sample> = pairs
        .filter_map(|pair| {
            let error = bench.apart_in_time(variant.element(), n, [pair[0], pair[1]])?;
            let step = variant.setup.grid(pair[0]).largest_step();
            (error > 0.0).then_some(Sample { step, error })
        })
        .collect();
    let Some(order) = judge::fit::local_slopes(&apart).last().copied() else { return Vec::new() };
    let missing = 1.0 - f64::from(r).powf(-order);
    if !(order > 0.0 && missing > 0.0) {
        return Vec::new();
    }
    apart.into_iter().map(|s| Sample { error: s.error / missing, ..s }).collect()
}
