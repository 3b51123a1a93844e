//! Error and bounds over the horizon T at a fixed step k: is the error uniform in T, or does it grow
//! like e^{C2 T}? The theory is on R₊ with constants for each [0, T].

use super::GronwallError;
use super::bounds::Bounds;
use super::estimate::Judged;
use super::prepare::prepare;
use algebra::linalg::largest;
use scene::setup::Subject;

/// Error and bounds on [0, T].
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct HorizonRow {
    /// T.
    pub horizon: f64,
    /// N = T/k.
    pub steps: u32,
    /// max_{n ≤ N} e_n.
    pub error: f64,
    /// max_{n ≤ N} g_n β_φ/m0.
    pub truncation: f64,
    /// Maxima of the envelopes.
    #[serde(flatten)]
    pub bounds: Bounds<f64>,
    /// C2 on [0, T].
    pub c2: f64,
    /// log(error(T)/error(T'))/(T - T') from the horizon T' before; compare with C2.
    pub growth: Option<f64>,
}

/// A run to the longest horizon, and its rows.
#[derive(serde::Serialize)]
pub struct Horizons {
    /// k.
    pub k: f64,
    /// Where the truth comes from.
    pub truth: String,
    /// One row a horizon, increasing.
    pub rows: Vec<HorizonRow>,
    /// The run to the longest horizon, with the links that fail on some horizon.
    #[serde(skip)]
    pub judged: Judged,
}

/// Runs the scene with the step k to the longest of `horizons`: on a uniform grid the run to a
/// shorter one is its beginning.
///
/// # Errors
/// A horizon that is no multiple of k; those of the run.
pub(crate) fn horizons(
    subject: &Subject,
    n: Option<u32>,
    k: f64,
    horizons: &[f64],
) -> Result<Horizons, GronwallError> {
    let scene = subject.scene();
    if scene.time.grid != scene::TimeGrid::Uniform {
        return Err(GronwallError::NotUniform { scene: scene.name.clone() });
    }
    let mut sorted = horizons.to_vec();
    sorted.sort_by(f64::total_cmp);
    sorted.dedup();
    let steps: Vec<u32> =
        sorted.iter().map(|&horizon| whole_steps(horizon, k)).collect::<Result<_, _>>()?;
    let (longest, last) = (sorted[sorted.len() - 1], steps[steps.len() - 1]);
    // Formulas are defined for all t; what validation samples over the horizon (exact contact state,
    // constants) is sampled again.
    let mut longer = scene.clone();
    longer.time.horizon = longest;
    let longer = Subject::new(longer)?;
    let in_time = prepare(&longer, n, &[last])?;
    let run = in_time.measure(last)?;
    let mut rows: Vec<HorizonRow> = Vec::new();
    let mut violations = Vec::new();
    for (&horizon, &steps) in sorted.iter().zip(&steps) {
        let judged = Judged::new(run.up_to(steps as usize))?;
        let estimate = &judged.estimate;
        let error = largest(&estimate.error);
        let before = rows.last();
        rows.push(HorizonRow {
            horizon,
            steps,
            error,
            truncation: largest(&estimate.source) / estimate.m0,
            bounds: judged.envelopes.map(|bound| largest(bound)),
            c2: estimate.c2(),
            growth: before
                .filter(|before| before.error > 20.0 * estimate.floor)
                .map(|before| (error / before.error).ln() / (horizon - before.horizon)),
        });
        violations.extend(judged.violations);
    }
    let judged = Judged { violations, ..Judged::new(run)? };
    Ok(Horizons { k, truth: in_time.truth(), rows, judged })
}

/// T/k, if that is a whole number.
pub(super) fn whole_steps(horizon: f64, k: f64) -> Result<u32, GronwallError> {
    let steps = horizon / k;
    let whole = steps.round();
    let fits =
        whole >= 1.0 && whole <= f64::from(u32::MAX) && (steps - whole).abs() <= 1e-9 * whole;
    if fits { Ok(whole as u32) } else { Err(GronwallError::Horizon { horizon, k }) }
}
