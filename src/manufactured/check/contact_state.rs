//! Contact state on Γ3: signs, complementarity, which states occur, and whether h3 vanishes.

use super::{Finding, SideOfRectangle, Status};
use crate::manufactured::Exact;
use crate::manufactured::constitutive::stress;
use crate::norms::is_locked;

/// Samples along a side and in time.
const ALONG: usize = 200;
const TIMES: usize = 40;
/// |h3| below this share of the largest stress on Γ3 is rounding of the formulas.
const PURE: f64 = 1e-9;

#[derive(Default)]
struct Extremes {
    penetration: f64,
    tension: f64,
    complementarity: f64,
    pressure: f64,
    sourced: f64,
    stress: f64,
    states: [usize; 4],
    samples: usize,
}

pub(super) fn contact(exact: &Exact, sides: &[SideOfRectangle]) -> Vec<Finding> {
    if exact.data.contact.is_none() {
        return Vec::new();
    }
    let mut extremes = Extremes { penetration: f64::NEG_INFINITY, ..Extremes::default() };
    for side in sides.iter().filter(|side| side.contact) {
        sample(exact, side, &mut extremes);
    }
    let Extremes { penetration, tension, complementarity, pressure, sourced, stress, .. } =
        extremes;
    let scale = stress.max(f64::MIN_POSITIVE);
    let mut findings = Vec::new();
    if penetration.is_finite() {
        let text = format!("largest u_nu - g on the samples is {penetration:.2e}");
        let status = if penetration <= 1e-9 { Status::Verified } else { Status::Failed };
        findings.push(Finding::new("u_nu <= g", status, penetration, text));
    }
    let status = if tension >= 0.0 { Status::Verified } else { Status::Failed };
    let text = format!("smallest multiplier {tension:.2e}, largest pressure {pressure:.3e}");
    findings.push(Finding::new("lambda >= 0", status, tension, text));
    let status = if complementarity <= 1e-9 * scale { Status::Verified } else { Status::Failed };
    let text = format!("largest lambda (g - u_nu) is {complementarity:.2e}");
    findings.push(Finding::new("complementarity", status, complementarity, text));
    let share = |count: usize| 100.0 * count as f64 / extremes.samples.max(1) as f64;
    let [open, compliant, grazing, locked] = extremes.states.map(share);
    let text = format!(
        "of Gamma3 x [0,T]: open {open:.0} %, compliant {compliant:.0} %, grazing {grazing:.0} %, locked {locked:.0} %"
    );
    findings.push(Finding::new("contact states", Status::Fact, locked, text));
    let relative = sourced / scale;
    let text = if relative <= PURE {
        format!("pure: |h3| <= {relative:.1e} of the stress on Gamma3")
    } else {
        format!("sourced: |h3| up to {relative:.2} of the largest stress on Gamma3")
    };
    findings.push(Finding::new("h3 = sigma nu + c nu", Status::Fact, relative, text));
    findings
}

fn sample(exact: &Exact, side: &SideOfRectangle, extremes: &mut Extremes) {
    let formulas = exact.boundary(&side.normal);
    let points: Vec<[f64; 3]> =
        (0..=ALONG).map(|i| side.point(exact.data.size, i as f64 / ALONG as f64)).collect();
    let (mut bound, mut inside) = (formulas.program.bind(&points), exact.interior.bind(&points));
    let mut values = vec![Vec::new(); 5];
    let mut fields = vec![Vec::new(); 5 + exact.memory.len()];
    for n in 0..=TIMES {
        let t = exact.data.horizon * n as f64 / TIMES as f64;
        bound.evaluate(t, 0.0, &mut values);
        inside.evaluate(t, 0.0, &mut fields);
        let kappa = exact.kappa(t);
        for p in 0..points.len() {
            let [u_nu, pressure, gap, _, lambda] = [0, 1, 2, 3, 4].map(|i| values[i][p]);
            let tensor = |first: usize| {
                let at = |i: usize| fields[first + i][p];
                [[at(0), at(1)], [at(1), at(2)]]
            };
            let memory = if exact.memory.is_empty() { [[0.0; 2]; 2] } else { tensor(5) };
            let sigma = stress(&exact.data.material, &tensor(2), &memory, kappa);
            extremes.add(u_nu, pressure, gap, lambda);
            let normal = side.normal;
            let traction = sigma.map(|row| row[0] * normal[0] + row[1] * normal[1]);
            let h3 = [traction[0] + pressure * normal[0], traction[1] + pressure * normal[1]];
            extremes.sourced = extremes.sourced.max(h3[0].hypot(h3[1]));
            extremes.stress = sigma.iter().flatten().fold(extremes.stress, |m, s| m.max(s.abs()));
        }
    }
}

impl Extremes {
    fn add(&mut self, u_nu: f64, pressure: f64, gap: f64, lambda: f64) {
        self.samples += 1;
        self.tension = self.tension.min(lambda);
        self.pressure = self.pressure.max(pressure);
        let locked = is_locked(u_nu, gap);
        if gap.is_finite() {
            self.penetration = self.penetration.max(u_nu - gap);
            self.complementarity = self.complementarity.max((lambda * (gap - u_nu)).abs());
        }
        let state = match (locked, lambda > 0.0) {
            (true, true) => 3,
            (true, false) => 2,
            _ => usize::from(u_nu > 0.0),
        };
        self.states[state] += 1;
    }
}
