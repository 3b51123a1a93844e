//! Uncertainty of a functional by least squares on three or more grids.
//!
//! L. Eça, M. Hoekstra, "A procedure for the estimation of the numerical uncertainty of CFD calculations based on grid
//! refinement studies", J. Comput. Phys. 262 (2014) 104-130; the variant for methods of nominal order two, which P1
//! elements are in L² functionals and the trapezoidal rule is.

use nalgebra::{DMatrix, DVector};
use serde::Serialize;

use super::ValueSample;

const GRIDS: usize = 3;

/// Range of orders in which the power expansion is kept; up to its end the small safety factor applies.
const TRUSTED: [f64; 2] = [0.5, 2.0];
const TRUSTED_WITH_MARGIN: f64 = 2.1;

const SAFE: f64 = 1.25;
const DOUBTFUL: f64 = 3.0;

/// Search range of the order; an optimum at either end does not count.
const ORDERS: [f64; 2] = [-4.0, 8.0];
const ORDER_STEP: f64 = 0.05;

/// The error expansions φ − φ₀ among which the procedure chooses.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(into = "String")]
pub enum Expansion {
    Power(f64),
    First,
    Second,
    Mixed,
}

impl From<Expansion> for String {
    fn from(expansion: Expansion) -> Self {
        match expansion {
            Expansion::Power(p) => format!("α h^{p:.2}"),
            Expansion::First => "α h".into(),
            Expansion::Second => "α h²".into(),
            Expansion::Mixed => "α h + β h²".into(),
        }
    }
}

/// What the procedure says of the finest grid.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct EcaHoekstra {
    /// The expansion that was chosen.
    #[serde(flatten)]
    pub fit: ExpansionFit,
    /// Order of the power expansion, even if another was chosen; none without an optimum.
    #[serde(rename = "order")]
    pub observed_order: Option<f64>,
    /// Data range Δφ = (max φ − min φ)/(n − 1), with which σ is compared.
    pub data_range: f64,
    /// Factor of safety, 1.25 or 3.
    pub safety: f64,
    /// Uncertainty of the value on the finest grid, in units of the value.
    pub uncertainty: f64,
}

/// One expansion, fitted.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct ExpansionFit {
    pub expansion: Expansion,
    /// Whether the grids were weighted with 1/h.
    pub weighted: bool,
    pub limit: f64,
    pub deviation: f64,
    /// On the finest grid: the error by the expansion, and the misfit.
    #[serde(skip)]
    error: f64,
    #[serde(skip)]
    distance: f64,
}

/// The procedure on values in direction of refinement; none for fewer than three.
pub fn eca_hoekstra(samples: &[ValueSample]) -> Option<EcaHoekstra> {
    if samples.len() < GRIDS {
        return None;
    }
    let powers = [false, true].map(|weighted| power_fit(samples, weighted));
    let observed = smallest(powers.into_iter().flatten());
    let order = observed.and_then(|fit| match fit.expansion {
        Expansion::Power(order) => Some(order),
        _ => None,
    });
    let fit = match (observed, order) {
        (Some(fit), Some(p)) if (TRUSTED[0]..=TRUSTED[1]).contains(&p) => fit,
        (_, Some(p)) if p > TRUSTED[1] => chosen(samples, &[Expansion::First, Expansion::Second])?,
        _ => chosen(samples, &[Expansion::First, Expansion::Second, Expansion::Mixed])?,
    };
    let data_range = data_range(samples);
    let steady = fit.deviation < data_range;
    let trusted = order.is_some_and(|p| (TRUSTED[0]..TRUSTED_WITH_MARGIN).contains(&p));
    let safety = if trusted && steady { SAFE } else { DOUBTFUL };
    let uncertainty = if steady {
        safety * fit.error.abs() + fit.deviation + fit.distance
    } else {
        DOUBTFUL * fit.deviation / data_range * (fit.error.abs() + fit.deviation + fit.distance)
    };
    // All values equal: no range, deviation or error.
    let uncertainty = if data_range == 0.0 { 0.0 } else { uncertainty };
    Some(EcaHoekstra { fit, observed_order: order, data_range, safety, uncertainty })
}

fn data_range(samples: &[ValueSample]) -> f64 {
    let values = || samples.iter().map(|sample| sample.value);
    let hi = values().fold(f64::NEG_INFINITY, f64::max);
    let lo = values().fold(f64::INFINITY, f64::min);
    (hi - lo) / (samples.len() - 1) as f64
}

/// The expansion of smallest deviation, with and without weights.
fn chosen(samples: &[ValueSample], expansions: &[Expansion]) -> Option<ExpansionFit> {
    let fits = expansions.iter().flat_map(|expansion| {
        [false, true].map(|weighted| expansion_fit(samples, *expansion, weighted))
    });
    smallest(fits.flatten())
}

fn smallest(fits: impl Iterator<Item = ExpansionFit>) -> Option<ExpansionFit> {
    fits.min_by(|a, b| a.deviation.total_cmp(&b.deviation))
}

/// Power expansion with the p of least deviation, by a scan and golden section; none if the optimum is at an end of the
/// scan.
fn power_fit(samples: &[ValueSample], weighted: bool) -> Option<ExpansionFit> {
    let fit = |p: f64| expansion_fit(samples, Expansion::Power(p), weighted);
    let deviation = |p: f64| fit(p).map_or(f64::INFINITY, |fit| fit.deviation);
    let count = ((ORDERS[1] - ORDERS[0]) / ORDER_STEP).round() as usize;
    let place = |i: usize| ORDERS[0] + ORDER_STEP * i as f64;
    let best = (0..=count).min_by(|a, b| deviation(place(*a)).total_cmp(&deviation(place(*b))))?;
    if best == 0 || best == count {
        return None;
    }
    let golden = 0.5 * (5f64.sqrt() - 1.0);
    let (mut lo, mut hi) = (place(best - 1), place(best + 1));
    // 0.618^60: the interval 0.1 shrinks below the rounding of p.
    for _ in 0..60 {
        let (left, right) = (hi - golden * (hi - lo), lo + golden * (hi - lo));
        if deviation(left) < deviation(right) { hi = right } else { lo = left }
    }
    fit(0.5 * (lo + hi))
}

/// Linear least squares of φ on 1 and the terms of the expansion; weights 1 or 1/h.
fn expansion_fit(
    samples: &[ValueSample],
    expansion: Expansion,
    weighted: bool,
) -> Option<ExpansionFit> {
    let finest = samples.last()?;
    // Steps relative to the finest, so that all terms are 1 there.
    let terms = |step: f64| -> Vec<f64> {
        let s = step / finest.step;
        match expansion {
            Expansion::Power(p) => vec![power_term(p, s)],
            Expansion::First => vec![s - 1.0],
            Expansion::Second => vec![s * s - 1.0],
            Expansion::Mixed => vec![s - 1.0, s * s - 1.0],
        }
    };
    let columns = 1 + terms(finest.step).len();
    let parameters = columns + usize::from(matches!(expansion, Expansion::Power(_)));
    let freedom = match (samples.len().checked_sub(parameters)?, expansion) {
        // Three grids fit exactly; avoids 0/0.
        (0, Expansion::Power(_)) => 1,
        (0, _) => return None,
        (freedom, _) => freedom,
    };
    let inverse_sum: f64 = samples.iter().map(|sample| 1.0 / sample.step).sum();
    let count = samples.len() as f64;
    let weight = |sample: &ValueSample| {
        if weighted { count / (sample.step * inverse_sum) } else { 1.0 }
    };
    let rows: Vec<Vec<f64>> = samples.iter().map(|sample| terms(sample.step)).collect();
    let design = DMatrix::from_fn(samples.len(), columns, |i, j| {
        let root = weight(&samples[i]).sqrt();
        if j == 0 { root } else { root * rows[i][j - 1] }
    });
    // Relative to the finest value, against cancellation.
    let values = DVector::from_fn(samples.len(), |i, _| {
        weight(&samples[i]).sqrt() * (samples[i].value - finest.value)
    });
    let (q, r) = design.clone().qr().unpack();
    let coefficients = r.solve_upper_triangular(&(q.transpose() * &values))?;
    let residuals = &values - design * &coefficients;
    // Limit s → 0 of the terms.
    let error = match expansion {
        Expansion::Power(p) => -coefficients[1] * power_term(p, 0.0),
        _ => coefficients.rows(1, columns - 1).sum(),
    };
    let at_finest = coefficients[0];
    let fit = ExpansionFit {
        expansion,
        weighted,
        limit: finest.value + at_finest - error,
        deviation: (residuals.norm_squared() / freedom as f64).sqrt(),
        error,
        distance: at_finest.abs(),
    };
    fit.deviation.is_finite().then_some(fit)
}

/// (s^p − 1)/p, log s for p = 0: equivalent to s^p beside a constant, and never collinear with it.
fn power_term(p: f64, s: f64) -> f64 {
    if p == 0.0 { s.ln() } else { (p * s.ln()).exp_m1() / p }
}

#[cfg(test)]
mod tests;
