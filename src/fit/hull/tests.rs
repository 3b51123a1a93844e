//! Intervals on laws whose order is known, one by one and by simulation.

use super::*;

fn refined(ratio: f64, levels: i32, error: impl Fn(f64) -> f64) -> Vec<Sample> {
    (0..levels)
        .map(|level| 0.125 * ratio.powi(-level))
        .map(|step| Sample { step, error: error(step) })
        .collect()
}

#[test]
fn exact_laws_give_a_point_that_holds_the_truth() {
    for ratio in [1.3, 1.5, 2.0] {
        for order in [0.5, 1.0, 2.0, -2.0] {
            for levels in 3..8 {
                let samples = refined(ratio, levels, |h| 1e-9 * h.powf(order));
                let found = order_interval(&samples, Correction::Linear).unwrap();
                assert!(found.interval.contains(order), "{ratio} {order} {found:?}");
                // Student's factor 12.7 on rounding; nothing else is there.
                assert!(found.interval.half_width() < 1e-10, "{ratio} {order} {found:?}");
            }
        }
    }
}

/// e = h + 4h² on h = 1/8 … 1/256: every window lies in [1.03, 1.21], on one side of 1.
#[test]
fn bias_is_covered_though_every_window_misses() {
    let samples = refined(2.0, 6, |h| h + 4.0 * h * h);
    let found = order_interval(&samples, Correction::Linear).unwrap();
    assert!(found.windows.lo > 1.03 && found.windows.hi < 1.21);
    assert!(found.interval.contains(1.0) && found.interval.half_width() <= 0.15);
}

#[test]
fn divergence_is_negative() {
    let samples = refined(2.0, 5, |h| h.powi(-2));
    let found = order_interval(&samples, Correction::Quadratic).unwrap();
    assert!(found.interval.contains(-2.0) && found.interval.hi < -1.9);
}

#[test]
fn fewer_than_three_points_have_no_interval() {
    let samples = refined(2.0, 2, |h| h);
    let refused = order_interval(&samples, Correction::Linear).unwrap_err();
    assert_eq!(refused, FitError::TooFew { found: 2, needed: 3 });
    assert!(order_interval(&[], Correction::Linear).is_err());
}

/// A linear congruential generator (Knuth's MMIX constants), uniform on [0, 1).
struct Lcg(u64);

impl Lcg {
    fn uniform(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }

    fn normal(&mut self) -> f64 {
        let radius = (-2.0 * (1.0 - self.uniform()).ln()).sqrt();
        radius * (std::f64::consts::TAU * self.uniform()).cos()
    }
}

/// Coverage and median half-width over 1,000 tables e = C s^p (1 + D s^r)(1 + noise).
fn simulate(levels: i32, noise: f64, correction: Correction) -> (f64, f64) {
    let mut random = Lcg(20 + levels as u64);
    let mut widths = Vec::new();
    let mut covered = 0;
    for _ in 0..1000 {
        let order = 0.5 + 2.0 * random.uniform();
        let constant = (4.0 * random.uniform() - 2.0).exp();
        let bend = 8.0 * random.uniform() - 4.0;
        let samples: Vec<Sample> = refined(2.0, levels, |step| {
            constant * step.powf(order) * (1.0 + bend * step.powi(correction.power()))
        })
        .into_iter()
        .map(|exact| Sample { error: exact.error * (noise * random.normal()).exp(), ..exact })
        .collect();
        let found = order_interval(&samples, correction).unwrap();
        covered += usize::from(found.interval.contains(order));
        widths.push(found.interval.half_width());
    }
    widths.sort_by(f64::total_cmp);
    (covered as f64 / 1000.0, widths[500])
}

#[test]
fn simulated_coverage_is_at_least_95_percent() {
    for correction in [Correction::Linear, Correction::Quadratic] {
        for levels in [4, 5, 6] {
            for noise in [0.0, 0.01, 0.02] {
                let (coverage, median) = simulate(levels, noise, correction);
                println!("{correction:?} {levels} levels, noise {noise}: {coverage} {median:.4}");
                assert!(coverage >= 0.95, "{levels} levels, noise {noise}: {coverage}");
            }
        }
    }
}
