//! The zone of Γ3 under pressure: its extent and its largest pressure.

use serde::Serialize;

use fem::contact::{Discretization, StepView};

/// Quantities of the pressure ξ + λ at the points of Γ3; the field names are JSON keys.
#[derive(Debug, Clone, Copy, Default, Serialize)]
pub struct PressedZone {
    /// Half of the length of Γ3 on which ξ + λ > 0, each vertex with its share of the edges (plane scenes; null in
    /// space). It changes by whole cells.
    pub contact_half_width: Option<f64>,
    /// Largest ξ + λ; null without Γ3.
    pub peak_pressure: Option<f64>,
    /// √(∫ p |x - x̄|² / ∫ p), x̄ the centre of pressure p = ξ + λ > 0: half of the half-width under Hertz's pressure;
    /// null where there is no pressure.
    pub pressure_spread: Option<f64>,
}

impl PressedZone {
    /// Of the level that `view` shows.
    pub(super) fn new(space: &Discretization, view: &StepView<'_>) -> Self {
        let (mut zone, mut length) = (Self::default(), 0.0);
        let (mut force, mut first, mut second) = (0.0, [0.0; 3], 0.0);
        for (i, point) in space.trace.points.iter().enumerate() {
            let pressure = view.compliance[i] + view.multiplier[i];
            let peak = zone.peak_pressure.unwrap_or(f64::NEG_INFINITY);
            zone.peak_pressure = Some(peak.max(pressure));
            if pressure > 0.0 {
                let x = space.mesh.point(&[point.vertex], &[1.0]);
                length += point.weight;
                force += point.weight * pressure;
                second += point.weight * pressure * x.iter().map(|x| x * x).sum::<f64>();
                (0..3).for_each(|a| first[a] += point.weight * pressure * x[a]);
            }
        }
        if space.mesh.dimension == 2 && !space.trace.points.is_empty() {
            zone.contact_half_width = Some(0.5 * length);
        }
        if force > 0.0 {
            let centre: f64 = first.iter().map(|moment| (moment / force).powi(2)).sum();
            zone.pressure_spread = Some((second / force - centre).max(0.0).sqrt());
        }
        zone
    }
}
