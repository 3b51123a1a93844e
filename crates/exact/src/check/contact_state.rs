//! Contact state on Γ3: signs, complementarity, occurring states, and whether h3 vanishes.

use super::sliding::SlidingExtremes;
use super::{BodyFace, Finding, Status};
use crate::Sliding;
use crate::constitutive::{Tensor, full};
use crate::{ContactFormulas, Exact};
use fem::mesh::in_dimension;
use fem::norms::is_locked;

/// Samples along an edge, along each direction of a face of a box or of one of many triangles, and in time.
const ALONG: u32 = 200;
const ON_FACE: u32 = 32;
const ON_TRIANGLE: u32 = 8;
const TIMES: usize = 40;
/// |h3| below this share of the largest stress or pressure on Γ3 is rounding of the formulas.
const PURE: f64 = 1e-9;

/// States of a point of Γ3, as indices.
const OPEN: usize = 0;
const COMPLIANT: usize = 1;
const GRAZING: usize = 2;
const LOCKED: usize = 3;

#[derive(Default)]
struct Extremes {
    penetration: f64,
    /// Largest |g| and |u_ν|, if there is a gap.
    lengths: f64,
    tension: f64,
    complementarity: f64,
    pressure: f64,
    sourced: f64,
    stress: f64,
    friction: Option<SlidingExtremes>,
    states: [usize; 4],
    samples: usize,
}

pub(super) fn contact(exact: &Exact, faces: &[BodyFace]) -> Vec<Finding> {
    if exact.data.contact.is_empty() {
        return Vec::new();
    }
    let mut extremes = Extremes { penetration: f64::NEG_INFINITY, ..Extremes::default() };
    for BodyFace { side, face, .. } in faces.iter().filter(|of| of.contact) {
        let count = match (exact.dimension(), face.triangle) {
            (2, _) => ALONG,
            (_, false) => ON_FACE,
            (_, true) => ON_TRIANGLE,
        };
        let (points, part) = (face.points(count), (*side, face.normal));
        in_dimension!(exact.dimension(), D => sample::<D>(exact, &points, part, &mut extremes));
    }
    let Extremes {
        penetration, lengths, tension, complementarity, pressure, sourced, stress, ..
    } = extremes;
    let scale = stress.max(pressure).max(f64::MIN_POSITIVE);
    let mut findings = Vec::new();
    if penetration.is_finite() {
        let text = format!("largest u_nu - g on the samples is {penetration:.2e}");
        let status = if penetration <= 1e-9 * lengths { Status::Verified } else { Status::Failed };
        findings.push(Finding::new("u_nu <= g", status, penetration, text));
    }
    let status = if tension >= 0.0 { Status::Verified } else { Status::Failed };
    let text = format!("smallest multiplier {tension:.2e}, largest pressure {pressure:.3e}");
    findings.push(Finding::new("lambda >= 0", status, tension, text));
    let status =
        if complementarity <= 1e-9 * scale * lengths { Status::Verified } else { Status::Failed };
    let text = format!("largest lambda (g - u_nu) is {complementarity:.2e}");
    findings.push(Finding::new("complementarity", status, complementarity, text));
    let locked = extremes.share(LOCKED);
    let text = extremes.states_in_words(&exact.data.contact);
    findings.push(Finding::new("contact states", Status::Fact, locked, text));
    if let Some(friction) = &extremes.friction {
        findings.extend(friction.findings(scale, extremes.samples));
    }
    let relative = sourced / scale;
    let text = if relative <= PURE {
        format!("pure: |h3| <= {relative:.1e} of the stress on Gamma3")
    } else {
        format!("sourced: |h3| up to {relative:.2} of the largest stress or pressure on Gamma3")
    };
    findings.push(Finding::new("h3 = sigma nu + c nu", Status::Fact, relative, text));
    findings
}

fn sample<const D: usize>(
    exact: &Exact,
    points: &[[f64; 3]],
    (side, normal): (u32, [f64; 3]),
    extremes: &mut Extremes,
) {
    let formulas = exact.boundary(side, &normal[..D]);
    let has_law = exact.contact_on(side).is_some_and(|contact| contact.law.is_some());
    let bilateral = exact.contact_on(side).is_some_and(|contact| contact.bilateral);
    let (mut bound, mut inside) = (formulas.program.bind(points), exact.fields.bind(points));
    let first = D + exact.strain.len();
    let friction = exact.friction(side, &normal[..D]);
    let mut sliding = friction.map(|friction| (friction.tangents, friction.program.bind(points)));
    for n in 0..=TIMES {
        let t = exact.data.horizon * n as f64 / TIMES as f64;
        let (values, fields) = (bound.values_at(t, 0.0), inside.values_at(t, exact.zeta.at(t)));
        let slides = sliding.as_mut().map(|(tangents, bound)| (*tangents, bound.values_at(t, 0.0)));
        for p in 0..points.len() {
            let [u_nu, pressure, gap, _, lambda] = [0, 1, 2, 3, 4].map(|i| values[i][p]);
            let sigma: Tensor<D> = full(|k| fields[first + k][p]);
            extremes.add(u_nu, pressure, gap, lambda, has_law);
            let mut along = [0.0; 3];
            if let Some((tangents, slides)) = &slides {
                let sliding_state = Sliding::new(*tangents, D, |i| slides[i][p]);
                extremes.friction.get_or_insert_default().add(&sliding_state);
                along = sliding_state.stress();
            }
            let traction = |i: usize| sigma[i].iter().zip(&normal).map(|(s, n)| s * n).sum::<f64>();
            // Where u_ν = 0, the reaction is what σ leaves.
            let reaction = match bilateral {
                true => -(0..D).map(|i| traction(i) * normal[i]).sum::<f64>(),
                false => pressure,
            };
            let h3 = (0..D).map(|i| traction(i) + reaction * normal[i] + along[i]);
            let h3 = h3.map(|component| component * component).sum::<f64>().sqrt();
            extremes.sourced = extremes.sourced.max(h3);
            extremes.stress = sigma.iter().flatten().fold(extremes.stress, |m, s| m.max(s.abs()));
        }
    }
}

impl Extremes {
    fn add(&mut self, u_nu: f64, pressure: f64, gap: f64, lambda: f64, has_law: bool) {
        self.samples += 1;
        self.tension = self.tension.min(lambda);
        self.pressure = self.pressure.max(pressure);
        let locked = is_locked(u_nu, gap);
        if gap.is_finite() {
            self.penetration = self.penetration.max(u_nu - gap);
            self.lengths = self.lengths.max(u_nu.abs()).max(gap.abs());
            self.complementarity = self.complementarity.max((lambda * (gap - u_nu)).abs());
        }
        let state = match (locked, lambda > 0.0) {
            (true, true) => LOCKED,
            (true, false) => GRAZING,
            // Without a law nothing is compressed before the gap closes.
            _ if has_law && u_nu > 0.0 => COMPLIANT,
            _ => OPEN,
        };
        self.states[state] += 1;
    }

    /// Per cent of the samples in a state.
    fn share(&self, state: usize) -> f64 {
        100.0 * self.states[state] as f64 / self.samples.max(1) as f64
    }

    /// The possible states: compliant needs a law, grazing and locked need a gap.
    fn states_in_words(&self, contact: &[ContactFormulas]) -> String {
        let has_law = contact.iter().any(|contact| contact.law.is_some());
        let has_gap = contact.iter().any(|contact| contact.gap.is_some());
        if contact.iter().any(|contact| contact.bilateral) {
            return "bilateral: u_nu = 0 on Gamma3, which no tension opens".into();
        }
        let absent = match (has_law, has_gap) {
            (false, false) => return "no law and no gap: Gamma3 is free".into(),
            (false, true) => " (no law)",
            (true, false) => " (no gap)",
            (true, true) => "",
        };
        let states = [
            (OPEN, "open", true),
            (COMPLIANT, "compliant", has_law),
            (GRAZING, "grazing", has_gap),
            (LOCKED, "locked", has_gap),
        ];
        let possible = states.into_iter().filter(|(.., possible)| *possible);
        let share = |(state, name, _)| format!("{name} {:.0} %", self.share(state));
        let shares: Vec<String> = possible.map(share).collect();
        format!("of Gamma3 x [0,T]: {}{absent}", shares.join(", "))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::LawNumbers;
    use formula::Graph;

    /// The words for samples at u_ν = 0.05 below a gap: one open, one touching, one pressed.
    fn words(has_law: bool, has_gap: bool) -> String {
        let law = LawNumbers {
            points: vec![[0.0, 0.0]],
            slope_before: 0.0,
            slope_after: 1.0,
            curve: None,
        };
        let contact = ContactFormulas {
            law: has_law.then_some(law),
            gap: has_gap.then(|| Graph::new().constant(0.1)),
            ..ContactFormulas::default()
        };
        let mut extremes = Extremes::default();
        let gap = if has_gap { 0.1 } else { f64::INFINITY };
        for (u_nu, lambda) in [(-0.1, 0.0), (0.05, 0.0), (0.1, 0.0), (0.1, 1.0)] {
            extremes.add(u_nu, lambda, gap, lambda, has_law);
        }
        extremes.states_in_words(&[contact])
    }

    #[test]
    fn states_are_named_only_where_law_or_gap_make_them() {
        let on = "of Gamma3 x [0,T]: ";
        let all = format!("{on}open 25 %, compliant 25 %, grazing 25 %, locked 25 %");
        assert_eq!(words(true, true), all);
        let gap_alone = format!("{on}open 50 %, grazing 25 %, locked 25 % (no law)");
        assert_eq!(words(false, true), gap_alone);
        assert_eq!(words(true, false), format!("{on}open 25 %, compliant 75 % (no gap)"));
        assert_eq!(words(false, false), "no law and no gap: Gamma3 is free");
    }
}
