//! Tangents against differences of the residual.

use vhi::StepInequality;

/// The step of central differences: truncation 1e-12 over curvature, rounding 1e-16/1e-6 times the condition of the matrix.
const STEP: f64 = 1e-6;
/// The residual of the linear solve: a thousandth of the agreement that tests ask for.
const FORCING: f64 = 1e-10;

/// ‖J⁻¹(F(u + s d) - F(u - s d))/2s - d‖/‖d‖ of a level that is begun, without graphs.
pub fn mismatch(problem: &mut impl StepInequality, u: &[f64], d: &[f64]) -> f64 {
    let mut force = |scale: f64| {
        let at: Vec<f64> = u.iter().zip(d).map(|(u, d)| u + scale * d).collect();
        let mut out = vec![0.0; u.len()];
        problem.residual(&at, &mut out);
        out
    };
    let (plus, minus) = (force(STEP), force(-STEP));
    force(0.0);
    let mut x: Vec<f64> = plus.iter().zip(&minus).map(|(p, m)| (p - m) / (2.0 * STEP)).collect();
    problem.linearize(&[], &[]).expect("a positive definite tangent");
    problem.solve(&mut x, FORCING).expect("a solve");
    let off: f64 = x.iter().zip(d).map(|(x, d)| (x - d).powi(2)).sum();
    let size: f64 = d.iter().map(|d| d * d).sum();
    (off / size).sqrt()
}
