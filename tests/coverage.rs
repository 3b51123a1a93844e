//! Whether the intervals of orders and constants contain the truth: 1,000 simulated tables a cell.

use gronwall::fit::{Correction, Sample, constant_under, order_interval};

const TABLES: usize = 1000;
const ORDERS: [f64; 4] = [0.5, 1.0, 1.5, 2.0];

struct Random(u64);
impl Random {
    fn between(&mut self, lo: f64, hi: f64) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        lo + (hi - lo) * ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }
    fn normal(&mut self) -> f64 {
        let radius = (-2.0 * self.between(f64::MIN_POSITIVE, 1.0).ln()).sqrt();
        radius * self.between(0.0, std::f64::consts::TAU).cos()
    }
}

struct Drawn { order: f64, constant: f64, samples: Vec<Sample> }

fn draw(random: &mut Random, levels: i32, noise: f64, power: i32) -> Drawn {
    let order = ORDERS[(random.between(0.0, 4.0) as usize).min(3)];
    let constant = random.between(-2.0, 2.0).exp();
    let bend = random.between(-4.0, 4.0);
    let first = (random.between(0.0, f64::from(7 - levels)) as i32).min(6 - levels);
    let samples = (first..first + levels).map(|level| {
        let step = 0.125 * 0.5f64.powi(level);
        let exact = constant * step.powf(order) * (1.0 + bend * step.powi(power));
        Sample { step, error: exact * (noise * random.normal()).exp() }
    }).collect();
    Drawn { order, constant, samples }
}

#[test]
fn experiment() {
    for power in [1, 2] { for correction in [Correction::Linear, Correction::Quadratic] {
    for levels in [4, 5, 6] { for noise in [0.0, 0.01, 0.02] {
        let mut random = Random(levels as u64 * 7 + (noise * 100.0) as u64);
        let (mut c, mut cc, mut w, mut wc) = (0, 0, vec![], vec![]);
        let mut parts = [0; 5];
        let mut pw: [Vec<f64>; 5] = Default::default();
        for _ in 0..TABLES {
            let d = draw(&mut random, levels, noise, power);
            let f = order_interval(&d.samples, correction).unwrap();
            c += usize::from(f.interval.contains(d.order));
            w.push(f.interval.half_width());
            for (i, p) in [f.student, f.windows, f.drift, f.curvature.unwrap(), f.student.hull(f.windows).hull(f.drift)].into_iter().enumerate() { parts[i] += usize::from(p.contains(d.order)); pw[i].push(p.half_width()); }
            let (_, i) = constant_under(d.order, &d.samples).unwrap();
            cc += usize::from(i.contains(d.constant));
            wc.push(i.half_width() / d.constant);
        }
        let med = |w: &mut Vec<f64>| { w.sort_by(f64::total_cmp); w[TABLES / 2] };
        let pm: Vec<String> = pw.iter_mut().map(|w| format!("{:.3}", med(w))).collect();
        println!("true power {power} {correction:?} {levels} {noise}: order {c} half-width {:.4} parts {parts:?} {pm:?}; constant {cc} rel half-width {:.4}", med(&mut w), med(&mut wc));
    }}}}
}
